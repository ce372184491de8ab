"""The folder of a study: parts as Parquet files, and what they belong to."""

from __future__ import annotations

import hashlib
import json
import logging
from collections.abc import Iterable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

from loadshare.errors import LoadshareError, Problem, ResultError
from loadshare.output import write_whole
from loadshare.study.tolerance.job import SAMPLES, STAMP, Job, Part

if TYPE_CHECKING:
    import numpy as np
    import pandas as pd
    import pyarrow as pa

log = logging.getLogger("loadshare")

STUDY = "study.json"
WORST = "worst.json"
DIGEST = b"loadshare.sha256"
"""Key of a part's metadata under which the digest of its content stands."""


class Folder:
    """Parts of a study on disk.

    Parameters
    ----------
    path : pathlib.Path
    job : Job

    Raises
    ------
    LoadshareError
        If the folder holds another study, or what is no study.
    """

    def __init__(self, path: Path, job: Job) -> None:
        self.path, self.job = path, job
        self.all = tuple(job.parts())
        content = {"case": job.name, "text": job.text, "hash": job.hash, "settings": job.settings}
        if not (path / STUDY).exists():
            if path.exists() and (not path.is_dir() or any(path.iterdir())):
                raise LoadshareError(
                    f"{path}: is not empty and holds no tolerance study. Allowed: a new or empty "
                    "folder, or the folder of the same study, which is then completed"
                )
            _write_json(path / STUDY, content)
            return
        try:
            known = json.loads((path / STUDY).read_text(encoding="utf-8"))["settings"]
        except (OSError, ValueError, KeyError, TypeError) as error:
            raise LoadshareError(f"{path / STUDY}: cannot be read: {error}") from None
        apart = differing(known, json.loads(json.dumps(job.settings)))
        if apart:
            raise LoadshareError(
                "\n".join(
                    [
                        f"{path}: holds a study with other settings:",
                        *apart,
                        "Give another folder, or the same settings to complete it.",
                    ]
                )
            )

    def file(self, part: Part) -> Path:
        """Return where a part stands."""
        folder = self.path if part.design == SAMPLES else self.path / part.design
        return folder / f"part-{part.number:06d}.parquet"

    def missing(self) -> list[Part]:
        """Return the parts that are not there, or not whole; the log names the latter."""
        found = [part for part in self.all if not self._whole(part)]
        for file in filter(Path.exists, map(self.file, found)):
            log.warning("%s: is not what was written there; it is solved again.", file)
        return found

    def _whole(self, part: Part) -> bool:
        import pyarrow as pa
        from pyarrow import parquet

        file = self.file(part)
        try:
            # A part of the same name can stem from elsewhere: the stamp names study, number, rows.
            told = parquet.read_metadata(file).metadata or {}
            if told.get(STAMP) != self.job.stamp(part):
                return False
            table = parquet.read_table(file, page_checksum_verification=True)
        except (OSError, ValueError, pa.ArrowException):
            return False
        return len(table) == part.rows and told.get(DIGEST) == digest(table)

    def write(self, part: Part, table: pa.Table) -> None:
        """Put a part in its place, whole or not at all."""
        import pyarrow as pa
        from pyarrow import parquet

        file = self.file(part)
        sealed = table.replace_schema_metadata({**table.schema.metadata, DIGEST: digest(table)})
        how: dict[str, Any] = {"compression": "zstd", "write_page_checksum": True}
        held = pa.BufferOutputStream()
        parquet.write_table(sealed, held, **how)
        write_whole(file, held.getvalue().to_pybytes())
        # What a killed process left of the same part.
        for left in file.parent.glob(f".{file.name}.*"):
            with suppress(FileNotFoundError):
                left.unlink()

    def worst(self) -> list[dict[str, Any]] | None:
        """Return the worst cases that were found for this study, or None if none are known."""
        try:
            content = json.loads((self.path / WORST).read_text(encoding="utf-8"))
            return list(content["worst"]) if content["study"] == self.job.hash else None
        except (OSError, ValueError, KeyError, TypeError):
            return None

    def keep_worst(self, found: Sequence[dict[str, Any]]) -> None:
        """Write the worst cases, so that the search need not be made again."""
        _write_json(self.path / WORST, {"study": self.job.hash, "worst": list(found)})

    def files(self, design: str = SAMPLES) -> list[Path]:
        """Return the parts' files in order."""
        return [self.file(part) for part in self.all if part.design == design]

    def column(self, name: str, design: str = SAMPLES) -> np.ndarray[Any, Any]:
        """Return one column of all parts, shape (samples,)."""
        import numpy as np

        pieces = [_read(file, [name]).column(0).to_numpy() for file in self.files(design)]
        return np.concatenate(pieces)

    def frame(self, columns: Sequence[str] | None = None) -> pd.DataFrame:
        """Return columns of the study's own samples as a table."""
        import pyarrow as pa

        chosen = None if columns is None else list(columns)
        tables = [_read(file, chosen).replace_schema_metadata() for file in self.files()]
        whole: pd.DataFrame = pa.concat_tables(tables, promote_options="none").to_pandas()
        return whole


