"""A library that writes files in their place, which the harness must find."""

from pathlib import Path

from loadshare import output


def _in_place(path: Path, content: bytes) -> None:
    output.make_folder(path.parent)
    path.write_bytes(content)


output._write = _in_place
