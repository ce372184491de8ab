"""Tables of a spreadsheet: export and import give the same case; cells, and errors in them."""

from __future__ import annotations

import contextlib
import csv
import math
import sys
import zipfile
from datetime import datetime
from pathlib import Path

import pandas as pd
import pytest
from tests.cli.conftest import on_a_screen_of
from tests.support import CASES, SHIPPED, shipped

import loadshare as ls
from loadshare.errors import CaseError
from loadshare.exchange.spreadsheet import (
    export_frames,
    export_tables,
    import_tables,
    workbook_of,
    write_tables,
)
from loadshare.exchange.spreadsheet.exporting import case_frames
from loadshare.output import csv_of
from loadshare.settings import ALLOWED

OPERATING = "key,value\ninput,a\noutput,b\ntorque [N*m],100\n"
GEARS = "name,teeth,module [mm],centre [mm],Face width [mm]\na,20,2,0; 0,10\nb,40,2,60; 0,10\n"
MESHES = "name,stiffness\na-b,1e6 N*m/rad\n"


@pytest.fixture
def box(tmp_path):
    """Return a function that writes a folder of tables."""

    def write(**tables: str | bytes) -> Path:
        given: dict[str, str | bytes] = {
            "operating": OPERATING,
            "gears": GEARS,
            "meshes": MESHES,
            **tables,
        }
        for name, text in given.items():
            content = text.encode() if isinstance(text, str) else text
            (tmp_path / f"{name}.csv").write_bytes(content)
        return tmp_path

    return write


@pytest.mark.parametrize("name", SHIPPED)
@pytest.mark.quick(10)
def test_a_case_survives_its_tables(name, tmp_path) -> None:
    case = shipped(name)
    for table, frame in case_frames(case.to_dict()):
        (tmp_path / f"{table}.csv").write_text(csv_of(frame), encoding="utf-8")
    again = import_tables(tmp_path).case()
    assert again == case
    assert again.hash == case.hash


def test_a_few_lines_make_a_case(box) -> None:
    found = import_tables(box())
    case = found.case()
    assert found.taken == ("gears (2)", "meshes (1)")
    assert case.gears["b"].centre[0].si == pytest.approx(0.06)
    assert case.gears["a"].face_width.si == pytest.approx(0.01), "a space stands for _"
    assert case.gears["a"].teeth == 20
    assert ls.solve(case).positions[0].torque == pytest.approx({"a-b": 100.0})


def test_columns_may_have_any_order(box) -> None:
    rows = [line.split(",") for line in GEARS.splitlines()]
    turned = "".join(",".join(reversed(row)) + "\n" for row in rows)
    assert import_tables(box(gears=turned)).case() == import_tables(box()).case()
    with pytest.raises(CaseError, match="row 4, column E: has no name"):
        import_tables(box(gears=turned + "10,0; 0\n"))


def test_a_head_may_say_that_its_numbers_have_no_unit(box) -> None:
    given = import_tables(box(gears=GEARS.replace("teeth", "teeth [-]")))
    assert given.data == import_tables(box()).data
    (_, table), *_ = case_frames({"stages": {"I": {"meshes": ["5 -"]}}})
    assert list(table.columns) == ["name", "meshes"]


def test_whole_numbers_may_have_decimals(box) -> None:
    """Some programs write all numbers so; numbers of teeth remain whole numbers."""
    case = import_tables(box(gears=GEARS.replace("a,20,2", "a,20.0,2.0"))).case()
    assert case == import_tables(box()).case().replace({"gears.a.module": "2.0 mm"})
    assert isinstance(case.gears["a"].teeth, int)
    with pytest.raises(CaseError, match=r"gears\.a\.teeth = .*20\.5.*Allowed: a whole number"):
        import_tables(box(gears=GEARS.replace("a,20,2", "a,20.5,2"))).case()


