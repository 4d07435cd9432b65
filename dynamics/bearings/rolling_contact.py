"""A rolling bearing's radial force: clearance, Hertzian contact, damping; and its compiled law.

The press is the compression of the contact: the radial displacement beyond the clearance. The duty of a
bearing is the load and the share of its shaft's mass that are expected of it.
"""

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

ROLLER = 10.0 / 9.0
BALL = 1.5
"""`ROLLER`, `BALL`: Exponents of Hertzian line and point contact, from force over press."""
REACH_SHARE = 0.05
"""Elastic force from which damping acts in full, as a share of the typical load."""
MIN_PRESS = 1e-6
"""Press in m at the smallest typical load: the typical load of a bearing that nothing loads."""


class RollingContactLaws(NamedTuple):
    """The arrays of l rolling contacts, as the compiled law reads them."""

    stiffness: FloatArray
    exponent: FloatArray
    clearance: FloatArray
    """`stiffness`, `exponent`, `clearance`: Stiffness, N/m^exponent, exponent and clearance, m, of the
    contacts. Shape (l,) each.
    """
    damping: FloatArray
    reach: FloatArray
    """`damping`, `reach`: Damping in full contact, N s/m, and the elastic force from which it acts in full,
    N. Shape (l,) each.
    """

    @classmethod
    def packed(cls, laws: Sequence[tuple[RollingContact, BearingDuty]]) -> RollingContactLaws:
        """Return the arrays of rolling contacts, each given with the duty of its bearing."""
        contacts = [contact for contact, _ in laws]
        return cls(
            stiffness=np.array([contact.stiffness for contact in contacts], dtype=float),
            exponent=np.array([contact.exponent for contact in contacts], dtype=float),
            clearance=np.array([contact.clearance for contact in contacts], dtype=float),
            damping=np.array([contact._full_damping(duty) for contact, duty in laws], dtype=float),
            reach=np.array(
                [REACH_SHARE * contact.typical_load(duty.load) for contact, duty in laws], dtype=float
            ),
        )


@dataclass(frozen=True)
class RollingContact(SceneBearingLaw):
    """The radial force of a rolling bearing, in addition to the linear one of its bushing or planet bearing.

    The shaft moves across its axis by the vector u of length r; a planet moves so relative to its pin. Beyond
    the clearance the restoring force along u is ``stiffness (r - clearance)^exponent``, the same in all
    directions. Within the clearance it is zero.
    """

    bushing: str
    """Name of the bushing or planet bearing at which it acts; a bearing has at most one rolling contact."""
    stiffness: float
    """Stiffness of the whole bearing, N/m^exponent."""
    exponent: float = ROLLER
    """10/9 for rollers (the default), 3/2 for balls; from 1 to 3."""
    clearance: float = 0.0
    """Radial displacement from the middle to contact, m, >= 0: half the play between both extremes."""
    damping: float | None = None
    """Damping along u in full contact, N s/m. It fades to zero at lift-off, and the total force is never
    tensile. None: ``2 damping_ratio sqrt(k mass)`` with k the tangent stiffness at the typical load, and mass
    that of the shaft and its gears divided by the number of its bushings.
    """
    damping_ratio: float = 0.05
    """Damping ratio from which the damping follows where that is None."""

    arrays: ClassVar[type[RollingContactLaws]] = RollingContactLaws
    """Record that the contacts of a scene are packed into."""

    def __post_init__(self) -> None:
        positive("stiffness", self.stiffness)
        within("exponent", self.exponent, 1.0, 3.0, "10/9 for rollers, 3/2 for balls.")
        suggestion = "For interference give the tangent stiffness as that of the bushing."
        not_negative("clearance", self.clearance, suggestion)
        not_negative("damping_ratio", self.damping_ratio)
        if self.damping is not None:
            not_negative("damping", self.damping)

    @property
    def acts_at(self) -> str:
        """The name of the bearing, which has no other rolling contact."""
        return self.bushing

    def displacement(self, force: float) -> float:
        """Return the displacement of the shaft by a static radial `force` (N, > 0), with the clearance, m."""
        return self.clearance + self._press(force)

    def tangent(self, force: float) -> float:
        """Return the derivative of the force over the displacement at a static `force` (N, > 0), N/m."""
        return self.exponent * force / self._press(force)

    def _press(self, force: float) -> float:
        return float((force / self.stiffness) ** (1.0 / self.exponent))

    def _full_damping(self, duty: BearingDuty) -> float:
        if self.damping is not None:
            return self.damping
        stiffness = self.tangent(self.typical_load(duty.load))
        return 2.0 * self.damping_ratio * math.sqrt(stiffness * duty.mass)

    def typical_load(self, load: float) -> float:
        """Return `load` (N), or the force at a press of `MIN_PRESS` if that is larger."""
        return float(max(load, self.stiffness * MIN_PRESS**self.exponent))

    def rows(self, duty: BearingDuty) -> FloatArray:
        """Return the coordinates x and y per displacement x, y, z, tilt_x, tilt_y of the bearing, (2, 5)."""
        return np.eye(2, 5)

    def array_entry(self, duty: BearingDuty) -> tuple[RollingContact, BearingDuty]:
        """Return the arguments of `RollingContactLaws.packed`: the contact and the duty of its bearing."""
        return self, duty

    def row_stiffness(self, duty: BearingDuty) -> FloatArray:
        """Return the tangent stiffness along x and y at the typical load, (2,), N/m."""
        return np.full(2, self.tangent(self.typical_load(duty.load)))

    def tangent_error(self, duty: BearingDuty) -> float:
        """Return the displacement under the typical load less that of its tangent stiffness, m."""
        load = self.typical_load(duty.load)
        return self.displacement(load) - load / self.tangent(load)

    def scaled(self, factor: float) -> RollingContact:
        """Return the contact with `factor` times its stiffness."""
        return replace(self, stiffness=factor * self.stiffness)

    def plausible_values(self) -> tuple[PlausibleValue, ...]:
        """Return the clearance, where there is one, and the damping ratio."""
        clearance = PlausibleValue(
            "clearance", "rolling_contact.radial_clearance", self.clearance, "m", skip_zero=True
        )
        ratio = PlausibleValue("damping_ratio", "rolling_contact.damping_ratio", self.damping_ratio, "1")
        return clearance, ratio


