"""Pages that several tests use."""

from __future__ import annotations

from collections import Counter
from html.parser import HTMLParser

EVIL = "</script><script>window.pwned=1</script><img src=x onerror=\"window.pwned=1\"> & 'ok'"
"""Text in a case file that must not be able to do any harm."""

EVIL_CASE = f"""
title = '''{EVIL}'''
source = '''{EVIL}'''
notes = '''{EVIL}'''
assumed = ["gears.*.base_radius", "meshes"]
[operating]
input = "<b>in</b>"
output = "<i>out</i>"
torque = "100 N*m"
[gears."<b>in</b>"]
centre = ["0 mm", "0 mm"]
base_radius = "40 mm"
support = "free"
[gears."<i>out</i>"]
centre = ["106.4178 mm", "0 mm"]
base_radius = "60 mm"
[rings."<b>in</b>"]
radius = "5 um"
[meshes."<script>"]
driver = "<b>in</b>"
driven = "<i>out</i>"
pressure_angle = "20 deg"
stiffness = "1e6 N*m/rad"
[stages."<svg onload=alert(1)>"]
meshes = ["<script>"]
"""


class Reader(HTMLParser):
    """Tags, attributes and words of a page."""

    def __init__(self, page: str) -> None:
        super().__init__(convert_charrefs=True)
        self.tags: Counter[str] = Counter()
        self.attributes: list[tuple[str, str, str | None]] = []
        self.words: list[str] = []
        self._inside: list[str] = []
        self.feed(page)

    def handle_starttag(self, tag, attrs):
        self.tags[tag] += 1
        self.attributes += [(tag, name, value) for name, value in attrs]
        self._inside.append(tag)

    def handle_endtag(self, tag):
        while self._inside and self._inside.pop() != tag:
            pass

    def handle_data(self, data):
        if not {"script", "style"} & set(self._inside):
            self.words.append(data)

    @property
    def text(self) -> str:
        return " ".join(" ".join(self.words).split())
