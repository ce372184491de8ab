"""The page: all chapters as one Markdown file; the same figures give the same text."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from importlib.metadata import version

from benchmarks.reproduction.chapter import Chapter
from benchmarks.reproduction.entry import table
from loadshare._version import __version__

PICTURES = "reproduction"
"""Folder of the pictures, next to the page."""
PACKAGES = ("numpy", "scipy", "clarabel", "altair", "vl-convert-python")
VERSIONS = "Computed with"
"""Start of the one line that may differ between computers."""


def page(chapters: Sequence[Chapter], used: Mapping[str, str]) -> str:
    """Return the page.

    Parameters
    ----------
    chapters : sequence of Chapter
    used : mapping of path to str
        Hash of the physical content of every file that was read.
    """
    packages = ", ".join(f"{name} {version(name)}" for name in PACKAGES)
    blocks = [
        "# The seed paper, reproduced",
        "<!-- Written by `make reproduce`; do not edit. -->",
        *_INTRODUCTION,
        table(
            ("figure", "result", "status"),
            [(_link(c.title), c.verdict, c.standing) for c in chapters],
        ),
    ]
    for chapter in chapters:
        blocks.append(f"## {chapter.title}")
        blocks += [_picture(b) if b.startswith("{") else b for b in chapter.blocks]
    blocks += [
        "## How this page was made",
        "`make reproduce` solves the cases, makes the fits, and writes this page and its pictures. "
        "Every position is certified, and every number on the page is computed in that run; the "
        "same case files give the same page.",
        table(
            ("file", "SHA-256 of its physical content"),
            [(f"`cases/{path}`", f"`{digest[:16]}…`") for path, digest in used.items()],
        ),
        f"{VERSIONS} loadshare {__version__}; {packages}.",
    ]
    return "\n\n".join(blocks) + "\n"


_INTRODUCTION = (
    "The paper on the face-gear four-branch split-torque transmission prints results in Figs. 7 "
    "to 14 and 18 and Table 2, but few of its inputs. This page compares every printed figure "
    "with the computed one and explains the differences.",
    "**Status.** *Fitted*: an input that the paper does not print was chosen so that this "
    "figure agrees, so it does not test the model. *Predicted*: nothing was chosen for it. Two "
    "things are fitted: the directions of the eccentricities, to Fig. 10, and the geometry in "
    "all case files, to Figs. 13 and 14. The tooth data of Fig. 7 are chosen; they only affect "
    "the pictures over the mesh cycle.",
    "**Assumed throughout**, as the paper does not print it: radii, centres, pressure angles, "
    "shaft stiffness, the direction of the installation errors, and what each case file lists "
    "as `assumed` (see [validation](validation.md#the-seed-paper)). Mesh stiffness is the "
    "middle of the printed ranges. Ω of stage II is taken within each pinion's pair, as in the "
    "paper. A difference in % is relative to the printed figure.",
)


def _link(title: str) -> str:
    """Return a figure's name, linked to its chapter by the anchor that Markdown makes."""
    short = title.split(":")[0]
    kept = "".join(c for c in title.lower() if c.isalnum() or c in " -")
    return f"[{short}](#{'-'.join(kept.split())})"


def _picture(block: str) -> str:
    name = block.strip("{}")
    return f"![{_ALTERNATIVES[name]}]({PICTURES}/{name}.svg)"


_ALTERNATIVES = {
    "stiffness": "Mesh stiffness over the mesh cycle, three pairs, three loads",
    "installation": "Load sharing against the installation error of one gear",
    "eccentricity": "Load sharing over a revolution of one eccentric gear",
    "both_errors": "Torque of the meshes at five positions with both errors",
    "full_float": "Torque of the meshes at five positions in full float",
    "clearance": "Load sharing against the clearance of the splines",
    "rings": "Load sharing against the clearance of the limit rings",
    "points": "Paths of the balance points of both pinions",
    "load": "Load sharing against the input torque",
}
