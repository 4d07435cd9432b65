"""Rotating-frame elements: gyroscopic moments, Coriolis and centripetal terms."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from dynamics.arrays.elements import Element
from dynamics.assembly.rotor_rotations import largest_speeds
from dynamics.assembly.spun_shaft import spun_pairs
from dynamics.effects.ledger import EffectLedger
from dynamics.forces.element_laws import Law
from dynamics.forces.rotating_frame import RotatingFrameLaws
from dynamics.mechanism.columns import column_count
from dynamics.mechanism.freedoms import ROTATION, Freedoms
from dynamics.mechanism.kinematics import Kinematics
from dynamics.mechanism.rotor import Rotor
from dynamics.mechanism.seats import Seats
from dynamics.mechanism.supports import Supports
from dynamics.scene.scene import Scene
from dynamics.types import FloatArray

LATERAL, TILT = (0, 1), (3, 4)
Factors = tuple[float, float, float, float, float]
Part = tuple[FloatArray, Factors, int]
"""Rows (2, N) across the axis, factors of the law, rotor."""


def rotating_frame_elements(
    scene: Scene,
    rotors: Sequence[Rotor],
    kinematics: Kinematics,
    vectors: FloatArray,
    freedoms: Freedoms,
    supports: Supports,
    seats: Seats,
    ledger: EffectLedger,
) -> tuple[tuple[Element, ...], RotatingFrameLaws]:
    """Return the elements of all rotors whose effect is on, and their laws.

    `vectors` (k, N) are the laws' kinematic vectors; a radius makes lengths of angles. A shaft of spin
    w in a frame of speed W (0: fixed) feels, with J = z x,

        lateral:  m (2 W J u' - W^2 u),     tilt:  (2 I_t W - I_p w) J a' + (I_p w W - I_t W^2) a,

    and a ground damper seen from the frame c W J u. Where nothing moves there is no element.
    """
    lever = max((gear.base_radius for gear in scene.gears), default=1.0)
    found: list[Part] = []
    free = np.any(kinematics.float_ratio[:, len(scene.drives) :] != 0.0, axis=1)
    speed = largest_speeds(scene, kinematics)
    for index, rotor in enumerate(rotors):
        if not ledger.on("gyroscopic", rotor.shaft.name):
            continue
        mass, polar, across = rotor.inertia.mass, rotor.inertia.polar, rotor.inertia.transverse
        own = np.eye(column_count(rotors))[6 * index : 6 * index + 6]
        if rotor.frame is not None:
            found.append((own[list(LATERAL)], (0.0, 2.0 * mass, 0.0, -mass, 0.0), index))
        if rotor.elastic is not None and rotor.elastic.bends:
            fastest = math.inf if free[index] else float(speed[index])
            found += _along_the_shaft(rotors, index, lever, fastest)
            continue
        tilt = np.array((-polar, 2.0 * across, polar, -across, 0.0)) / lever**2
        found.append((lever * own[list(TILT)], _five(tilt), index))
        found += [(rows, (0.0,) * 4 + (c,), index) for rows, c in _dampers(index, supports, seats, lever)]
    merged = _merged([part for part in found if np.any(freedoms.keep(part[0]))], freedoms)
    elements = tuple(
        _element(entry, rows, rotors[index], index, kinematics, vectors, lever if free[index] else 0.0)
        for entry, (rows, _, index) in enumerate(merged)
    )
    return elements, RotatingFrameLaws(
        np.array([factors for _, factors, _ in merged], dtype=float).reshape(-1, 5),
        np.full(len(merged), lever),
        np.array([free[index] for _, _, index in merged], dtype=np.bool_),
    )


def _along_the_shaft(rotors: Sequence[Rotor], index: int, lever: float, speed: float) -> list[Part]:
    """Return the parts of a shaft in the fixed frame whose tilt differs along it."""
    return [
        (lever * rows, (-polar / lever**2, 0.0, 0.0, 0.0, 0.0), index)
        for rows, polar in spun_pairs(rotors, index, speed)
    ]


def _merged(parts: Sequence[Part], freedoms: Freedoms) -> list[Part]:
    """Return the parts with those of a rotor that move alike made one: each costs two unknowns a stage."""
    found: list[Part] = []
    for rows, factors, index in parts:
        for entry, (other, before, owner) in enumerate(found):
            if owner == index and np.array_equal(freedoms.keep(rows), freedoms.keep(other)):
                found[entry] = (other, _five(np.add(before, factors)), index)
                break
        else:
            found.append((rows, factors, index))
    return found


def _five(values: FloatArray) -> Factors:
    """Return five numbers as a tuple."""
    a, b, c, d, e = (float(value) for value in values)
    return a, b, c, d, e


def _element(
    entry: int,
    across: FloatArray,
    rotor: Rotor,
    index: int,
    kinematics: Kinematics,
    vectors: FloatArray,
    lever: float,
) -> Element:
    """Return an element with its rows `across` (2, N), and with a `lever` a row of the shaft's rotation."""
    ratio = kinematics.float_ratio
    rows, drift = across, across @ vectors.T
    if lever > 0.0:
        spin = np.zeros((1, across.shape[1]))
        spin[0, 6 * index + ROTATION] = lever
        rows, drift = np.concatenate([rows, spin]), np.concatenate([drift, np.zeros((1, drift.shape[1]))])
    frame = np.zeros(ratio.shape[1]) if rotor.frame is None else ratio[rotor.frame]
    speed = np.array([ratio[index], frame])
    return Element(Law.ROTATING_FRAME, entry, -1, rows, np.zeros(len(rows)), drift, speed=speed)


def _dampers(index: int, supports: Supports, seats: Seats, lever: float) -> list[tuple[FloatArray, float]]:
    """Rows (2, N) and dampings of what ground dampers of a rotor in a rotating frame are.

    A bushing's damping matrix, alike in all directions, is a damper at a point of the axis and one of tilt.
    """
    found = []
    for support, frame in enumerate(supports.frame):
        rows = supports.motion[support, :2]
        if frame is not None and np.any(rows[:, 6 * index]):
            found.append((rows, float(supports.damping[support, 0])))
    for seat, frame in enumerate(seats.frame):
        first = 5 * seat
        motion, c = seats.motion[first : first + 5], seats.damping[first : first + 5, first : first + 5]
        if frame is None or not np.any(motion[:2, 6 * index]):
            continue
        away = float(c[0, 4] / c[0, 0]) if c[0, 0] > 0.0 else 0.0
        at = motion[:2] + away * np.array([motion[4], -motion[3]])
        found.append((at, float(c[0, 0])))
        found.append((lever * motion[3:5], float(c[3, 3] - c[0, 0] * away**2) / lever**2))
    return [(rows, damping) for rows, damping in found if damping != 0.0]
