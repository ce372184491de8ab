"""A small typed program that uses the whole public interface as users do."""

from __future__ import annotations

from pathlib import Path

import altair as alt
import pandas as pd
import xarray as xr

import loadshare as ls

CASE = "fgfbstts/limit_ring"
FLOAT = "rings.4.float"


def solved() -> tuple[ls.Result, ls.Figure]:
    names: tuple[str, ...] = ls.examples()
    case: ls.Case = ls.examples(names[names.index(CASE)])
    result: ls.Result = ls.solve(case, positions=[1])
    passed: bool = result.passed
    omega: float | None = result.omega["II"]
    torque: float = result.positions[0].torque["6-10"]
    table: pd.DataFrame = result.to_dataframe()
    arrays: xr.Dataset = result.to_xarray()
    figure: ls.Figure = result.plot.floats() | result.plot.share(over="group")
    assert passed
    assert omega is not None
    assert torque > 0.0
    assert len(table)
    assert arrays.sizes["mesh"]
    assert ls.plot(result) is not None
    assert ls.explain(case, 1) is not None
    return result, figure


def studied(case: ls.Case) -> None:
    found: ls.Sweep = ls.sweep(case, {FLOAT: ["8 um", "9 um"]}, positions=[1])
    rule = alt.Chart(alt.InlineData(values=[{"y": 1.0}])).mark_rule().encode(y="y:Q")
    drawn: ls.Figure = found.plot() + rule
    events: ls.Critical = ls.critical(case, FLOAT, "8 um", "9 um", positions=[1])
    values: list[float] = [event.value for event in events.events]
    rates: ls.Sensitivity = ls.sensitivity(case, [FLOAT], positions=[1])
    rate: float = rates.omega[FLOAT, "rising"]["II"]
    steps: ls.March = ls.march(ls.examples("fgfbstts/full_float"), gear="6", revolutions=1, steps=2)
    bench = ls.examples("fgfbstts/installation_error").replace(
        {"measured.bench": {"position": 1, "pair_share": {"6-10": 0.9}, "uncertainty": 0.1}}
    )
    fitted: ls.Fit = ls.fit(bench, {"errors.6.installation[0]": ("0 um", "100 um")})
    against: ls.Comparison = ls.compare(bench)
    scatter: ls.Tolerance = ls.tolerance(
        ls.examples("fgfbstts/tolerance"), samples=64, indices=0, worst=False
    )
    mean: float = scatter.of("system").summary.mean.value
    tables: list[pd.DataFrame] = [
        one.to_dataframe() for one in (found, events, rates, steps, fitted, against, scatter)
    ]
    arrays: list[xr.Dataset] = [one.to_xarray() for one in (found, rates, steps, scatter)]
    assert drawn.name
    assert values
    assert rate == rate
    assert mean >= 1.0
    assert all(map(len, tables))
    assert all(one.sizes for one in arrays)
    study = {"study.floats": {"kind": "sweep", "over": {FLOAT: ["8 um", "9 um"]}}}
    assert ls.run_study(case.replace(study), "floats") is not None


def refused_and_read(folder: Path, result: ls.Result) -> None:
    many: xr.Dataset = ls.solve_many(result.case, {f"{FLOAT} [um]": [8.0, 9.0]}, positions=[1])
    assert many.sizes["sample"] == 2
    assert ls.formulate(result.case, 1) is not None
    assert ls.search(result.case) is not None
    result.to_json(folder / "result.json")
    again: ls.Result = ls.load_result(folder / "result.json")
    assert again == result
    assert "gears" in ls.case_schema()["properties"]
    text: str = result.case.to_toml(folder / "case.toml")
    assert text
    assert ls.load_case(folder / "case.toml") == result.case
    try:
        result.case.replace({FLOAT: "8"})
    except ls.CaseError as error:
        problems: list[ls.Problem] = list(error.problems)
        wrong: ls.LoadshareError = error
        (folder / "problems.txt").write_text(f"{problems}{wrong}")
    try:
        ls.load_result(folder / "case.toml")
    except (ls.ResultError, ls.Refused) as error:
        (folder / "refusal.txt").write_text(str(error))


def main(folder: Path) -> None:
    """Use the whole interface, and save a picture."""
    result, figure = solved()
    figure.save(folder / "floats.svg")
    studied(result.case)
    refused_and_read(folder, result)
