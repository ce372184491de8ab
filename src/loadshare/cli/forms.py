"""Formats of an answer: ``-o FILE`` of every command, the format chosen by the ending."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from loadshare.cli.exits import REFUSED, UNUSABLE, fail, unwritten_line
from loadshare.cli.files import print_written
from loadshare.cli.options import OUTPUT
from loadshare.cli.waiting import erase_line
from loadshare.errors import LoadshareError
from loadshare.json_text import json_text
from loadshare.libraries import pd
from loadshare.output import STANDARD, csv_of, write_whole

if TYPE_CHECKING:
    from loadshare.report.figure import Figure

FORMS = {
    "json": "JSON file",
    "nc": "netCDF file",
    "csv": "table",
    "parquet": "table",
    "xlsx": "workbook",
    "html": "page",
    "svg": "picture",
    "png": "picture",
    "pdf": "picture",
    "toml": "case",
    "rexs": "REXS file",
    "folder": "folder",
}
"""Endings of files and what they hold; "folder" is a place for many files."""
FIGURES = ("svg", "png", "pdf", "html")
"""Forms of a picture; as a page it shows figures under the pointer."""
TABLES = ("csv", "parquet", "xlsx", "json", "nc")
FOLDER = "folder"

Makers = Mapping[str, Callable[[], str | bytes]]
"""Functions that make the content of a file, by the file's form."""


@dataclass(frozen=True)
class Output:
    """A file to write.

    Attributes
    ----------
    form : str
        One of `FORMS`.
    file : Path
    """

    form: str
    file: Path


def read_output(text: str, forms: Sequence[str]) -> Output:
    """Return the file that is named by ``FILE`` or ``FORM:FILE``.

    Parameters
    ----------
    text : str
    forms : sequence of str
        Forms that the command writes; standard output takes the first if no form is given.

    Raises
    ------
    typer.BadParameter
        If the text names no file, or the ending is missing or none of the forms.
    """
    prefix, colon, rest = text.partition(":")
    if not rest and (not prefix or (colon and prefix in FORMS)):
        raise typer.BadParameter(f"{text!r} names no file.")
    if colon and prefix in FORMS:
        form, file = prefix, Path(rest)
    else:
        file = Path(text)
        ending = file.suffix.lower().removeprefix(".")
        ending = "html" if ending == "htm" else ending
        if FOLDER in forms and _is_folder(text, ending, mainly=forms[0] == FOLDER):
            ending = FOLDER
        form = _first(forms) if file == STANDARD else ending
    if form in forms and (file != STANDARD or form != FOLDER):
        return Output(form, file)
    can = ", ".join(f".{known}" for known in forms if known != FOLDER)
    more = ", or many files into FOLDER/" if FOLDER in forms else ""
    if form in FORMS:
        wrong = f"this command cannot write a {FORMS[form]}"
    elif file.suffix:
        wrong = f"unknown ending {file.suffix}"
    else:
        wrong = "it has no ending, which says what to write"
    raise typer.BadParameter(f"{text}: {wrong}. Allowed: {can}{more}.")


def check_case_file(file: Path, force: bool) -> None:
    """Refuse a case file with the ending of another form, or one that exists, unless forced.

    Raises
    ------
    typer.BadParameter
        If the ending is that of another form.
    typer.Exit
        If the file exists.
    """
    ending = file.suffix.lower().removeprefix(".")
    if ending in FORMS and ending != "toml":
        wrong = f"this command cannot write a {FORMS[ending]}. Allowed: .toml."
        raise typer.BadParameter(f"{file}: {wrong}", param_hint="--output")
    if file != STANDARD and file.exists() and not force:
        fail([f"{file}: exists already; --force overwrites it"], UNUSABLE)


def _first(forms: Sequence[str]) -> str:
    """Return the form of a file on standard output."""
    return next(form for form in forms if form != FOLDER)


def _is_folder(text: str, ending: str, *, mainly: bool) -> bool:
    """Return whether a folder is meant; `mainly` if that is what the command writes by default."""
    return text.endswith(("/", os.sep)) or Path(text).is_dir() or (mainly and ending not in FORMS)


def outputs(*forms: str, what: str = "Write the answer") -> Any:
    """Return the option for files of some forms."""

    def checked(made: list[Output] | None) -> list[Output] | None:
        if made is None:
            return None
        if sum(output.file == STANDARD for output in made) > 1:
            raise typer.BadParameter("only one file can go to standard output (-).")
        files = [output.file for output in made if output.file != STANDARD]
        twice = next((file for file in files if files.count(file) > 1), None)
        if twice is not None:
            forms_of = {output.form for output in made if output.file == twice}
            how = " in different forms" if len(forms_of) > 1 else "; name it once"
            raise typer.BadParameter(f"{twice}: would be written twice{how}.")
        return made

    endings = ", ".join(f".{form}" for form in forms if form != FOLDER)
    folder = ", or FOLDER/ for CSV tables" if FOLDER in forms[1:] else ""
    return typer.Option(
        "-o",
        "--output",
        metavar=OUTPUT,
        parser=partial(read_output, forms=forms),
        callback=checked,
        help=f"{what}: {endings}{folder}. - is stdout ({_first(forms)}). May be repeated.",
    )


