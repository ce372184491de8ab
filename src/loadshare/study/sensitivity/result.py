"""The result of a sensitivity study."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar, Literal

from loadshare.array_types import Array
from loadshare.equality import Comparable
from loadshare.libraries import pd, xr
from loadshare.pictures import Figure, picture
from loadshare.results.dataset import unchanging, with_units
from loadshare.study.parameter import Value
from loadshare.study.tables import sensitivity_dataset
from loadshare.view import View, Viewed

SIDES = ("falling", "rising")


@dataclass(frozen=True, slots=True)
class Input:
    """An input that is varied.

    Attributes
    ----------
    key : str
        Dotted key path.
    value : Value
        As the case gives it.
    """

    key: str
    value: Value


@dataclass(frozen=True, slots=True)
class Kink:
    """An equilibrium on the verge of another active set: each derivative holds on one side only.

    Attributes
    ----------
    position : int
    elements : tuple of str
        Elements that have neither gap nor force or are at a corner of their law, and contacts that
        catch a free body as soon as an input loads it.
    """

    position: int
    elements: tuple[str, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Rates(Comparable):
    """Derivatives of one position with respect to one input, on one side, per SI unit.

    Attributes
    ----------
    torque, share, pair_share : mapping of mesh to float
        [N·m], [-]; NaN if there is no derivative on that side, or a group carries nothing.
    displacement : mapping of gear to ndarray, shape (2,)
        [m], in the gear's transverse frame; NaN where the equilibrium leaves it undetermined.
    error : Rates or None
        Stated errors of all these, ≥ 0; None for errors themselves.
    """

    torque: dict[str, float]
    share: dict[str, float]
    pair_share: dict[str, float]
    displacement: dict[str, Array]
    error: Rates | None = None


@dataclass(frozen=True, slots=True)
class Remark:
    """A note on one derivative: why it does not exist, or what it leaves out.

    Attributes
    ----------
    key : str
    position : int
    side : str
        "falling" or "rising".
    message : str
    """

    key: str
    position: int
    side: str
    message: str


@dataclass(frozen=True, eq=False, repr=False)
class Sensitivity(Viewed):
    """Derivatives of the certified equilibria of a case.

    Attributes
    ----------
    inputs : tuple of Input
    positions : tuple of int
    rates : mapping of (position, key, side) to Rates
        Side is "falling" or "rising"; the two agree where there is no kink.
    omega, pair_omega : mapping of (key, side) to mapping of stage to float
        Derivative of the largest Ω of each stage and of the system.
    omega_error, pair_omega_error : mapping of (key, side) to mapping of stage to float
        Their stated errors.
    kinks : tuple of Kink
    error : mapping of key to float
        Largest stated error of a torque's derivative [N·m per SI unit]; that of each derivative is
        in `Rates.error`.
    remarks : tuple of Remark
        Which derivatives do not exist or leave something out, and why.
    skipped : tuple of (str, str)
        Inputs that cannot be varied on their own, and why.
    sides : tuple of str
        "falling" and "rising".
    """

    sides: ClassVar[tuple[str, ...]] = SIDES
    inputs: tuple[Input, ...]
    positions: tuple[int, ...]
    rates: dict[tuple[int, str, str], Rates]
    omega: dict[tuple[str, str], dict[str, float]]
    pair_omega: dict[tuple[str, str], dict[str, float]]
    omega_error: dict[tuple[str, str], dict[str, float]]
    pair_omega_error: dict[tuple[str, str], dict[str, float]]
    kinks: tuple[Kink, ...]
    error: dict[str, float]
    remarks: tuple[Remark, ...]
    skipped: tuple[tuple[str, str], ...]

    @cached_property
    def dataset(self) -> xr.Dataset:
        """The derivatives as labelled arrays, per SI unit of the input."""
        return unchanging(sensitivity_dataset(self))

    def to_dataframe(self) -> pd.DataFrame:
        """Return derivatives of torques and shares with their errors, per SI unit of the input.

        One row per position, input, side and mesh; ``attrs["units"]`` has the units.
        """
        names = [n + e for n in ("torque", "share", "pair_share") for e in ("", "_error")]
        # An input's value, unit and factor belong to the arrays; "error" is that of all torques.
        arrays = self.dataset[names].reset_coords(
            ["value", "unit", "factor", "error", "kink"], drop=True
        )
        return with_units(arrays.to_dataframe().reset_index(), self.dataset)

    def to_xarray(self) -> xr.Dataset:
        """Return the labelled arrays, `dataset`."""
        return self.dataset

    def plot(self, stage: str = "system", over: Literal["stage", "group"] = "stage") -> Figure:
        """Plot the inputs that change Ω most, each derivative times the input's whole value.

        Parameters
        ----------
        stage : str
        over : {"stage", "group"}
            Whose mean torque divides the torques in Ω.
        """
        return picture(self, stage, over)

    def _view(self) -> View:
        """Show the inputs that change Ω of the system most, and what each derivative leaves out."""
        from loadshare.study.sensitivity.view import sensitivity_view

        return sensitivity_view(self)
