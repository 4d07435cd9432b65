"""Compliance between the contact candidates of gears in the transverse plane."""

from __future__ import annotations

import math

import numpy as np

from fe_contact.compliance import FlankCompliance, FlankCompliance3D
from fe_contact.contact.patch import Patches, load_vector
from fe_contact.contact.problem import Candidates, ContactProblem, LoadedSlices
from fe_contact.types import BoolArray, FloatArray, IntArray
from host.loops import njit

NEAR = 1e-3
"""Distance over half a patch, by which patches are displaced for the derivative of their forces."""

_STRETCH = 0.25
"""Relative change of the length of a patch at an edge, for the derivative of its forces."""


def share_of_pinion(pinion: FloatArray, both: FloatArray) -> FloatArray:
    """Return the share of gear 1 in compliances (P, n) of both gears, 0.5 where these are zero."""
    return np.asarray(np.divide(pinion, both, out=np.full(both.shape, 0.5), where=both > 0.0))


def contact_problem(
    candidates: Candidates,
    compliances: tuple[FlankCompliance, FlankCompliance],
    couple_teeth: bool = True,
) -> ContactProblem:
    """Assemble the compliance of plane candidates from the condensed flanks.

    Parameters
    ----------
    candidates : Candidates
        n candidates, one per tooth pair.
    compliances : (FlankCompliance, FlankCompliance)
        Driving and driven gear, per unit face width.
    couple_teeth : bool
        False neglects the motion of one tooth by the load on another.

    Notes
    -----
    A force on a tip corner acts along the mating flank's normal, which is inclined to the normal of the tip
    gear's own flank. The tip gear moves less along that line than along its own normal, and by reciprocity a
    force along it moves the gear less: both change with the lever arm of the line, as in a rotation. Without
    this the stiffness at corners would be up to 4 % too low, and the error of STE would grow with load.

    That holds for a gear that turns about its axis. Under the load on its edge a tooth also bends about its
    root, and the wedge at the tip yields across: by the finite elements the motion along the flank is kappa
    times that of a rotation, and 1 + kappa (lever - 1) takes the place of the lever.

    At edges the tilt is that of patches that grow from the edge, less the logarithm in the local law.

    Pair +1 is ahead in the sense of rotation. The load turns a gear counter-clockwise in its tooth frame; the
    driving gear turns against its load and the driven one with it, so that pair j is on tooth -j of gear 1
    and on tooth +j of gear 2.
    """
    slices = candidates.slices
    compliance, tilt = np.zeros((2, *slices.present.shape, slices.pair.size))
    touch = slices.touch
    patches = slices.patch_1, slices.patch_2
    sides = ((touch.lever_1, 1.0), (touch.lever_2, -1.0))
    diagonals = []
    for g, (flank, (lever, tip), direction) in enumerate(zip(compliances, sides, (-1, 1), strict=True)):
        blocks = _tooth_blocks(flank, direction * slices.pair)
        rows = np.ascontiguousarray  # one order in memory: compiled once
        displaced, distance = _displaced(patches[g], patches[1 - g], slices.edge_side, tip, flank.s[-1])
        along = rows(flank.along) / slices.tip_inclinations[g]
        levers = rows(lever)
        _add_gear(
            flank.s,
            blocks,
            along,
            displaced,
            distance,
            levers,
            slices.present,
            couple_teeth,
            compliance,
            tilt,
        )
        diagonals.append(np.einsum("pii->pi", compliance).copy())
    planes, modulus = half_planes(compliances)
    diagonal = np.arange(slices.pair.size)
    tilt[:, diagonal, diagonal] += _logarithm_at_edges(slices, planes)
    return ContactProblem(
        candidates,
        compliance / slices.width,
        modulus,
        *planes,
        tilt / slices.width,
        share_of_pinion(*diagonals),
    )


def half_planes(
    flanks: tuple[FlankCompliance, FlankCompliance] | tuple[FlankCompliance3D, FlankCompliance3D],
) -> tuple[tuple[float, float], float]:
    """Return 2 (1 - nu^2)/(pi E) of both gears in 1/Pa, and the contact modulus in Pa."""
    first, second = (flank.contact_modulus for flank in flanks)
    return (2.0 / (math.pi * first), 2.0 / (math.pi * second)), 1.0 / (1.0 / first + 1.0 / second)


def _tooth_blocks(flank: FlankCompliance, teeth: IntArray) -> FloatArray:
    """Return the compliance between the flanks of the teeth (n, n, k, k)."""
    k = flank.s.size
    rows = teeth - flank.teeth[0]
    if rows.min() < 0 or rows.max() >= flank.teeth.size:
        raise ValueError(f"teeth {teeth.tolist()} are not all condensed: {flank.teeth.tolist()}")
    blocks = flank.matrix.reshape(flank.teeth.size, k, flank.teeth.size, k)
    return np.ascontiguousarray(blocks[rows][:, :, rows].transpose(0, 2, 1, 3))


