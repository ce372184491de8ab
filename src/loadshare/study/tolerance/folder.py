"""The folder of a study: parts as Parquet files, and the study to which they belong."""

from __future__ import annotations

import hashlib
import json
import logging
import os
import tomllib
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from loadshare.case.content import ABOUT
from loadshare.case.keys import dotted
from loadshare.case.revise import differing as differences
from loadshare.case.words import as_given
from loadshare.errors import LoadshareError, Problem, ResultError
from loadshare.libraries import pa, parquet, pd
from loadshare.lock import LOCK
from loadshare.numbers import counted
from loadshare.output import clear, is_left, write_whole
from loadshare.results.digest import DIGEST, digest_of
from loadshare.study.tolerance.job import SAMPLES, STAMP, Job, Part

if TYPE_CHECKING:
    import numpy as np

log = logging.getLogger("loadshare")

STUDY = "study.json"
WORST = "worst.json"
KEYS = 10
"""Number of keys in which two cases differ that are listed one by one."""
PART_DIGEST = b"loadshare.sha256"
"""Key of a part's metadata for the digest of its content."""


class Folder:
    """Parts of a study on disk.

    Parameters
    ----------
    path : pathlib.Path
    job : Job
    lasting : bool
        Whether the folder stays if the study fails.

    Raises
    ------
    LoadshareError
        If the folder holds another study, or something other than a study.
    """

    def __init__(self, path: Path, job: Job, *, lasting: bool = True) -> None:
        self.path, self.job, self.lasting = path, job, lasting
        self.all = tuple(job.parts())
        clear([path / STUDY, path / WORST, *map(self.file, self.all)])
        content = {"case": job.name, "text": job.text, "hash": job.hash, "settings": job.settings}
        if not (path / STUDY).exists():
            if path.exists() and (not path.is_dir() or any(map(_is_foreign, path.iterdir()))):
                raise LoadshareError(
                    f"{path}: is not empty and contains no tolerance study. Allowed: a new or "
                    "empty folder, or the folder of the same study, which is then completed"
                )
            _write_sealed(path / STUDY, content)
            return
        try:
            known = json.loads((path / STUDY).read_text(encoding="utf-8"))
            whole = known.get(DIGEST) == digest_of(known)
            apart = differing(known["settings"], json.loads(json.dumps(job.settings)))
            apart += _differing_keys(known["text"], job.text) if apart else []
        except (OSError, ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
            raise LoadshareError(
                f"{path / STUDY}: is damaged or cannot be read ({error}). Put the original file "
                "back, or give a new or empty folder: without it the study cannot be continued."
            ) from None
        if apart:
            raise LoadshareError(
                "\n".join(
                    [
                        f"{path}: contains a study with other settings"
                        f"{'' if whole else ', or study.json was altered'}:",
                        *apart,
                        "Give another folder, or the same settings to complete it.",
                    ]
                )
            )
        if not whole:
            log.warning("%s: was changed after it was written; it is written again.", path / STUDY)
            _write_sealed(path / STUDY, content)

    def file(self, part: Part) -> Path:
        """Return the path of a part."""
        folder = self.path if part.design == SAMPLES else self.path / part.design
        return folder / f"part-{part.number:06d}.parquet"

    def kept(self) -> str:
        """Return a text on what is kept if the study ends now, and how to continue it."""
        if not self.lasting:
            return "Nothing is kept: the study has no folder (out, or --output)."
        done = sum(self.file(part).is_file() for part in self.all)
        text = f"{done} of {len(self.all)} parts are kept in {self.path}"
        return f"{text}: the same command continues from there."

    def missing(self) -> list[Part]:
        """Return the parts that are missing or damaged; the log names the latter."""
        found = [part for part in self.all if not self._whole(part)]
        for file in filter(Path.exists, map(self.file, found)):
            log.warning(
                "%s: does not belong to this study or was changed; it is solved again.", file
            )
        return found

    def _whole(self, part: Part) -> bool:

        file = self.file(part)
        try:
            # A part of the same name can be another study's: the stamp has study, number and rows.
            metadata = parquet.read_metadata(file).metadata or {}
            if metadata.get(STAMP) != self.job.stamp(part):
                return False
            table = parquet.read_table(file, page_checksum_verification=True)
        except (OSError, ValueError, pa.ArrowException):
            return False
        return len(table) == part.rows and metadata.get(PART_DIGEST) == digest(table)

    def write(self, part: Part, table: pa.Table) -> None:
        """Write a part to its file, whole or not at all."""
        file = self.file(part)
        sealed = table.replace_schema_metadata(
            {**table.schema.metadata, PART_DIGEST: digest(table)}
        )
        how: dict[str, Any] = {"compression": "zstd", "write_page_checksum": True}
        held = pa.BufferOutputStream()
        parquet.write_table(sealed, held, **how)
        write_whole(file, held.getvalue().to_pybytes())

    def worst(self) -> list[dict[str, Any]] | None:
        """Return the worst cases that were found for this study, or None if none are known.

        A file that was altered since it was written counts as none; the log names it.
        """
        file = self.path / WORST
        try:
            content = json.loads(file.read_text(encoding="utf-8"))
            if content[DIGEST] == digest_of(content):
                return list(content["worst"]) if content["study"] == self.job.hash else None
        except FileNotFoundError:
            return None
        except (OSError, ValueError, KeyError, TypeError, RecursionError):
            pass
        log.warning(
            "%s: was changed after it was written; worst cases are searched for again.", file
        )
        return None

    def keep_worst(self, found: Sequence[dict[str, Any]]) -> None:
        """Write the worst cases, so that the search need not be repeated."""
        _write_sealed(self.path / WORST, {"study": self.job.hash, "worst": list(found)})

    def files(self, design: str = SAMPLES) -> list[Path]:
        """Return the parts' files in order."""
        return [self.file(part) for part in self.all if part.design == design]

    def column(self, name: str, design: str = SAMPLES) -> np.ndarray[Any, Any]:
        """Return one column of all parts, shape (samples,)."""
        import numpy as np

        pieces = [read_part(file, [name]).column(0).to_numpy() for file in self.files(design)]
        return np.concatenate(pieces)

    def frame(self, columns: Sequence[str] | None = None) -> pd.DataFrame:
        """Return columns of the study's own samples as a table.

        Raises
        ------
        ValueError
            If there is no such column.
        """
        files = self.files()
        chosen = [columns] if isinstance(columns, str) else None if columns is None else [*columns]
        with _reading(files[0]):
            there = parquet.read_schema(files[0]).names
        unknown = [name for name in chosen or () if name not in there]
        if unknown:
            raise ValueError(f"no column {', '.join(unknown)}; allowed: {', '.join(there)}")
        tables = [read_part(file, chosen).replace_schema_metadata() for file in files]
        whole: pd.DataFrame = pa.concat_tables(tables, promote_options="none").to_pandas()
        return whole


def _is_foreign(file: Path) -> bool:
    """Return whether a file is neither the lock nor left over from writing the study's document."""
    begins = is_left(file.name) and file.name.startswith(f".{STUDY}.")
    return not begins and file.name != LOCK


def digest(table: pa.Table) -> bytes:
    """Return the SHA-256 of a table's content, which does not depend on how a file encodes it."""
    found = hashlib.sha256()
    for name, column in zip(table.column_names, table.columns, strict=True):
        values = column.to_numpy()
        text = values.dtype.kind == "O"
        content = json.dumps(values.tolist()).encode() if text else values.tobytes()
        found.update(f"{name} {values.dtype} {len(values)} {len(content)}\n".encode())
        found.update(content)
    return found.hexdigest().encode()


def read_part(file: Path, columns: list[str] | None = None) -> pa.Table:
    """Read columns of a part, all by default, and check each page against its checksum.

    Raises
    ------
    ResultError
        If the part cannot be read, or was altered since it was written.
    """
    with _reading(file):
        return parquet.read_table(file, columns=columns, page_checksum_verification=True)


@contextmanager
def _reading(file: Path) -> Iterator[None]:
    """Turn an error in reading a part into a `ResultError`."""
    try:
        yield
    except (OSError, ValueError, pa.ArrowException) as error:
        hint = "run the same study again: damaged parts are solved again"
        code = getattr(error, "errno", None)
        why = (
            f"was altered since it was written ({str(error).splitlines()[0]})"
            if code is None
            else f"cannot be read: {os.strerror(code).lower()}"
        )
        raise ResultError([Problem(str(file), "", "", why, hint=hint)]) from None


def differing(known: dict[str, Any], wanted: dict[str, Any]) -> list[str]:
    """Return a line for each setting that differs."""
    lines = []
    for key in dict.fromkeys((*known, *wanted)):
        one, other = known.get(key), wanted.get(key)
        if one == other:
            continue
        if key == "inputs" and isinstance(one, list) and isinstance(other, list):
            lines += _differing_inputs(one, other)
        else:
            lines.append(f"  {key}: {_short(one)} there, {_short(other)} requested")
    return lines


def _differing_keys(known: str, wanted: str) -> list[str]:
    """Return a line for each of the first keys in which the texts of two cases differ."""
    every = differences(tomllib.loads(known), tomllib.loads(wanted))
    found = [
        f"  {dotted(path)}: {as_given(there) or 'nothing'} there, "
        f"{as_given(here) or 'nothing'} requested"
        for path, there, here in every
        if path[0] not in ABOUT
    ]
    more = len(found) - KEYS
    return found[:KEYS] + ([f"  and {counted(more, 'further key')}"] if more > 0 else [])


def _differing_inputs(known: Iterable[Any], wanted: Iterable[Any]) -> list[str]:
    there = {"=".join(one["keys"]): one for one in known}
    here = {"=".join(one["keys"]): one for one in wanted}
    lines = [
        f"  input {name}: {_input_text(there.get(name))} there, "
        f"{_input_text(here.get(name))} requested"
        for name in dict.fromkeys((*there, *here))
        if there.get(name) != here.get(name)
    ]
    return lines or ["  inputs: in a different order"]


def _input_text(one: dict[str, Any] | None) -> str:
    if one is None:
        return "none"
    numbers = " ".join(f"{k} {v:.6g}" for k, v in one["numbers"].items())
    return " ".join(filter(None, (one["distribution"], numbers, one["unit"])))


def _short(value: Any) -> str:
    text = json.dumps(value, ensure_ascii=False)
    return text if len(text) <= 60 else f"{text[:57]}…"


def _write_sealed(file: Path, content: dict[str, Any]) -> None:
    """Write a document with the digest of its content."""
    sealed = {**content, DIGEST: digest_of(content)}
    write_whole(file, json.dumps(sealed, indent=1, ensure_ascii=False) + "\n")
