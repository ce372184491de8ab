"""Choice of the engine: the compiled one if it is worthwhile and usable, otherwise NumPy's."""

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
"""Modules that the compiled engine calls, all of which must be available."""
KERNELS = (
    ("loadshare.solver.hot.compiled", "_settle_all"),
    ("loadshare.certify.bound.kernel", "find_all"),
    ("loadshare.certify.bound.kernel", "bound_all"),
)
"""Functions that take long to compile; all others take a moment."""


def engine_named(name: str, count: int) -> Engine:
    """Return an engine by name.

    Parameters
    ----------
    name : {"auto", "compiled", "vectorised"}
        "auto" is the compiled one if it was used in this process, otherwise the one that `chosen`
        names. If nothing can be compiled or kept, the vectorised one takes its place.
    count : int
        Equilibria to solve.
    """
    if name not in ENGINES:
        raise ValueError(f"unknown engine {name!r}; allowed: {', '.join(ENGINES)}")
    if name == "auto":
        name = "compiled" if loaded() else chosen(count)
    return vectorised.settle if name == "vectorised" else _compiled() or vectorised.settle


def chosen(count: int) -> str:
    """Return the name of the engine that is fastest for `count` equilibria in a new process.

    Up to a few hundred it is the vectorised one. Above, it is the compiled one if that is kept on
    disk, or if there are so many that compiling takes less time than it saves.
    """
    if count <= JOB.few:
        return "vectorised"
    return "compiled" if count > JOB.compiling or is_available() else "vectorised"


def loaded() -> bool:
    """Return whether the compiled engine was used or loaded in this process, and so is fastest."""
    # Another thread may be importing one of the modules.
    kernels = [getattr(sys.modules.get(module), name, None) for module, name in KERNELS]
    return compilation.why_not() is None and all(k is not None and k.overloads for k in kernels)


def is_available() -> bool:
    """Return whether the compiled engine needs no compiling; code on disk is loaded."""
    try:
        needed = [getattr(import_module(module), name) for module, name in KERNELS]
    except Exception:  # noqa: BLE001 -- those who ask for the compiled one are told
        return False
    return compilation.is_available(*needed)


@dataclass(slots=True)
class Tally:
    """Count of what callers who solve case by case have solved in this process.

    Attributes
    ----------
    equilibria : int
    """

    equilibria: int = 0


tally = Tally()


def available_engine(name: str, count: int) -> Engine:
    """Return an engine by name, for callers who solve case by case.

    Parameters
    ----------
    name : {"auto", "compiled", "vectorised"}
        "auto" is the compiled one if that needs no compiling: once it was used in this process, or
        once so many equilibria were solved that reading it from disk is worthwhile.
    count : int
        Equilibria to solve.
    """
    if name != "auto":
        return engine_named(name, count)
    tally.equilibria += count
    if not loaded() and (tally.equilibria <= JOB.few or not is_available()):
        return vectorised.settle
    from loadshare.solver.hot import compiled

    return compiled.settle


def _compiled() -> Engine | None:
    """Return the compiled engine; None, with a message in the log, if it cannot be used."""
    try:
        for name in COMPILED:
            import_module(name)
    except Exception as error:  # noqa: BLE001 -- whatever it is, there is another engine
        compilation.give_up(compilation.words_of(error))
    if compilation.why_not() is None:
        from loadshare.solver.hot import compiled

        return compiled.settle
    compilation.log_why_not()
    return None
