"""Assumed angles and tooth thicknesses behind the phases of meshes, for the effect ledger.

The phase of a mesh is its position at time 0. It follows from the geometry, except for angles between gears
of one shaft and tooth thicknesses that a scene does not state. Those are assumed; the influence of an angle
is estimated.

Axis letters: m meshes, b bearings, S speeds, H orders.
"""

from __future__ import annotations

import math

import numpy as np

from bounds import engineering
from dynamics.assembly.assemble import System
from dynamics.errors import DynamicsError
from dynamics.influence.level_change import decibels
from dynamics.influence.linear_figures import POSITIONS
from dynamics.influence.operating_conditions import FEWER, operating_conditions
from dynamics.linearize.harmonic_response import bearing_forces
from dynamics.linearize.operating_speeds import leading_law
from dynamics.linearize.steady_vibration import Excited, excited, flank_forces, swept_vibration
from dynamics.mechanism.train_phases import AssumedAngle
from dynamics.types import ComplexArray, FloatArray, IntArray, Json

SPEEDS = 16
"""Number of speeds of a run at which a response is computed."""
ANGLES = 239
"""Number of angles over a pitch at which a response is computed. It is a prime, so that every order meets a
different phase at each angle.
"""
AUDIBLE = 0.01
"""Least amplitude of an order over the largest; changes of smaller orders are not reported."""


def with_assumed_phases(ledger: Json, system: System) -> Json:
    """Return a ledger with the assumptions on phases of meshes; unchanged where geometry fixes all phases.

    The influence of an angle is the change of the level of the forces on all bearings, by linear response.
    The level of an order is its largest over the speeds of the run. Its change is from the angle with the
    lowest level to the angle with the highest one; the ledger has the order with the largest change.
    """
    rows = _rows(system)
    return {**ledger, "assumed": rows} if rows else ledger


def _rows(system: System) -> list[Json]:
    phases = system.phases
    rows: list[Json] = [
        {"part": gear, "words": "tooth thickness not known: half the pitch"} for gear in phases.thickness
    ]
    for angle, change in zip(phases.angles, _changes(system), strict=True):
        first, second = angle.gears
        text = f"angle from a tooth of {first} to a tooth of {second} not stated: 0{_change_text(change)}"
        rows.append({"part": angle.shaft, "words": text, "angle": 0.0, **change})
    return rows


def _change_text(change: Json) -> str:
    if "decibels" not in change:
        return ""
    size = engineering(change["decibels"], 2)
    return f"; {size} dB of bearing forces at order {change['order']:.4g} over all angles"


def _changes(system: System) -> list[Json]:
    """Return the change of level by each angle, or the reason why linear theory has no answer."""
    angles = system.phases.angles
    if not angles:
        return []
    try:
        speed = _speeds(system)
        linear = excited(system, 0.0, FEWER, POSITIONS)
        harmonics = _lines(linear)
        parts = _forces_by_mesh(linear, speed, harmonics)
    except DynamicsError as error:
        return [{"reason": str(error)}] * len(angles)
    return [_change(linear, angle, harmonics, parts) for angle in angles]


def _speeds(system: System) -> FloatArray:
    """Return speeds (S,) of the leading law that the run passes, rad/s."""
    conditions = operating_conditions(system.scene, leading_law(system))
    speed = np.unique(np.concatenate([np.empty(0), *(condition.speed for condition in conditions)]))
    return np.asarray(speed[np.unique(np.linspace(0, speed.size - 1, SPEEDS).round().astype(int))])


def _lines(linear: Excited) -> IntArray:
    """Return the low mesh orders of all meshes (H,), multiples of the frequency of their common period."""
    pitches = np.unique(np.abs(linear.period.pitches))
    return np.unique(np.arange(1, FEWER + 1)[:, None] * pitches[pitches > 0])


def _forces_by_mesh(linear: Excited, speed: FloatArray, harmonics: IntArray) -> ComplexArray:
    """Return the forces on bearings that each mesh excites, (m, b, 3, S, H), N."""
    _, force = flank_forces(linear, harmonics)  # (rows of flanks, H)
    steady = swept_vibration(linear, speed, np.zeros(speed.size), harmonics)
    parts = []
    for cycle in linear.cycles:
        # displacements of the freedoms n by the forces on the flanks f of one mesh
        motion = np.einsum("shnf,fh->shn", steady.receptance[..., cycle.rows], force[cycle.rows])
        parts.append(bearing_forces(linear, steady.omega, motion)[:, :3])
    return np.stack(parts)


def _change(linear: Excited, angle: AssumedAngle, harmonics: IntArray, parts: ComplexArray) -> Json:
    """Return the order whose level an angle changes most, and the change in dB."""
    pitches = np.array(linear.period.pitches, dtype=float)
    # an angle of one pitch of the second gear shifts a mesh by `moves` of its base pitches; the common period
    # has
    # `pitches` of them
    per_pitch = np.divide(angle.moves, pitches, out=np.zeros_like(pitches), where=pitches != 0.0)
    turn = np.arange(ANGLES) / ANGLES
    phase = np.exp(2j * math.pi * turn[:, None, None] * per_pitch[:, None] * harmonics)
    # square of the sum over meshes m and n, summed over bearings b and directions d, for each angle a
    products = np.einsum("mbdsh,nbdsh->mnsh", parts.conj(), parts)
    squares = np.einsum("amh,anh,mnsh->ash", phase.conj(), phase, products, optimize=True).real
    level = np.sqrt(np.maximum(np.max(squares, axis=1), 0.0))  # (angles, H)
    minimum, maximum = level.min(axis=0), level.max(axis=0)
    audible = maximum > AUDIBLE * maximum.max(initial=0.0)
    if not np.any(audible):
        return {"decibels": 0.0, "order": 1.0}
    by_order = np.array([decibels(a, b) for a, b in zip(minimum, maximum, strict=True)])
    index = int(np.argmax(np.where(audible, by_order, -1.0)))
    above = decibels(float(level[0, index]), float(maximum[index]))
    return {
        "decibels": float(by_order[index]),
        "above_assumed": above,  # dB from the assumed angle to the loudest one
        "order": float(harmonics[index] / linear.period.counted),
    }