def digest(table: pa.Table) -> bytes:
    """Return the SHA-256 of what a table holds, whatever bytes it is written in."""
    found = hashlib.sha256()
    for name, column in zip(table.column_names, table.columns, strict=True):
        values = column.to_numpy()
        text = values.dtype.kind == "O"
        content = json.dumps(values.tolist()).encode() if text else values.tobytes()
        found.update(f"{name} {values.dtype} {len(values)} {len(content)}\n".encode())
        found.update(content)
    return found.hexdigest().encode()


def _read(file: Path, columns: list[str] | None) -> pa.Table:
    """Read columns of a part, each page against its checksum.

    Raises
    ------
    ResultError
        If the part was altered since it was written.
    """
    import pyarrow as pa
    from pyarrow import parquet

    try:
        return parquet.read_table(file, columns=columns, page_checksum_verification=True)
    except (OSError, ValueError, pa.ArrowException) as error:
        hint = "ask for the same study again: what is not whole is solved anew"
        why = f"was altered since it was written ({str(error).splitlines()[0]})"
        raise ResultError([Problem(str(file), "", "", why, hint=hint)]) from None


def differing(known: dict[str, Any], asked: dict[str, Any]) -> list[str]:
    """Return a line for each setting that differs."""
    lines = []
    for key in dict.fromkeys((*known, *asked)):
        one, other = known.get(key), asked.get(key)
        if one == other:
            continue
        if key == "inputs" and isinstance(one, list) and isinstance(other, list):
            lines += _differing_inputs(one, other)
        else:
            lines.append(f"  {key}: {_short(one)} there, {_short(other)} asked")
    return lines


def _differing_inputs(known: Iterable[Any], asked: Iterable[Any]) -> list[str]:
    there = {"=".join(one["keys"]): one for one in known}
    here = {"=".join(one["keys"]): one for one in asked}
    lines = [
        f"  input {name}: {_told(there.get(name))} there, {_told(here.get(name))} asked"
        for name in dict.fromkeys((*there, *here))
        if there.get(name) != here.get(name)
    ]
    return lines or ["  inputs: in another order"]


def _told(one: dict[str, Any] | None) -> str:
    if one is None:
        return "none"
    numbers = " ".join(f"{k} {v:.6g}" for k, v in one["numbers"].items())
    return " ".join(filter(None, (one["distribution"], numbers, one["unit"])))


def _short(value: Any) -> str:
    text = json.dumps(value, ensure_ascii=False)
    return text if len(text) <= 60 else f"{text[:57]}…"


def _write_json(file: Path, content: dict[str, Any]) -> None:
    write_whole(file, json.dumps(content, indent=1, ensure_ascii=False) + "\n")
