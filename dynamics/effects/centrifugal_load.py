"""Centrifugal load of planets: the carrier's rotation presses them outwards on their pins."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from bounds import engineering
from dynamics.effects.effect import RotorEffect, Verdict
from dynamics.effects.loaded_parts import LoadedRotor
from dynamics.forces.frames import FrameTerm
from dynamics.mechanism.columns import column_count
from dynamics.mechanism.connections import Connections
from dynamics.mechanism.mechanism import Mechanism

SHARE = 0.01
"""Least load, over the displacing force of the nominal mesh forces on the planet, at which a scene calls for
the effect.
"""


class CentrifugalLoad(RotorEffect):
    """A force m r W^2 away from the axis of a carrier of speed W, on a planet of mass m at the radius r."""

    name = "centrifugal_load"
    cost = "none beside the effect gyroscopic; without it a force element of two rows per planet"

    def called_for(self, rotor: LoadedRotor) -> Verdict:
        """Call for the effect where the load at the largest speed is a share of the forces of the meshes.

        Its influence is how far that load, held by the bearing alone, moves it along a line of action.
        """
        body, mechanism = rotor.rotor, rotor.mechanism
        if body.carrier is None:
            return Verdict(False, False, "no planet: the shaft's axis is its frame's", 0.0)
        if body.radial_stiffness == 0.0:
            return Verdict(False, False, "no bearing with radial stiffness: held rigidly", 0.0)
        if mechanism.freely_turned[body.carrier]:
            reason = "neglected: torques alone turn the carrier's frame, so its speed is unknown"
            return Verdict(False, False, reason, 0.0)
        x, y = _arm(mechanism, rotor.index, body.carrier)
        radius = math.hypot(x, y)
        force = body.inertia.mass * radius * float(mechanism.largest_speed[body.carrier]) ** 2
        along = [abs(x * mesh.direction[0] + y * mesh.direction[1]) / radius for mesh in rotor.meshes]
        pulled, pushed = engineering(force), engineering(rotor.resultant)
        reason = f"up to {pulled} N away from the carrier's axis; mesh forces are {pushed} N"
        influence = force / body.radial_stiffness * max(along, default=0.0)
        return Verdict(force > SHARE * rotor.resultant, True, reason, influence)

    def frame_terms(self, mechanism: Mechanism, connections: Connections, index: int) -> Sequence[FrameTerm]:
        """Return -m r W^2, r from the carrier's axis to the planet's."""
        rotor = mechanism.rotors[index]
        if rotor.carrier is None:
            return ()
        columns = np.eye(column_count(mechanism.rotors))[6 * index : 6 * index + 2]
        x, y = _arm(mechanism, index, rotor.carrier)
        return [FrameTerm(columns, load=(rotor.inertia.mass * x, rotor.inertia.mass * y))]


def _arm(mechanism: Mechanism, planet: int, carrier: int) -> tuple[float, float]:
    """Return where the axis of a planet is from its carrier's, along x and y, m."""
    away = mechanism.rotors[planet].center - mechanism.rotors[carrier].center
    return float(away[0]), float(away[1])