def _displaced(
    patch: Patches, mate: Patches, side: FloatArray, tip: float, end: float
) -> tuple[FloatArray, FloatArray]:
    """Return patches of one gear, the same displaced down and up for a derivative, and the distance of these.

    The patches (3, 3, P, n) are, in this order, the given ones, the lower and the upper ones, each by center,
    half-width and edge share. The distance from lower to upper ones (P, n) in m is positive towards tip 1.
    Patches at an edge become shorter and longer instead, the others count as plain ones of the greatest
    width.

    Parameters
    ----------
    patch, mate : Patches
        Patches of this gear and of the other one.
    side : ndarray, shape (P, n)
        See `LoadedSlices.edge_side`.
    tip : float
        +1 on gear 1 and -1 on gear 2.
    end : float
        Flank coordinate of the tip edge, m.
    """
    short, long = patch.stretched(-_STRETCH, mate), patch.stretched(_STRETCH, mate)
    widest = patch.half_width.max()
    step, highest = NEAR * widest, end - widest
    above = np.minimum(patch.center + step, highest)
    plain = np.full(above.shape, widest), np.zeros(above.shape)
    at_edge = side != 0.0
    low, high = (
        np.where(at_edge, (stretched.center, stretched.half_width, stretched.edge_share), (center, *plain))
        for stretched, center in ((short, above - 2.0 * step), (long, above))
    )
    spread = 2.0 * _STRETCH * np.where(patch.at_tip, patch.edge_distance, mate.edge_distance)
    distance = np.where(at_edge, side * spread, tip * 2.0 * step)
    return np.stack([(patch.center, patch.half_width, patch.edge_share), low, high]), distance


def _logarithm_at_edges(slices: LoadedSlices, planes: tuple[float, float]) -> FloatArray:
    """Return half of how the logarithm in the local law falls as strips at edges grow (P, n), 1/N."""
    first, second = slices.half_planes(*planes)
    distance_1, distance_2 = slices.patch_1.edge_distance, slices.patch_2.edge_distance
    by_distance = np.where(slices.edge_side < 0.0, first / distance_1, second / distance_2)
    growth = math.log((1.0 + _STRETCH) / (1.0 - _STRETCH)) / (2.0 * _STRETCH)
    return np.asarray(0.5 * slices.edge_side * by_distance * growth)


@njit(cache=True)
def _add_gear(
    nodes: FloatArray,
    blocks: FloatArray,
    along: FloatArray,
    displaced: FloatArray,
    distance: FloatArray,
    lever: FloatArray,
    present: BoolArray,
    couple_teeth: bool,
    out: FloatArray,
    tilt: FloatArray,
) -> None:
    """Add b_i' S b_j of one gear for all positions to `out`, and its derivative to `tilt`.

    The derivative is that by the motion of patch i towards tip 1. `displaced` and `distance` are those of
    `_displaced`; `along` (k, k) has the motions along the flank over those of a rotation that moves the flank
    across by 1.
    """
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
                    center, half, share = displaced[k, 0, p, i], displaced[k, 1, p, i], displaced[k, 2, p, i]
                    low, high = load_vector(nodes, center, half, share, load[k, i])
                    first[i], last[i] = min(first[i], low), max(last[i], high)
        for i in range(n):
            for j in range(n):
                if (i != j and not couple_teeth) or last[i] == 0 or last[j] == 0:
                    continue
                value, change = 0.0, 0.0
                for a in range(first[i], last[i]):
                    motion, plain = 0.0, 0.0
                    for b in range(first[j], last[j]):
                        motion += blocks[i, j, a, b] * load[0, j, b]
                        plain += blocks[i, j, a, b] * (load[1, j, b] + load[2, j, b])
                    value += load[0, i, a] * motion
                    change += (load[2, i, a] - load[1, i, a]) * plain
                arms = lever[p, i] * lever[p, j]
                value, change = arms * value, arms * change
                if i == j and lever[p, i] != 1.0:
                    ends = first[i], last[i], lever[p, i]
                    value = _turned(blocks[i, i], along, load[0, i], *ends)
                    change = _turned(blocks[i, i], along, load[2, i], *ends)
                    change -= _turned(blocks[i, i], along, load[1, i], *ends)
                tilt[p, i, j] += change / (2.0 * distance[p, i])
                if j <= i:
                    out[p, i, j] += value
                if j < i:
                    out[p, j, i] += value


@njit(cache=True)
def _turned(
    block: FloatArray, along: FloatArray, load: FloatArray, first: int, last: int, lever: float
) -> float:
    """Return the motion of an edge under its own load along the mate's normal; nodes first to last - 1."""
    across = _work(block, load, first, last)
    turn = _work(along, load, first, last) / across
    return across * (1.0 + turn * (lever - 1.0)) ** 2


@njit(cache=True)
def _work(matrix: FloatArray, load: FloatArray, first: int, last: int) -> float:
    """Return b' M b of a load that acts on nodes first to last - 1."""
    value = 0.0
    for a in range(first, last):
        for b in range(first, last):
            value += load[a] * matrix[a, b] * load[b]
    return value
