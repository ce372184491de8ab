"""The certificate: whether an answer is an equilibrium, recomputed from the physics and the answer alone."""

from loadshare.certify.certificate import Certificate, Residual, certify
from loadshare.certify.floats import FloatState, Touch

__all__ = ["Certificate", "FloatState", "Residual", "Touch", "certify"]
