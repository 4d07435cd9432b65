"""Contact problems put together: plane, over the face, with what carries the gears, in several pitches."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from fe_contact.compliance import FlankCompliance, FlankCompliance3D
from fe_contact.contact.candidates import with_gaps
from fe_contact.contact.face_patch import FaceGrid, FaceLoads, add_compliance, face_loads
from fe_contact.contact.flank_slope import rolls_at
from fe_contact.contact.model import ContactModel
from fe_contact.contact.patch import Patches, load_vector
from fe_contact.contact.plain_touch import Touch
from fe_contact.contact.problem import Candidates, ContactProblem, LoadedSlices
from fe_contact.contact.tooth_touch import tooth_touch
from fe_contact.contact.touch_cache import cached_touch
from fe_contact.geometry import ParallelAxes
from fe_contact.types import BoolArray, FloatArray, IntArray
from host.loops import njit

# The same positions in several base pitches: other teeth, hence other gaps, but the same compliance.


def in_pitches(
    pair: ParallelAxes, problem: ContactProblem, model: ContactModel, pitch: IntArray
) -> ContactProblem:
    """Put the positions of a problem into whole base pitches, and add the gaps of the teeth that meet there.

    Parameters
    ----------
    problem : ContactProblem
        P positions in [0, 1), with all other gaps in it.
    model : ContactModel
        Its `tooth_gaps` are added.
    pitch : ndarray of int, shape (R,)
        Whole base pitches, R a multiple of P: row r is position r modulo P in this pitch.

    Returns
    -------
    ContactProblem
        R positions; its compliance stays that of the P positions.

    Notes
    -----
    Pair j of pitch m is the pair of teeth that meets (m - j)-th: one pitch later each pair has moved on to
    the place of the next one. Load patches stay those of perfect pitches: micrometers of rolling are nothing
    to the bodies.
    """
    candidates = problem.candidates
    times = pitch.size // candidates.position.size

    def find() -> Touch:
        tiled = (np.concatenate([values] * times) for values in vars(candidates.touch).values())
        touch = Touch(*tiled)
        if not model.tooth_gaps:
            return touch
        return tooth_touch(pair, touch, model, pitch[:, None] - candidates.pair, candidates.face_position)

    common = candidates.touch
    touch = cached_touch(
        (pair, model.gaps, model.tooth_gaps, model.corner_contact),
        (common.roll_1, common.s_1, common.gap, candidates.face_position, candidates.pair, pitch),
        find,
    )
    moved = replace(
        candidates,
        position=np.tile(candidates.position, times) + pitch,
        touch=touch,
        width=np.concatenate([candidates.width] * times),
    )
    return problem.touching(moved)


def with_flanks(
    pair: ParallelAxes, problem: ContactProblem, model: ContactModel, touch: Touch | None = None
) -> ContactProblem:
    """Add the gaps of the model to a problem of plain involutes.

    Where patches follow the flanks, the touch says how far the middles of the strips have moved.
    `touch`: where the flanks touch, if it is known.
    """
    plain = problem.candidates
    modified = with_gaps(pair, plain, model) if touch is None else plain.touching(touch)
    if problem.tilt.size and model.sloped:
        modified = problem.candidates.following(modified.touch)
    return problem.touching(modified)


# Compliance of what carries the gears, added to that of the teeth and bodies.


def with_compliances(pair: ParallelAxes, problem: ContactProblem, model: ContactModel) -> ContactProblem:
    """Add the compliance terms of the model, at the touching points of plain involutes.

    They couple all slices of all pairs, whether or not the teeth themselves are coupled. Without terms
    the problem is returned as it is.
    """
    if not model.compliances:
        return problem
    slices = problem.candidates.slices
    touch, face = slices.touch, slices.face_position
    roll_1, roll_2 = rolls_at(pair, touch.s_1, touch.s_2)
    added = sum(term(pair, roll_1, roll_2, face) for term in model.compliances)
    return replace(problem, compliance=problem.compliance + added)


# Compliance between the contact candidates of gears of finite width.


def face_contact_problem(
    candidates: Candidates,
    compliances: tuple[FlankCompliance3D, FlankCompliance3D],
    axial_offset: float = 0.0,
    couple_teeth: bool = True,
) -> ContactProblem:
    """Assemble the compliance between slices from condensed flanks; pairs, teeth as in `contact_problem`.

    Parameters
    ----------
    candidates : Candidates
        Pressing on n slices of the tooth pairs.
    compliances : (FlankCompliance3D, FlankCompliance3D)
        Driving and driven gear.
    axial_offset : float
        Distance of the driven gear's mid-face from the driving gear's, m.
    couple_teeth : bool
        False drops what the load on one tooth moves on another.
    """
    compliance = np.zeros((*candidates.slices.present.shape, candidates.slices.pair.size))
    diagonals = []
    for gear in _face_gears(candidates.slices, compliances, axial_offset, couple_teeth):
        for rows, added in gear.compliances():
            compliance[rows] += added
        diagonals.append(np.einsum("pii->pi", compliance).copy())
    planes, modulus = _half_planes(compliances)
    return ContactProblem(candidates, compliance, modulus, *planes, share_1=share_of_pinion(*diagonals))


def share_of_pinion(pinion: FloatArray, both: FloatArray) -> FloatArray:
    """Return the share of gear 1 in compliances (P, n), 0.5 where there is none."""
    return np.asarray(np.divide(pinion, both, out=np.full(both.shape, 0.5), where=both > 0.0))


def with_face_tilt(
    problem: ContactProblem,
    compliances: tuple[FlankCompliance3D, FlankCompliance3D],
    axial_offset: float = 0.0,
    couple_teeth: bool = True,
) -> ContactProblem:
    """Add how the compliance changes along the flanks; parameters as of `face_contact_problem`."""
    tilt = np.zeros(problem.compliance.shape)
    for gear in _face_gears(problem.candidates.slices, compliances, axial_offset, couple_teeth):
        for rows, added in gear.displaced().compliances():
            tilt[rows] += added[:, 1::2, ::2]
    return replace(problem, tilt=tilt)


TOGETHER = 8
"""Positions that are assembled together, always the same ones: sums round by what is beside them."""


class _KeyedFlanks(NamedTuple):
    """Contribution of a keyed bore: rows (2 s + 1, q, f) by tooth from -s to s, core (q, q)."""

    rows: FloatArray
    core: FloatArray
    couple_teeth: bool

    def compliance(self, tooth: IntArray, loads: FaceLoads) -> FloatArray:
        """Return what is added between patches (n, n) on the teeth (n,)."""
        rows = self.rows[tooth + len(self.rows) // 2]
        moved = np.empty((len(tooth), rows.shape[1]))
        for i, (row, nodes, forces, used) in enumerate(
            zip(rows, loads.nodes, loads.forces, loads.used, strict=True)
        ):
            moved[i] = row[:, nodes[:used]] @ forces[:used]
        added = moved @ self.core @ moved.T
        return added if self.couple_teeth else np.where(tooth[:, None] == tooth, added, 0.0)


@dataclass(frozen=True)
class _FaceGear:
    """One gear over the face; `tip` is +1 on gear 1 and -1 on gear 2, other names as of `add_compliance`."""

    grid: FaceGrid
    blocks: FloatArray
    key: _KeyedFlanks
    patches: Patches
    lever: FloatArray
    teeth: IntArray
    low: FloatArray
    high: FloatArray
    tip: float
    present: BoolArray

    def compliances(self) -> Iterator[tuple[IntArray, FloatArray]]:
        """Yield positions and its compliance there (P, n, n)."""
        planes = self.grid.freedom.ravel()
        order = planes[planes >= 0]
        for rows in together(len(self.present)):
            at = np.array(np.nonzero(self.present[rows]))
            loads, arms = self._loads(rows[at[0]], at[1]), np.ascontiguousarray(self.lever[rows])
            added = np.zeros((rows.size, self.teeth.size, self.teeth.size))
            add_compliance(self.blocks, order, self.teeth, loads, at, arms, added)
            for p in range(rows.size if len(self.key.rows) else 0):
                here = at[0] == p
                on = at[1, here]
                by_key = self.key.compliance(self.teeth[on], loads.rows(here))
                added[p][np.ix_(on, on)] += by_key * np.outer(arms[p, on], arms[p, on])
            yield rows, added

    def displaced(self) -> _DisplacedGear:
        """Return it with two loads on each slice: the patches, and how they change."""
        doubled = {name: np.repeat(getattr(self, name), 2, axis=-1) for name in _DOUBLED}
        return _DisplacedGear(**(vars(self) | doubled))

    def _loads(self, position: IntArray, on: IntArray) -> FaceLoads:
        return face_loads(self.grid, *self.patches.by_slice(position, on), self.low[on], self.high[on])


_DOUBLED = ("lever", "teeth", "low", "high", "present")
_NEAR = 1e-3
"""Way over half a patch by which patches are displaced to see how their forces change."""


class _DisplacedGear(_FaceGear):
    """The same with loads in turn: of the patches as plain ones, and their change per m towards tip 1.

    Beside an edge patches give way more than a strip there does: here they count as if they were plain.
    """

    def _loads(self, position: IntArray, on: IntArray) -> FaceLoads:
        at = position[::2], on[::2] // 2
        widest = self.patches.half_width.max()
        near, center = _NEAR * widest, self.patches.by_slice(*at)[0]
        center = np.minimum(center, self.grid.s[-1] - widest - near)
        alike = np.full(center.shape, widest), np.zeros(center.shape), self.low[on[::2]], self.high[on[::2]]
        above, below = (face_loads(self.grid, center + way, *alike) for way in (near, -near))
        steep = 0.5 * self.tip / near
        plain, change = above.plus(0.5, below, 0.5), above.plus(steep, below, -steep)
        in_turn = (np.stack(each, axis=1) for each in zip(plain, change, strict=True))
        nodes, forces, used = (each.reshape(on.size, *each.shape[2:]) for each in in_turn)
        return FaceLoads(nodes, forces, used)


def _face_gears(
    slices: LoadedSlices,
    compliances: tuple[FlankCompliance3D, FlankCompliance3D],
    axial_offset: float,
    couple_teeth: bool,
) -> Iterator[_FaceGear]:
    """Yield both gears."""
    touch, face = slices.touch, slices.face_position
    sides = (
        (slices.patch_1, touch.lever_1, -slices.pair, face, 1.0),
        (slices.patch_2, touch.lever_2, slices.pair, face - axial_offset, -1.0),
    )
    for flank, (patches, lever, teeth, along, tip) in zip(compliances, sides, strict=True):
        blocks = flank.blocks if couple_teeth else flank.blocks[:1]
        grid = FaceGrid(flank.s, flank.z, flank.index)
        low = np.maximum(along - 0.5 * slices.slice_width, flank.z[0])
        high = np.minimum(along + 0.5 * slices.slice_width, flank.z[-1])
        key = _KeyedFlanks(flank.key_rows, flank.key_core, couple_teeth)
        yield _FaceGear(grid, blocks, key, patches, lever, teeth, low, high, tip, slices.present)


def together(count: int) -> list[IntArray]:
    """Return the rows of so many positions that are assembled together.

    A single row is not left by itself: it cannot be laid out in memory as many are.
    """
    return np.split(np.arange(count), np.arange(TOGETHER, count - 1, TOGETHER))


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
        False drops what the load on one tooth moves on another.

    Notes
    -----
    A corner force acts along the mating flank's normal, inclined to the tip gear's own. The tip gear moves
    less along that line than along its own normal, and by reciprocity is moved less: both scale with the
    lever arm of the line, as for a rotation. Without this the corner stiffness reads up to 4 % too low, and
    the error of STE grows with load.

    A gear that turns about its axis moves so. Under the load on its edge a tooth also bends about its root,
    and the wedge at the tip yields across: the way along the flank is kappa times that of a turn, by the
    finite elements, and 1 + kappa (lever - 1) takes the place of the lever.

    At edges the tilt is that of patches that grow from the edge, less the logarithm that the local law has.

    Pair +1 is ahead in the sense of rotation. The load turns a gear counter-clockwise in its tooth frame; the
    driving gear turns against its load and the driven one with it, so pair j lies on tooth -j of gear 1 and
    on tooth +j of gear 2.
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
        laid, way = _laid(patches[g], patches[1 - g], slices.edge_side, tip, flank.s[-1])
        along = rows(flank.along) / slices.tip_inclinations[g]
        levers = rows(lever)
        _add_gear(flank.s, blocks, along, laid, way, levers, slices.present, couple_teeth, compliance, tilt)
        diagonals.append(np.einsum("pii->pi", compliance).copy())
    planes, modulus = _half_planes(compliances)
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


def _half_planes(
    flanks: tuple[FlankCompliance, FlankCompliance] | tuple[FlankCompliance3D, FlankCompliance3D],
) -> tuple[tuple[float, float], float]:
    """Return 2 (1 - nu^2)/(pi E) of both gears in 1/Pa, and the contact modulus in Pa."""
    first, second = (flank.contact_modulus for flank in flanks)
    return (2.0 / (math.pi * first), 2.0 / (math.pi * second)), 1.0 / (1.0 / first + 1.0 / second)


def _tooth_blocks(flank: FlankCompliance, teeth: IntArray) -> FloatArray:
    """Compliance between the flanks of the teeth, shape (n, n, k, k)."""
    k = flank.s.size
    rows = teeth - flank.teeth[0]
    if rows.min() < 0 or rows.max() >= flank.teeth.size:
        raise ValueError(f"teeth {teeth.tolist()} are not all condensed: {flank.teeth.tolist()}")
    blocks = flank.matrix.reshape(flank.teeth.size, k, flank.teeth.size, k)
    return np.ascontiguousarray(blocks[rows][:, :, rows].transpose(0, 2, 1, 3))


_STRETCH = 0.25
"""Part of its length by which a patch at an edge is longer or shorter to see how its forces change."""


def _laid(
    patch: Patches, mate: Patches, side: FloatArray, tip: float, end: float
) -> tuple[FloatArray, FloatArray]:
    """Return patches of one gear as they are and on either side of that, and how far apart those lie.

    Centers, half-widths and edge shares (3, 3, P, n); ways (P, n) in m, positive towards tip 1. Patches at an
    edge grow from it, the others are displaced as if they were plain ones.

    Parameters
    ----------
    patch, mate : Patches
        Of this gear and of the other one.
    side : ndarray, shape (P, n)
        See `LoadedSlices.edge_side`.
    tip : float
        +1 on gear 1 and -1 on gear 2.
    end : float
        Flank coordinate of the tip edge, m.
    """
    short, long = patch.stretched(-_STRETCH, mate), patch.stretched(_STRETCH, mate)
    widest = patch.half_width.max()
    near, most = _NEAR * widest, end - widest
    above = np.minimum(patch.center + near, most)
    plain = np.full(above.shape, widest), np.zeros(above.shape)
    at_edge = side != 0.0
    low, high = (
        np.where(at_edge, (each.center, each.half_width, each.edge_share), (center, *plain))
        for each, center in ((short, above - 2.0 * near), (long, above))
    )
    apart = 2.0 * _STRETCH * np.where(patch.at_tip, patch.edge_distance, mate.edge_distance)
    way = np.where(at_edge, side * apart, tip * 2.0 * near)
    return np.stack([(patch.center, patch.half_width, patch.edge_share), low, high]), way


def _logarithm_at_edges(slices: LoadedSlices, planes: tuple[float, float]) -> FloatArray:
    """Return half of how the logarithm in the local law falls as strips at edges grow (P, n), 1/N."""
    first, second = slices.half_planes(*planes)
    near, far = slices.patch_1.edge_distance, slices.patch_2.edge_distance
    by_distance = np.where(slices.edge_side < 0.0, first / near, second / far)
    growth = math.log((1.0 + _STRETCH) / (1.0 - _STRETCH)) / (2.0 * _STRETCH)
    return np.asarray(0.5 * slices.edge_side * by_distance * growth)


@njit(cache=True)
def _add_gear(
    nodes: FloatArray,
    blocks: FloatArray,
    along: FloatArray,
    laid: FloatArray,
    way: FloatArray,
    lever: FloatArray,
    present: BoolArray,
    couple_teeth: bool,
    out: FloatArray,
    tilt: FloatArray,
) -> None:
    """Add b_i' S b_j of one gear for all positions, and to `tilt` how it changes as patch i moves to tip 1.

    `laid` and `way` are those of `_laid`, `along` (k, k) the motions along the flank over those of a rotation
    that moves it across by 1.
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
                    center, half, share = laid[k, 0, p, i], laid[k, 1, p, i], laid[k, 2, p, i]
                    low, high = load_vector(nodes, center, half, share, load[k, i])
                    first[i], last[i] = min(first[i], low), max(last[i], high)
        for i in range(n):
            for j in range(n):
                if (i != j and not couple_teeth) or last[i] == 0 or last[j] == 0:
                    continue
                value, change = 0.0, 0.0
                for a in range(first[i], last[i]):
                    moved, plain = 0.0, 0.0
                    for b in range(first[j], last[j]):
                        moved += blocks[i, j, a, b] * load[0, j, b]
                        plain += blocks[i, j, a, b] * (load[1, j, b] + load[2, j, b])
                    value += load[0, i, a] * moved
                    change += (load[2, i, a] - load[1, i, a]) * plain
                arms = lever[p, i] * lever[p, j]
                value, change = arms * value, arms * change
                if i == j and lever[p, i] != 1.0:
                    ends = first[i], last[i], lever[p, i]
                    value = _turned(blocks[i, i], along, load[0, i], *ends)
                    change = _turned(blocks[i, i], along, load[2, i], *ends)
                    change -= _turned(blocks[i, i], along, load[1, i], *ends)
                tilt[p, i, j] += change / (2.0 * way[p, i])
                if j <= i:
                    out[p, i, j] += value
                if j < i:
                    out[p, j, i] += value


@njit(cache=True)
def _turned(
    block: FloatArray, along: FloatArray, load: FloatArray, first: int, last: int, lever: float
) -> float:
    """Return what an edge yields to the load on it, nodes first to last - 1, along the normal of its mate."""
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
