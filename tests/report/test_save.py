"""Pictures on disk: the file name's ending gives the format, and HTML needs no network."""

from __future__ import annotations

import json
import re
import struct
import subprocess
import sys

import pytest

import loadshare as ls
from loadshare.report.figure import CONFIG, Figure

EVIL = "</script><script>window.pwned = true</script><img src=x onerror=alert(1)>"


def without_scripts(page):
    """Return a page with its script elements emptied."""
    return re.sub(r"(<script[^>]*>).*?(</script>)", r"\1\2", page, flags=re.DOTALL)


def test_png_has_the_size_of_the_scale(picture, tmp_path):
    figure = picture("limit_ring", "share")
    sizes = []
    for scale in (1.0, 2.0):
        file = figure.save(tmp_path / f"{scale}.png", scale=scale)
        content = file.read_bytes()
        assert content[:8] == b"\x89PNG\r\n\x1a\n"
        sizes.append(struct.unpack(">II", content[16:24]))
    assert sizes[1] == pytest.approx([2 * v for v in sizes[0]], abs=2)


def test_svg_pdf_and_json(picture, tmp_path):
    figure = picture("limit_ring", "share")
    svg = figure.save(tmp_path / "new" / "a.svg").read_text(encoding="utf-8")
    assert svg.startswith("<svg")
    assert "Stage II" in svg
    assert figure.save(tmp_path / "a.PDF").read_bytes().startswith(b"%PDF-")
    assert json.loads(figure.save(tmp_path / "a.json").read_text(encoding="utf-8")) == figure.spec


def test_html_holds_its_scripts_and_loads_nothing(picture, tmp_path):
    page = picture("limit_ring", "share").save(tmp_path / "a.html").read_text(encoding="utf-8")
    assert "vegaEmbed" in page
    bare = without_scripts(page)
    assert not re.search(r"<script[^>]+src=|<link[^>]+href=.(?!data:)|@import|url\(", bare)
    assert "default-src 'none'" in page


def test_an_unknown_ending_is_reported(picture, tmp_path):
    with pytest.raises(ls.LoadshareError, match=r"'.bmp'.*Allowed: .png, .svg, .pdf, .html, .json"):
        picture("limit_ring", "share").save(tmp_path / "a.bmp")
    with pytest.raises(ls.LoadshareError, match="none"):
        picture("limit_ring", "share").save(tmp_path / "a")
    assert list(tmp_path.iterdir()) == []


def test_an_unknown_form_or_scale_is_reported(picture, tmp_path):
    figure = picture("limit_ring", "share")
    with pytest.raises(ValueError, match="unknown form 'gif'; allowed: png, svg, pdf, html, json"):
        figure.content("gif")
    for scale in (0, -1.0, float("nan"), 1e9, "2", None):
        with pytest.raises(ValueError, match=r"scale .*; allowed: a number from 0\.1 to 10"):
            figure.save(tmp_path / "a.png", scale=scale)
    assert list(tmp_path.iterdir()) == []


def test_nothing_is_left_of_a_picture_that_failed(drawn_anew, picture, tmp_path, monkeypatch):
    import vl_convert

    def broken(*_, **__):
        raise ValueError("no")

    monkeypatch.setattr(vl_convert, "svg_to_png", broken)
    with pytest.raises(ValueError, match="no"):
        picture("limit_ring", "share").save(tmp_path / "a.png")
    assert list(tmp_path.iterdir()) == []


def test_text_of_a_case_cannot_end_a_script(tmp_path):
    import altair as alt

    chart = alt.Chart(alt.InlineData(values=[{"a": EVIL}])).mark_text().encode(text="a:N")
    figure = Figure("evil", chart.properties(title=EVIL))
    page = figure.save(tmp_path / "a.html").read_text(encoding="utf-8")
    # Two scripts with code and one with the specification.
    assert len(re.findall(r"<script", page)) == 3
    assert len(re.findall(r"</script", page)) == 3
    assert "<img" not in without_scripts(page)
    assert EVIL not in page


def test_a_notebook_is_shown_svg(picture):
    figure = picture("limit_ring", "share")
    shown = figure._repr_mimebundle_()
    assert set(shown) == {"image/svg+xml"}
    assert figure.spec["config"] == CONFIG


def test_a_picture_is_its_specification_and_an_altair_chart(picture):
    figure = picture("limit_ring", "torque")
    assert Figure("torque", figure.spec).to_svg() == figure.to_svg()
    assert Figure("torque", figure.chart).to_svg() == figure.to_svg()


def test_an_altair_chart_keeps_its_rows_and_its_selection_beside_a_picture(picture):
    import altair as alt

    chart = alt.Chart(alt.InlineData(values=[{"x": 1.0}])).mark_point().encode(x="x:Q")
    figure = picture("limit_ring", "torque")
    for drawn in (chart.interactive(), alt.layer(chart, chart).interactive()):
        both = (figure | drawn).spec
        assert [{"x": 1.0}] in both["datasets"].values()
        params = both.get("params") or both["hconcat"][1]["params"]
        assert params[0]["bind"] == "scales"
        assert "<svg" in (figure | drawn).to_svg()


@pytest.mark.parametrize(
    "more", ["", "print(type(converter.begin('', None).exception()).__name__)"]
)
def test_what_is_interrupted_as_the_thread_of_pictures_starts_comes_to_its_end(more):
    # Ctrl-C arrives while the main thread waits for the new one to start. The pool does not have
    # that thread yet, and the interpreter would wait for it. Later drawings get another one.
    script = f"""
import threading
from loadshare.report import converter
begun = threading.Thread.start
def start(thread):
    begun(thread)
    raise KeyboardInterrupt
threading.Thread.start = start
try:
    converter.begin("", None)
except KeyboardInterrupt:
    threading.Thread.start = begun
    {more}
"""
    words = [sys.executable, "-c", script]
    done = subprocess.run(words, capture_output=True, text=True, timeout=30, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout == ("AttributeError\n" if more else "")
