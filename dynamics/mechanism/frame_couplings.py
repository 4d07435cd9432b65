"""Couplings between shafts that are described in different frames."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dynamics.bearings.seat import SEAT
from dynamics.mechanism.bodies import Bodies
from dynamics.mechanism.columns import section_rows
from dynamics.mechanism.coupling_rows import full_matrix
from dynamics.scene.scene import Scene
from dynamics.types import FloatArray


@dataclass(frozen=True)
class _FrameCoupling:
    """One coupling across frames: its index in the scene and its rotors, that in the fixed frame first.

    It acts on both at the `height` along z, m, in 2 `directions`, across the axis alone, or 4: tilts too.
    """

    coupling: int
    first: int
    second: int
    height: float
    directions: int


def frame_couplings(scene: Scene) -> tuple[_FrameCoupling, ...]:
    """Return all couplings with matrices between shafts of different frames."""
    couplings = []
    for index, coupling in enumerate(scene.couplings):
        if not scene.crosses_frames(coupling):
            continue
        ends = [scene.shaft_index(name) for name in (coupling.first, coupling.second)]
        z = scene.shafts[ends[0]].origin[2] + coupling.position
        if scene.shafts[ends[1]].frame is None:
            ends.reverse()
        matrices = [full_matrix(m, 0.0) for m in (coupling.stiffness, coupling.damping)]
        tilts = any(np.any(matrix[3:5, :5] != 0.0) for matrix in matrices)
        couplings.append(_FrameCoupling(index, ends[0], ends[1], z, 4 if tilts else 2))
    return tuple(couplings)


def frame_joint(
    scene: Scene, rotors: Bodies, part: _FrameCoupling, angle: float
) -> tuple[FloatArray, FloatArray]:
    """Return strain (5, N) and stiffness (5, 5) with the second frame turned by `angle` in rad."""
    c, s = np.cos(angle), np.sin(angle)
    rotation_matrix = np.eye(SEAT)
    rotation_matrix[:2, :2] = rotation_matrix[3:, 3:] = [[c, -s], [s, c]]
    first, second = (section_rows(rotors, end, part.height)[:SEAT] for end in (part.first, part.second))
    matrix = full_matrix(scene.couplings[part.coupling].stiffness, 0.0)[:SEAT, :SEAT].copy()
    matrix[2], matrix[:, 2] = 0.0, 0.0  # no frame turns the part along the axis: `gather_couplings` has it
    return first - rotation_matrix @ second, matrix
