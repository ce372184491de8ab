"""Samples of a case that are solved together, each of which can be read as if solved alone."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from loadshare.array_types import Numbers
from loadshare.case import Case
from loadshare.errors import CaseError, Refused
from loadshare.job.answer import Answer
from loadshare.job.block import NONE
from loadshare.job.engines import available_engine
from loadshare.job.hot import HotAnswers
from loadshare.job.ladder import AUTO, climb
from loadshare.job.machine import Machine
from loadshare.job.positions import result_of, share, wanted_of
from loadshare.progress import Progress
from loadshare.results.figures import Figures
from loadshare.results.result import Result
from loadshare.settings import CERTIFY, JOB
from loadshare.solver import Options
from loadshare.tooth import resolve
from loadshare.train import Train, build_train
from loadshare.train.placed import train_at
from loadshare.train.samples import Samples, samples_of

Unanswered = Refused | CaseError


@dataclass(frozen=True, eq=False)
class MachineSamples:
    """Samples of one machine at positions that are solved together, position by position.

    Attributes
    ----------
    rows : ndarray of int, shape (S,)
        Numbers of the samples.
    positions : tuple of int
    samples : Samples
    solved : HotAnswers
        S answers for every position.
    others : dict of int to Answer
        Answers of the ladder, by number among these.
    refused : dict of int to exception
        Why there is no answer, likewise.
    """

    rows: Numbers
    positions: tuple[int, ...]
    samples: Samples
    solved: HotAnswers
    others: dict[int, Answer]
    refused: dict[int, Unanswered]

    def numbers(self, row: int) -> Iterator[tuple[int, int]]:
        """Yield number and position of every answer to a sample, given by its place in `rows`."""
        for p, index in enumerate(self.positions):
            yield p * len(self.rows) + row, index

    def answers(self, row: int, train: Train) -> list[Answer]:
        """Return the answers to a sample, given by its place in `rows` and its train."""
        every = dict(self.numbers(row))
        hot = [k for k in every if k not in self.refused and k not in self.others]
        here, wanted = train_at(train, self.positions[0]), [every[k] for k in hot]
        found = dict(zip(hot, self.solved.answers(hot, wanted, here), strict=True)) | self.others
        return [found[k] for k in every if k in found]

    @cached_property
    def there(self) -> Numbers:
        """Numbers of the answers that exist."""
        every = np.arange(len(self.rows) * len(self.positions))
        return np.delete(every, list(self.refused))

    @cached_property
    def figures(self) -> Figures:
        """Figures of the answers, as arrays in the order of `there`."""
        solved, answers = self.solved, self.solved.found.equilibria
        proved = solved.found.verdicts.bounds.relative.copy()
        numbers = self.there.tolist()
        solved.to_least_norm([k for k in numbers if k not in self.others])
        for number, answer in self.others.items():
            answers.put(number, answer.equilibrium)
            proved[number] = answer.certificate.proved
        return Figures(
            solved.machine.train,
            solved.situations.take(self.there),
            answers.take(self.there),
            [
                self.others[k].equilibrium.undetermined if k in self.others else solved.ranges(k)
                for k in numbers
            ],
            proved[self.there],
        )


@dataclass(frozen=True, eq=False)
class SampleAnswers:
    """Answers to samples of a case.

    Attributes
    ----------
    positions : tuple of int
        1-based, as requested; without a request, all that any sample has.
    parts : tuple of MachineSamples
    lacking : mapping of int to tuple of int
        Requested positions that a sample does not have.
    """

    positions: tuple[int, ...]
    parts: tuple[MachineSamples, ...]
    lacking: Mapping[int, tuple[int, ...]] = field(default_factory=dict)

    def of(self, sample: int) -> Iterator[tuple[MachineSamples, int]]:
        """Yield the parts that hold a sample, and its place there."""
        for part in self.parts:
            for row in np.flatnonzero(part.rows == sample).tolist():
                yield part, row

    def refused(self, sample: int) -> tuple[Unanswered, ...]:
        """Return why a sample has no answer at some positions, in their order."""
        found: list[Unanswered] = [
            part.refused[k]
            for part, row in self.of(sample)
            for k, _ in part.numbers(row)
            if k in part.refused
        ]
        lacking = self.lacking.get(sample, ())
        return (*found, *(Refused(f"position {k}: {NONE}") for k in lacking))

    def asked(self, sample: int) -> tuple[int, ...]:
        """Return the requested positions of a sample."""
        there = {k for part, _ in self.of(sample) for k in part.positions}
        there |= {*self.lacking.get(sample, ())}
        return tuple(k for k in self.positions if k in there)

    def result(self, sample: int) -> Result | None:
        """Return a sample as `solve` would: its certified positions, None if there are none."""
        answers: list[Answer] = []
        case = solved = train = None
        for part, row in self.of(sample):
            if train is None:
                case = part.samples.one(row)
                solved = resolve(case)
                train = build_train(solved)
            answers += part.answers(row, train)
        if case is None or solved is None or train is None or not answers:
            return None
        options = Options(solver=AUTO)
        asked = self.asked(sample)
        return result_of(case, solved, train, answers, options, CERTIFY.tolerance, asked)


def answer_samples(
    case: Case,
    samples: Mapping[str, ArrayLike],
    positions: Iterable[int] | None = None,
    progress: Progress | None = None,
) -> SampleAnswers:
    """Solve and certify samples of a case, all together.

    Parameters
    ----------
    case : Case
    samples : mapping of str to array_like
        As for `solve_many`.
    positions : iterable of int, optional
        1-based positions; all by default.
    progress : Progress, optional
        Called from time to time with the numbers of samples done and in all.

    Raises
    ------
    CaseError
        If a key or a value cannot be used.
    ValueError
        If a position does not exist in any sample.
    """
    groups = samples_of(case, samples)
    every = wanted_of((group.train for _, group in groups), positions)
    total, done = sum(len(rows) for rows, _ in groups), 0
    parts, lacking = [], dict[int, tuple[int, ...]]()
    for rows, group in groups:
        machine = Machine(group.train)
        share(machine)
        each = max(1, machine.together // len(every))
        wanted = tuple(k for k in every if k <= group.train.count)
        if positions is not None and len(wanted) < len(every):
            lacking |= dict.fromkeys(rows.tolist(), tuple(k for k in every if k not in wanted))
        chunks = [(k,) for k in wanted] if group.train.is_placed_anew else [wanted]
        for at in range(0, len(rows), each):
            some = slice(at, at + each)
            taken = group.take(some)
            parts += [_part(machine, rows[some], taken, k) for k in chunks if k]
            done += len(rows[some])
            if progress is not None:
                progress(done, total)
    return SampleAnswers(every, tuple(parts), lacking)


def _part(
    machine: Machine, rows: Numbers, samples: Samples, positions: tuple[int, ...]
) -> MachineSamples:
    """Solve samples at some positions; those that the fast method leaves climb the ladder."""
    here = machine.at(positions[0])
    situations = samples.at_positions(positions)
    engine = available_engine("auto", situations.count)
    found = here.answer(situations, CERTIFY.tolerance, engine, starts=positions)
    solved = HotAnswers(here, situations, found, CERTIFY.tolerance)
    part = MachineSamples(rows, positions, samples, solved, {}, {})
    for k in np.flatnonzero(~(found.passed & solved.small)).tolist():
        p, row = divmod(k, len(rows))
        try:
            train = train_at(samples.train_of_one(row), positions[p])
            if found.passed[k]:
                (answer,) = solved.answers([k], [positions[p]], train)
            else:
                answer = climb(train, positions[p], Options(), CERTIFY.tolerance, JOB.steps)
                part.others[k] = answer
            because: Unanswered | None = answer.refused()
        except (CaseError, Refused) as refusal:
            because = refusal
        if because is not None:
            part.others.pop(k, None)
            part.refused[k] = because
    return part
