"""A tolerance study as plain data, so that any process can solve any part of it."""

from __future__ import annotations

import hashlib
import json
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any

import numpy as np

from loadshare._version import __version__
from loadshare.array_types import Array
from loadshare.case import Case
from loadshare.errors import CaseError
from loadshare.job.block import Block
from loadshare.job.many import solve_blocks
from loadshare.libraries import pa
from loadshare.study.tolerance.design import Drawn, PickFreeze
from loadshare.study.tolerance.figures import Figures, figure_names, largest_figures
from loadshare.study.tolerance.inputs import ScatteredInputs
from loadshare.train import Train, build_train
from loadshare.train.samples import unusable

SAMPLES, INDICES = "samples", "indices"
STAMP = b"loadshare"
"""Key in a part's metadata that says to which study the part belongs."""


@dataclass(frozen=True, slots=True, order=True)
class Part:
    """Whole blocks of a design, solved and written together.

    Attributes
    ----------
    design : str
        "samples" or "indices".
    number : int
        0-based.
    rows : int
        Number of samples.
    """

    design: str
    number: int
    rows: int


@dataclass(frozen=True)
class Job:
    """Everything on which the samples of a study and their answers depend.

    Attributes
    ----------
    name : str
        Of the case.
    text : str
        The case as a case file.
    settings : dict
        Plain data: ``case_hash``, ``inputs``, ``groups``, ``samples``, ``seed``, ``sampling``,
        ``indices``, ``positions``, ``tolerance``, ``engine``, ``chunk`` (blocks per part) and
        ``version``.
    """

    name: str
    text: str
    settings: dict[str, Any]

    @classmethod
    def of(cls, case: Case, inputs: ScatteredInputs, **settings: Any) -> Job:
        """Return the job of a case and its inputs."""
        whole = {
            "version": __version__,
            "case_hash": case.hash,
            **inputs.to_plain(),
            **settings,
        }
        return cls(case.name, case.to_toml(), whole)

    def to_json(self) -> str:
        """Return the job as JSON text."""
        return json.dumps({"name": self.name, "text": self.text, "settings": self.settings})

    @cached_property
    def hash(self) -> str:
        """SHA-256 of the settings."""
        text = json.dumps(self.settings, sort_keys=True, separators=(",", ":"))
        return hashlib.sha256(text.encode()).hexdigest()

    @cached_property
    def inputs(self) -> ScatteredInputs:
        """The inputs of the study."""
        return ScatteredInputs.from_plain(self.settings)

    @cached_property
    def case(self) -> Case:
        """The case."""
        return Case(tomllib.loads(self.text), name=self.name)

    @cached_property
    def train(self) -> Train:
        """The train of the case."""
        return build_train(self.case)

    @cached_property
    def designs(self) -> dict[str, Drawn]:
        """The designs of the samples, by purpose."""
        seed, sampling = self.settings["seed"], self.settings["sampling"]
        return {
            SAMPLES: Drawn(self.inputs, self.settings["samples"], seed, sampling),
            INDICES: PickFreeze(self.inputs, self.settings["indices"], seed, sampling),
        }

    def parts(self) -> Iterator[Part]:
        """Yield all parts, the study's own samples first."""
        for name, design in self.designs.items():
            for number in range(-(-design.blocks // self.settings["chunk"])):
                rows = sum(len(design.rows(b)) for b in self.blocks(name, number))
                yield Part(name, number, rows)

    def blocks(self, design: str, number: int) -> range:
        """Return the blocks of a part."""
        chunk = self.settings["chunk"]
        return range(chunk * number, min(chunk * (number + 1), self.designs[design].blocks))

    def stamp(self, part: Part) -> bytes:
        """Return the stamp that identifies a part in its metadata."""
        about = {"study": self.hash, "design": part.design, "part": part.number, "rows": part.rows}
        return json.dumps(about, sort_keys=True).encode()

    def table(self, part: Part) -> pa.Table:
        """Draw and solve a part.

        Returns
        -------
        pyarrow.Table
            One row per sample: its number, inputs, figures, largest residual, whether it is
            certified, and the message if it is not.
        """
        design = self.designs[part.design]
        blocks = self.blocks(part.design, part.number)
        table = pa.concat_tables([self._block_table(design, block) for block in blocks])
        return table.combine_chunks().replace_schema_metadata({STAMP: self.stamp(part)})

    def solve(self, values: Array) -> Figures:
        """Solve samples with the given inputs, shape (S, inputs)."""
        count = len(values)
        columns = {name: np.full(count, np.nan) for name in figure_names(self.train)}
        residual = np.full(count, np.nan)
        message: dict[int, str] = {}
        usable = np.arange(count)
        try:
            blocks = self._solved(values)
        except CaseError:
            # Some sample gives no valid case; the others are solved all the same.
            samples = self.inputs.samples(values)
            message |= {
                k: f"does not give a valid case: {w}" for k, w in unusable(self.case, samples)
            }
            usable = np.setdiff1d(usable, list(message))
            blocks = self._solved(values[usable]) if len(usable) else []
        for block in blocks:
            rows = usable[block.rows]
            solved = block.certified.all(axis=1)
            for name, found in largest_figures(block).items():
                columns[name][rows[solved]] = found[solved]
            residual[rows[solved]] = block.residual[solved].max(axis=1)
            refused: dict[int, list[str]] = {}
            for (row, position), why in block.message.items():
                refused.setdefault(int(usable[row]), []).append(f"position {position}: {why}")
            message |= {row: "\n".join(why) for row, why in refused.items()}
        return Figures(columns, residual, message)

    def _solved(self, values: Array) -> list[Block]:
        how = {key: self.settings[key] for key in ("positions", "tolerance", "engine")}
        return list(solve_blocks(self.case, self.inputs.samples(values), **how, workers=1))

    def _block_table(self, design: Drawn, block: int) -> pa.Table:
        """Solve one block; answers never depend on the other blocks of its part."""
        rows, values = design.rows(block), design.values(block)
        found = self.solve(values)
        messages = [found.message.get(row) for row in range(len(rows))]
        return pa.table(
            {
                "sample": rows,
                **{one.column: values[:, k] for k, one in enumerate(self.inputs.every)},
                **found.columns,
                "residual": found.residual,
                "certified": ~np.isnan(found.residual),
                "message": pa.array(messages, pa.string()),
            }
        )


@lru_cache(maxsize=4)
def known_job(text: str) -> Job:
    """Return the job that `to_json` wrote; it is kept, with its train, for the next part."""
    return Job(**json.loads(text))


def equilibria(samples: int, indices: int, units: int, positions: int) -> int:
    """Return how many equilibria a study solves."""
    return (samples + indices * (units + 2)) * positions


CHUNK = 8
"""Blocks per part: 32768 samples, a few seconds of work and a few megabytes of memory."""
