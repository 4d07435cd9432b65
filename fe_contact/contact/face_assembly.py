"""Compliance between the contact candidates of gears of finite width."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from fe_contact.compliance import FlankCompliance3D
from fe_contact.contact.assembly import NEAR, half_planes, share_of_pinion
from fe_contact.contact.face_patch import (
    FaceGrid,
    FaceLoads,
    add_compliance,
    face_loads,
    means_and_differences,
)
from fe_contact.contact.patch import Patches
from fe_contact.contact.problem import Candidates, ContactProblem, LoadedSlices
from fe_contact.types import BoolArray, FloatArray, IntArray

TOGETHER = 8
"""Number of positions that are assembled together.

The groups are always the same, since the rounding of a sum depends on the other positions of its group.
"""

_DOUBLED = ("lever", "teeth", "low", "high", "present")
"""Arrays of `_FaceGear` that have two entries for each slice in `_DisplacedGear`."""


def face_contact_problem(
    candidates: Candidates,
    compliances: tuple[FlankCompliance3D, FlankCompliance3D],
    axial_offset: float = 0.0,
    couple_teeth: bool = True,
) -> ContactProblem:
    """Assemble the compliance between slices from condensed flanks.

    Pairs and teeth are numbered as in `contact_problem`.

    Parameters
    ----------
    candidates : Candidates
        Candidates that press on n slices of the tooth pairs.
    compliances : (FlankCompliance3D, FlankCompliance3D)
        Driving and driven gear.
    axial_offset : float
        Distance of the driven gear's mid-face from the driving gear's, m.
    couple_teeth : bool
        Whether the load on one tooth moves the others.
    """
    compliance = np.zeros((*candidates.slices.present.shape, candidates.slices.pair.size))
    diagonals = []
    for gear in _face_gears(candidates.slices, compliances, axial_offset, couple_teeth):
        for rows, added in gear.compliances():
            compliance[rows] += added
        diagonals.append(np.einsum("pii->pi", compliance).copy())
    planes, modulus = half_planes(compliances)
    return ContactProblem(candidates, compliance, modulus, *planes, share_1=share_of_pinion(*diagonals))


def with_face_tilt(
    problem: ContactProblem,
    compliances: tuple[FlankCompliance3D, FlankCompliance3D],
    axial_offset: float = 0.0,
    couple_teeth: bool = True,
) -> ContactProblem:
    """Add the `tilt` of the flanks to a problem; for the parameters see `face_contact_problem`."""
    tilt = np.zeros(problem.compliance.shape)
    for gear in _face_gears(problem.candidates.slices, compliances, axial_offset, couple_teeth):
        for rows, added in gear.displaced().compliances():
            tilt[rows] += added[:, 1::2, ::2]  # motions by displaced loads, under patches
    return replace(problem, tilt=tilt)


class KeyedFlanks(NamedTuple):
    """Additional compliance by a keyed bore: r' C r of the rows r of two teeth and the core C."""

    rows: FloatArray
    """Rows by tooth from -s to s. Shape (2 s + 1, q, f)."""
    core: FloatArray
    """Shape (q, q)."""
    couple_teeth: bool
    """Whether the load on one tooth moves another."""

    def compliance(self, tooth: IntArray, loads: FaceLoads) -> FloatArray:
        """Return the compliance (n, n) between unit loads on the teeth (n,), m/N."""
        rows = self.rows[tooth + len(self.rows) // 2]
        motion = np.empty((len(tooth), rows.shape[1]))
        for i, used in enumerate(loads.used):
            motion[i] = rows[i][:, loads.nodes[i, :used]] @ loads.forces[i, :used]
        added = motion @ self.core @ motion.T
        return added if self.couple_teeth else np.where(tooth[:, None] == tooth, added, 0.0)


@dataclass(frozen=True)
class _FaceGear:
    """One gear over the face. `tip` is +1 on gear 1 and -1 on gear 2; see `add_compliance`."""

    grid: FaceGrid
    blocks: FloatArray
    key: KeyedFlanks
    patches: Patches
    lever: FloatArray
    teeth: IntArray
    low: FloatArray
    high: FloatArray
    tip: float
    present: BoolArray

    def compliances(self) -> Iterator[tuple[IntArray, FloatArray]]:
        """Yield groups of positions, and the compliance of the gear (P, n, n) at each group."""
        planes = self.grid.freedom.ravel()
        order = planes[planes >= 0]
        for rows in together(len(self.present)):
            at = np.array(np.nonzero(self.present[rows]))  # position in the group, and slice
            loads, arms = self._loads(rows[at[0]], at[1]), np.ascontiguousarray(self.lever[rows])
            added = np.zeros((rows.size, self.teeth.size, self.teeth.size))
            add_compliance(self.blocks, order, self.teeth, loads, at, arms, added)
            for p in range(rows.size) if len(self.key.rows) else ():
                at_position = at[0] == p
                on = at[1, at_position]
                by_key = self.key.compliance(self.teeth[on], loads.rows(at_position))
                added[p][np.ix_(on, on)] += by_key * np.outer(arms[p, on], arms[p, on])
            yield rows, added

    def displaced(self) -> _DisplacedGear:
        """Return the gear with two loads on each slice: the patch, and its derivative by a displacement."""
        doubled = {name: np.repeat(getattr(self, name), 2, axis=-1) for name in _DOUBLED}
        return _DisplacedGear(**(vars(self) | doubled))

    def _loads(self, position: IntArray, on: IntArray) -> FaceLoads:
        return face_loads(self.grid, *self.patches.by_slice(position, on), self.low[on], self.high[on])


class _DisplacedGear(_FaceGear):
    """A gear whose loads are alternately a patch and its change per m towards tip 1.

    Patches near an edge would yield more than a strip there does. Here all patches count as plain ones that
    do not reach an edge.
    """

    def _loads(self, position: IntArray, on: IntArray) -> FaceLoads:
        center, _, _ = self.patches.by_slice(position[::2], on[::2] // 2)  # two loads on each slice
        widest = self.patches.half_width.max()
        near = NEAR * widest
        center = np.minimum(center, self.grid.s[-1] - widest - near)
        alike = np.full(center.shape, widest), np.zeros(center.shape), self.low[on[::2]], self.high[on[::2]]
        above, below = (face_loads(self.grid, center + way, *alike) for way in (near, -near))
        return means_and_differences(above, below, 0.5 * self.tip / near)


def _face_gears(
    slices: LoadedSlices,
    compliances: tuple[FlankCompliance3D, FlankCompliance3D],
    axial_offset: float,
    couple_teeth: bool,
) -> Iterator[_FaceGear]:
    """Yield the driving and the driven gear over the face."""
    touch, face = slices.touch, slices.face_position
    sides = (
        (slices.patch_1, touch.lever_1, -slices.pair, face, 1.0),
        (slices.patch_2, touch.lever_2, slices.pair, face - axial_offset, -1.0),
    )
    for flank, (patches, lever, teeth, middle, tip) in zip(compliances, sides, strict=True):
        blocks = flank.blocks if couple_teeth else flank.blocks[:1]
        grid = FaceGrid(flank.s, flank.z, flank.index)
        low = np.maximum(middle - 0.5 * slices.slice_width, flank.z[0])
        high = np.minimum(middle + 0.5 * slices.slice_width, flank.z[-1])
        key = KeyedFlanks(flank.key_rows, flank.key_core, couple_teeth)
        yield _FaceGear(grid, blocks, key, patches, lever, teeth, low, high, tip, slices.present)


def together(count: int) -> list[IntArray]:
    """Return the groups of positions, `count` in all, that are assembled together.

    No group has one position alone, unless it is the only one: its arrays would differ in memory order.
    """
    return np.split(np.arange(count), np.arange(TOGETHER, count - 1, TOGETHER))
