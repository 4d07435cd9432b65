"""A rolling bearing's radial force: clearance, Hertzian contact, damping; and its compiled law."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import ClassVar, NamedTuple

import numpy as np

from dynamics.bearings.bearing_law import BearingDuty, PlausibleValue, SceneBearingLaw
from dynamics.checks import not_negative, positive, within
from dynamics.kernels.local_state import LocalState
from dynamics.kernels.routine import routine
from dynamics.types import FloatArray

ROLLER, BALL = 10.0 / 9.0, 1.5
REACH_SHARE = 0.05  # of the typical load: where damping acts in full
MIN_PRESS = 1e-6  # m; sets the typical load of a bearing that nothing loads


class RollingContactLaws(NamedTuple):
    """Laws of l contacts."""

    stiffness: FloatArray
    exponent: FloatArray
    clearance: FloatArray
    """`stiffness`, `exponent`, `clearance`: N/m^n, 1, m. Shape (l,) each."""
    damping: FloatArray
    reach: FloatArray
    """`damping`, `reach`: N s/m in full contact, and the elastic force (N) from which it acts in full. Shape
    (l,) each.
    """

    @classmethod
    def packed(cls, laws: Sequence[tuple[RollingContact, BearingDuty]]) -> RollingContactLaws:
        """Lay out laws, each with the duty of its bearing."""
        parts = [part for part, _ in laws]
        typical = [part.typical_load(duty.load) for part, duty in laws]
        damping = [
            2.0 * part.damping_ratio * math.sqrt(part.tangent(load) * duty.mass)
            if part.damping is None
            else part.damping
            for (part, duty), load in zip(laws, typical, strict=True)
        ]
        fields = ([getattr(part, name) for part in parts] for name in ("stiffness", "exponent", "clearance"))
        reach = [REACH_SHARE * load for load in typical]
        return cls(*(np.array(values, dtype=float) for values in (*fields, damping, reach)))


@dataclass(frozen=True)
class RollingContact(SceneBearingLaw):
    """The radial force of a rolling bearing, in addition to the linear one of its bushing or planet bearing.

    The shaft moves across the axis by u, r = `abs(u)`; a planet relative to its pin. Beyond the clearance the
    restoring force along u is ``stiffness (r - clearance)^exponent``, in all directions; within it, zero.
    """

    bushing: str
    """The bushing or planet bearing at which it acts; one rolling contact each."""
    stiffness: float
    """Of the whole bearing, N/m^exponent."""
    exponent: float = ROLLER
    """10/9 for rollers (the default), 3/2 for balls; from 1 to 3."""
    clearance: float = 0.0
    """m, >= 0: radial, from the middle to contact; half the play between the extremes."""
    damping: float | None = None
    """N s/m along u in full contact; fades to zero at lift-off, and the total force is never tensile. None:
    ``2 damping_ratio sqrt(k mass)`` with k the tangent stiffness at the typical load and the mass of the
    shaft and its gears divided by the number of its bushings.
    """
    damping_ratio: float = 0.05
    """Used where the damping is None."""

    def __post_init__(self) -> None:
        positive("stiffness", self.stiffness)
        within("exponent", self.exponent, 1.0, 3.0, "10/9 for rollers, 3/2 for balls.")
        suggestion = "For interference give the tangent stiffness as that of the bushing."
        not_negative("clearance", self.clearance, suggestion)
        not_negative("damping_ratio", self.damping_ratio)
        if self.damping is not None:
            not_negative("damping", self.damping)

    arrays: ClassVar[type[RollingContactLaws]] = RollingContactLaws

    @property
    def acts_at(self) -> str:
        """The bearing."""
        return self.bushing

    def displacement(self, force: float) -> float:
        """Return how far the shaft moves along a static `force` (N, > 0), m."""
        return self.clearance + float((force / self.stiffness) ** (1.0 / self.exponent))

    def tangent(self, force: float) -> float:
        """Return the stiffness along a static `force` (N, > 0), N/m."""
        press = float((force / self.stiffness) ** (1.0 / self.exponent))
        return self.exponent * force / press

    def typical_load(self, load: float) -> float:
        """Return `load` (N), or the force at one micrometer of compression if that is larger."""
        return float(max(load, self.stiffness * MIN_PRESS**self.exponent))

    def rows(self, duty: BearingDuty) -> FloatArray:
        """Return the displacements x and y, (2, 5)."""
        return np.eye(2, 5)

    def laid_out(self, duty: BearingDuty) -> tuple[RollingContact, BearingDuty]:
        """Return what its arrays take."""
        return self, duty

    def typical(self, duty: BearingDuty) -> FloatArray:
        """Return the stiffness of the rows at the typical load, (2,), N/m."""
        return np.full(2, self.tangent(self.typical_load(duty.load)))

    def tangent_error(self, duty: BearingDuty) -> float:
        """Return what its tangent misses of the displacement under the typical load, m."""
        load = self.typical_load(duty.load)
        return self.displacement(load) - load / self.tangent(load)

    def scaled(self, factor: float) -> RollingContact:
        """Return the contact with `factor` times its stiffness."""
        return replace(self, stiffness=factor * self.stiffness)

    def plausible_values(self) -> tuple[PlausibleValue, ...]:
        """Return its clearance, where it has one, and its damping ratio."""
        clearance, ratio = "rolling_contact.radial_clearance", "rolling_contact.damping_ratio"
        return (
            PlausibleValue("clearance", clearance, self.clearance, "m", skip_zero=True),
            PlausibleValue("damping_ratio", ratio, self.damping_ratio, "1"),
        )


@routine
def rolling_contact(laws: RollingContactLaws, entry: int, local: LocalState, row: int) -> None:
    """Write forces and derivatives of a contact into its two rows, the first of which is `row`.

    With e = u/r and w = e u': F = max(0, K(r) + c s(K/reach) w), s as for flanks, force F e, and

        df/du = F_r e e^T + F/r (1 - e e^T) + F_w e (u' - w e)^T/r,    df/du' = F_w e e^T.
    """
    coordinate, rate, force, elastic = local.coordinate, local.rate, local.force, local.elastic
    tangent, viscous = local.tangent, local.viscous
    x, y = coordinate[row], coordinate[row + 1]
    distance = math.sqrt(x * x + y * y)
    press = distance - laws.clearance[entry]
    for k in range(2):
        force[row + k], elastic[row + k] = 0.0, 0.0
        for j in range(2):
            tangent[row + k, j], viscous[row + k, j] = 0.0, 0.0
    if press <= 0.0:
        return
    exponent = laws.exponent[entry]
    spring = laws.stiffness[entry] * press**exponent
    slope = exponent * spring / press
    ratio = min(spring / laws.reach[entry], 1.0)
    fade = laws.damping[entry] * ratio * ratio * (3.0 - 2.0 * ratio)
    fade_slope = laws.damping[entry] * 6.0 * ratio * (1.0 - ratio) / laws.reach[entry] * slope
    e = (x / distance, y / distance)
    moving = (rate[row], rate[row + 1])
    along = e[0] * moving[0] + e[1] * moving[1]
    total = spring + fade * along
    for k in range(2):
        elastic[row + k] = spring * e[k]
    if total <= 0.0:
        return
    radial, across = slope + fade_slope * along, total / distance
    for k in range(2):
        force[row + k] = total * e[k]
        for j in range(2):
            turned = fade * e[k] * (moving[j] - along * e[j]) / distance
            straight = across if k == j else 0.0
            tangent[row + k, j] = (radial - across) * e[k] * e[j] + straight + turned
            viscous[row + k, j] = fade * e[k] * e[j]


@routine
def rolling_contact_energy(laws: RollingContactLaws, entry: int, local: LocalState, row: int) -> float:
    """Return the energy stored at the displacement in `row` and the next, J."""
    x, y = local.coordinate[row], local.coordinate[row + 1]
    press = math.sqrt(x * x + y * y) - laws.clearance[entry]
    if press <= 0.0:
        return 0.0
    higher = laws.exponent[entry] + 1.0
    return float(laws.stiffness[entry] * press**higher / higher)
