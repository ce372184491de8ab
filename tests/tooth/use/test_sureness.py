"""The dependence of a law on rims and sampling, reported with the law."""

import re

import numpy as np
import pytest
from tests.tooth.use.pairs import FACE, SPUR, written

from loadshare.tooth.analysis.ltca import ltca
from loadshare.tooth.law.file import MeshLaw, law_of, law_text, load_law
from loadshare.tooth.pair.file import load_pair
from loadshare.tooth.pair.sensitivity import rim_effects, sampled_deflection

BORED = SPUR.replace("[driven]", '[driven]\nrim = "60 mm"')
RING = SPUR.replace("[driven]", '[driven]\ninternal = true\naddendum = 0.8\nrim = "90 mm"')


@pytest.mark.parametrize("text", [SPUR, BORED, RING, FACE])
@pytest.mark.quick(2)
def test_a_thinner_rim_is_stiffer_and_a_thicker_one_softer(text, tmp_path):
    effects = rim_effects(load_pair(written(tmp_path, text)))
    assert set(effects) == {"driver", "driven"}
    for effect in effects.values():
        thin, own, thick = effect.stiffness
        assert thin > own == 1.0 > thick
        assert effect.thickness[0] == pytest.approx(0.5 * effect.thickness[1])


def test_the_effect_is_that_of_another_pair_file(tmp_path):
    """Independent check: the pair with that rim, analysed directly over 40 positions."""
    effect = rim_effects(load_pair(written(tmp_path, BORED)))["driven"]
    root = 71.25  # of 50 teeth of module 3 mm
    assert effect.thickness[1] == pytest.approx((root - 60.0) * 1e-3)
    means = []
    for thickness in effect.thickness:
        text = BORED.replace('rim = "60 mm"', f'rim = "{root - 1e3 * thickness} mm"')
        found = ltca(load_pair(written(tmp_path, text)).geometry, 100.0, 40, (1.0,), "slices")
        means.append(found.approach[:, -1].mean())
    # 40 positions alias the mean of this pair by 0.8 %, but equally for all three.
    assert means[1] / np.array(means) == pytest.approx(effect.stiffness, rel=2e-3)


def test_a_shaft_pinion_is_tried_half_way_to_solid(tmp_path):
    text = SPUR.replace("[driver]", '[driver]\nrim = "6 mm"')
    effect = rim_effects(load_pair(written(tmp_path, text)))["driver"]
    root = 33.75e-3
    assert effect.thickness[2] == pytest.approx(0.5 * (root - 6e-3 + root))


def test_positions_that_alias_are_reported(spur):
    pair = load_pair(spur)  # two positions
    found = pair.analyse()
    many = ltca(pair.geometry, pair.torque, 401, (1.0,), "slices", points=8)
    missed = found.approach[:, -1].mean() / many.approach[:, -1].mean()
    assert sampled_deflection(pair) == pytest.approx(missed, rel=5e-3)
    finding = law_of(pair, found).findings[-1]
    assert re.search(r"Sampled at 2 positions, .* is \+7\.\d % off", finding)


def test_means_are_requested_in_the_pair_file(tmp_path):
    """The law's mean no longer depends on the positions, and nothing is reported about them."""
    laws = {}
    for count in (2, 7):
        text = SPUR.replace("positions = 2", f'positions = {count}\nsampling = "means"')
        pair = load_pair(written(tmp_path, text))
        laws[count] = law_of(pair, pair.analyse())
        assert laws[count].computed.sampling == "means"
        assert laws[count].sampled is None
        assert not any("Sampled" in line for line in laws[count].findings)
    means = [
        np.mean(
            [b.si * 90.0 + c.si * 90.0 ** (2 / 3) + a.si for a, b, c in zip(*parts, strict=True)]
        )
        for parts in ((law.a, law.b, law.c) for law in laws.values())
    ]
    assert means[0] == pytest.approx(means[1], rel=5e-4)


def test_a_law_file_holds_it(tmp_path):
    pair = load_pair(written(tmp_path, BORED))
    law = law_of(pair, pair.analyse())
    again = load_law(written(tmp_path, law_text(law), "law.toml"))
    assert again == law
    assert (law.rim["driver"].assumed, law.rim["driven"].assumed) == (True, False)
    assert "(assumed, 1.5 tooth heights)" in law.findings[0]
    assert "driven gear is 11.25 mm thick. With 5.625 mm" in law.findings[1]
    old = re.sub(r"sampled = .*\n\n\[rim(.|\n)*?\[computed\]", "[computed]", law_text(law))
    assert load_law(written(tmp_path, old, "old.toml")).findings == ()


def narrow(modules: float, compliance: str) -> str:
    """Return a helical pair of 30° on a face of `modules` modules."""
    text = SPUR.replace("[driven]", 'helix_angle = "30 deg"\n[driven]').replace("100 N", "500 N")
    text = text.replace('"20 mm"', f'"{3.0 * modules} mm"')
    return text.replace('compliance = "slices"', f'compliance = "{compliance}"')


@pytest.mark.parametrize(
    ("modules", "noted"),
    [(2.0, True), pytest.param(6.0, True, marks=pytest.mark.slow), (12.0, False)],
)
def test_what_slices_leave_out_of_narrow_helical_teeth_is_noted(tmp_path, modules, noted):
    pair = load_pair(written(tmp_path, narrow(modules, "slices")))
    law = law_of(pair, pair.analyse())
    assert any("sideways bending" in line for line in law.findings) is noted
    # A case that computes its law reports this with the law.
    assert ("sideways bending" in law.as_law()["basis"]) is noted
    solid = law.computed.model_copy(update={"compliance": "finite elements"})
    other = law.model_copy(update={"computed": solid})
    assert not any("sideways bending" in line for line in other.findings)


@pytest.mark.slow
def test_the_note_says_what_finite_elements_yield_more(tmp_path):
    torque = 500.0
    yielded = {}
    for model in ("slices", "finite elements"):
        pair = load_pair(written(tmp_path, narrow(2.0, model)))
        law = law_of(pair, pair.analyse())
        yielded[model] = np.mean(law_angles(law, torque))
        if model == "slices":
            (line,) = [line for line in law.findings if "sideways bending" in line]
    noted = float(re.search(r"about (\d+) % more", line)[1]) / 100.0
    # Finite elements of spur gears yield some 4 % more in any case.
    missed = yielded["finite elements"] / yielded["slices"] - 1.04
    assert missed == pytest.approx(noted, rel=0.15)


def law_angles(law: MeshLaw, torque: float) -> np.ndarray:
    """Return the elastic angle at every position [rad]."""
    return np.array(
        [b.si * torque + c.si * torque ** (2.0 / 3.0) for b, c in zip(law.b, law.c, strict=True)]
    )