def test_cells_are_what_their_keys_take(box) -> None:
    """Numbers are names, counts or physical values; lists, lists of lists, tables and words."""
    gears = (
        "name,type,teeth,base_radius [mm],centre.distance,centre.angle [deg],held,axis\n"
        "1,,,30,0 mm,0,false,0;0;1.0\n"
        "2,internal,80,90,60 mm,0,,\n"
    )
    meshes = "name,table.torque [N*m],table.deflection,pressure_angle\n"
    meshes += "1-2,100; 200,1 mrad; 2 mrad | 1.1 mrad; 2.1 mrad,0 deg\n"
    found = import_tables(
        box(
            operating="key,value\ninput,1\noutput,2\npositions,2\ntorque,5 N*m\n",
            gears=gears,
            meshes=meshes,
            stages="name,meshes,groups\nI,1-2,1-2 | 1-2\n",
            case="key,value\ntitle,one; two\nassumed,gears.1.teeth\n",
        )
    ).data
    assert found["operating"] == {"input": "1", "output": "2", "positions": 2, "torque": "5 N*m"}
    assert found["gears"]["1"] == {
        "base_radius": "30 mm",
        "centre": {"distance": "0 mm", "angle": "0 deg"},
        "held": False,
        "axis": [0, 0, 1.0],
    }
    assert found["meshes"]["1-2"]["table"] == {
        "torque": ["100 N*m", "200 N*m"],
        "deflection": [["1 mrad", "2 mrad"], ["1.1 mrad", "2.1 mrad"]],
    }
    assert found["stages"]["I"] == {"meshes": ["1-2"], "groups": [["1-2"], ["1-2"]]}
    assert found["title"] == "one; two"
    assert found["assumed"] == ["gears.1.teeth"]


@pytest.mark.parametrize(
    ("tables", "message"),
    [
        (
            {"gears": GEARS.replace("40,2", "40,2 kg")},
            'gears.csv: row 3, column C: gears.b.module = "2 kg": is a mass, but a length is '
            "needed",
        ),
        ({"gears": GEARS.replace("20,2", "two,2")}, "gears.csv: row 2, column B: gears.a.teeth"),
        (
            {"gears": GEARS.replace("teeth", "tooth")},
            "gears.csv: row 2, column B: gears.a.tooth = ",
        ),
        (
            {"gears": GEARS.replace("teeth", "a b.c[0]")},
            'gears.csv: row 1, column B: "a b.c[0]" is not a key',
        ),
        ({"gears": GEARS + "a,1,1,1\n"}, 'row 4, column A: the name "a" appears twice'),
        ({"gears": GEARS + ",1,1,1\n"}, "row 4, column A: has no name"),
        ({"gears": GEARS + "c,1,1,1;1,1,6\n"}, 'row 4, column F: "6" has no head'),
        ({"gears": GEARS.replace("module", "teeth")}, "gears.csv: row 2, column C: gears.a.teeth"),
        (
            {"gears": "a,b\n"},
            "gears.csv: row 1, column A: has no heading. Allowed: name, then keys",
        ),
        ({"gears": ""}, "gears.csv: row 1, column A: has no head"),
        ({"gears": GEARS.replace(",", "\t")}, "has no commas between its cells"),
        ({"gears": "name;teeth\na;1,5\n"}, "has no commas between its cells"),
        ({"gears": 'name,teeth\n"a,1\n'}, "gears.csv: is not CSV"),
        ({"gears": b"name,teeth\n\xff,1\n"}, "gears.csv: is not UTF-8 text at byte 11"),
        (
            {"operating": "input,a\n"},
            "operating.csv: row 1, column A: has no heading. Allowed: key,",
        ),
        (
            {"operating": OPERATING + "speed,1 rpm,2\n"},
            "row 5, column C: is outside the columns key and",
        ),
        ({"operating": OPERATING + ",1 rpm\n"}, "row 5, column A: has a value but no key"),
        ({"operating": OPERATING + "torque,1 N*m\n"}, "operating.torque appears twice"),
        (
            {"meshes": "name,law,law.b\na-b,iso,1e-6 rad/(N*m)\n"},
            'row 2, column C: meshes."a-b".law.b cannot be combined with meshes."a-b".law',
        ),
        ({"gaers": GEARS}, "gaers.csv: gaers is not a table of a case. Allowed: case, operating, "),
        ({"gears": "name," + ".".join("a" * 30) + "\na,1\n"}, "is not a key"),
    ],
)
def test_what_is_wrong_is_reported_with_its_cell(box, tables, message) -> None:
    with pytest.raises(CaseError) as caught:
        import_tables(box(**tables)).case()
    assert message in str(caught.value)


