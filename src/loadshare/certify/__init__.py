"""The certificate: is an answer an equilibrium? Recomputed from physics and the answer alone."""

from loadshare.certify.certificate import Certificate, Residual, certify
from loadshare.certify.floats import FloatState, Touch
from loadshare.certify.judge import Judge
from loadshare.certify.residuals import RESIDUALS
from loadshare.certify.verdicts import Verdicts

__all__ = [
    "RESIDUALS",
    "Certificate",
    "FloatState",
    "Judge",
    "Residual",
    "Touch",
    "Verdicts",
    "certify",
]
