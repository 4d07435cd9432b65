"""Candidates of a placement: every pair of bores as far apart as the two shafts that are farthest apart."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import permutations

import numpy as np

from dynamics.housings import Bore
from dynamics.types import FloatArray
from lineofaction.gearbox.convert.placement import Placement

NEAR = 1e-4
"""Largest distance from the axis of a bearing to the axis of its bore, m."""

PARALLEL = 1e-4
"""Sine of the angle between axes that are parallel."""

Bearings = Mapping[str, FloatArray]
"""Positions of the bearings in the scene, m, by name of the bearing. Shape (3,) each."""


def placements(bores: Sequence[Bore], bearings: Bearings) -> Iterator[Placement]:
    """Yield the placements in which two bores are about two shafts."""
    shafts = _distinct_points(np.array([position[:2] for position in bearings.values()]))
    distance = np.linalg.norm(shafts[:, None] - shafts[None], axis=-1)
    if not distance.any():
        return
    pair = shafts[list(np.unravel_index(distance.argmax(), distance.shape))]
    for direction in _directions(bores):
        middles = np.array([bore.position for bore in bores if _along(bore, direction)])
        for sense in (1.0, -1.0):
            frame = _frame(sense * direction)
            lines = _distinct_points((middles @ frame)[:, :2])
            for axes, across in _turned(frame, lines, pair):
                for along in _offsets(middles @ axes.T, across, bearings):
                    yield Placement(axes, np.array([*across, along]))


def _distinct_points(points: FloatArray) -> FloatArray:
    """Return points without duplicates, to 1 µm."""
    _, first = np.unique(np.round(points, 6), axis=0, return_index=True)
    return points[first]


def _directions(bores: Sequence[Bore]) -> Iterator[FloatArray]:
    """Yield the directions of bores, each once."""
    directions: list[FloatArray] = []
    for bore in bores:
        if not any(_along(bore, other) for other in directions):
            directions.append(np.array(bore.axis))
            yield directions[-1]


def _along(bore: Bore, direction: FloatArray) -> bool:
    return bool(np.linalg.norm(np.cross(bore.axis, direction)) < PARALLEL)


def _frame(z: FloatArray) -> FloatArray:
    """Return a right-handed frame with this z axis, by columns."""
    x = np.cross(z, np.eye(3)[np.abs(z).argmin()])  # with the axis that is farthest from z
    x /= np.linalg.norm(x)
    return np.stack([x, np.cross(z, x), z], axis=1)


def _turned(
    frame: FloatArray, lines: FloatArray, pair: FloatArray
) -> Iterator[tuple[FloatArray, FloatArray]]:
    """Yield the axes, and the origin across them, that put two lines of bores on the pair of shafts."""
    span = pair[1] - pair[0]
    for first, second in permutations(lines, 2):
        arm = second - first
        if abs(np.linalg.norm(arm) - np.linalg.norm(span)) < NEAR:
            angle = np.arctan2(span[1], span[0]) - np.arctan2(arm[1], arm[0])
            about = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
            turn = np.eye(3)
            turn[:2, :2] = about
            yield turn @ frame.T, pair.mean(axis=0) - about @ (0.5 * (first + second))


def _offsets(middles: FloatArray, across: FloatArray, bearings: Bearings) -> list[float]:
    """Return the offsets along z of turned bores that put a bearing in the middle of one, m."""
    positions = np.array(list(bearings.values()))
    distance = positions[:, None, :2] - across - middles[None, :, :2]
    aligned = np.hypot(distance[..., 0], distance[..., 1]) < NEAR
    offsets = (positions[:, None, 2] - middles[None, :, 2])[aligned]
    _, first = np.unique(np.round(offsets, 6), return_index=True)
    return [float(offset) for offset in offsets[first]]
