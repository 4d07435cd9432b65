"""What the force of a rolling bearing costs, by displacement and cage angle, from Python."""

from __future__ import annotations

import time

from benchmarks.figures import Figure
from dynamics.bearings import BallBearing, RollerBearing
from dynamics.bearings.loaded_bearing import LoadedBearing

TARGET = 10.0
"""Microseconds of CPU time: 1e5 evaluations a second of a bearing of eight balls."""
EVALUATIONS, REPEATS = 20_000, 3
_BALLS = BallBearing(count=8, diameter=11.5e-3, pitch_diameter=43.5e-3)
_ROLLERS = RollerBearing(count=14, diameter=9e-3, length=13.6e-3, pitch_diameter=53.5e-3)
_BEARINGS: dict[str, tuple[BallBearing | RollerBearing, str, float | None]] = {
    "8 balls": (_BALLS, "both", TARGET),
    "8 balls, floating": (_BALLS, "none", TARGET),
    "14 rollers": (_ROLLERS, "both", None),
}
_DISPLACEMENT = (2e-5, 1e-5, 1e-4, 4e-4, -3e-4)


def figures() -> list[Figure]:
    """Return the shortest time of an evaluation of each bearing."""
    return [
        Figure(
            "rolling bearing: force, tangent", name, _microseconds(LoadedBearing(row, 1, seat)), "us", target
        )
        for name, (row, seat, target) in _BEARINGS.items()
    ]


def _microseconds(loaded: LoadedBearing) -> float:
    """CPU time of an evaluation, once compiled."""
    loaded.evaluate(_DISPLACEMENT)
    seconds = []
    for _ in range(REPEATS):
        begin = time.process_time()
        for _ in range(EVALUATIONS):
            loaded.evaluate(_DISPLACEMENT, 0.3)
        seconds.append(time.process_time() - begin)
    return 1e6 * min(seconds) / EVALUATIONS
