"""Compliance between the contact candidates of gears in the transverse plane.

A candidate is the place where a tooth pair may touch. A patch is the area over which the finite elements of a
gear are loaded there, by nodal weights b. The compliance between candidates i and j of a gear is b_i' S b_j,
with S that of the condensed flank. The tilt of (i, j) is its derivative by the position of patch i along the
profile, towards tip 1: the angle by which a unit force on j tilts the flanks at i. The lever of a candidate
at a tip edge is the arm of its force, which acts along the mate's normal, over the arm along the tip gear's
own normal; elsewhere it is 1. Shapes: P positions, n candidates, k nodes of a flank.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from fe_contact.compliance import FlankCompliance, FlankCompliance3D
from fe_contact.contact.patch import Patches, load_vector
from fe_contact.contact.problem import Candidates, ContactProblem, LoadedSlices
from fe_contact.types import BoolArray, FloatArray, IntArray
from host.loops import njit

NEAR = 1e-3
"""Displacement of patches by which the tilt is differenced, in half-widths of the widest patch."""

_STRETCH = 0.25
"""Relative change of the length of a patch at an edge, by which the tilt is differenced there."""

_DEPARTURE = 0.2
"""Distance, in half-widths of the widest patch, over which a patch leaves the edge: from the tilt by its
length to the tilt by its position. For a soft gear these differ by 2 %; deflections follow the square.
"""


def share_of_pinion(pinion: FloatArray, both: FloatArray) -> FloatArray:
    """Return the share of gear 1 in compliances (P, n), 0.5 where there is none."""
    return np.asarray(np.divide(pinion, both, out=np.full(both.shape, 0.5), where=both > 0.0))


def contact_problem(
    candidates: Candidates, compliances: tuple[FlankCompliance, FlankCompliance], couple_teeth: bool = True
) -> ContactProblem:
    """Assemble the compliance of plane candidates from the condensed flanks.

    Parameters
    ----------
    candidates : Candidates
        n candidates, one per tooth pair.
    compliances : (FlankCompliance, FlankCompliance)
        Driving and driven gear, per unit face width.
    couple_teeth : bool
        Whether the load on one tooth moves the others.

    Notes
    -----
    A corner force acts along the mating flank's normal, which is inclined to the normal of the tip gear's
    flank. Along that line the tip gear moves less than along its own normal. By reciprocity the force moves
    it less, too: both scale with the lever, if the tooth only rotates about the gear's axis. Without this the
    corner stiffness is up to 4 % too low, and the error of STE grows with load.

    Under the load on its edge a tooth also bends about its root, and the wedge at the tip yields across. The
    displacement along the flank is then kappa times that of a rotation about the axis, with kappa from the
    finite elements, and the factor is 1 + kappa (lever - 1) instead of the lever.

    At edges the tilt is the derivative by the length of patches that grow from the edge, without the
    logarithm that the local law has already. As patches leave the edge, it becomes the derivative by their
    position.

    Pair +1 is ahead in the sense of rotation. The load turns a gear counter-clockwise in its tooth frame; the
    driving gear turns against its load and the driven one with it, so pair j lies on tooth -j of gear 1 and
    on tooth +j of gear 2.
    """
    slices = candidates.slices
    compliance, tilt = np.zeros((2, *slices.present.shape, slices.pair.size))
    diagonals, at_edge = [], _share_at_edge(slices)
    for g, flank in enumerate(compliances):
        tilt += _added_gear(_gear_flank(flank, slices, g), slices, at_edge, couple_teeth, compliance)
        diagonals.append(np.einsum("pii->pi", compliance).copy())  # of gear 1, then of both gears
    planes, modulus = half_planes(compliances)
    diagonal = np.arange(slices.pair.size)
    tilt[:, diagonal, diagonal] += at_edge * _logarithm_at_edges(slices, planes)
    return ContactProblem(
        candidates,
        compliance / slices.width,
        modulus,
        *planes,
        tilt=tilt / slices.width,
        share_1=share_of_pinion(*diagonals),
    )


def _gear_flank(flank: FlankCompliance, slices: LoadedSlices, gear: int) -> _GearFlank:
    """Return the condensed flank of gear 0 or 1 with the points at which candidates press on it."""
    patches, levers = (slices.patch_1, slices.patch_2), (slices.touch.lever_1, slices.touch.lever_2)
    tip = 1 - 2 * gear  # on gear 1 pair j lies on tooth -j, on gear 2 on tooth j
    blocks, teeth = _tooth_blocks(flank, -tip * slices.pair)
    return _GearFlank(
        nodes=flank.s,
        blocks=blocks,
        teeth=teeth,
        # rows in one order in memory: the loops are compiled once
        along=np.ascontiguousarray(flank.along) / slices.tip_inclinations[gear],
        lever=np.ascontiguousarray(levers[gear]),
        patch=patches[gear],
        mate=patches[1 - gear],
        tip=float(tip),
    )


class _GearFlank(NamedTuple):
    """Flank of one gear with its patches."""

    nodes: FloatArray
    """Flank coordinates, m. Shape (k,)."""
    blocks: FloatArray
    teeth: IntArray
    along: FloatArray
    """`blocks`, `teeth`, `along`: Compliances as `_add_gear` takes them."""
    lever: FloatArray
    """Shape (P, n)."""
    patch: Patches
    mate: Patches
    """`patch`, `mate`: Patches of this gear and of the other one."""
    tip: float
    """+1 on gear 1 and -1 on gear 2."""

    def add(
        self,
        side: FloatArray,
        present: BoolArray,
        rows: IntArray,
        couple_teeth: bool,
        out: FloatArray,
        tilt: FloatArray,
    ) -> None:
        """Add the compliance and the tilt of positions `rows` (R,); see `_laid` and `_add_gear`."""
        patch, mate, widest = self.patch.rows(rows), self.mate.rows(rows), self.patch.half_width.max()
        laid, way = _laid(patch, mate, widest, side[rows], self.tip, self.nodes[-1])
        body = self.nodes, self.blocks, self.teeth, self.along
        _add_gear(body, laid, way, self.lever[rows], present[rows], couple_teeth, out, tilt)


def _added_gear(
    gear: _GearFlank, slices: LoadedSlices, at_edge: FloatArray, couple_teeth: bool, compliance: FloatArray
) -> FloatArray:
    """Add the compliance of a gear to `compliance` (P, n, n), and return its tilt (P, n, n)."""
    side, present = slices.edge_side, slices.present
    by_length, by_position = np.zeros((2, *compliance.shape))
    gear.add(side, present, np.arange(len(side)), couple_teeth, compliance, by_length)
    share = np.where(side != 0.0, at_edge, 1.0)
    leaving = np.flatnonzero((share < 1.0).any(axis=1))
    if leaving.size:
        unused, displaced = np.zeros((2, leaving.size, *compliance.shape[1:]))
        gear.add(np.zeros(side.shape), present, leaving, couple_teeth, unused, displaced)
        by_position[leaving] = displaced
    return np.asarray(share[..., None] * by_length + (1.0 - share[..., None]) * by_position)


def _share_at_edge(slices: LoadedSlices) -> FloatArray:
    """Return the share (P, n) in which a patch is at an edge: 1, falling to 0 where it leaves the edge."""
    on_gear_1 = slices.edge_side < 0.0
    widest = np.where(on_gear_1, slices.patch_1.half_width.max(), slices.patch_2.half_width.max())
    offset = np.where(on_gear_1, slices.touch.offset_1, slices.touch.offset_2)
    return np.asarray(np.clip((1.0 - offset / widest) / _DEPARTURE, 0.0, 1.0))


def half_planes(
    flanks: tuple[FlankCompliance, FlankCompliance] | tuple[FlankCompliance3D, FlankCompliance3D],
) -> tuple[tuple[float, float], float]:
    """Return 2 (1 - nu^2)/(pi E) of both gears in 1/Pa, and the contact modulus in Pa."""
    first, second = (flank.contact_modulus for flank in flanks)
    return (2.0 / (math.pi * first), 2.0 / (math.pi * second)), 1.0 / (1.0 / first + 1.0 / second)


def _tooth_blocks(flank: FlankCompliance, teeth: IntArray) -> tuple[FloatArray, IntArray]:
    """Return the compliance by condensed teeth t and nodes, (t, k, t, k), and the rows of `teeth` in it."""
    k, count = flank.s.size, flank.teeth.size
    rows = teeth - flank.teeth[0]
    if rows.min() < 0 or rows.max() >= count:
        raise ValueError(f"teeth {teeth.tolist()} are not all condensed: {flank.teeth.tolist()}")
    return np.ascontiguousarray(flank.matrix).reshape(count, k, count, k), rows


def _laid(
    patch: Patches, mate: Patches, widest: float, side: FloatArray, tip: float, end: float
) -> tuple[FloatArray, FloatArray]:
    """Return patches of one gear and the two displaced ones of each, and the distances between those.

    The patches are an array (3, 3, P, n). Its first axis are the patch itself, the lower and the higher one;
    its second the center, half-width and edge share. The distances (P, n) from lower to higher are in m,
    positive towards tip 1. Patches at an edge are lengthened from it; the others are displaced with the
    widest half-width and no edge share.

    Parameters
    ----------
    patch, mate : Patches
        Patches of this gear and of the other one.
    widest : float
        Half-width of patches away from edges, m.
    side : ndarray, shape (P, n)
        See `LoadedSlices.edge_side`; 0: the patch is displaced.
    tip : float
        +1 on gear 1 and -1 on gear 2.
    end : float
        Flank coordinate of the tip edge, m.
    """
    short, long = patch.stretched(-_STRETCH, mate), patch.stretched(_STRETCH, mate)
    near, highest = NEAR * widest, end - widest
    above = np.minimum(patch.center + near, highest)
    plain = np.full(above.shape, widest), np.zeros(above.shape)
    at_edge = side != 0.0
    low, high = (
        np.where(at_edge, (stretched.center, stretched.half_width, stretched.edge_share), (center, *plain))
        for stretched, center in ((short, above - 2.0 * near), (long, above))
    )
    spread = 2.0 * _STRETCH * np.where(patch.at_tip, patch.edge_distance, mate.edge_distance)
    way = np.where(at_edge, side * spread, tip * 2.0 * near)
    return np.stack([(patch.center, patch.half_width, patch.edge_share), low, high]), way


def _logarithm_at_edges(slices: LoadedSlices, planes: tuple[float, float]) -> FloatArray:
    """Return half the change of the local law's logarithm as strips at edges grow (P, n), 1/N.

    The law has -half_plane ln(length). Its derivative over the same stretch as in `_laid` is `growth` over
    the distance of the patch's center from the edge.
    """
    first, second = slices.half_planes(*planes)
    distance_1, distance_2 = slices.patch_1.edge_distance, slices.patch_2.edge_distance
    by_distance = np.where(slices.edge_side < 0.0, first / distance_1, second / distance_2)
    growth = math.log((1.0 + _STRETCH) / (1.0 - _STRETCH)) / (2.0 * _STRETCH)
    return np.asarray(0.5 * slices.edge_side * by_distance * growth)


@njit(cache=True)
def _add_gear(
    body: tuple[FloatArray, FloatArray, IntArray, FloatArray],
    laid: FloatArray,
    way: FloatArray,
    lever: FloatArray,
    present: BoolArray,
    couple_teeth: bool,
    out: FloatArray,
    tilt: FloatArray,
) -> None:
    """Add b_i' S b_j of one gear for all positions to `out`, and its derivative by patch i to `tilt`.

    `laid` and `way` are those of `_laid`. `body` is nodes, blocks, teeth, along: `along` (k, k) are the
    displacements along the flank by unit forces, over those of a rotation about the axis that moves the flank
    across by 1. `blocks` (t, k, t, k) are S of all condensed teeth, and `teeth` (n,) says which of them have
    candidates. Nodes first[i] to last[i] - 1 are loaded by patch i; last[i] = 0: no such candidate.
    """
    nodes, blocks, teeth, along = body
    positions, n = present.shape
    load = np.zeros((3, n, nodes.size))
    first, last = np.zeros(n, dtype=np.int64), np.zeros(n, dtype=np.int64)
    for p in range(positions):
        for i in range(n):
            last[i] = first[i] = 0
            if present[p, i]:
                load[:, i] = 0.0
                first[i], last[i] = nodes.size, 0
                for k in range(3):
                    center, half, share = laid[k, 0, p, i], laid[k, 1, p, i], laid[k, 2, p, i]
                    low, high = load_vector(nodes, center, half, share, load[k, i])
                    first[i], last[i] = min(first[i], low), max(last[i], high)
        for i in range(n):
            for j in range(n):
                if (i != j and not couple_teeth) or last[i] == 0 or last[j] == 0:
                    continue
                value, change = 0.0, 0.0
                row, column = teeth[i], teeth[j]
                for a in range(first[i], last[i]):
                    motion, both = 0.0, 0.0  # by the patch on j, and by the lower and the higher one together
                    for b in range(first[j], last[j]):
                        motion += blocks[row, a, column, b] * load[0, j, b]
                        both += blocks[row, a, column, b] * (load[1, j, b] + load[2, j, b])
                    value += load[0, i, a] * motion
                    change += (load[2, i, a] - load[1, i, a]) * both
                arms = lever[p, i] * lever[p, j]
                value, change = arms * value, arms * change
                if i == j and lever[p, i] != 1.0:
                    ends = first[i], last[i], lever[p, i]
                    block = blocks[row, :, row]
                    value = _turned(block, along, load[0, i], *ends)
                    change = _turned(block, along, load[2, i], *ends)
                    change -= _turned(block, along, load[1, i], *ends)
                # half: `both` is twice a patch; on the diagonal both patches move, half of that is the tilt
                tilt[p, i, j] += change / (2.0 * way[p, i])
                if j <= i:
                    out[p, i, j] += value
                if j < i:
                    out[p, j, i] += value


@njit(cache=True)
def _turned(
    block: FloatArray, along: FloatArray, load: FloatArray, first: int, last: int, lever: float
) -> float:
    """Return the yield of an edge along the normal of its mate under its load on nodes first to last - 1."""
    across = _work(block, load, first, last)
    kappa = _work(along, load, first, last) / across
    return across * (1.0 + kappa * (lever - 1.0)) ** 2


@njit(cache=True)
def _work(matrix: FloatArray, load: FloatArray, first: int, last: int) -> float:
    """Return b' M b of a load that acts on nodes first to last - 1."""
    value = 0.0
    for a in range(first, last):
        for b in range(first, last):
            value += load[a] * matrix[a, b] * load[b]
    return value
