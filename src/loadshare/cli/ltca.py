"""`loadshare ltca`: the loaded contact of one pair of gears."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from loadshare.cli.console import progress, say
from loadshare.cli.exits import fail_refused, reporting_problems, writing
from loadshare.cli.files import keep_inputs, save_text
from loadshare.cli.forms import FOLDER, Output, outputs, write_all
from loadshare.cli.tables.table import show, table
from loadshare.errors import Refused
from loadshare.libraries import pd
from loadshare.output import csv_of

if TYPE_CHECKING:
    from loadshare.report.figure import Figure
    from loadshare.tooth.analysis.result import Ltca
    from loadshare.tooth.law.file import MeshLaw
    from loadshare.tooth.pair.file import PairFile

PICTURES = (".svg", ".png", ".html")
LAW = "law.toml"
FORMS = (FOLDER, "toml", "csv")


def ltca(
    pair: Annotated[Path, typer.Argument(metavar="PAIR", help="Pair file.")],
    positions: Annotated[
        int | None,
        typer.Option(
            metavar="N", min=1, help="Positions of the mesh cycle, instead of the file's."
        ),
    ] = None,
    torque: Annotated[
        str | None,
        typer.Option(metavar="T", help="Rated torque on the driver, such as '900 N*m'."),
    ] = None,
    compliance: Annotated[
        Literal["finite elements", "slices"] | None,
        typer.Option(metavar="MODEL", help="finite elements, or slices (much faster, less exact)."),
    ] = None,
    file: Annotated[
        list[Output] | None,
        outputs(
            *FORMS,
            what="Folder for tables, pictures and law file, by default one named after the "
            "pair; or the law file or the table alone",
        ),
    ] = None,
) -> None:
    """Analyse the loaded tooth contact of a pair and write its mesh law.

    The folder receives law.toml, which a mesh of a case can name as its law_file, table.csv,
    lines.csv, and pictures as SVG, PNG and HTML.
    """
    from loadshare.tooth.analysis.tables import position_rows
    from loadshare.tooth.law.file import law_text
    from loadshare.tooth.law.folder import kept_law
    from loadshare.tooth.pair.file import load_pair

    load = _torque(torque)
    with reporting_problems():
        pair_file = load_pair(pair).revised(torque=load, positions=positions, compliance=compliance)
    written = file or [Output(FOLDER, Path(pair_file.name))]
    folders = [output.file for output in written if output.form == FOLDER]
    keep_inputs([pair], [("--output", folder / LAW) for folder in folders])
    _print_heading(pair_file, pair)
    try:
        with progress("positions", pair_file.analysis.positions) as tick:
            found = pair_file.analyse(tick)
    except Refused as refusal:
        fail_refused(refusal)
    law = kept_law(pair_file, found)
    _print_positions(found, law)
    _print_summary(pair_file, found)
    for finding in law.findings:
        say(f"Note: {finding}", whole=True)
    for folder in folders:
        wrote = list(_written(folder, pair_file, found, law))
        say(f"Wrote {', '.join(file.name for file in wrote)} to {wrote[0].parent}", whole=True)
    makers = {
        "toml": lambda: law_text(law),
        "csv": lambda: _csv(position_rows(found, law)),
    }
    write_all([output for output in written if output.form != FOLDER], makers)


def _torque(text: str | None) -> float | None:
    """Return the torque [N·m] that the option gives."""
    if text is None:
        return None
    from pydantic import TypeAdapter, ValidationError

    from loadshare.tooth.pair.model import Load

    try:
        return float(TypeAdapter(Load).validate_python(text))
    except ValidationError as error:
        message = error.errors(include_url=False)[0]["msg"].rstrip()
        raise typer.BadParameter(f"{text!r} {message}", param_hint="--torque") from None


def _print_heading(pair: PairFile, file: Path) -> None:
    from loadshare.tooth.pair.findings import findings

    geometry, chosen = pair.geometry, pair.analysis
    say(pair.title, style="bold")
    say(str(file), whole=True)
    say(
        f"T = {pair.torque:.7g} N·m on the driver; contact ratio {geometry.contact_ratio:.3f}, "
        f"overlap ratio {geometry.overlap_ratio:.3f}; {chosen.compliance}, "
        f"{chosen.points} points on a line"
    )
    for finding in findings(geometry):
        say(f"Note: {finding}", whole=True)


def _print_positions(found: Ltca, law: MeshLaw) -> None:
    """Print law and stiffness by position, in units that keep the figures short."""
    from loadshare.numbers import decimals, fixed
    from loadshare.report.figures.ltca_cycle import stiffness_unit
    from loadshare.tooth.analysis.tables import STIFFNESS_LOADS

    rows = (
        (
            str(k + 1),
            fixed(phase, 3),
            fixed(1e6 * law.a[k].si, 2),
            fixed(1e9 * law.b[k].si, 2),
            fixed(1e9 * law.c[k].si, 1),
            f"{fixed(100 * law.misfit[k], 2)} %",
            fixed(1e6 * found.unloaded_error[k], 3),
        )
        for k, phase in enumerate(found.phase)
    )
    made = table(("position", "phase", "a", "b", "c", "misfit", "unloaded lead"), rows)
    show("Law: a and lead [µrad], b [nrad/(N·m)], c [nrad/(N·m)^(2/3)]", made)
    secants = [found.secant(part) for part in STIFFNESS_LOADS]
    columns = (*secants, found.increment(0.9, 1.0), found.tangent(1.0))
    unit = stiffness_unit(secants[0])
    places = decimals(unit.of(value) for values in columns for value in values)
    names = ["T", *(f"{part:g} T" for part in STIFFNESS_LOADS[1:])]
    stiffnesses = (
        (str(k + 1), *(fixed(unit.of(values[k]), places) for values in columns))
        for k in range(len(found.phase))
    )
    made = table(("position", *names, "0.9 T to T", "tangent at T"), stiffnesses)
    show(f"Mesh stiffness [{unit.name} at the driver]", made)


def _print_summary(pair: PairFile, found: Ltca) -> None:
    rated = found.secant(1.0)
    load = len(found.torque) - 1
    say()
    say(
        f"Stiffness at T: max/min {rated.max() / rated.min():.3f}, mean {rated.mean():.4g} "
        f"N·m/rad. Contact ratio under load {found.contact_ratio[load]:.2f}."
    )
    if found.law.bounded.any():
        where = ", ".join(str(k + 1) for k in range(len(rated)) if found.law.bounded[k])
        say(f"b or c is held at 0 at position {where}, where the fit would make it negative.")
    if pair.offset:
        say(
            f"Offset and gear shift turn the driver by {1e6 * pair.offset:.3f} µrad as a whole; "
            "the law excludes this. In a case, give them as installation errors of the face gear."
        )
    edges: dict[str, list[int]] = {}
    for edge in found.edges:
        if edge.load == load:
            edges.setdefault(edge.edge, []).append(edge.position + 1)
    for name, positions in sorted(edges.items()):
        places = ", ".join(map(str, sorted(set(positions))))
        say(f"Load reaches the {name} at position {places}.")


def _written(folder: Path, pair: PairFile, found: Ltca, law: MeshLaw) -> Iterator[Path]:
    """Write everything, and report each file."""
    from loadshare.tooth.analysis.tables import line_rows, position_rows
    from loadshare.tooth.law.file import law_text

    texts = {
        LAW: law_text(law),
        "table.csv": _csv(position_rows(found, law)),
        "lines.csv": _csv(line_rows(found)),
    }
    for name, text in texts.items():
        file = folder / name
        save_text(file, text)
        yield file
    for figure in [figure.begin() for figure in _figures(pair, found)]:
        for ending in PICTURES:
            file = folder / f"{figure.name}{ending}"
            with writing(file):
                figure.save(file)
            yield file


def _figures(pair: PairFile, found: Ltca) -> Iterator[Figure]:
    from loadshare.report.figures.ltca_cycle import stiffness, transmission_error
    from loadshare.report.figures.ltca_flank import contact_pattern, load_map, plane_of

    geometry = pair.geometry
    planes = plane_of(geometry.driver, 1), plane_of(geometry.driven, geometry.driven_side)
    yield stiffness(found, pair.title)
    yield transmission_error(found, pair.title)
    yield load_map(found, planes, pair.title)
    yield contact_pattern(found, planes, pair.title)


def _csv(rows: Iterable[dict[str, Any]]) -> str:

    return csv_of(pd.DataFrame(rows))
