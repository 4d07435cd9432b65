"""Loads on slices of a flank of finite width: their nodal forces, and the compliance between them.

The load of a slice follows the contact line: patches side by side, each the plane patch of
`fe_contact.contact.patch` along the profile times a box along the face. The flank is a grid of 8-node
faces whose shape functions are sums of products of one-dimensional terms, so their integrals come from
three moments of either factor.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from fe_contact.contact.patch import GAUSS_POINTS, GAUSS_WEIGHTS, patch_angles
from fe_contact.types import FloatArray, IntArray
from host.loops import njit


class FaceGrid(NamedTuple):
    """Nodes of one flank.

    Attributes
    ----------
    s : ndarray, shape (k,)
        Flank coordinates, corner and mid-side nodes in turn, m.
    z : ndarray, shape (L + 1,)
        Ends of the layers along the face, m.
    freedom : ndarray of int, shape (2 L + 1, k)
        Freedom at each plane (layer ends and middles in turn) and profile node; -1 at the centers of faces.
    """

    s: FloatArray
    z: FloatArray
    freedom: IntArray


class FaceLoads(NamedTuple):
    """Nodal forces of n unit patches: freedoms and forces (n, w); the first `used` (n,) of each count."""

    nodes: IntArray
    forces: FloatArray
    used: IntArray


@njit(cache=True)
def face_loads(
    grid: FaceGrid,
    center: FloatArray,
    half_width: FloatArray,
    edge_share: FloatArray,
    low: FloatArray,
    high: FloatArray,
) -> FaceLoads:
    """Nodal forces of unit loads on slices, each of Q equal patches side by side along its contact line.

    Parameters
    ----------
    center, half_width, edge_share : ndarray, shape (n, Q)
        See `fe_contact.contact.patch.Patches`.
    low, high : ndarray, shape (n,)
        Range of each slice along the face, m, within `grid.z`.
    """
    n, count = center.shape
    width = _most_nodes(grid, center, half_width, low, high)
    nodes = np.full((n, width), -1, dtype=np.int64)
    forces = np.zeros((n, width))
    used = np.zeros(n, dtype=np.int64)
    slot = np.full(grid.freedom.max() + 1, -1, dtype=np.int64)
    along_moments, across_moments = np.zeros(3), np.zeros(3)
    for p in range(n):
        for q in range(count):
            middle, half = center[p, q], half_width[p, q]
            left, right = _part(low[p], high[p], q, count)
            for e in range((grid.s.size - 1) // 2):
                if not _overlaps(grid.s[2 * e], grid.s[2 * e + 2], middle - half, middle + half):
                    continue
                _profile_moments(grid.s, e, middle, half, edge_share[p, q], along_moments)
                along_moments /= count
                for k in range(grid.z.size - 1):
                    if _overlaps(grid.z[k], grid.z[k + 1], left, right):
                        _box_moments(grid.z[k], grid.z[k + 1], left, right, across_moments)
                        used[p] = _add_face(
                            grid.freedom,
                            e,
                            k,
                            along_moments,
                            across_moments,
                            nodes[p],
                            forces[p],
                            slot,
                            used[p],
                        )
        for i in range(used[p]):
            slot[nodes[p, i]] = -1
    return FaceLoads(nodes, forces, used)


@njit(cache=True)
def _most_nodes(
    grid: FaceGrid, center: FloatArray, half_width: FloatArray, low: FloatArray, high: FloatArray
) -> int:
    """Return the most nodes that a slice loads, those that its patches share counted for each."""
    n, count = center.shape
    most = 0
    for p in range(n):
        needed = 0
        for q in range(count):
            along = _touched(grid.s[::2], center[p, q] - half_width[p, q], center[p, q] + half_width[p, q])
            across = _touched(grid.z, *_part(low[p], high[p], q, count))
            needed += (2 * along + 1) * (2 * across + 1)
        most = max(most, needed)
    return most


@njit(cache=True)
def _part(low: float, high: float, q: int, count: int) -> tuple[float, float]:
    """Return one of the equal parts of a range."""
    step = (high - low) / count
    return low + q * step, low + (q + 1) * step


@njit(cache=True)
def _overlaps(left: float, right: float, low: float, high: float) -> bool:
    """Whether two intervals share more than a point."""
    return right > low and left < high


@njit(cache=True)
def _touched(ends: FloatArray, low: float, high: float) -> int:
    """Count the elements between consecutive ends that the interval overlaps."""
    count = 0
    for e in range(ends.size - 1):
        count += _overlaps(ends[e], ends[e + 1], low, high)
    return count


@njit(cache=True)
def _profile_moments(
    s: FloatArray, e: int, center: float, half_width: float, edge_share: float, out: FloatArray
) -> None:
    """Moments 0 to 2 of the load on one element, in its coordinate from -1 to 1."""
    left, right = s[2 * e], s[2 * e + 2]
    start, stop = patch_angles(s, e, center, half_width)
    out[:] = 0.0
    for g in range(GAUSS_POINTS.size):
        sine = math.sin(0.5 * (start + stop) + 0.5 * (stop - start) * GAUSS_POINTS[g])
        density = (1.0 - edge_share) * 2.0 * (1.0 - sine * sine) + edge_share * (1.0 + sine)
        weight = density / math.pi * 0.5 * (stop - start) * GAUSS_WEIGHTS[g]
        x = 2.0 * (center + half_width * sine - left) / (right - left) - 1.0
        out[0] += weight
        out[1] += weight * x
        out[2] += weight * x * x


@njit(cache=True)
def _box_moments(left: float, right: float, low: float, high: float, out: FloatArray) -> None:
    """Moments 0 to 2 of a unit box load on one layer, in its coordinate from -1 to 1."""
    start = 2.0 * (max(left, low) - left) / (right - left) - 1.0
    stop = 2.0 * (min(right, high) - left) / (right - left) - 1.0
    density = 0.5 * (right - left) / (high - low)
    out[0] = density * (stop - start)
    out[1] = density * (stop**2 - start**2) / 2.0
    out[2] = density * (stop**3 - start**3) / 3.0


@njit(cache=True)
def _add_face(
    index: IntArray,
    e: int,
    k: int,
    x: FloatArray,
    y: FloatArray,
    nodes: IntArray,
    forces: FloatArray,
    slot: IntArray,
    count: int,
) -> int:
    """Add the eight nodal forces of one face; `slot` knows the nodes already there, return how many are."""
    for i in range(3):
        for j in range(3):
            if i == 1 and j == 1:
                continue
            a, b = i - 1.0, j - 1.0
            if a != 0.0 and b != 0.0:  # (1 + a x)(1 + b y)(a x + b y - 1)/4
                force = 0.25 * (
                    x[2] * y[0]
                    + x[0] * y[2]
                    - x[0] * y[0]
                    + a * b * x[1] * y[1]
                    + b * x[2] * y[1]
                    + a * x[1] * y[2]
                )
            elif b != 0.0:  # (1 - x^2)(1 + b y)/2
                force = 0.5 * (x[0] - x[2]) * (y[0] + b * y[1])
            else:  # (1 + a x)(1 - y^2)/2
                force = 0.5 * (x[0] + a * x[1]) * (y[0] - y[2])
            node = index[2 * k + j, 2 * e + i]
            if slot[node] < 0:
                slot[node] = count
                nodes[count] = node
                count += 1
            forces[slot[node]] += force
    return count


@njit(cache=True)
def add_compliance(
    blocks: FloatArray,
    tooth: IntArray,
    loads: FaceLoads,
    lever: FloatArray,
    out: FloatArray,
) -> None:
    """Add lever_i lever_j f_i' S f_j to `out` (n, n).

    Parameters
    ----------
    blocks : ndarray, shape (r + 1, f, f)
        blocks[m]: displacement on tooth j + m per force on tooth j; its transpose for -m.
    tooth : ndarray of int, shape (n,)
        Tooth of each patch, counted counter-clockwise; patches of one tooth stand together.
    lever : ndarray, shape (n,)

    Notes
    -----
    Patch i is the one on the tooth ahead: then its forces weigh whole rows of a block, which lie together in
    memory, and nothing is transposed.
    """
    moved = np.zeros(blocks.shape[1])
    needed = np.zeros(blocks.shape[1], dtype=np.int64)
    for i in range(tooth.size):
        for j in range(tooth.size):
            apart = tooth[i] - tooth[j]
            if apart < 0 or apart >= blocks.shape[0] or (apart == 0 and j < i):
                continue
            begins = j == 0 or tooth[j] != tooth[j - 1]
            if begins or i == j:
                count = _needed(tooth, loads, j, needed)
                _weigh_rows(blocks[apart], loads, i, needed[:count], moved)
            value = 0.0
            for p in range(loads.used[j]):
                value += moved[loads.nodes[j, p]] * loads.forces[j, p]
            value *= lever[i] * lever[j]
            out[i, j] += value
            if i != j:
                out[j, i] += value


@njit(cache=True)
def _needed(tooth: IntArray, loads: FaceLoads, first: int, out: IntArray) -> int:
    """List the freedoms that the patches of one tooth, from `first` on, load; return how many."""
    seen = np.zeros(out.size, dtype=np.bool_)
    count = 0
    for i in range(first, tooth.size):
        if tooth[i] != tooth[first]:
            break
        for p in range(loads.used[i]):
            node = loads.nodes[i, p]
            if not seen[node]:
                seen[node] = True
                out[count] = node
                count += 1
    return count


@njit(cache=True)
def _weigh_rows(block: FloatArray, loads: FaceLoads, i: int, needed: IntArray, moved: FloatArray) -> None:
    for a in needed:
        moved[a] = 0.0
    for q in range(loads.used[i]):
        row = block[loads.nodes[i, q]]
        force = loads.forces[i, q]
        for a in needed:
            moved[a] += row[a] * force
