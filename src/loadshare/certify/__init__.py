"""The certificate: is an answer an equilibrium? Recomputed from physics and the answer alone."""

from loadshare.certify.certificate import Certificate, certified, certify
from loadshare.certify.claims import Claims
from loadshare.certify.floats import FloatState, Touch
from loadshare.certify.judge import Judge
from loadshare.certify.residuals import RESIDUALS, Residual
from loadshare.certify.verdicts import Verdicts

__all__ = [
    "RESIDUALS",
    "Certificate",
    "Claims",
    "FloatState",
    "Judge",
    "Residual",
    "Touch",
    "Verdicts",
    "certified",
    "certify",
]
