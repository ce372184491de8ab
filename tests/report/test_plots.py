"""Who draws: results and studies offer pictures, and `loadshare.plot` draws them."""

import pytest

import loadshare as ls
from loadshare.report.plots import Plots


def test_a_result_and_the_package_draw_alike(limit_ring):
    assert limit_ring.plot == ls.plot(limit_ring) == Plots(limit_ring)
    assert ls.plot(limit_ring).torque().spec == limit_ring.plot.torque().spec


def test_a_study_is_drawn_as_its_settings_say(limit_ring):
    found = ls.sweep(limit_ring.case, {"rings.4.float": ["0 um", "8 um"]}, positions=[1])
    assert ls.plot(found, "torque").spec == found.plot("torque").spec
    assert found.plot("torque").spec != found.plot("omega").spec


def test_what_has_no_pictures_is_told():
    with pytest.raises(TypeError, match="no pictures of dict"):
        ls.plot({})


def test_the_package_lists_what_is_public():
    assert dir(ls) == sorted(ls.__all__)
    assert all(getattr(ls, name) is not None for name in dir(ls))
