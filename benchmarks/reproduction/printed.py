"""The values that the seed paper prints: Figs. 7 to 14 and 18, Table 2 and the text about them.

Nothing here is computed or assumed. The paper does not print the figures' curves, Table 2 itself or
the directions of the errors.
"""

from __future__ import annotations

TORQUE = 2175.2
"""Input torque of 2000 kW at 8780 r/min [N·m]."""
ERROR = 50.0
"""Eccentricity and installation error [µm]."""

STIFFNESS = {"1-2": (7.46e5, 9.27e5), "4-6": (3.77e6, 4.78e6), "6-10": (6.17e6, 6.68e6)}
"""Fig. 7: range over the cycle, for all meshes with the same teeth [N·m/rad]."""

OMEGA_INSTALLATION = {"I": 1.0049, "II": 1.1602}
"""Fig. 8: largest Ω for an installation error of 50 µm."""
OMEGA_ECCENTRICITY = {"I": 1.0121, "II": 1.1144}
"""Fig. 9: the same for an eccentricity."""

TORQUES = {"1-2": 1107.7, "1-3": 1068.5}
"""Fig. 10 (a) [N·m]."""
TORQUES_II = {"6-10": 7064.4, "7-10": 8079.1, "8-10": 7321.8, "9-10": 7821.6}
"""Fig. 10 (b) [N·m]."""
SHARE_I = {"1-2": 1.019, "1-3": 0.983}
SHARES_II = {"6-10": 0.933, "7-10": 1.067, "8-10": 0.967, "9-10": 1.033}
"""Fig. 10, within each pinion's pair."""

CLEARANCE = 400.0
"""Fig. 11: clearance of the splines [µm]."""
FLOATS = {"4": 356.0, "5": 238.0}
"""Fig. 11: floats [µm]."""
FLOATING_SHARE_I = {"1-2": 1.014, "1-3": 0.986}
FLOATING_SHARES_II = {"6-10": 0.984, "7-10": 1.016, "8-10": 0.993, "9-10": 1.007}
HALF_FREE, HALF_FREE_PINIONS = 300.0, ("5",)
"""Fig. 12: clearance [µm] at which only these pinions float fully."""
BENDING = 1.78e7
"""Bending stiffness K_w of a spline shaft [N/m]."""
FRICTION = 0.1

RIGID_RINGS = {"4": 1.047, "5": 1.019}
"""Fig. 13: largest Ω of each pinion's pair, ring clearance 0 (7-10 and 8-10)."""
FREE_RINGS = {"4": 1.004, "5": 1.003}
"""Fig. 13: the same with a large clearance."""
THRESHOLDS = {"4": 8.36, "5": 2.91}
"""Fig. 13: ring clearance from which a pinion floats fully [µm]."""
POINTS = {"4": (4.14, 7.13), "5": (1.37, -2.37)}
"""Fig. 14: balance points [µm]."""

RATED = 1100.0
"""Table 2: T_in [N·m]."""
LOADS = (0.2, 1.6)
"""Table 2: lowest and highest load over T_in."""
LIGHT = 283.0
"""Fig. 18: the only load for which coefficients are printed [N·m]."""
LIGHT_THEORY, LIGHT_TEST = 1.078, 1.139
"""Fig. 18: coefficients at that load."""
