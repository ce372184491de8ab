"""A case cannot be changed, and neither can its result."""

import copy
import pickle

import pytest
from tests.support import CASES

import loadshare as ls


@pytest.fixture
def case() -> ls.Case:
    external = {"operating.external.6": "1 N*m"}
    return ls.load_case(CASES / "fgfbstts" / "limit_ring.toml").replace(external)


def test_tables_of_a_case_refuse_to_be_changed(case: ls.Case) -> None:
    for table in (case.rings, case.meshes, case.study, case.operating.external):
        with pytest.raises(TypeError, match=r"Case\.replace"):
            table["4"] = None  # type: ignore[index]
    with pytest.raises(TypeError, match=r"Case\.replace"):
        case.rings.pop("4")
    with pytest.raises(TypeError, match=r"Case\.replace"):
        del case.rings["4"]


def test_tables_of_a_result_refuse_to_be_changed(case: ls.Case) -> None:
    result = ls.solve(case, positions=[1])
    position = result.positions[0]
    tables = (
        *(result.omega, result.pair_omega, result.stages, result.frames, result.laws),
        *(position.torque, position.share, position.displacement, position.claim.flank_force),
    )
    for table in (*tables, position.floats):
        with pytest.raises(TypeError, match=r"cannot be changed|item assignment"):
            table["4"] = None  # type: ignore[index]
    for copied in (copy.copy(result), copy.deepcopy(result)):
        assert copied == result


def test_the_copy_that_pydantic_makes_is_none_with_changes(case: ls.Case) -> None:
    # It used to have the hash of the original case, so that a file of its result was refused.
    assert case.model_copy() == case.model_copy(deep=True) == case
    for copied in (case.model_copy, case.copy):
        with pytest.raises(TypeError, match=r"Case\.replace"):
            copied(update={"title": 3})


def test_arrays_of_a_study_cannot_be_written_to(case: ls.Case) -> None:
    found = ls.sweep(case, {"rings.*.float": ["2 um", "4 um"]}, positions=[1])
    for study in (found, ls.sensitivity(case, "rings.4.float", positions=[1])):
        with pytest.raises(ValueError, match="read-only"):
            study.dataset["torque"].values[:] = 0.0


def test_copies_are_cases_too(case: ls.Case) -> None:
    for copied in (copy.copy(case), copy.deepcopy(case), pickle.loads(pickle.dumps(case))):
        assert copied == case
        with pytest.raises(TypeError, match=r"Case\.replace"):
            copied.rings.clear()
