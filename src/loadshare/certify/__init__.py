"""The certificate: is an answer an equilibrium? Recomputed from physics and the answer alone."""

from loadshare.certify.certificate import Certificate, Residual, certify
from loadshare.certify.floats import FloatState, Touch

__all__ = ["Certificate", "FloatState", "Residual", "Touch", "certify"]
