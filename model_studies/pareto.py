"""The front of error against time, and its knee."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np


def front_of(points: Mapping[str, tuple[float, float]]) -> tuple[str, ...]:
    """Return the names of the Pareto-optimal points (time, error), the fastest first."""
    best = float("inf")
    front = []
    for name in sorted(points, key=lambda key: points[key]):
        if points[name][1] < best:
            best = points[name][1]
            front.append(name)
    return tuple(front)


def knee_of(points: Mapping[str, tuple[float, float]]) -> str | None:
    """Return the point after which time buys least: the deepest below the line between the ends, log-log.

    The curve is the front, and from its last point on level to the slowest point. None with fewer than three
    points, or if it nowhere bends below the line.
    """
    front = front_of(points)
    if len(points) < 3 or any(value <= 0.0 for point in points.values() for value in point):
        return None
    corners = [points[name] for name in front]
    slowest = max(time for time, _ in points.values())
    time, error = np.log(np.array([*corners, (slowest, corners[-1][1])])).T
    if time[-1] <= time[0] or error[0] <= error[-1]:
        return None
    x, y = (time - time[0]) / (time[-1] - time[0]), (error[0] - error) / (error[0] - error[-1])
    below = (y - x)[: len(front)]
    deepest = int(np.argmax(below))
    return front[deepest] if below[deepest] > 1e-12 else None
