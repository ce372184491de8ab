"""The command, but with small studies solved like large ones: part by part in other processes.

``python -m tests.kills.launch batch ...`` is ``loadshare batch ...``.
"""

from __future__ import annotations

from loadshare.cli.main import main
from loadshare.study.tolerance import study
from loadshare.study.tolerance.study import tolerance


def _small() -> None:
    study.TOLERANCE = study.TOLERANCE._replace(small=0)
    tolerance.__kwdefaults__.update(chunk=1, engine="vectorised")


if __name__ == "__main__":
    _small()
    main()