def write_all(
    wanted: Iterable[Output] | None,
    makers: Makers,
    *,
    err: bool = True,
    missing: Iterable[str] = (),
    code: int = REFUSED,
) -> None:
    """Write the files asked for, each whole or not at all, and report them on stderr or stdout.

    A file that cannot be written does not keep the others from being written.

    Parameters
    ----------
    wanted : iterable of Output or None
    makers : mapping of form to callable
    err : bool
        Whether files that were written are reported on stderr.
    missing : iterable of str
        Lines on answers that are missing, such as refusals.
    code : int
        Exit code if answers are missing.

    Raises
    ------
    typer.Exit
        If a file cannot be made or written, or answers are missing; the message names all of them.
    """
    lost = []
    for output in wanted or ():
        try:
            content = makers[output.form]()
            erase_line()
            write_whole(output.file, content)
        except LoadshareError as error:
            lost.append(f"{output.file}: not written: {error}")
        except ModuleNotFoundError as error:
            if error.name != "openpyxl":
                raise
            hint = "Install it with: pip install 'loadshare[spreadsheet]'."
            lost.append(f"{output.file}: a workbook needs openpyxl to be written. {hint}")
        except OSError as error:
            lost.append(unwritten_line(output.file, error))
        else:
            print_written(output.file, "" if err else ".", err=err)
    if lines := [*lost, *missing]:
        fail(lines, UNUSABLE if lost else code)


def tables_of(name: str, frame: Callable[[], pd.DataFrame], **about: object) -> Makers:
    """Return the functions that make files of a table: CSV, Parquet, a workbook, JSON, netCDF.

    Parameters
    ----------
    name : str
        Name of the question, such as ``"sweep"``.
    frame : callable
        Makes the table.
    **about
        Written in the JSON file before the rows.
    """

    def workbook() -> bytes:
        from loadshare.exchange.spreadsheet import workbook_of
        from loadshare.exchange.spreadsheet.sheet import FOUND

        return workbook_of({f"{FOUND}{name}": frame()})

    return {
        "csv": lambda: csv_of(frame()),
        "parquet": lambda: _parquet(frame()),
        "xlsx": workbook,
        "json": lambda: _json(name, frame(), about),
        "nc": lambda: _netcdf(name, frame()),
    }


def figure_of(figure: Callable[[], Figure]) -> Makers:
    """Return the functions that make files of a picture."""
    return {form: lambda form=form: figure().content(form) for form in FIGURES}  # type: ignore[misc]


def _parquet(frame: pd.DataFrame) -> bytes:
    held = BytesIO()
    frame.infer_objects().apply(_of_one_type).to_parquet(held, index=False)
    return held.getvalue()


def _of_one_type(column: pd.Series[Any]) -> pd.Series[Any]:
    """Return a column in the type it has in every file, even if its figures happen to be whole."""
    known = column.dropna()
    if len(known) and all(isinstance(value, float) for value in known):
        return column.astype("Float64")
    return column if column.dtype.kind == "f" else column.convert_dtypes()


def _netcdf(name: str, frame: pd.DataFrame) -> bytes:
    """Return a table as labelled arrays over its rows; missing texts are empty."""
    from loadshare._version import __version__
    from loadshare.output import netcdf_of

    table = frame.infer_objects()
    # netCDF knows no whole number that is missing.
    table = table.astype({name: float for name, kind in table.dtypes.items() if kind == "Int64"})
    words = table.select_dtypes(exclude=["number", "bool"])
    table = table.assign(**{str(c): words[c].map(_word) for c in words})
    arrays = table.rename_axis("row").to_xarray()
    return netcdf_of(arrays.assign_attrs(question=name, loadshare_version=__version__))


def _word(cell: Any) -> str:
    value = _plain(cell)
    return "" if value is None else str(value)


def _json(name: str, frame: pd.DataFrame, about: Mapping[str, object]) -> str:
    from loadshare._version import __version__

    heads = [str(column) for column in frame.columns]
    rows = [
        dict(zip(heads, map(_plain, row), strict=True)) for row in frame.itertuples(index=False)
    ]
    document = {"question": name, "version": __version__, **about, "rows": rows}
    return json_text(document)


def _plain(cell: Any) -> object:
    """Return a cell as plain data for JSON, which has no NaN and no infinity."""
    value = cell.item() if hasattr(cell, "item") else cell
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    return None if value is pd.NA else value
