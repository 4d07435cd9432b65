"""Reduced housings of random matrices."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from dynamics.housing_modes import ModalDamping, ReducedHousing, Ring, SeatFrame, housing_of_matrices
from dynamics.housing_modes.reduced_housing import PointMotion
from dynamics.housing_modes.reduced_matrices import ReducedMatrices
from dynamics.housing_modes.seats import MOTIONS

PER_SEAT = 5
PAIR = ("input.left", "input.right", "output.left", "output.right")
"""Bearings of a gear pair."""


def random_housing(
    names: tuple[str, ...] = PAIR, modal: int = 3, seed: int = 1, coupled: bool = False
) -> ReducedHousing:
    """Held, two points; seats turned about z, so that their axes are not the scene's. Coupled by damping."""
    lever = np.concatenate([np.tile([1.0, 1.0, 1.0, 0.1, 0.1], len(names)), np.ones(modal)])
    draw = np.random.default_rng(seed + 7)
    matrices = []
    for number, scale in enumerate((3e8, 4.0, 600.0)):
        factor = np.random.default_rng(seed + number).normal(size=(lever.size, lever.size))
        full = scale * (factor @ factor.T / lever.size + 0.5 * np.eye(lever.size))
        matrices.append(np.outer(lever, lever) * full)
    seats = tuple(_seat(name, 0.3 * index) for index, name in enumerate(names))
    given = ReducedMatrices(*matrices[: 3 if coupled else 2])
    housing = housing_of_matrices(given, seats, ModalDamping((0.02,)))
    motions = draw.normal(size=(2, 3, lever.size)) / lever
    points = tuple(PointMotion(name, np.zeros(3), motion) for name, motion in zip("ab", motions, strict=True))
    return replace(housing, points=points)


def _seat(name: str, angle: float) -> SeatFrame:
    c, s = math.cos(angle), math.sin(angle)
    axes = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    return SeatFrame(name, np.zeros(3), axes, Ring.RIGID, MOTIONS[:PER_SEAT])
