"""Rims of the openings of a surface, and caps that close them."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from dynamics.types import FloatArray, IntArray


def rims(triangles: IntArray) -> list[IntArray]:
    """Return the nodes along every open edge path of a surface, each path closed, in its panels' sense.

    Parameters
    ----------
    triangles : (T, 3) int array
        Consistently oriented.
    """
    starts, ends = triangles.ravel(), np.roll(triangles, -1, axis=1).ravel()
    count = int(triangles.max()) + 1
    open_edge = ~np.isin(starts * count + ends, ends * count + starts)
    onward: dict[int, list[int]] = {}
    for start, end in zip(starts[open_edge].tolist(), ends[open_edge].tolist(), strict=True):
        onward.setdefault(start, []).append(end)
    return [rim for first in list(onward) for rim in _walk(first, onward)]


def _walk(first: int, onward: dict[int, list[int]]) -> Iterator[IntArray]:
    """Take the edges from a node on until it has none; whenever a node comes twice, that part is a rim.

    As many edges enter a node as leave it, so that the walk ends where it began.
    """
    path = [first]
    while onward[path[-1]]:
        node = onward[path[-1]].pop()
        if node not in path:
            path.append(node)
            continue
        start = path.index(node)
        yield np.array(path[start:])
        del path[start + 1 :]


def cap(points: FloatArray, rim: IntArray, first: int) -> tuple[IntArray, FloatArray]:
    """Return triangles (C, 3) that close a rim, and their new nodes as weights of the rim's nodes, (K, R).

    Rings of nodes between the rim and its middle, the last, are as far apart as the nodes of the rim. The new
    nodes are numbered from `first` on.
    """
    count = rim.size
    even = np.full((count, count), 1.0 / count)
    radius = np.linalg.norm(points[rim] - points[rim].mean(axis=0), axis=1).max()
    edge = np.linalg.norm(points[rim] - points[np.roll(rim, 1)], axis=1).max()
    parts = max(int(np.ceil(radius / edge)), 1)
    inward = [even * k / parts + np.eye(count) * (1.0 - k / parts) for k in range(1, parts)]
    weights = np.concatenate([*inward, even[:1]])
    rings = np.vstack([rim, first + np.arange((parts - 1) * count).reshape(parts - 1, count)])
    triangles = [
        np.stack([[b, a, c], [b, c, d]], axis=0).transpose(0, 2, 1).reshape(-1, 3)
        for a, c in pairwise(rings)
        for b, d in [(np.roll(a, -1), np.roll(c, -1))]
    ]
    last = rings[-1]
    middle = np.full(count, first + len(weights) - 1)
    return np.concatenate([*triangles, np.stack([np.roll(last, -1), last, middle], axis=1)]), weights
