"""Shafts and splines of a train, and the stages for which load sharing is computed."""

from __future__ import annotations

from dataclasses import dataclass

from loadshare.contact.radial import RadialLaw, spline_law


@dataclass(frozen=True, slots=True)
class Shaft:
    """A torsion shaft: ½ K (φ_a − φ_b − clocking)².

    Attributes
    ----------
    name, first, second : str
    stiffness : float
        K_T [N·m/rad]; infinite for a rigid shaft.
    clocking : float
        Angle by which the second end lags the first when unloaded [rad].
    """

    name: str
    first: str
    second: str
    stiffness: float
    clocking: float


@dataclass(frozen=True, slots=True)
class Spline:
    """A clearance spline that holds a gear (formulation, section 5).

    Attributes
    ----------
    gear : str
    bending_stiffness : float
        K_w [N/m].
    stick_limit : float or None
        S1 [m], or None for F_m/K_w.
    clearance : float
        S2 [m].
    friction_force : float or None
        F_m [N] where it is fixed (given, or τ F_N with F_N given).
    friction_per_torque : float
        τ/radius [1/m] where F_m follows the torque that the spline transmits to its gear.
    """

    gear: str
    bending_stiffness: float
    stick_limit: float | None
    clearance: float
    friction_force: float | None
    friction_per_torque: float

    @property
    def name(self) -> str:
        """Name of the element."""
        return f"spline {self.gear}"

    @property
    def stop_name(self) -> str:
        """Name of the stop at the end of its clearance, with memory an element of its own."""
        return f"{self.name} clearance"

    def bound(self, torque: float) -> float:
        """Return the friction bound F_m [N] when the spline transmits `torque` [N·m]."""
        if self.friction_force is not None:
            return self.friction_force
        return self.friction_per_torque * abs(torque)

    def law(self, torque: float) -> RadialLaw:
        """Return the radial law at `torque` [N·m].

        Raises
        ------
        ValueError
            If the force would drop somewhere at this torque; the message names the numbers.
        """
        bound = self.bound(torque)
        try:
            return spline_law(self.bending_stiffness, self.stick_limit, self.clearance, bound)
        except ValueError as error:
            raise ValueError(f"{self.name}: {error}") from error


@dataclass(frozen=True, slots=True)
class Stage:
    """A named stage: the meshes among which the load sharing is computed."""

    name: str
    meshes: tuple[str, ...]
    groups: tuple[tuple[str, ...], ...]
