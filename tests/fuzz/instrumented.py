"""All modules that read and answer a case, imported with line counters."""

import atheris

CODE = ("case", "cli", "job", "report", "results", "scene", "study", "train")
"""Folders whose lines count; those with code that Numba compiles cannot have counters."""

with atheris.instrument_imports(include=[f"loadshare.{name}" for name in CODE]):
    import loadshare.cli.draw
    import loadshare.cli.run
    import loadshare.cli.study
    import loadshare.results.files
    import loadshare.study.compare
    import loadshare.study.critical
    import loadshare.study.fit
    import loadshare.study.march
    import loadshare.study.sensitivity
    import loadshare.study.sweep
    import loadshare.study.tolerance  # noqa: F401
