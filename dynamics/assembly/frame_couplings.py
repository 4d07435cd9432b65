"""Couplings between shafts described in different frames: where they act, and how the frames turn."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from dynamics.arrays.arrays import SystemArrays
from dynamics.arrays.elements import Element
from dynamics.bearings.seat import SEAT
from dynamics.forces.elements import FrameCouplingLaws
from dynamics.kernels.law import Law
from dynamics.mechanism.bodies import Bodies
from dynamics.mechanism.columns import section_rows
from dynamics.mechanism.coupling_rows import ACROSS, full_matrix
from dynamics.mechanism.kinematics import Kinematics
from dynamics.motion.observation import local_state
from dynamics.scene.scene import Scene, crosses_frames
from dynamics.types import FloatArray


@dataclass(frozen=True)
class FrameCoupling:
    """One coupling across frames.

    Attributes
    ----------
    coupling : int
        Its index in the scene.
    first, second : int
        Rotors: that in the fixed frame first, if there is one.
    height : float
        Where it acts on both, along z, m.
    directions : int
        2: across the axis alone; 4: tilts too.
    """

    coupling: int
    first: int
    second: int
    height: float
    directions: int


def frame_couplings(scene: Scene) -> tuple[FrameCoupling, ...]:
    """Return all couplings with matrices between shafts of different frames."""
    couplings = []
    for index, coupling in enumerate(scene.couplings):
        ends = [scene.shaft_index(name) for name in (coupling.first, coupling.second)]
        if not crosses_frames(scene.shafts[ends[0]], scene.shafts[ends[1]], coupling):
            continue
        z = scene.shafts[ends[0]].origin[2] + coupling.position
        if scene.shafts[ends[1]].frame is None:
            ends.reverse()
        matrices = [full_matrix(m, 0.0) for m in (coupling.stiffness, coupling.damping)]
        tilts = any(np.any(matrix[3:5, :5] != 0.0) for matrix in matrices)
        couplings.append(FrameCoupling(index, ends[0], ends[1], z, 4 if tilts else 2))
    return tuple(couplings)


def frame_turns(scene: Scene, kinematics: Kinematics) -> tuple[tuple[Fraction, ...], ...]:
    """Return the revolutions of the second frame against the first per revolution of each law, for each."""
    turns = []
    for coupling in scene.couplings:
        ends = [scene.shaft_index(name) for name in (coupling.first, coupling.second)]
        if not crosses_frames(scene.shafts[ends[0]], scene.shafts[ends[1]], coupling):
            continue
        if scene.shafts[ends[1]].frame is None:
            ends.reverse()
        first, second = (_frame_speed(scene, kinematics, end) for end in ends)
        turns.append(tuple(b - a for a, b in zip(first, second, strict=True)))
    return tuple(turns)


def frame_coupling_elements(
    scene: Scene, rotors: Bodies, lever: float
) -> tuple[tuple[Element, ...], FrameCouplingLaws]:
    """Return the elements of all couplings across frames, and their laws; `lever` (m) makes lengths of tilts.

    Each reads a phase of its own behind those of the meshes: how far its second frame has turned against its
    first.
    """
    parts = frame_couplings(scene)
    elements = []
    size = np.array([1.0, 1.0, lever, lever])
    laws = [np.zeros((len(parts), 4, 4)) for _ in range(2)]
    for entry, part in enumerate(parts):
        coupling, n = scene.couplings[part.coupling], part.directions
        for law, matrix in zip(laws, (coupling.stiffness, coupling.damping), strict=True):
            law[entry] = full_matrix(matrix, 0.0)[np.ix_(ACROSS, ACROSS)] / np.outer(size, size)
        ends = (section_rows(rotors, rotor, part.height) for rotor in (part.first, part.second))
        gradient = np.concatenate([(moves[list(ACROSS)] * size[:, None])[:n] for moves in ends])
        typical = np.tile(np.diag(laws[0][entry])[:n], 2)
        phase = len(scene.meshes) + entry
        offset = np.zeros(2 * n)
        elements.append(Element(Law.FRAME_COUPLING, entry, phase, gradient, offset, stiffness=typical))
    directions = np.array([part.directions for part in parts], dtype=np.int64)
    return tuple(elements), FrameCouplingLaws(directions, *laws)


def stiffness_across(arrays: SystemArrays, time: float) -> FloatArray:
    """Return the stiffness (n, n) of all couplings across frames, at their angles at `time`."""
    elements, n = arrays.elements, arrays.mass.shape[0]
    stiffness, crossing = np.zeros((n, n)), np.flatnonzero(elements.law == Law.FRAME_COUPLING)
    if crossing.size:
        tangent = local_state(arrays, time, np.zeros(n), np.zeros(n)).tangent
        for e in crossing:
            rows = slice(elements.first[e], elements.first[e + 1])
            direction = arrays.direction[rows]
            stiffness += direction.T @ tangent[rows, : direction.shape[0]] @ direction
    return stiffness


def frame_joint(
    scene: Scene, rotors: Bodies, part: FrameCoupling, angle: float
) -> tuple[FloatArray, FloatArray]:
    """Return strain (5, N) and stiffness (5, 5) with the second frame turned by `angle` in rad."""
    c, s = np.cos(angle), np.sin(angle)
    turn = np.eye(SEAT)
    turn[:2, :2] = turn[3:, 3:] = [[c, -s], [s, c]]
    first, second = (section_rows(rotors, end, part.height)[:SEAT] for end in (part.first, part.second))
    matrix = full_matrix(scene.couplings[part.coupling].stiffness, 0.0)[:SEAT, :SEAT].copy()
    matrix[2], matrix[:, 2] = 0.0, 0.0
    return first - turn @ second, matrix


def _frame_speed(scene: Scene, kinematics: Kinematics, shaft: int) -> tuple[Fraction, ...]:
    frame = scene.frame_index(shaft)
    return kinematics.ratio[frame] if frame is not None else (Fraction(0),) * len(kinematics.law_shaft)
