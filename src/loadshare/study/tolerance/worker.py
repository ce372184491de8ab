"""A worker process of `loadshare.study.tolerance.local`: solves the parts that it is told."""

from __future__ import annotations

import json
import os
import signal
import sys

from loadshare.study.tolerance.job import Part
from loadshare.study.tolerance.local import folder_of


def main() -> None:
    """Read parts from standard input, one a line, and answer each with a line."""
    # The study tells its workers when to end; an interrupt from the keyboard is its affair.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    # What libraries print goes to stderr: standard output is for answers.
    answers = os.dup(1)
    os.dup2(2, 1)
    folder = folder_of(sys.stdin.readline())
    for line in sys.stdin:
        design, number, rows = line.split()
        part = Part(design, int(number), int(rows))
        try:
            folder.write(part, folder.job.table(part))
            reply = {"done": str(part.number)}
        except Exception as error:  # noqa: BLE001 -- told by the study
            reply = {"error": f"{type(error).__name__}: {error}"}
        try:
            os.write(answers, (json.dumps(reply) + "\n").encode())
        except BrokenPipeError:
            # The study is gone; the part stands in its place for the next one.
            return


if __name__ == "__main__":
    main()
