"""Pair files of the tests, and a case whose one mesh names a pair file."""

from pathlib import Path

PAIRS = Path(__file__).parents[3] / "cases/fgfbstts/pairs"

SPUR = """
kind = "helicoid"
title = "A spur pair"
torque = "100 N*m"

[driver]
module = "3 mm"
teeth = 25
pressure_angle = "20 deg"
face_width = "20 mm"

[driven]
teeth = 50
face_width = "20 mm"

[analysis]
compliance = "slices"
positions = 2
points = 8
"""

FACE = """
kind = "face-gear"
torque = "100 N*m"

[driver]
module = "4 mm"
teeth = 25
pressure_angle = "25 deg"
face_width = "20 mm"
tip_radius = 0.3

[driven]
teeth = 120
inner = "233 mm"
outer = "256 mm"

[driven.shaper]
teeth = 27

[analysis]
compliance = "slices"
positions = 2
points = 8
"""

CASE = """
[operating]
input = "a"
output = "b"
torque = "100 N*m"
positions = 2

[gears.a]
centre = ["0 mm", "0 mm"]
base_radius = "35.238 mm"

[gears.b]
centre = ["112.5 mm", "0 mm"]
base_radius = "70.476 mm"

[meshes."a-b"]
pressure_angle = "20 deg"
"""


def written(folder, text, name="pair.toml"):
    """Write a text to a file; return the file."""
    file = folder / name
    file.write_text(text, encoding="utf-8")
    return file
