from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import cache
from typing import Any

import pytest
from tests.chromium import as_new
from tests.support import CASES, round_ring, shipped

import loadshare as ls
from loadshare.report.figures.train import train
from loadshare.report.page import Chapter, chapter_of_file


@pytest.fixture(scope="module")
def browser(chrome) -> Any:
    """Return a headless Chromium without a network."""
    return as_new(chrome, offline=True)


@pytest.fixture(scope="session")
def limit_ring() -> ls.Result:
    """Return two floating pinions on their rings; all five positions are the same."""
    return ls.solve(shipped("fgfbstts/limit_ring"))


@pytest.fixture(scope="session")
def all_elements() -> ls.Result:
    """Return a result with every element, at positions that differ."""
    return ls.solve(shipped("fgfbstts/all_elements"), positions=[1, 2, 7, 10])


@pytest.fixture(scope="session")
def full_float() -> ls.Result:
    """Return pinions on clearance splines that slip."""
    return ls.solve(shipped("fgfbstts/full_float"), positions=[1])


@pytest.fixture(scope="session")
def pressed_sun() -> ls.Result:
    """Return a sun on a round ring that is off centre."""
    return ls.solve(round_ring())


@pytest.fixture(scope="session")
def picture(request) -> Callable[..., Any]:
    """Return a function that draws a picture of one of the results above, once."""

    @cache
    def drawn(result: str, kind: str, *settings: str) -> Any:
        return getattr(request.getfixturevalue(result).plot, kind)(*settings)

    return drawn


@pytest.fixture(scope="session")
def drawing() -> Callable[[str], Any]:
    """Return a function that draws a shipped case, once."""
    return cache(lambda name: train(shipped(name)))


@pytest.fixture(scope="session")
def ring_chapter() -> Chapter:
    """Return the chapter of a page: two floating pinions on their rings."""
    return chapter_of_file(CASES / "fgfbstts/limit_ring.toml")


class Spec:
    """A specification, with methods to read its content."""

    def __init__(self, spec: dict[str, Any]) -> None:
        self.spec = spec

    def units(self) -> Iterator[dict[str, Any]]:
        """Yield every mark with its rows."""
        yield from self._units(self.spec, {})

    def _units(self, part: dict[str, Any], data: dict[str, Any]) -> Iterator[dict[str, Any]]:
        data = part.get("data", data)
        if "mark" in part:
            rows = data.get("values") or self.spec.get("datasets", {}).get(data.get("name"), [])
            yield {**part, "rows": rows}
        for key in ("layer", "concat", "hconcat", "vconcat"):
            for inner in part.get(key, ()):
                yield from self._units(inner, data)

    def marks(self, kind: str) -> list[dict[str, Any]]:
        return [u for u in self.units() if u["mark"]["type"] == kind]

    def rows(self, kind: str, field: str) -> list[dict[str, Any]]:
        """Return the rows of all marks of a kind that have a field."""
        return [r for u in self.marks(kind) for r in u["rows"] if field in r]

    def words(self) -> str:
        """Return all words: texts, titles, subtitles."""
        found: list[str] = [str(r["text"]) for r in self.rows("text", "text")]

        def walk(part: Any) -> None:
            if isinstance(part, dict):
                title = part.get("title")
                if isinstance(title, dict):
                    found.append(str(title.get("text", "")))
                    found.extend(map(str, title.get("subtitle", [])))
                elif isinstance(title, str):
                    found.append(title)
                for value in part.values():
                    walk(value)
            elif isinstance(part, list):
                for value in part:
                    walk(value)

        walk({k: v for k, v in self.spec.items() if k != "datasets"})
        return "\n".join(found)


@pytest.fixture(scope="session")
def read() -> type[Spec]:
    """Return the reader of a figure's specification."""
    return Spec
