"""Loads of bearings under load cases, and the load that stands for all of them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from dynamics.assembly.assemble import System
from dynamics.deflection.bearing_life import life_of
from dynamics.deflection.bearing_strain import BearingStrain
from dynamics.deflection.rest import Rest
from dynamics.joints import PlanetBearing
from dynamics.mechanism.bearing_elements import supports_by_name
from dynamics.types import FloatArray
from model_studies import Record, in_unit

LIFE_EXPONENT = 10.0 / 3.0
"""Of roller bearings; ball bearings have 3."""


@dataclass(frozen=True)
class BearingLoad(Record):
    """The load of a bearing under a load case, mean over the mesh cycle; x, y, z, tilt_x, tilt_y.

    Attributes
    ----------
    name, shaft : str
    speed : float
        Of the shaft against what holds the bearing, rad/s, >= 0.
    force : (5,) array
        On the housing, of a planet bearing on the pin, N and N m.
    largest_radial : float
        Over the cycle, N.
    elastic, clearance, seat : (5,) arrays
        Parts of the displacement of the shaft there, m and rad.
    rating_life : float
        Basic reference rating life L_10r at the mean displacement, revolutions; infinite where no element is
        loaded, NaN if the bearing has no dynamic capacity.
    """

    name: str
    shaft: str
    speed: float = field(metadata=in_unit("rad_s"))
    force: FloatArray = field(metadata=in_unit("n", "direction"))
    largest_radial: float = field(metadata=in_unit("n"))
    elastic: FloatArray = field(metadata=in_unit("m", "direction"))
    clearance: FloatArray = field(metadata=in_unit("m", "direction"))
    seat: FloatArray = field(metadata=in_unit("m", "direction"))
    rating_life: float = math.nan

    @property
    def radial(self) -> float:
        """Radial force, N."""
        return float(np.hypot(self.force[0], self.force[1]))

    @property
    def axial(self) -> float:
        """Axial force, N, positive towards +z."""
        return float(self.force[2])


def bearing_loads(system: System, rest: Rest, strain: BearingStrain) -> tuple[BearingLoad, ...]:
    """Return the loads of all bearings in the rest positions, `strain` that of their mean."""
    places, force = supports_by_name(system.rotors), rest.bearing_force
    speed = system.kinematics.float_ratio @ [drive.speed.extreme for drive in system.scene.drives]
    rows = {bearing.name: bearing for bearing in system.scene.rolling_bearings}
    loads = []
    for k, name in enumerate(system.supports.name):
        index, part = places[name]
        carrier = system.rotors[index].carrier if isinstance(part, PlanetBearing) else None
        held = 0.0 if carrier is None else speed[carrier]
        loads.append(
            BearingLoad(
                name,
                part.shaft,
                abs(float(speed[index] - held)),
                force[:, k].mean(axis=0),
                float(np.max(np.hypot(force[:, k, 0], force[:, k, 1]))),
                strain.elastic[k],
                strain.clearance[k],
                strain.seat[k],
                life_of(rows[name], strain.elastic[k] + strain.clearance[k]) if name in rows else math.nan,
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
