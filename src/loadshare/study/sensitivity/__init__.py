r"""Sensitivities: how torques, shares and floats change with any input of a case.

The equilibrium equations of the active set are differentiated implicitly: with r(z, u) = 0,

.. math:: \frac{dz}{du} = -\left(\frac{\partial r}{\partial z}\right)^{-1}
    \frac{\partial r}{\partial u}

The Jacobian is factorised once for all inputs; away from a verge no equilibrium is solved again.
"""

from loadshare.study.sensitivity.result import SIDES, Input, Kink, Rates, Remark, Sensitivity
from loadshare.study.sensitivity.study import sensitivity

__all__ = ["SIDES", "Input", "Kink", "Rates", "Remark", "Sensitivity", "sensitivity"]
