"""Loads on slices of a flank of finite width: their nodal forces, and the compliance between them.

The load of a slice follows the contact line, as patches side by side. Each has the pressure of the plane
patch of `fe_contact.contact.patch` along the profile, and is uniform along the face. The flank is a grid of
8-node faces. Their shape functions are sums of products of one-dimensional terms, so that three moments of
the load in either direction give the nodal forces.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fe_contact.contact.elimination import dot
from fe_contact.contact.kernel import kernel
from fe_contact.contact.patch import profile_moments
from fe_contact.types import BoolArray, FloatArray, IntArray
from host.loops import inner, njit


class FaceGrid(NamedTuple):
    """Nodes of one flank."""

    s: FloatArray
    """Flank coordinates, alternately of corner and of mid-side nodes, m. Shape (k,)."""
    z: FloatArray
    """Ends of the layers along the face, m. Shape (L + 1,)."""
    freedom: IntArray
    """Degree of freedom of each node of the flank; -1 at the centers of faces. The rows are planes across the
    face, alternately ends and middles of layers. Shape (2 L + 1, k).
    """


class FaceLoads(NamedTuple):
    """Nodal forces of n unit loads."""

    nodes: IntArray
    forces: FloatArray
    """`nodes`, `forces`: Degrees of freedom that each load acts on, and its forces there. Shape (n, w) each.
    """
    used: IntArray
    """Number of entries of each row that count, from the first on. Shape (n,)."""

    def rows(self, keep: BoolArray) -> FaceLoads:
        """Return the loads selected by `keep`."""
        return FaceLoads(self.nodes[keep], self.forces[keep], self.used[keep])


@njit(cache=True)
def face_loads(
    grid: FaceGrid,
    center: FloatArray,
    half_width: FloatArray,
    edge_share: FloatArray,
    low: FloatArray,
    high: FloatArray,
) -> FaceLoads:
    """Return nodal forces of unit loads on slices, each of Q equal patches along its contact line.

    Parameters
    ----------
    center, half_width, edge_share : ndarray, shape (n, Q)
        See `fe_contact.contact.patch.Patches`.
    low, high : ndarray, shape (n,)
        Range of each slice along the face, m, within `grid.z`.
    """
    n, count = center.shape
    width = _max_nodes(grid, center, half_width, low, high)
    nodes = np.full((n, width), -1, dtype=np.int64)
    forces = np.zeros((n, width))
    used = np.zeros(n, dtype=np.int64)
    slot = np.full(grid.freedom.max() + 1, -1, dtype=np.int64)
    along_moments, across_moments = np.zeros(3), np.zeros(3)
    for p in range(n):
        for q in range(count):
            patch = center[p, q], half_width[p, q], edge_share[p, q]
            ends = _part(low[p], high[p], q, count)
            used[p] = _add_patch(
                grid,
                patch,
                ends,
                count,
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


@kernel
def _add_patch(
    grid: FaceGrid,
    patch: tuple[float, float, float],
    ends: tuple[float, float],
    count: int,
    along_moments: FloatArray,
    across_moments: FloatArray,
    nodes: IntArray,
    forces: FloatArray,
    slot: IntArray,
    used: int,
) -> int:
    """Add the nodal forces of one of `count` patches; return how many entries are used then.

    `patch`: Center, half-width and edge share. `ends`: Range of the patch along the face, m. The moments are
    overwritten. `nodes`, `forces`, `slot` and `used` are those of `_add_face`.
    """
    middle, half, edge_share = patch
    left, right = ends
    for e in range((grid.s.size - 1) // 2):
        if not _overlaps(grid.s[2 * e], grid.s[2 * e + 2], middle - half, middle + half):
            continue
        moments = profile_moments(grid.s, e, middle, half, edge_share)
        for k in range(3):
            along_moments[k] = moments[k] / count
        for k in range(grid.z.size - 1):
            if _overlaps(grid.z[k], grid.z[k + 1], left, right):
                _box_moments(grid.z[k], grid.z[k + 1], left, right, across_moments)
                used = _add_face(grid.freedom, e, k, along_moments, across_moments, nodes, forces, slot, used)
    return used


@njit(cache=True)
def means_and_differences(first: FaceLoads, second: FaceLoads, half: float) -> FaceLoads:
    """Return for each slice the mean of two loads, and `half` times their difference: 2 n loads in turn."""
    n, count, others = first.used.size, first.used.max(), second.used.max()
    nodes = np.empty((2 * n, count + others), dtype=np.int64)
    forces = np.empty((2 * n, count + others))
    _halve(first, 0, count, half, nodes, forces)
    _halve(second, count, others, -half, nodes, forces)
    for p in range(n):
        for k in range(count + others):  # numbers beyond the used ones are no forces, on any node
            if nodes[2 * p, k] < 0:
                nodes[2 * p, k] = nodes[2 * p + 1, k] = first.nodes[p, 0]
    return FaceLoads(nodes, forces, np.full(2 * n, count + others))


@kernel
def _halve(
    loads: FaceLoads, begin: int, count: int, factor: float, nodes: IntArray, forces: FloatArray
) -> None:
    """Fill columns from `begin` on with half the forces of loads, in next rows with `factor` times them."""
    for p in range(loads.used.size):
        for k in range(count):
            nodes[2 * p, begin + k] = loads.nodes[p, k]
            nodes[2 * p + 1, begin + k] = loads.nodes[p, k]
            forces[2 * p, begin + k] = 0.5 * loads.forces[p, k]
            forces[2 * p + 1, begin + k] = factor * loads.forces[p, k]


@kernel
def _max_nodes(
    grid: FaceGrid, center: FloatArray, half_width: FloatArray, low: FloatArray, high: FloatArray
) -> int:
    """Return an upper bound of the nodes that a slice loads: nodes that patches share count for each."""
    n, count = center.shape
    maximum = 0
    for p in range(n):
        needed = 0
        for q in range(count):
            middle, half = center[p, q], half_width[p, q]
            along = _touched(grid.s, 2, middle - half, middle + half)
            left, right = _part(low[p], high[p], q, count)
            across = _touched(grid.z, 1, left, right)
            needed += (2 * along + 1) * (2 * across + 1)
        maximum = max(maximum, needed)
    return maximum


@kernel
def _part(low: float, high: float, q: int, count: int) -> tuple[float, float]:
    """Return part q of a range that is divided into `count` equal parts."""
    step = (high - low) / count
    return low + q * step, low + (q + 1) * step


@kernel
def _overlaps(left: float, right: float, low: float, high: float) -> bool:
    """Return whether two intervals have more than a point in common."""
    return right > low and left < high


@kernel
def _touched(nodes: FloatArray, step: int, low: float, high: float) -> int:
    """Count the elements, between every `step`th of the nodes, that the interval overlaps."""
    count = 0
    for e in range(0, nodes.size - step, step):
        count += _overlaps(nodes[e], nodes[e + step], low, high)
    return count


@kernel
def _box_moments(left: float, right: float, low: float, high: float, out: FloatArray) -> None:
    """Fill `out` with moments 0 to 2 of a uniform unit load on one layer, in its coordinate from -1 to 1."""
    start = 2.0 * (max(left, low) - left) / (right - left) - 1.0
    stop = 2.0 * (min(right, high) - left) / (right - left) - 1.0
    density = 0.5 * (right - left) / (high - low)
    out[0] = density * (stop - start)
    out[1] = density * (stop**2 - start**2) / 2.0
    out[2] = density * (stop**3 - start**3) / 3.0


@kernel
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
    """Add the eight nodal forces of one face to `nodes` and `forces`; return how many entries are used then.

    Before, `count` entries are used. `slot` has the entry of each node, or -1 where the node has none.
    """
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
    order: IntArray,
    tooth: IntArray,
    loads: FaceLoads,
    at: IntArray,
    lever: FloatArray,
    out: FloatArray,
) -> None:
    """Add lever_i lever_j f_i' S f_j to `out` (P, n, n), at P positions near each other.

    Parameters
    ----------
    blocks : ndarray, shape (r + 1, f, f)
        blocks[m]: displacement on tooth j + m per force on tooth j; its transpose for -m.
    order : ndarray of int, shape (f,)
        The degrees of freedom plane by plane along the face.
    tooth : ndarray of int, shape (n,)
        Tooth of each slice, counted counter-clockwise; slices of one tooth stand together.
    loads : FaceLoads
    at : ndarray of int, shape (2, loads)
        Position and slice of each load.
    lever : ndarray, shape (P, n)

    Notes
    -----
    At each position an entry of a block is used once or twice only, and to fetch it from memory takes longer
    than to use it. Therefore the rows and columns that any of the positions needs are gathered once, and
    multiplied by the forces of a slice at all positions together.
    """
    ends = _ends(tooth)
    needed, rank = _needed(order, loads, at[1], ends)
    slices = _slice_forces(loads, at, lever, rank, ends)
    buffer = np.empty(needed[:, 0].max() ** 2)
    for a in range(ends.size - 1):
        for b in range(ends.size - 1):
            distance = tooth[ends[a]] - tooth[ends[b]]
            if 0 <= distance < blocks.shape[0] and (distance > 0 or a == b):
                rows, columns = needed[a, 1 : needed[a, 0] + 1], needed[b, 1 : needed[b, 0] + 1]
                _add_teeth(_gathered(blocks[distance], rows, columns, buffer), slices, ends, a, b, out)


class _SliceForces(NamedTuple):
    """Forces of n slices at P positions on the degrees of freedom of their teeth that are loaded at all."""

    low: IntArray
    width: IntArray
    """`low`, `width`: Range of the loaded degrees of freedom of its tooth on which each slice acts: the
    first, and their number. Shape (n,) each.
    """
    start: IntArray
    """Sum of the widths of all slices before each slice. Shape (n + 1,)."""
    force: FloatArray
    """Forces of all slices one after the other; those of slice i, (P, width), begin at entry P start[i]."""
    lever: FloatArray
    """Lever of the load of each slice. Shape (P, n)."""


@inner()
def _slice_forces(
    loads: FaceLoads, at: IntArray, lever: FloatArray, rank: IntArray, ends: IntArray
) -> _SliceForces:
    """Return the forces of all slices one after the other; for the arguments see `add_compliance`.

    `rank` and `ends` are those of `_needed` and `_ends`.
    """
    low, width, start = _ranges(loads, at[1], rank, ends)
    count = lever.shape[0]
    force = np.zeros(start[-1] * count)
    slices = _SliceForces(low, width, start, force, lever)
    _fill_forces(loads, at, rank, slices)
    return slices


@kernel
def _fill_forces(loads: FaceLoads, at: IntArray, rank: IntArray, slices: _SliceForces) -> None:
    """Add the nodal forces of all loads to the forces of slices."""
    count = slices.lever.shape[0]
    for r in range(at.shape[1]):
        p, i = at[0, r], at[1, r]
        begin = slices.start[i] * count + p * slices.width[i] - slices.low[i]
        for k in range(loads.used[r]):
            slices.force[begin + rank[i, loads.nodes[r, k]]] += loads.forces[r, k]


@inner()
def _gathered(block: FloatArray, rows: IntArray, columns: IntArray, buffer: FloatArray) -> FloatArray:
    """Return rows and columns of a block side by side in memory, in a part of `buffer`."""
    gathered = buffer[: rows.size * columns.size].reshape(rows.size, columns.size)
    _gather(block, rows, columns, gathered)
    return gathered


@kernel
def _gather(block: FloatArray, rows: IntArray, columns: IntArray, out: FloatArray) -> None:
    """Copy rows and columns of a block to `out`."""
    for k in range(rows.size):
        for m in range(columns.size):
            out[k, m] = block[rows[k], columns[m]]


@inner()
def _add_teeth(
    block: FloatArray, slices: _SliceForces, ends: IntArray, a: int, b: int, out: FloatArray
) -> None:
    """Add the displacements at slices of tooth a by forces on slices of tooth b, and those the other way."""
    low, width, start, forces, lever = slices
    count = lever.shape[0]
    motion = np.empty((count, block.shape[1]))
    for i in range(ends[a], ends[a + 1]):
        force = forces[start[i] * count : start[i + 1] * count].reshape(count, width[i])
        np.dot(force, block[low[i] : low[i] + width[i]], motion)
        _add_motions(motion, slices, i, (i if a == b else ends[b], ends[b + 1]), out)


@kernel
def _add_motions(
    motion: FloatArray, slices: _SliceForces, i: int, others: tuple[int, int], out: FloatArray
) -> None:
    """Add the motions (P, f) by the force on slice i at a range of other slices, and those the other way."""
    count, lever = motion.shape[0], slices.lever
    for j in range(others[0], others[1]):
        low, width = slices.low[j], slices.width[j]
        for p in range(count):
            begin = slices.start[j] * count + p * width
            value = dot(motion[p, low:], slices.force[begin:], width) * lever[p, i] * lever[p, j]
            out[p, i, j] += value
            if i != j:
                out[p, j, i] += value


@inner()
def _ends(tooth: IntArray) -> IntArray:
    """Return the index of the first slice of each tooth, and behind it the number of all slices."""
    changes = np.flatnonzero(np.diff(tooth)) + 1
    ends = np.zeros(changes.size + 2, dtype=np.int64)
    ends[1:-1], ends[-1] = changes, tooth.size
    return ends


@inner()
def _needed(order: IntArray, loads: FaceLoads, on: IntArray, ends: IntArray) -> tuple[IntArray, IntArray]:
    """Return the loaded degrees of freedom of each tooth, and the rank of each among them.

    A row of the first array is a tooth: the number of these degrees of freedom, then their indices. The
    second array (n, f) has the rank on the tooth of each slice, -1 where a degree of freedom is not loaded.
    `on`: Slice of each load.
    """
    needed = np.zeros((ends.size - 1, order.size + 1), dtype=np.int64)
    rank = np.full((ends[-1], order.size), -1, dtype=np.int64)
    for a in range(ends.size - 1):
        loaded = np.zeros(order.size, dtype=np.bool_)
        _mark(loads, on, ends[a], ends[a + 1], loaded)
        for node in order:
            if loaded[node]:
                rank[ends[a] : ends[a + 1], node] = needed[a, 0]
                needed[a, 0] += 1
                needed[a, needed[a, 0]] = node
    return needed, rank


@kernel
def _mark(loads: FaceLoads, on: IntArray, first: int, end: int, loaded: BoolArray) -> None:
    """Mark the degrees of freedom that loads on slices from `first` to before `end` act on."""
    for r in range(on.size):
        if first <= on[r] < end:
            for k in range(loads.used[r]):
                loaded[loads.nodes[r, k]] = True


@inner()
def _ranges(
    loads: FaceLoads, on: IntArray, rank: IntArray, ends: IntArray
) -> tuple[IntArray, IntArray, IntArray]:
    """Return `low`, `width` and `start` of `_SliceForces`."""
    low, high = np.full(ends[-1], rank.shape[1]), np.zeros(ends[-1], dtype=np.int64)
    _widen(loads, on, rank, low, high)
    low = np.minimum(low, high)
    start = np.zeros(ends[-1] + 1, dtype=np.int64)
    start[1:] = np.cumsum(high - low)
    return low, high - low, start


@kernel
def _widen(loads: FaceLoads, on: IntArray, rank: IntArray, low: IntArray, high: IntArray) -> None:
    """Widen the range of ranks of each slice, from low to before high (n,), by those that its loads have."""
    for r in range(on.size):
        i = on[r]
        for k in range(loads.used[r]):
            index = rank[i, loads.nodes[r, k]]
            low[i], high[i] = min(low[i], index), max(high[i], index + 1)
