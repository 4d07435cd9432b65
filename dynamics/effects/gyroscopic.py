"""Gyroscopic moments of spinning shafts; Coriolis and centripetal terms of rotating frames."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from bounds import engineering
from dynamics.effects.effect import RotorEffect, Verdict
from dynamics.effects.loaded_parts import LoadedRotor
from dynamics.forces.frames import FrameTerm
from dynamics.mechanism.additions import SPEED_DEPENDENCE
from dynamics.mechanism.bearing_elements import tilt_lever
from dynamics.mechanism.columns import column_count
from dynamics.mechanism.connections import Connections
from dynamics.mechanism.mechanism import Mechanism
from dynamics.mechanism.spun_shaft import spun_pairs
from dynamics.types import FloatArray

SHARE = 0.01
"""Least shift of a natural frequency, over the frequency, at which a scene calls for the effect."""
FREEDOMS = 6  # of a rotor: x, y, z, tilt_x, tilt_y, rotation
LATERAL, TILT = (0, 1), (3, 4)  # indices among the freedoms of a rotor: x and y, tilt_x and tilt_y
SEAT_ROWS = 5  # rows of a seat of a bearing: x, y, z, tilt_x, tilt_y


class Gyroscopic(RotorEffect):
    """One force element of two rows per tilting shaft, and one or more per member of a planetary set."""

    name = "gyroscopic"
    adds = (SPEED_DEPENDENCE,)
    cost = "a force element of two rows per tilting shaft; in rotating frames one or more per member"

    def called_for(self, rotor: LoadedRotor) -> Verdict:
        """Call for the effect where it shifts a natural frequency by more than a share.

        A tilting shaft of spin w whirls at its frequency f times 1 +- I_p w/(2 sqrt(I_t k_t)); one seen from
        a frame of speed W at f +- W/(2 pi).
        """
        body, mechanism = rotor.rotor, rotor.mechanism
        if body.tilt_stiffness == 0.0 and body.frame is None:
            reason = "no bushing with tilt stiffness: held rigidly"
            return Verdict(on=False, possible=False, reason=reason, influence=0.0)
        free = bool(mechanism.freely_turned[rotor.index if body.frame is None else body.frame])
        if body.frame is not None and free:
            reason = "neglected: torques alone turn the carrier's frame, so its speed is unknown"
            return Verdict(on=False, possible=False, reason=reason, influence=0.0)
        if free:
            reason = "torques alone turn the shaft: its speed is not known in advance"
            return Verdict(on=True, possible=True, reason=reason, influence=0.0)
        share = max(_tilt_share(rotor), _frame_share(rotor))
        deflection = rotor.resultant / body.radial_stiffness if body.radial_stiffness > 0.0 else 0.0
        reason = f"rotation shifts natural frequencies by up to {engineering(share, 2)} of them"
        return Verdict(on=share > SHARE, possible=True, reason=reason, influence=min(share, 1.0) * deflection)

    def frame_terms(self, mechanism: Mechanism, connections: Connections, index: int) -> Sequence[FrameTerm]:
        """Return the terms of a shaft of spin w in a frame of speed W (0: fixed).

        J is the cross product with the axis z, u the lateral motion, a the tilt, c the damping of a damper
        on the ground as seen from the frame:

        lateral:  m (2 W J u' - W^2 u),     tilt:  (2 I_t W - I_p w) J a' + (I_p w W - I_t W^2) a,
        damper:   c W J u.

        The five factors of a `FrameTerm` are those of w J a', W J a', w W a, W^2 a and W J a.
        """
        rotor, lever = mechanism.rotors[index], tilt_lever(mechanism.scene)
        mass, polar, across = rotor.inertia.mass, rotor.inertia.polar, rotor.inertia.transverse
        columns = np.eye(column_count(mechanism.rotors))[FREEDOMS * index : FREEDOMS * (index + 1)]
        terms = []
        if rotor.frame is not None:
            terms.append(FrameTerm(columns[list(LATERAL)], (0.0, 2.0 * mass, 0.0, -mass, 0.0)))
        if rotor.elastic is not None and rotor.elastic.bends:
            return [*terms, *_along_the_shaft(mechanism, index, lever)]
        square = lever**2
        tilt = (-polar / square, 2.0 * across / square, polar / square, -across / square, 0.0)
        terms.append(FrameTerm(lever * columns[list(TILT)], tilt))
        return [*terms, *_dampers(connections, index, lever)]


def _tilt_share(rotor: LoadedRotor) -> float:
    """Return I_p w/(2 sqrt(I_t k_t)) at the largest speed w of the run."""
    body, speed = rotor.rotor, rotor.mechanism.largest_speed
    resistance = math.sqrt(body.inertia.transverse * body.tilt_stiffness)
    return body.inertia.polar * float(speed[rotor.index]) / (2.0 * resistance) if resistance > 0.0 else 0.0


def _frame_share(rotor: LoadedRotor) -> float:
    """Return the largest quotient of the frame's speed by the lateral natural frequency of its members."""
    frame, speed = rotor.rotor.frame, rotor.mechanism.largest_speed
    if frame is None:
        return 0.0
    members = [other for other in rotor.mechanism.rotors if other.frame == frame]
    supported = [member for member in members if member.radial_stiffness > 0.0]
    shares = (
        float(speed[frame]) * math.sqrt(member.inertia.mass / member.radial_stiffness) for member in supported
    )
    return max(shares, default=0.0)


def _along_the_shaft(mechanism: Mechanism, index: int, lever: float) -> list[FrameTerm]:
    """Return the terms of a shaft in the fixed frame whose tilt differs along it."""
    free = mechanism.freely_turned[index]
    fastest = math.inf if free else float(mechanism.largest_speed[index])
    return [
        FrameTerm(lever * rows, (-polar / lever**2, 0.0, 0.0, 0.0, 0.0))
        for rows, polar in spun_pairs(mechanism.rotors, index, fastest)
    ]


def _dampers(connections: Connections, index: int, lever: float) -> list[FrameTerm]:
    """Return the terms of the ground dampers of a rotor in a rotating frame.

    A bushing's damping matrix, alike in all directions, is a damper at a point of the axis and one of tilt.
    """
    supports, seats = connections.supports, connections.seats
    dampers: list[tuple[FloatArray, float]] = []
    for support, frame in enumerate(supports.frame):
        rows = supports.motion[support, :2]
        if frame is not None and np.any(rows[:, FREEDOMS * index]):  # a column of x: it is on this rotor
            dampers.append((rows, float(supports.damping[support, 0])))
    for seat, frame in enumerate(seats.frame):
        part = slice(SEAT_ROWS * seat, SEAT_ROWS * (seat + 1))
        motion, c = seats.motion[part], seats.damping[part, part]
        if frame is None or not np.any(motion[:2, FREEDOMS * index]):
            continue
        # distance along the axis at which the lateral damper acts, m: there it is not coupled to the tilt
        offset = float(c[0, 4] / c[0, 0]) if c[0, 0] > 0.0 else 0.0
        lateral = motion[:2] + offset * np.array([motion[4], -motion[3]])
        dampers.append((lateral, float(c[0, 0])))
        dampers.append((lever * motion[3:5], float(c[3, 3] - c[0, 0] * offset**2) / lever**2))
    return [FrameTerm(rows, (0.0, 0.0, 0.0, 0.0, damping)) for rows, damping in dampers if damping != 0.0]
