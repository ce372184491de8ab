"""Numba's cache of compiled functions, made safe: damaged or outdated code is compiled again."""

from __future__ import annotations

import hashlib
import pickle
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path
from types import CodeType, FunctionType, ModuleType
from typing import Any

from numba.core.caching import (
    CompileResultCacheImpl,
    FunctionCache,
    IndexDataCacheFile,
    NullCache,
)

from loadshare.compile_watch import watch
from loadshare.lock import one_after_another


def fingerprint(function: Callable[..., Any]) -> str:
    """Return a digest of a function, of all functions it calls and of all constants they read.

    Numba checks only the function's own file, and would keep using old constants of another one.

    Parameters
    ----------
    function
        The plain Python function, not the compiled one.
    """
    parts: list[str] = []
    seen = {function}
    waiting = [function]
    while waiting:
        one = waiting.pop()
        codes = _codes(one.__code__)
        for code in codes:
            # Code objects are left out: their printed form contains an address in memory.
            constants = [c for c in code.co_consts if not isinstance(c, CodeType)]
            parts.append(f"{one.__qualname__} {code.co_code.hex()} {constants!r} {code.co_names!r}")
        names = [name for code in codes for name in code.co_names]
        known = {name: one.__globals__.get(name) for name in names}
        for module in [value for value in known.values() if isinstance(value, ModuleType)]:
            read = {f"{module.__name__}.{n}": vars(module).get(n) for n in names}
            # Functions that are not compiled, such as NumPy's, are supplied by the compiler.
            known |= {n: v for n, v in read.items() if not isinstance(v, FunctionType)}
        for name, value in known.items():
            called = getattr(value, "py_func", value)
            if isinstance(called, FunctionType):
                if called not in seen:
                    seen.add(called)
                    waiting.append(called)
            elif isinstance(value, tuple) and hasattr(value, "_fields"):
                # Only those entries of a settings table that the function reads.
                used = [field for field in value._fields if field in names]
                parts += [f"{name}.{field} = {getattr(value, field)!r}" for field in used]
            elif isinstance(value, int | float | str | tuple):
                parts.append(f"{name} = {value!r}")
    return hashlib.sha256("\n".join(parts).encode()).hexdigest()


def _codes(code: CodeType) -> list[CodeType]:
    """Return the code of a function and of all functions and comprehensions in it."""
    within = [each for c in code.co_consts if isinstance(c, CodeType) for each in _codes(c)]
    return [code, *within]


class _Files(IndexDataCacheFile):
    """Index and data files of a function; damaged or outdated ones count as missing."""

    _function: Callable[..., Any]
    _written: Any

    @property
    def _source_stamp(self) -> Any:
        # Computed late: the functions that it calls may be defined further down in its module.
        return self._written, fingerprint(self._function)

    @_source_stamp.setter
    def _source_stamp(self, stamp: Any) -> None:
        self._written = stamp

    def _load_index(self) -> Any:
        try:
            return super()._load_index()
        except Exception:  # noqa: BLE001 -- a damaged pickle may raise anything
            return {}

    def save(self, key: Any, data: Any) -> None:
        """Save code with a note of what it belongs to: the index is written before the data."""
        super().save(key, (self._kept_for(key), data))

    def load(self, key: Any) -> Any:
        """Load saved code; None where a kill or a full disk left the code of another version."""
        kept_for, data = super().load(key) or (None, None)
        return data if kept_for == self._kept_for(key) else None

    def _kept_for(self, key: Any) -> Any:
        return self._version, self._source_stamp, key

    def _load_data(self, name: str) -> Any:
        """Load saved data; nothing is unpickled or run before its digest has been compared."""
        data = Path(self._data_path(name)).read_bytes()
        size = hashlib.sha256().digest_size
        if hashlib.sha256(data[size:]).digest() != data[:size]:
            raise OSError(f"{name} is damaged")
        return pickle.loads(data[size:])

    def _save_data(self, name: str, data: Any) -> None:
        packed = self._dump(data)
        with self._open_for_write(self._data_path(name)) as file:
            file.write(hashlib.sha256(packed).digest() + packed)


class _Places(CompileResultCacheImpl):
    """Folders in which compiled code may be kept.

    For a user without a home, Numba would make a folder named ``~`` in the working directory.
    """

    def __init__(self, function: Callable[..., Any]) -> None:
        if not _has_home():
            places = [p for p in self._locator_classes if "UserWide" not in p.__name__]
            self._locator_classes = places
        super().__init__(function)


def _has_home() -> bool:
    try:
        Path.home()
    except RuntimeError:
        return False
    return True


class CodeCache(FunctionCache):
    """Compiled code of a function on disk; what cannot be read or written is compiled again.

    If several processes need the same missing code, one compiles it and the others wait.
    """

    _impl_class = _Places

    def __init__(self, function: Callable[..., Any], not_kept: Callable[[Exception], None]) -> None:
        super().__init__(function)
        self._not_kept = not_kept
        self._cache_file = _Files(
            cache_path=self._cache_path,
            filename_base=self._impl.filename_base,
            source_stamp=self._impl.locator.get_source_stamp(),
        )
        self._cache_file._function = function
        self._alone = ExitStack()

    def compiling(self, compile_: Callable[[Any], Any]) -> Callable[[Any], Any]:
        """Return a compile method that releases the lock on the code once it is done."""

        def one_compiles(sig: Any) -> Any:
            with ExitStack() as self._alone:
                return compile_(sig)

        return one_compiles

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Load the code kept for a signature; None where it must be compiled here and now."""
        found = self._read(sig, target_context)
        if found is None and self._ready():
            file = Path(self._cache_file._index_path).with_suffix(".lock")
            self._alone.enter_context(one_after_another(file, watch.waiting))
            # Another process may have compiled it since, whether it was waited for or not.
            return self._read(sig, target_context)
        return found

    def _ready(self) -> bool:
        """Return whether there is a folder to keep code in."""
        try:
            self._impl.locator.ensure_cache_path()
        except OSError:
            return False
        return True

    def _read(self, sig: Any, target_context: Any) -> Any:
        """Load the code kept for a signature; None where that cannot be read."""
        try:
            return super().load_overload(sig, target_context)
        except Exception:  # noqa: BLE001 -- it is compiled again
            return None

    def load_all(self, function: Any) -> bool:
        """Load all code that is kept of a function; return whether there is any."""
        for sig, *_ in self._cache_file._load_index():
            code = self._read(sig, function.targetctx)
            if code is not None:
                # The dispatcher does the same when it is called.
                entry = (code.entry_point, code.fndesc, [code.library])
                function.targetctx.insert_user_function(*entry)
                function.add_overload(code)
        return bool(function.signatures)

    def save_overload(self, sig: Any, data: Any) -> None:
        """Save the code compiled for a signature, if that can be written."""
        try:
            super().save_overload(sig, data)
        except Exception as error:  # noqa: BLE001 -- the compiled code is there, and runs
            self._not_kept(error)


class NoCache(NullCache):
    """A cache that keeps nothing, and reports it when something has been compiled."""

    def __init__(self, not_kept: Callable[[], None]) -> None:
        self._not_kept = not_kept

    def load_all(self, function: Any) -> bool:
        """Return False: nothing is kept."""
        return False

    def save_overload(self, sig: Any, data: Any) -> None:
        """Report that the code is not kept."""
        self._not_kept()