def test_a_unit_may_be_a_reciprocal(box) -> None:
    gears = GEARS.replace("teeth,", "teeth,expansion [1/K],").replace(",20,", ",20,11.5e-6,")
    found = import_tables(box(gears=gears.replace(",40,", ",40,,"))).data
    assert found["gears"]["a"]["expansion"] == "11.5e-6 1/K"


def test_a_folder_without_tables_and_none_at_all_are_reported(tmp_path) -> None:
    for path, message in ((tmp_path, "contains no CSV file"), (tmp_path / "x", "no such file")):
        with pytest.raises(CaseError, match=message):
            import_tables(path)


def test_names_that_look_like_formulas_stay_names(box, tmp_path) -> None:
    """No written cell is a formula, and reading it gives the name."""
    case = import_tables(box()).case()
    data = case.to_dict()
    name = "=1+1"
    data["gears"][name] = data["gears"].pop("a")
    data["operating"]["input"] = name
    data["meshes"] = {"m": {"driver": name, "driven": "b", **data["meshes"]["a-b"]}}
    tables = {name: csv_of(frame) for name, frame in case_frames(data)}
    assert "\n'=1+1," in tables["gears"]
    cells = [
        cell for text in tables.values() for row in csv.reader(text.splitlines()) for cell in row
    ]
    assert not [cell for cell in cells if cell[:1] in tuple("=@\t")]
    again = import_tables(box(**tables)).case()
    assert again == ls.Case(data)


def test_what_cannot_stand_in_a_cell_is_not_written(box) -> None:
    data = import_tables(box()).case().to_dict()
    data["meshes"] = {"m;n": {"driver": "a", "driven": "b", **data["meshes"]["a-b"]}}
    data["stages"] = {"I": {"meshes": ["m;n"]}}
    with pytest.raises(CaseError, match="cannot be written to a cell as it is"):
        dict(case_frames(data))
    assert dict(case_frames({"notes": "one line\r\nand another"}))
    with pytest.raises(CaseError, match="cannot be written to a cell as it is"):
        dict(case_frames({"notes": "one line\rand another"}))


@pytest.mark.parametrize(
    ("law", "cell"),
    [
        ({"stiffness": ["1e6 N*m/rad"]}, "1e6;"),
        ({"law": {"b": ["1e-6 rad/(N*m)"]}}, "1e-6;"),
        ({"table": {"torque": ["50 N*m"], "deflection": [["1 mrad"]]}}, "1 |"),
        ({"table": {"torque": ["5 N*m", "9 N*m"], "deflection": [["1 mrad", "2 mrad"]]}}, "1; 2 |"),
    ],
)
def test_a_list_of_one_stays_a_list(box, law, cell) -> None:
    case = ls.Case(import_tables(box()).case().to_dict() | {"meshes": {"a-b": law}})
    tables = {name: csv_of(frame) for name, frame in case_frames(case.to_dict())}
    assert tables["meshes"].splitlines()[1].endswith(f",{cell}")
    assert import_tables(box(**tables)).case() == case


def test_an_empty_end_of_a_longer_list_is_an_entry(box) -> None:
    tables = box(meshes="name,stiffness [N*m/rad]\na-b,1e6; 2e6;\n")
    with pytest.raises(CaseError, match="not a number followed by a unit"):
        import_tables(tables).case()


def test_a_text_that_fits_no_cell_is_named_with_its_element(box) -> None:
    data = import_tables(box()).case().to_dict()
    data["stages"] = {"I": {"meshes": ["a-b"]}, "II": {"meshes": ["m;n"]}}
    with pytest.raises(CaseError, match=r'stages\.II\.meshes = \["m;n"\]: cannot be written'):
        dict(case_frames(data))


def test_a_cell_of_a_table_may_be_as_long_as_the_table(box, tmp_path) -> None:
    """The loads of some ten thousand steps are; Python's CSV reader stops at 131,072 characters."""
    case = import_tables(box()).case().replace({"notes": "x" * 200_000})
    (tmp_path / "case.csv").write_text(csv_of(dict(case_frames(case.to_dict()))["case"]))
    limit = csv.field_size_limit()
    assert import_tables(tmp_path).case() == case
    assert csv.field_size_limit() == limit


