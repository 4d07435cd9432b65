"""The interface of the nonlinear laws of bearings, through which the rest of the model knows them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, NamedTuple, Protocol, Self

from dynamics.types import FloatArray


@dataclass(frozen=True)
class BearingDuty:
    """Expected duty of a bearing: its load, its mass and its size."""

    load: float
    """Typical load of the bearing, N."""
    mass: float
    """Share of the bearing in the mass on the shaft, kg."""
    lever: float
    """Radius by which tilts become lengths, where a law states no lever, m."""


class BearingLaw(Protocol):
    """A law of p rows at a bushing or planet bearing, in addition to its linear one."""

    @property
    def arrays(self) -> Any:
        """The packed arrays of its kind, which `ElementLaws` has a field of."""

    @property
    def bushing(self) -> str:
        """Name of the bushing at which the law acts."""

    @property
    def acts_at(self) -> str:
        """Key of the law's action: the bushing, for a law of one direction also the direction.

        No two laws of a kind share a key.
        """

    def rows(self, duty: BearingDuty) -> FloatArray:
        """Return the coordinates, m, per displacement x, y, z, tilt_x, tilt_y of the bearing, (p, 5)."""

    def array_entry(self, duty: BearingDuty) -> Any:
        """Return the law as `packed` of its arrays takes it."""

    def row_stiffness(self, duty: BearingDuty) -> FloatArray:
        """Return the stiffness of the rows at the typical load, (p,), N/m."""

    def tangent_error(self, duty: BearingDuty) -> float:
        """Return the displacement under the typical load, less that by the tangent, m."""


class PlausibleValue(NamedTuple):
    """A value of a law, to compare with the values of real bearings."""

    check: str
    """Name of the check in `dynamics.plausibility`."""
    field: str
    """Address of the value in a scene file: the law's table and its field, without the unit."""
    value: float
    unit: str
    skip_zero: bool = False
    """Whether 0 says that there is none."""


class SceneBearingLaw:
    """Defaults of a bearing law that is a part of the scene, for all but its force.

    A law replaces those that differ.
    """

    def scaled(self, factor: float) -> Self:
        """Return the law with all its elastic forces times `factor`."""
        raise NotImplementedError

    def after_growth(self, growth: float) -> Self:
        """Return the law where the shaft has grown by `growth` (m) along z at the bearing."""
        return self

    @property
    def holds_axially(self) -> bool:
        """Whether the law holds the shaft along z."""
        return False

    @property
    def fixed_direction(self) -> str | None:
        """The name of the field that gives the law a direction across the axis in the fixed frame.

        A shaft in a carrier's frame turns against such a law. None: it acts alike all around the axis.
        """
        return None

    def plausible_values(self) -> Iterable[PlausibleValue]:
        """Return the values to compare with those of real bearings."""
        return ()
