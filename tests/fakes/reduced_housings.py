"""Reduced housings of random matrices."""

import math
from dataclasses import replace

import numpy as np

from dynamics.housings import ModalDamping, ReducedHousing, Ring, SeatFrame, housing_of_matrices
from dynamics.housings.reduced_housing import PointMotion
from dynamics.housings.reduced_matrices import ReducedMatrices
from dynamics.housings.supports import MOTIONS

PER_SEAT = 5
PAIR = ("input.left", "input.right", "output.left", "output.right")
"""Bearings of a gear pair."""


def random_housing(coupled: bool = False) -> ReducedHousing:
    """Held, two points; seats turned about z, so that their axes are not the scene's. Coupled by damping."""
    housing, lever = bare_housing(coupled=coupled), _lever(len(PAIR), 3, PER_SEAT)
    motions = np.random.default_rng(8).normal(size=(2, 3, lever.size)) / lever
    points = tuple(PointMotion(name, np.zeros(3), motion) for name, motion in zip("ab", motions, strict=True))
    return replace(housing, points=points)


def bare_housing(
    names=PAIR, modal=3, seed=1, *, motions=PER_SEAT, positions=None, coupled=False
) -> ReducedHousing:
    """The same without points: seats of some motions at positions."""
    lever = _lever(len(names), modal, motions)
    matrices = []
    for number, scale in enumerate((3e8, 4.0, 600.0)):
        factor = np.random.default_rng(seed + number).normal(size=(lever.size, lever.size))
        full = scale * (factor @ factor.T / lever.size + 0.5 * np.eye(lever.size))
        matrices.append(np.outer(lever, lever) * full)
    positions = positions or [(0.0, 0.0, 0.0)] * len(names)
    seats = tuple(seat(name, 0.3 * i, motions, positions[i]) for i, name in enumerate(names))
    reduced = ReducedMatrices(*matrices[: 3 if coupled else 2])
    return housing_of_matrices(reduced, seats, ModalDamping((0.02,)))


def seat(name: str, angle: float = 0.0, motions: int = PER_SEAT, position=(0.0, 0.0, 0.0)) -> SeatFrame:
    c, s = math.cos(angle), math.sin(angle)
    axes = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    return SeatFrame(name, np.array(position), axes, Ring.RIGID, MOTIONS[:motions])


def _lever(seats: int, modal: int, motions: int) -> np.ndarray:
    """Lengths by which coordinates are scaled: tilts by 0.1 m."""
    return np.concatenate([np.tile([1.0, 1.0, 1.0, 0.1, 0.1][:motions], seats), np.ones(modal)])