def test_spaces_at_the_ends_of_a_title_are_named(box) -> None:
    data = import_tables(box()).case().to_dict() | {"title": "A box, which one? "}
    with pytest.raises(CaseError, match="A cell loses leading and trailing spaces"):
        dict(case_frames(data))


def test_the_command_writes_tables_that_the_command_reads(tmp_path) -> None:
    command, folder = on_a_screen_of(200), tmp_path / "deep" / "box"
    case = shipped("fgfbstts/all_elements")
    path = tmp_path / "all.toml"
    path.write_text(case.to_toml(), encoding="utf-8")
    assert command("run", path, "--tables", folder).exit_code == 0
    again = tmp_path / "again.toml"
    done = command("import", folder, "-o", again)
    assert done.exit_code == 0
    assert "Left out: tables of a result" in done.stdout
    assert ls.load_case(again) == case
    result = ls.solve(case)
    with (folder / "result_meshes.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == len(result.positions) * len(case.meshes)
    for row in rows:
        here = result.positions[int(row["position"]) - 1]
        assert float(row["torque [N·m]"]) == here.torque[row["mesh"]]
        assert float(row["mesh_force [N]"]) == here.loads.meshes[row["mesh"]]
        assert float(row["mesh_position [1]"]) == here.mesh_position[row["mesh"]]
    with (folder / "result_gears.csv").open(encoding="utf-8") as file:
        for row in csv.DictReader(file):
            force = result.positions[int(row["position"]) - 1].loads.bearings[row["gear"]]
            assert (float(row["bearing_force x [N]"]), float(row["bearing_force y [N]"])) == force
    assert {*export_tables(result)} == {file.stem for file in folder.iterdir()}


BESIDE = ("notes.csv", "Errors2.csv", "result_mine.csv", "errors.csv.old", "readme.txt")


def test_tables_of_an_earlier_case_join_no_other(tmp_path) -> None:
    command, folder = on_a_screen_of(200), tmp_path / "box"
    first, second = (CASES / "fgfbstts" / f"{n}.toml" for n in ("installation_error", "base"))
    assert command("run", first, "-o", f"{folder}/").exit_code == 0
    assert (folder / "errors.csv").exists()
    for name in BESIDE:
        (folder / name).write_text("name\n", encoding="utf-8")
    assert command("run", second, "-o", f"{folder}/").exit_code == 0
    own = {f"{name}.csv" for name in export_tables(ls.solve(second))}
    assert {file.name for file in folder.iterdir()} == {*own, *BESIDE}
    for name in BESIDE:
        (folder / name).unlink()
    assert import_tables(folder).case() == ls.load_case(second)


class Stopped(BaseException):
    """Stands for the effect of a signal on a command."""


@pytest.mark.parametrize("kind", [Stopped, OSError])
@pytest.mark.quick(1)
def test_no_interruption_leaves_a_folder_of_two_cases(tmp_path, monkeypatch, kind) -> None:
    cases = [shipped(f"star/floating_sun_{planets}") for planets in (3, 4)]
    first, second = (export_frames(ls.solve(case, positions=[1])) for case in cases)
    now, found = {"left": -1}, []

    def failing(do):
        def step(path: Path, *given: object, **named: object) -> object:
            now["left"] -= 1
            if now["left"] == 0:
                raise kind(28, "the disk is full")
            return do(path, *given, **named)

        return step

    for name in ("write_bytes", "replace", "unlink"):
        monkeypatch.setattr(Path, name, failing(getattr(Path, name)))
    for count in range(1, 100):
        folder = tmp_path / f"{count}"
        write_tables(folder, first)
        now["left"] = count
        with contextlib.suppress(Stopped, OSError):
            write_tables(folder, second)
        done, now["left"] = now["left"] > 0, -1
        try:
            found.append(cases.index(import_tables(folder).case()))
        except CaseError:
            found.append(None)
        assert not [file for file in folder.iterdir() if file.name.startswith(".")]
        if done:
            break
    # The old case, then none, then the new one.
    assert found == sorted(found, key=[0, None, 1].index)
    assert found.count(0) > len(second)
    assert found[-1] == 1


def test_a_folder_that_cannot_be_written_names_the_table(tmp_path, monkeypatch) -> None:
    folder = tmp_path / "box"
    (folder / "gears.csv").mkdir(parents=True)
    case = CASES / "fgfbstts" / "base.toml"
    done = on_a_screen_of(200)("run", case, "-o", f"{folder}/", "-q")
    assert done.exit_code == 2
    assert f"{folder / 'gears.csv'}: cannot be written" in done.stderr


def test_a_folder_has_its_name_for_the_case(box, monkeypatch) -> None:
    folder = box()
    monkeypatch.chdir(folder)
    done = on_a_screen_of(200)("import", ".")
    assert done.exit_code == 0
    assert (folder / f"{folder.name}.toml").exists()


def test_a_workbook_needs_its_library(tmp_path, monkeypatch) -> None:
    path = tmp_path / "box.xlsx"
    path.write_bytes(b"")
    monkeypatch.setitem(sys.modules, "openpyxl", None)
    done = on_a_screen_of(200)("import", path)
    assert done.exit_code == 2
    assert "is a workbook, which needs openpyxl to be read" in done.stderr
    assert "pip install 'loadshare[spreadsheet]'" in done.stderr


def test_a_case_and_its_result_go_into_a_workbook_and_back(tmp_path) -> None:
    openpyxl = pytest.importorskip("openpyxl")
    case = shipped("star/floating_sun_3")
    title = '=HYPERLINK("x")'
    tables = export_frames(ls.solve(case.replace({"title": title})))
    (tmp_path / "star.xlsx").write_bytes(workbook_of(tables))
    assert import_tables(tmp_path / "star.xlsx").data == {**case.to_dict(), "title": title}
    book = openpyxl.load_workbook(tmp_path / "star.xlsx")
    assert book.sheetnames == list(tables)
    kinds = {cell.data_type for sheet in book for row in sheet.iter_rows() for cell in row}
    assert "f" not in kinds
    figures = [c.value for row in book["result_meshes"].iter_rows(min_row=2) for c in row]
    assert any(isinstance(value, float) for value in figures)


@pytest.mark.parametrize("text", ["x" * 32768, "a\x07b", "a\r\nb", "a\ufffeb"])
def test_what_no_workbook_can_hold_is_not_written_there(box, text) -> None:
    """It used to be cut or changed, like lists of thousands of positions."""
    pytest.importorskip("openpyxl")
    data = import_tables(box()).case().to_dict()
    tables = dict(case_frames({**data, "notes": text}))
    with pytest.raises(CaseError, match=r"case\.notes.*: no cell of a workbook can hold it"):
        workbook_of(tables)
    tables = dict(case_frames({**data, "notes": "x\n" + "x" * 32765}))
    assert workbook_of(tables)


def test_names_of_a_result_stay_texts_in_a_workbook(box, tmp_path) -> None:
    """A column is numeric because it contains numbers, not because its texts look like numbers."""
    openpyxl = pytest.importorskip("openpyxl")
    gears = GEARS.replace("\na,", "\n1_1,").replace("\nb,", "\nnan,")
    operating = OPERATING.replace("input,a", "input,1_1").replace("output,b", "output,nan")
    folder = box(gears=gears, operating=operating, meshes=MESHES.replace("a-b", "1_1-nan"))
    result = ls.solve(import_tables(folder).case())
    (tmp_path / "box.xlsx").write_bytes(workbook_of(export_frames(result)))
    book = openpyxl.load_workbook(tmp_path / "box.xlsx")
    head, *rows = book["result_gears"].iter_rows(values_only=True)
    assert [row[head.index("gear")] for row in rows] == ["1_1", "nan"]
    assert [row[head.index("position")] for row in rows] == [1, 1]
    rotation = result.dataset["rotation"].sel(position=1).values.tolist()
    assert [row[head.index("rotation [rad]")] for row in rows] == rotation
    table = pd.DataFrame({"gear": ["inf", "007"], "load": [math.inf, math.nan]})
    (tmp_path / "box.xlsx").write_bytes(workbook_of({"one": table}))
    sheet = openpyxl.load_workbook(tmp_path / "box.xlsx")["one"]
    found = list(sheet.iter_rows(min_row=2, values_only=True))
    assert found == [("inf", "inf"), ("007", None)]


@pytest.fixture
def book(tmp_path):
    """Return a workbook with the tables of a case, and a function that reads its present state."""
    openpyxl = pytest.importorskip("openpyxl")
    book, path = openpyxl.Workbook(), tmp_path / "box.xlsx"
    book.remove(book.active)
    for name, text in {"operating": OPERATING, "gears": GEARS, "meshes": MESHES}.items():
        sheet = book.create_sheet(name)
        for row in csv.reader(text.splitlines()):
            sheet.append([float(cell) if cell.isdigit() else cell for cell in row])

    def read(*changes: tuple[bytes, bytes]) -> dict:
        book.save(path)
        with zipfile.ZipFile(path) as archive:
            parts = {name: archive.read(name) for name in archive.namelist()}
        for old, new in changes:
            assert any(old in content for content in parts.values())
            parts = {name: content.replace(old, new) for name, content in parts.items()}
        with zipfile.ZipFile(path, "w") as archive:
            for name, content in parts.items():
                archive.writestr(name, content)
        return import_tables(path).data

    return book, read


def test_a_sheet_that_is_lost_is_no_case_without_it(book) -> None:
    """The archive is damaged, or was only half written."""
    sheets, read = book
    sheets.create_sheet("errors")["A1"] = "name"
    assert read()
    with pytest.raises(CaseError, match="damaged workbook: it lacks its sheet 'errors'"):
        read((b"sheet4.xml", b"sheet9.xml"))


def test_empty_sheets_of_no_table_are_left_out(book, tmp_path) -> None:
    """Programs add them to new workbooks; an empty sheet of a table may have lost its rows."""
    sheets, read = book
    whole = read()
    sheets.create_sheet("Tabelle1")
    sheets.create_sheet("Notes")["B2"] = "  "
    assert read() == whole
    assert import_tables(tmp_path / "box.xlsx").left_out == ("empty sheets",)
    sheets["Notes"]["B2"] = "as agreed"
    with pytest.raises(CaseError, match="sheet Notes: notes is not a table of a case"):
        read()
    sheets["Notes"]["B2"] = None
    sheets.create_sheet("errors")
    with pytest.raises(CaseError, match="sheet errors: row 1, column A: has no head"):
        read()


def test_a_formula_without_a_saved_value_is_no_empty_cell(book) -> None:
    """Programs that write formulas do not compute them; a spreadsheet program saves values."""
    sheets, read = book
    whole = read()
    sheets["gears"]["B2"] = "=4*5"
    sheets.create_sheet("result_gears")["A1"] = "=1+1"
    message = "box.xlsx: sheet gears: row 2, column B: is a formula whose value was not saved"
    calculated = (b'fullCalcOnLoad="1"', b"")
    value = (b"<f>4*5</f><v />", b"<f>4*5</f><v>20</v>")
    # The value that is there before anybody has computed it does not count either.
    for changes in ((), (calculated,), (value,)):
        with pytest.raises(CaseError, match="save it, or write the value") as caught:
            read(*changes)
        assert message in str(caught.value)
        assert len(caught.value.problems) == 1
    assert read(calculated, value) == whole
    sheets["gears"]["F2"] = '=""'
    empty = (b'<c r="F2"><f>', b'<c r="F2" t="str"><f>')
    assert read(calculated, value, empty) == whole


@pytest.mark.parametrize(
    ("cell", "value", "shown"),
    [("A3", datetime(2026, 6, 4), None), ("B2", 20, "dd.mm.yyyy"), ("B2", 20, "h:mm")],
)
def test_a_date_is_told_to_be_no_name_and_no_number(book, cell, value, shown) -> None:
    """Programs turn the name 4-6 into one, and show numbers as dates."""
    sheets, read = book
    sheet = sheets["gears"]
    sheet[cell] = value
    sheet[cell].number_format = shown or sheet[cell].number_format
    place = f"row {cell[1]}, column {cell[0]}"
    with pytest.raises(CaseError, match=f"sheet gears: {place}: is a date or a time") as caught:
        read()
    assert "Format the cell as text, or as a number" in str(caught.value)


def test_merged_cells_have_their_value_in_every_row(book) -> None:
    sheets, read = book
    sheets["gears"]["E3"] = None
    sheets["gears"].merge_cells("E2:E3")
    # A header that spans two rows is one header.
    sheets["operating"].insert_rows(2)
    sheets["operating"].merge_cells("A1:A2")
    found = read()
    assert [gear["face_width"] for gear in found["gears"].values()] == ["10 mm", "10 mm"]
    assert found["operating"] == {"input": "a", "output": "b", "torque": "100 N*m"}
    sheets["gears"].merge_cells("B2:C2")
    with pytest.raises(CaseError, match=r"box.xlsx: sheet gears: B2:C2: is merged across columns"):
        read()
    sheets["gears"].unmerge_cells("B2:C2")
    with pytest.raises(CaseError, match="has merged cells that overlap"):
        read(
            (
                b'<mergeCell ref="E2:E3"',
                b'<mergeCell ref="E2:E3"/>' * 99 + b'<mergeCell ref="E2:E3"',
            )
        )


def test_rows_of_a_sheet_are_counted_and_those_of_a_result_are_not(book) -> None:
    import openpyxl

    sheets, read = book
    whole = read()
    sheets.create_sheet("result_gears")["A20000"] = 1.0
    sheets["gears"]["A20000"].font = openpyxl.styles.Font(bold=True)
    assert read() == whole
    sheets["gears"]["A20000"] = "c"
    with pytest.raises(CaseError, match="has more than 10000 rows in sheet gears"):
        read()


def test_cells_of_a_sheet_are_counted_with_the_empty_ones(book, monkeypatch) -> None:
    """One in the last column of ten thousand rows took half a minute and a gigabyte."""
    sheets, read = book
    sheets["gears"]["XFD3"] = "x"
    with pytest.raises(CaseError, match='column XFD: "x" has no head'):
        read()
    where = "loadshare.exchange.spreadsheet.workbook.ALLOWED"
    monkeypatch.setattr(where, ALLOWED._replace(cells=2**14))
    with pytest.raises(CaseError, match="has more than 16384 cells in sheet gears"):
        read()


@pytest.mark.parametrize("stated", [b"A1", b"A1:D2"])
def test_the_stated_size_of_a_sheet_is_not_believed(book, stated) -> None:
    _, read = book
    whole = read()
    assert read((b'ref="A1:E3"', b'ref="' + stated + b'"')) == whole


def test_run_writes_a_workbook_if_it_can(tmp_path, monkeypatch) -> None:
    pytest.importorskip("openpyxl")
    case = CASES / "star/floating_sun_3.toml"
    book = tmp_path / "star.xlsx"
    assert on_a_screen_of(200)("run", case, "--tables", book).exit_code == 0
    assert import_tables(book).data == ls.load_case(case).to_dict()
    monkeypatch.setitem(sys.modules, "openpyxl", None)
    done = on_a_screen_of(200)("run", case, "--tables", tmp_path / "other.xlsx")
    assert done.exit_code == 2
    assert "needs openpyxl to be written" in done.stderr


def test_a_workbook_says_what_its_sheets_say(box, tmp_path) -> None:
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.Workbook()
    book.remove(book.active)
    for name, text in {"operating": OPERATING, "Gears": GEARS, "meshes": MESHES}.items():
        sheet = book.create_sheet(name)
        for row in csv.reader(text.splitlines()):
            sheet.append([float(cell) if cell.isdigit() else cell for cell in row])
    book.save(tmp_path / "box.xlsx")
    assert import_tables(tmp_path / "box.xlsx").data == import_tables(box()).data
    (tmp_path / "box.xlsx").write_bytes(b"PK damaged")
    with pytest.raises(CaseError, match="is a damaged workbook"):
        import_tables(tmp_path / "box.xlsx")
    with zipfile.ZipFile(tmp_path / "box.xlsx", "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("xl/workbook.xml", b" " * (65 * 2**20))
    with pytest.raises(CaseError, match="unpacks into more than 64 MiB"):
        import_tables(tmp_path / "box.xlsx")