@routine
def rolling_contact(laws: RollingContactLaws, entry: int, local: LocalState, row: int) -> None:
    """Write forces and derivatives of a contact into its two rows, the first of which is `row`.

    u = (x, y) is the displacement, r its length, e = u/r, w = e u' the rate of r, K(r) the elastic force, c
    the damping and s(k) = k^2 (3 - 2 k) its rise from 0 at lift-off to 1 at K = reach. The force is F e with
    F = max(0, K(r) + c s(K/reach) w). With the partial derivatives F_r and F_w and the unit matrix I,

        df/du = F_r e e^T + F/r (I - e e^T) + F_w e (u' - w e)^T/r,    df/du' = F_w e e^T.
    """
    coordinate, rate, force, elastic = local.coordinate, local.rate, local.force, local.elastic
    tangent, viscous = local.tangent, local.viscous
    x, y = coordinate[row], coordinate[row + 1]
    distance = math.sqrt(x * x + y * y)
    press = distance - laws.clearance[entry]
    for k in range(2):
        force[row + k] = 0.0
        elastic[row + k] = 0.0
        for j in range(2):
            tangent[row + k, j] = 0.0
            viscous[row + k, j] = 0.0
    if press <= 0.0:
        return
    exponent = laws.exponent[entry]
    spring = laws.stiffness[entry] * press**exponent
    slope = exponent * spring / press
    ratio = min(spring / laws.reach[entry], 1.0)
    fade = laws.damping[entry] * ratio * ratio * (3.0 - 2.0 * ratio)  # F_w
    fade_slope = laws.damping[entry] * 6.0 * ratio * (1.0 - ratio) / laws.reach[entry] * slope
    e = (x / distance, y / distance)
    velocity = (rate[row], rate[row + 1])
    radial_rate = e[0] * velocity[0] + e[1] * velocity[1]
    total = spring + fade * radial_rate
    for k in range(2):
        elastic[row + k] = spring * e[k]
    if total <= 0.0:  # damping would pull: no force, though the contact is still pressed
        return
    radial = slope + fade_slope * radial_rate  # F_r
    across = total / distance
    for k in range(2):
        force[row + k] = total * e[k]
        for j in range(2):
            from_rate = fade * e[k] * (velocity[j] - radial_rate * e[j]) / distance
            diagonal = across if k == j else 0.0
            tangent[row + k, j] = (radial - across) * e[k] * e[j] + diagonal + from_rate
            viscous[row + k, j] = fade * e[k] * e[j]


@routine
def rolling_contact_energy(laws: RollingContactLaws, entry: int, local: LocalState, row: int) -> float:
    """Return the elastic energy of a contact, J; its displacements x and y are in `row` and the next row."""
    x, y = local.coordinate[row], local.coordinate[row + 1]
    press = math.sqrt(x * x + y * y) - laws.clearance[entry]
    if press <= 0.0:
        return 0.0
    higher = laws.exponent[entry] + 1.0
    return float(laws.stiffness[entry] * press**higher / higher)
