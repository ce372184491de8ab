"""Critical values: the values of a parameter at which the active set changes.

On one active set the equilibrium follows smooth equations. Between two certified points with the
same set, a bound proves that no gauge of an element (an approach, a force, a radius) reaches zero.
Where the sets differ, the zero of a gauge is found on the branch, and the stretches on either side
are proved up to it (`loadshare.study.follow`). Stretches that cannot be proved are listed.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import astuple, dataclass, fields, replace
from pathlib import Path as FilePath

from loadshare.case import Case
from loadshare.errors import CaseError, Problem
from loadshare.job.positions import wanted_positions
from loadshare.libraries import pd
from loadshare.numbers import counted, runs
from loadshare.pictures import Figure, picture
from loadshare.progress import Progress
from loadshare.study.events import Event, events_of, flanks_changed
from loadshare.study.follow.line import Line
from loadshare.study.follow.search import ChangeSearch
from loadshare.study.parameter import (
    RANGE,
    STUDY,
    Parameter,
    check_smooth,
    grid,
    named,
    read_parameter,
)
from loadshare.study.positions import alike, loaded
from loadshare.table import text_table
from loadshare.view import View, Viewed

SHOWN = 5
"""Number of unproved intervals that are listed one by one."""


@dataclass(frozen=True, slots=True)
class Unproved:
    """An interval in which changes of the active set could not be excluded.

    Attributes
    ----------
    position : int
        1-based.
    start, stop : float
        In the parameter's unit.
    why : str
    """

    position: int
    start: float
    stop: float
    why: str


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Critical(Viewed):
    """Events along a parameter.

    Attributes
    ----------
    parameter : Parameter
    start, stop : float
        In the parameter's unit.
    events : tuple of Event
        By position, then by value.
    unproved : tuple of Unproved
        Intervals that may hold further events; everywhere else there are none.
    """

    parameter: Parameter
    start: float
    stop: float
    events: tuple[Event, ...]
    unproved: tuple[Unproved, ...] = ()

    def marks(self, position: int | None = None) -> tuple[tuple[float, str], ...]:
        """Return values and labels for a picture; events at the same value share a label.

        Parameters
        ----------
        position : int, optional
            1-based; that of the first event by default.
        """
        here = [e for e in self.events if e.position == (position or self.events[0].position)]
        words: dict[float, dict[str, None]] = {}
        for event in here:
            what = f"gear {event.gear}" if event.gear else event.element
            words.setdefault(event.value, {})[f"{what}: {event.kind}"] = None
        return tuple((value, "; ".join(events)) for value, events in words.items())

    def of(self, kind: str = "", gear: str | None = None) -> tuple[Event, ...]:
        """Return the events of a kind, of a gear, or of both."""
        return tuple(e for e in self.events if kind in e.kind and (gear is None or e.gear == gear))

    def to_dataframe(self) -> pd.DataFrame:
        """Return the events as a table: a row for each event, a column for each attribute."""
        columns = [f.name for f in fields(Event)]
        return pd.DataFrame(list(map(astuple, self.events)), columns=columns)

    def plot(self) -> Figure:
        """Plot the events: one row for each element, the input along x."""
        return picture(self)

    def _view(self) -> View:
        """Show the interval, what is not proved, and the events, alike positions in one row."""
        name, unit = self.parameter.name, self.parameter.unit
        sure = sum(e.confirmed for e in self.events)
        doubtful = sure < len(self.events)
        facts = (
            (name, f"{self.start:g} to {self.stop:g} {unit}".rstrip()),
            ("events", f"{len(self.events)}, {sure} confirmed" if self.events else "none"),
            ("not proved", counted(len(self.unproved), "interval") if self.unproved else "nothing"),
        )
        alike: dict[tuple[str, ...], list[int]] = {}
        for e in sorted(self.events, key=lambda e: float(f"{e.value:.9g}")):
            confirmed = ["yes" if e.confirmed else "NO"] if doubtful else []
            row = (f"{e.value:.9g}", e.element, e.kind, e.before, e.after, *confirmed)
            alike.setdefault(row, []).append(e.position)
        words = ("element", "event", "below", "above", *(["confirmed"] if doubtful else []), "at")
        proved = "Proved: there are no other events between the certified solves."
        events = text_table(
            f"Events from {self.start:g} to {self.stop:g}" + (f" [{unit}]" if unit else ""),
            (self.parameter.column, *words),
            ((*row, ", ".join(runs(positions, "-"))) for row, positions in alike.items()),
            words,
            [] if doubtful or self.unproved else [proved],
        )
        return View("Critical values", facts, (events,))

    def _left_open(self) -> list[str]:
        doubtful = sum(not event.confirmed for event in self.events)
        lines = []
        if doubtful:
            lines.append(f"{counted(doubtful, 'event')} of {len(self.events)} not confirmed.")
        gaps = sorted({(u.start, u.stop, u.why) for u in self.unproved})
        unit = f" {self.parameter.unit}" if self.parameter.unit else ""
        lines += [
            f"Not proved to be free of other events: {start:.12g} to {stop:.12g}{unit} ({why})."
            for start, stop, why in gaps[:SHOWN]
        ]
        if len(gaps) > SHOWN:
            lines.append(f"{counted(len(gaps) - SHOWN, 'further interval')} not proved.")
        return lines


def critical(
    case: Case | str | FilePath,
    key: str | Sequence[str],
    start: object,
    stop: object,
    *,
    positions: Iterable[int] | None = None,
    progress: Progress | None = None,
) -> Critical:
    """Find every change of the active set along a parameter, with its exact value.

    Parameters
    ----------
    case : Case or path
    key : str or sequence of str
        Input to vary, such as ``"rings.4.float"``; with a star (``"rings.*.float"``) or as several
        keys, all of them take the same value.
    start, stop : physical value or number
        Ends of the interval, such as ``"0 um"`` and ``"12 um"``.
    positions : iterable of int, optional
        1-based positions; all by default. Identical positions are solved once.
    progress : Progress, optional
        Called after every position.

    Returns
    -------
    Critical
        The events, and the intervals in which further events could not be excluded. The zero of an
        event's gauge is found to round-off, about 1e-12 of the value.

    Raises
    ------
    CaseError
        If the key or the values cannot be used.
    Refused
        If an end of the interval has no certified equilibrium.

    Examples
    --------
    >>> import loadshare as ls
    >>> found = ls.critical("cases/fgfbstts/limit_ring.toml", "rings.*.float", "0 um", "12 um",
    ...                     positions=[1])
    >>> {event.gear: f"{event.value:.2f} um" for event in found.of("leaves boundary")}
    {'5': '2.98 um', '4': '8.35 um'}
    """
    name = named(key)
    case = loaded(case, [name])
    numbers, unit = grid([start, stop], "start, stop", RANGE)
    low, high = numbers
    if not low < high:
        message = f"start {low:g} {unit} is not below stop {high:g} {unit}"
        raise CaseError([Problem(STUDY, name, "", message, "start below stop")])
    parameter = read_parameter(case, name, unit)
    check_smooth(parameter)
    line = Line(case, parameter, low, high)
    events: list[Event] = []
    unproved: list[Unproved] = []
    chosen = wanted_positions(line.first, positions)
    done = 0
    for group in alike((line.first, line.last), chosen):
        here = line.at(group[0])
        search = ChangeSearch(here, group[0], low, high)
        search.run()
        found = [e for change in search.changes for e in events_of(here, group[0], change)]
        if any(
            here.first.meshes[n].named_backwards != m.named_backwards
            for n, m in here.last.meshes.items()
        ):
            found += [e for gap in search.gaps for e in flanks_changed(here, group[0], gap)]
        for position in group:
            events += [replace(event, position=position) for event in found]
            unproved += [
                Unproved(position, gap.first.value, gap.last.value, gap.why) for gap in search.gaps
            ]
        done += len(group)
        if progress is not None:
            progress(done, len(chosen))
    events.sort(key=lambda e: (e.position, e.value))
    unproved.sort(key=lambda u: (u.position, u.start))
    return Critical(line.parameter, low, high, tuple(events), tuple(unproved))
