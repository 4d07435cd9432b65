"""The knee of error against time: where time begins to buy little."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

DEPTH = 1e-12  # below the straight line, of its height: nearer is rounding


def knee_of(points: Mapping[str, tuple[float, float]]) -> str | None:
    """Return the point (time, error) that lies deepest below the line between the ends of the front, log-log.

    The front holds the points that no other beats in both; it goes on level from the best one to the slowest
    of all. None with fewer than three points, or where the front does not bend below the line.
    """
    if len(points) < 3 or any(value <= 0.0 for point in points.values() for value in point):
        return None
    front: list[str] = []
    for name in sorted(points, key=lambda name: points[name]):
        if not front or points[name][1] < points[front[-1]][1]:
            front.append(name)
    slowest = max(time for time, _ in points.values())
    corners = [*(points[name] for name in front), (slowest, points[front[-1]][1])]
    time, error = np.log(np.array(corners)).T
    if time[-1] <= time[0] or error[0] <= error[-1]:
        return None
    depth = (error[0] - error) / (error[0] - error[-1]) - (time - time[0]) / (time[-1] - time[0])
    deepest = int(np.argmax(depth[: len(front)]))
    return front[deepest] if depth[deepest] > DEPTH else None
