"""Which engine solves: the compiled one, where that is worth while and can be, or NumPy's."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from importlib import import_module

from loadshare import compilation
from loadshare.settings import JOB
from loadshare.solver.hot import vectorised
from loadshare.solver.hot.exchange import Engine

ENGINES = ("auto", "compiled", "vectorised")
COMPILED = (
    "loadshare.solver.hot.compiled",
    "loadshare.solver.hot.products",
    "loadshare.solver.hot.touching",
    "loadshare.certify.bound.kernel",
)
"""What a quick answer calls, all of which must be there."""
KERNELS = (
    ("loadshare.solver.hot.compiled", "_settle_all"),
    ("loadshare.certify.bound.kernel", "find_all"),
    ("loadshare.certify.bound.kernel", "bound_all"),
)
"""What takes long to compile of all that answers a case; the rest takes a moment."""


def engine_named(name: str, count: int) -> Engine:
    """Return an engine by name.

    Parameters
    ----------
    name : {"auto", "compiled", "vectorised"}
        "auto" is the compiled one where it was used in this process, else the one that `chosen`
        names. Where nothing can be compiled or kept, the vectorised one takes its place.
    count : int
        Equilibria to solve.
    """
    if name not in ENGINES:
        raise ValueError(f"unknown engine {name!r}; allowed: {', '.join(ENGINES)}")
    if name == "auto":
        name = "compiled" if loaded() else chosen(count)
    return vectorised.settle if name == "vectorised" else _compiled() or vectorised.settle


def chosen(count: int) -> str:
    """Name the engine that is done first with so many equilibria in a new process.

    Up to a few hundred it is the vectorised one. Above, it is the compiled one where that is kept
    on disk, and where there are so many that compiling takes less time than it saves.
    """
    if count <= JOB.few:
        return "vectorised"
    return "compiled" if count > JOB.compiling or at_hand() else "vectorised"


def loaded() -> bool:
    """Whether the compiled engine was used, or loaded, in this process: then it is always ahead."""
    # Another thread may be importing one of the modules.
    kernels = [getattr(sys.modules.get(module), name, None) for module, name in KERNELS]
    return compilation.why_not() is None and all(k is not None and k.overloads for k in kernels)


def at_hand() -> bool:
    """Whether the compiled engine is there without compiling; what is on disk is loaded."""
    try:
        needed = [getattr(import_module(module), name) for module, name in KERNELS]
    except Exception:  # noqa: BLE001 -- those who ask for the compiled one are told
        return False
    return compilation.at_hand(*needed)


@dataclass(slots=True)
class Tally:
    """What was solved in this process by those who solve case by case.

    Attributes
    ----------
    equilibria : int
    """

    equilibria: int = 0


tally = Tally()


def engine_at_hand(name: str, count: int) -> Engine:
    """Return an engine by name, for those who solve case by case.

    Parameters
    ----------
    name : {"auto", "compiled", "vectorised"}
        "auto" is the compiled one where that takes no compiling: once it was used in this process,
        or once so many equilibria were solved that reading it from disk is worth while.
    count : int
        Equilibria to solve.
    """
    if name != "auto":
        return engine_named(name, count)
    tally.equilibria += count
    if not loaded() and (tally.equilibria <= JOB.few or not at_hand()):
        return vectorised.settle
    from loadshare.solver.hot import compiled

    return compiled.settle


def _compiled() -> Engine | None:
    """Return the compiled engine; None, with a word in the log, where it cannot be used."""
    try:
        for name in COMPILED:
            import_module(name)
    except Exception as error:  # noqa: BLE001 -- whatever it is, there is another engine
        compilation.give_up(compilation.words_of(error))
    if compilation.why_not() is None:
        from loadshare.solver.hot import compiled

        return compiled.settle
    compilation.tell_why_not()
    return None
