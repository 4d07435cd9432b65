"""Where the solid of a STEP file stands in a scene: its bores are about the bearings.

Shafts of a scene are parallel to z. A placement is found from two bores as far apart as two shafts, turned
about z and moved along it until as many bearings as possible are in a bore; lengths in m.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import permutations

import numpy as np

from dynamics.housings import Bore
from dynamics.types import FloatArray
from lineofaction.gearbox.convert.placement import Placement
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.units import MM, as_typed

NEAR = 1e-4
"""Distance from the axis of a bearing to that of its bore, m."""
_PARALLEL = 1e-4
"""Sine of the angle between axes that are parallel."""
_ALIKE = 1e-3
"""Placements whose bearings are off the middles of their bores by as much more, m, are equally good."""
_FEWEST = 3
"""Bearings in bores by which a placement is known; those of one shaft leave the angle about it open."""
Bearings = Mapping[str, FloatArray]
"""By name where they are in the scene."""


@dataclass(frozen=True)
class Seated:
    """By name of a bearing the bore it is in, as placed."""

    bores: Mapping[str, Bore]
    placement: Placement
    bearings: Bearings

    @property
    def order(self) -> tuple[int, float]:
        """What is less for the better placement: minus the bearings in bores, how far off the middle, m."""
        off = [abs(bore.position[2] - self.bearings[name][2]) for name, bore in self.bores.items()]
        return -len(self.bores), max(off, default=0.0)


def placed_bore(bore: Bore, placement: Placement) -> Bore:
    """Return a bore where it is in the scene."""
    x, y, z = map(float, placement.points(bore.position))
    u, v, w = map(float, placement.axes @ np.array(bore.axis))
    return Bore((x, y, z), (u, v, w), bore.diameter, bore.length)


def seated(bores: Sequence[Bore], bearings: Bearings, placement: Placement) -> Seated:
    """Return the bores that bearings are in; of several the one whose middle is nearest."""
    placed = [placed_bore(bore, placement) for bore in bores]
    found = {}
    for name, (x, y, z) in bearings.items():
        about = [bore for bore in placed if _holds(bore, x, y, z)]
        if about:
            found[name] = min(about, key=lambda bore: abs(bore.position[2] - z))
    return Seated(found, placement, bearings)


def _holds(bore: Bore, x: float, y: float, z: float) -> bool:
    axial = np.hypot(*bore.axis[:2]) < _PARALLEL
    centered = np.hypot(bore.position[0] - x, bore.position[1] - y) < NEAR
    return bool(axial and centered and abs(bore.position[2] - z) < 0.5 * bore.length)


def found(bores: Sequence[Bore], bearings: Bearings) -> Seated:
    """Return the placement in which most bearings are in bores: that of the file, if no other has more.

    Raises `BadInput` naming ``step_file``: no placement has three bearings of two shafts in bores, or several
    are equally good.
    """
    own = seated(bores, bearings, Placement())
    if len(own.bores) == len(bearings):
        return own
    best = sorted(
        [own, *(seated(bores, bearings, each) for each in _placements(bores, bearings))],
        key=lambda each: each.order,
    )
    first = best[0]
    if len(first.bores) < _FEWEST or _shafts(first.bores) < 2:
        raise BadInput.of("step_file", _listed(bores), _bound(bearings), _WHERE)
    rivals = [each for each in best if _rival(each, first)]
    if rivals:
        ways = "; or ".join(_options(each.placement) for each in (first, *rivals[:3]))
        bound = f"one that fits the bearings in one way only: {1 + len(rivals)} are equally good"
        raise BadInput.of("step_file", f"{len(first.bores)} bearings in bores", bound, f"Choose: {ways}.")
    return first


_WHERE = "Say where the file stands: --origin-mm, and --x-axis and --z-axis where it is turned."


def _bound(bearings: Bearings) -> str:
    at = ", ".join(f"{name} at {_in_mm(position)}" for name, position in bearings.items())
    return f"a solid with bores about bearings of at least two shafts, three bearings in all: {at}"


def _listed(bores: Sequence[Bore]) -> str:
    shown = [f"{as_typed(bore.diameter, MM):g} at {_in_mm(bore.position)}" for bore in bores[:8]]
    return f"{len(bores)} bores, mm: {'; '.join(shown)}" if bores else "no bore"


def _in_mm(position: Sequence[float] | FloatArray) -> str:
    return " ".join(f"{as_typed(float(np.round(value, 9)), MM):g}" for value in position)


def _options(placement: Placement) -> str:
    fields = placement.fields or {"origin_mm": [0.0, 0.0, 0.0]}
    return " ".join(
        f"--{name.replace('_', '-')} {','.join(f'{value:.9g}' for value in values)}"
        for name, values in fields.items()
    )


def _shafts(bores: Mapping[str, Bore]) -> int:
    return len({(round(bore.position[0] / NEAR), round(bore.position[1] / NEAR)) for bore in bores.values()})


def _rival(other: Seated, first: Seated) -> bool:
    """Whether another placement is as good as the first, and not the same."""
    same = np.allclose(other.placement.axes, first.placement.axes, atol=1e-3)
    near = np.allclose(other.placement.origin, first.placement.origin, atol=_ALIKE)
    good = len(other.bores) == len(first.bores) and other.order[1] < first.order[1] + _ALIKE
    return other is not first and good and not (same and near)


# Candidates: every pair of bores as far apart as the two shafts that are farthest apart.


def _placements(bores: Sequence[Bore], bearings: Bearings) -> Iterator[Placement]:
    shafts = _once(np.array([at[:2] for at in bearings.values()]))
    distance = np.linalg.norm(shafts[:, None] - shafts[None], axis=-1)
    if not distance.any():
        return
    pair = shafts[list(np.unravel_index(distance.argmax(), distance.shape))]
    for direction in _directions(bores):
        middles = np.array([bore.position for bore in bores if _along(bore, direction)])
        for sense in (1.0, -1.0):
            frame = _frame(sense * direction)
            lines = _once((middles @ frame)[:, :2])
            for axes, across in _turned(frame, lines, pair):
                for along in _offsets(middles @ axes.T, across, bearings):
                    yield Placement(axes, np.array([*across, along]))


def _once(points: FloatArray) -> FloatArray:
    """Return points without those that others have, to 1 µm."""
    _, first = np.unique(np.round(points, 6), axis=0, return_index=True)
    return points[first]


def _directions(bores: Sequence[Bore]) -> Iterator[FloatArray]:
    """Yield the directions of bores, each once."""
    seen: list[FloatArray] = []
    for bore in bores:
        if not any(_along(bore, other) for other in seen):
            seen.append(np.array(bore.axis))
            yield seen[-1]


def _along(bore: Bore, direction: FloatArray) -> bool:
    return bool(np.linalg.norm(np.cross(bore.axis, direction)) < _PARALLEL)


def _frame(z: FloatArray) -> FloatArray:
    """Return a right-handed frame with this z axis, by columns."""
    x = np.cross(z, np.eye(3)[np.abs(z).argmin()])
    x /= np.linalg.norm(x)
    return np.stack([x, np.cross(z, x), z], axis=1)


def _turned(
    frame: FloatArray, lines: FloatArray, pair: FloatArray
) -> Iterator[tuple[FloatArray, FloatArray]]:
    """Yield axes and origin across the shafts, for lines of bores on a pair of shafts."""
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
    """Return how far along z turned bores are moved so that a bearing is in the middle of one."""
    at = np.array(list(bearings.values()))
    off = at[:, None, :2] - across - middles[None, :, :2]
    offsets = (at[:, None, 2] - middles[None, :, 2])[np.hypot(off[..., 0], off[..., 1]) < NEAR]
    _, first = np.unique(np.round(offsets, 6), return_index=True)
    return [float(offset) for offset in offsets[first]]
