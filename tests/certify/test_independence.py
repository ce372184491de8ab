"""The certificate is independent: it imports no solver, no programme and no back-end (formulation,
section 8).
"""

import subprocess
import sys

import pytest

FORBIDDEN = (
    "loadshare.solver",
    "loadshare.scene",
    "loadshare.contact.programme",
    "clarabel",
    "osqp",
    "cvxpy",
    "scipy.optimize",
)


def modules_after(code: str) -> set[str]:
    script = f"import sys\n{code}\nprint(*sys.modules)"
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True, timeout=120
    )
    return set(done.stdout.split())


def test_the_certificate_imports_no_solver():
    loaded = modules_after("import loadshare.certify")
    assert "loadshare.certify.certificate" in loaded
    assert not [m for m in loaded if m.startswith(FORBIDDEN)]


@pytest.mark.parametrize(
    ("solver", "absent"), [("clarabel", ("cvxpy", "osqp")), ("osqp", ("cvxpy", "clarabel"))]
)
def test_a_back_end_is_imported_only_on_request(solver, absent):
    loaded = modules_after(
        f"from loadshare.contact.backends.backend import backend\nbackend({solver!r})"
    )
    assert not [m for m in loaded if m.split(".")[0] in absent]
