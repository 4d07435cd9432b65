"""Compliance between tooth contacts by the shafts of the gears."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from fe_contact.geometry import ParallelAxes, Shaft
from fe_contact.types import FloatArray


@dataclass(frozen=True)
class SeatCompliance:
    """Displacement of a gear by a unit load on its seat, in any plane through the axis."""

    translation: float
    """Displacement per force, m/N."""
    coupling: float
    """Tilt (slope, > 0 where displacement grows with z) per force, and displacement per moment, 1/N."""
    tilt: float
    """Tilt per moment, 1/(N m)."""

    @classmethod
    def of_shaft(cls, shaft: Shaft) -> SeatCompliance:
        """Return the compliance of a shaft and its bearings at the gear's mid-face."""
        modulus, ratio = shaft.material.youngs_modulus, shaft.material.poissons_ratio
        bending = modulus * math.pi * shaft.diameter**4 / 64.0
        # shear coefficient of the full circle: G. R. Cowper, J. Appl. Mech. 33 (1966) 335-340
        coefficient = 6.0 * (1.0 + ratio) / (7.0 + 6.0 * ratio)
        shear = coefficient * modulus / (2.0 * (1.0 + ratio)) * math.pi * shaft.diameter**2 / 4.0
        flexibility = np.zeros((2, 2))  # displacement and tilt per force and moment
        for low, high in pairwise(sorted((0.0, shaft.length, shaft.position))):
            flexibility += _section(shaft, low, high, bending, shear)
        if shaft.bearing_stiffness is not None:
            for reaction in _reactions(shaft):
                flexibility += np.outer(reaction, reaction) / shaft.bearing_stiffness
        return cls(float(flexibility[0, 0]), float(flexibility[0, 1]), float(flexibility[1, 1]))


def _reactions(shaft: Shaft) -> tuple[FloatArray, FloatArray]:
    """Return the reactions of both bearings to a unit force and to a unit moment at the seat."""
    share = shaft.position / shaft.length
    return np.array([share - 1.0, 1.0 / shaft.length]), np.array([-share, -1.0 / shaft.length])


def _section(shaft: Shaft, low: float, high: float, bending: float, shear: float) -> FloatArray:
    """Return the flexibility of the shaft from `low` to `high`, a part on which the moment is linear."""
    first, second = _reactions(shaft)
    middle = 0.5 * (low + high)
    # shear force and moment (= constant + force x) by the loads on the left: unit force and unit moment
    force, constant = np.zeros(2), np.zeros(2)
    for position, load in ((0.0, first), (shaft.length, second), (shaft.position, np.array([1.0, 0.0]))):
        if middle > position:
            force, constant = force + load, constant - position * load
    if middle > shaft.position:
        constant = constant - np.array([0.0, 1.0])
    ends = [constant + force * x for x in (low, middle, high)]
    simpson = sum(weight * np.outer(m, m) for weight, m in zip((1.0, 4.0, 1.0), ends, strict=True)) / 6.0
    return np.asarray((high - low) * (simpson / bending + np.outer(force, force) / shear))


@dataclass(frozen=True)
class ShaftCompliance:
    """The compliance term of both shafts; None is a rigid one.

    Notes
    -----
    In the frame t (along the line of action, towards tip 1), n (from the axis to the line), z a unit normal
    force is (cos beta_b, 0, sin beta_b) at (l, +-r_b, z). It bends the shaft in the plane t z with the force
    cos beta_b and the moment z cos beta_b - l sin beta_b, and in the plane n z with the moment
    r_b sin beta_b of its axial part. Torsion is no part of it: transmission error is that of the seats.
    """

    pinion: SeatCompliance | None
    wheel: SeatCompliance | None

    def __call__(
        self, pair: ParallelAxes, roll_1: FloatArray, roll_2: FloatArray, face: FloatArray
    ) -> FloatArray:
        """Return the normal approach (P, n, n) in m/N; roll lengths (P, n) and face positions (n,) in m."""
        across, along = math.cos(pair.base_helix_angle), math.sin(pair.base_helix_angle)
        total = np.zeros((*roll_1.shape, face.size))
        second = pair.wheel.sign * roll_2
        sides = (
            (self.pinion, pair.pinion.base_radius, across * face - along * roll_1),
            # seen from an external wheel's axis the line of action runs the other way
            (self.wheel, pair.wheel.base_radius, across * (face - pair.axial_offset) + along * second),
        )
        for seat, radius, arm in sides:
            if seat is not None:
                constant = across**2 * seat.translation + (radius * along) ** 2 * seat.tilt
                total += constant + across * seat.coupling * (arm[:, :, None] + arm[:, None, :])
                total += seat.tilt * (arm[:, :, None] * arm[:, None, :])
        return total
