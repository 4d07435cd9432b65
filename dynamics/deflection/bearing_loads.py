"""Loads of bearings under load cases, and their basic reference rating life over all of them.

The rating life of one load case is that of ISO/TS 16281; load cases add up as in ISO 281.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from dynamics.assembly.assemble import System
from dynamics.bearings import PlanetBearing, RollingBearing
from dynamics.bearings.rating_life import rating_life
from dynamics.bearings.row_law import row_law
from dynamics.deflection.bearing_strain import BearingStrain
from dynamics.deflection.rest_positions import Rest
from dynamics.mechanism.bearing_elements import supports_by_name
from dynamics.types import FloatArray
from model_studies import in_unit

LIFE_EXPONENT = 10.0 / 3.0
"""Exponent of load in the life of roller bearings, ISO 281; ball bearings have 3."""


def bearing_life(bearing: RollingBearing, displacement: FloatArray) -> float:
    """Return L_10r of a row in revolutions; NaN without a capacity, infinite where no element is loaded.

    The inner ring turns against a load that stands still. Loads of the elements are averaged over their
    passing. `displacement` (5,): of the inner ring against the outer, x, y, z, tilt_x, tilt_y, m and rad,
    without the shift along the axis that makes the preload.
    """
    if bearing.dynamic_capacity is None:
        return math.nan
    law = row_law(bearing)
    shifted = np.array(displacement, dtype=float)
    shifted[2] += law.shift
    return rating_life(bearing.row, law.loaded.evaluate(shifted).load, bearing.dynamic_capacity).revolutions


def life_duration(revolutions: Sequence[float], speed: Sequence[float], share: Sequence[float]) -> float:
    """Return the life under C load cases by linear damage, s: 1 / sum (q n / L).

    Parameters
    ----------
    revolutions : (C,) sequence
        Life L under each case alone; may be infinite, NaN if not known.
    speed : (C,) sequence
        Speeds under the load cases, rad/s, >= 0.
    share : (C,) sequence
        Shares q of the duration, in any unit, not all 0.
    """
    part = np.asarray(share, dtype=float) / float(np.sum(share))
    turned = part * np.asarray(speed, dtype=float) / (2.0 * math.pi)  # revolutions per s
    damage = float(np.sum(turned / np.asarray(revolutions, dtype=float)))
    return math.inf if damage == 0.0 else 1.0 / damage


@dataclass(frozen=True)
class BearingLoad:
    """The load of a bearing under a load case, mean over the mesh cycle; x, y, z, tilt_x, tilt_y."""

    name: str
    shaft: str
    speed: float = field(metadata=in_unit("rad_s"))
    """Speed of the shaft relative to the part that holds the bearing, rad/s, >= 0."""
    force: FloatArray = field(metadata=in_unit("n", "direction"))
    """Force and moment on the housing, or of a planet bearing on its pin, N and N m. Shape (5,)."""
    largest_radial: float = field(metadata=in_unit("n"))
    """Largest radial force over the mesh cycle, N."""
    elastic: FloatArray = field(metadata=in_unit("m", "direction"))
    clearance: FloatArray = field(metadata=in_unit("m", "direction"))
    seat: FloatArray = field(metadata=in_unit("m", "direction"))
    """`elastic`, `clearance`, `seat`: Parts of the displacement of the shaft there, m and rad. Shape (5,)
    each.
    """
    rating_life: float = math.nan
    """Basic reference rating life L_10r at the mean displacement, revolutions; infinite where no element is
    loaded, NaN if the bearing has no dynamic capacity.
    """

    @property
    def radial(self) -> float:
        """Radial force, N."""
        return float(np.hypot(self.force[0], self.force[1]))

    @property
    def axial(self) -> float:
        """Axial force, N, positive towards +z."""
        return float(self.force[2])


def bearing_loads(system: System, rest: Rest, strain: BearingStrain) -> tuple[BearingLoad, ...]:
    """Return the load of every bearing, mean over the rest positions."""
    supports, force = supports_by_name(system.rotors), rest.bearing_force
    speed = system.kinematics.float_ratio @ [drive.speed.extreme for drive in system.scene.drives]
    rows = {bearing.name: bearing for bearing in system.scene.rolling_bearings}
    loads = []
    for k, name in enumerate(system.supports.name):
        index, part = supports[name]
        carrier = system.rotors[index].carrier if isinstance(part, PlanetBearing) else None
        carrier_speed = 0.0 if carrier is None else speed[carrier]
        loads.append(
            BearingLoad(
                name=name,
                shaft=part.shaft,
                speed=abs(float(speed[index] - carrier_speed)),
                force=force[:, k].mean(axis=0),
                largest_radial=float(np.max(np.hypot(force[:, k, 0], force[:, k, 1]))),
                elastic=strain.elastic[k],
                clearance=strain.clearance[k],
                seat=strain.seat[k],
                rating_life=bearing_life(rows[name], strain.elastic[k] + strain.clearance[k])
                if name in rows
                else math.nan,
            )
        )
    return tuple(loads)


def equivalent_load(
    load: Sequence[float],
    speed: Sequence[float],
    share: Sequence[float],
    exponent: float = LIFE_EXPONENT,
) -> float:
    """Return the constant load of the same life in revolutions as all load cases, N.

    P = (sum q n P^p / sum q n)^(1/p) with the shares q of the duration and the speeds n: linear damage, as in
    ISO 281. 0 where nothing turns.

    Parameters
    ----------
    load, speed, share : (C,) sequences
        N, rad/s, and any unit; >= 0.
    exponent : float
        p: 3 of ball bearings, 10/3 of roller bearings.
    """
    revolutions = np.asarray(share, dtype=float) * np.asarray(speed, dtype=float)
    total, largest = float(np.sum(revolutions)), float(np.max(load, initial=0.0))
    if total <= 0.0 or largest == 0.0:
        return 0.0
    relative = np.asarray(load, dtype=float) / largest
    mean = float(revolutions @ relative**exponent / total)
    return largest * float(mean ** (1.0 / exponent))
