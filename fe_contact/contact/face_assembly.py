"""Compliance between the contact candidates of gears of finite width."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from fe_contact.compliance import FlankCompliance3D
from fe_contact.contact.face_patch import FaceGrid, FaceLoads, add_compliance, face_loads
from fe_contact.contact.patch import Patches
from fe_contact.contact.problem import Candidates, ContactProblem
from fe_contact.types import BoolArray, FloatArray, IntArray


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
    slices = candidates.slices
    compliance = np.zeros((*slices.present.shape, slices.pair.size))
    touch, face = slices.touch, slices.face_position
    sides = (
        (slices.patch_1, touch.lever_1, -slices.pair, face),
        (slices.patch_2, touch.lever_2, slices.pair, face - axial_offset),
    )
    for flank, (patches, lever, teeth, along) in zip(compliances, sides, strict=True):
        reach = flank.blocks if couple_teeth else flank.blocks[:1]
        grid = FaceGrid(flank.s, flank.z, flank.index)
        low, high = along - 0.5 * slices.slice_width, along + 0.5 * slices.slice_width
        bounds = (np.maximum(low, flank.z[0]), np.minimum(high, flank.z[-1]))
        key = KeyedFlanks(flank.key_rows, flank.key_core, couple_teeth)
        _add_gear(grid, reach, key, patches, lever, teeth, bounds, slices.present, compliance)
    first, second = (flank.contact_modulus for flank in compliances)
    contact_modulus = 1.0 / (1.0 / first + 1.0 / second)
    return ContactProblem(
        candidates, compliance, contact_modulus, 2.0 / (math.pi * first), 2.0 / (math.pi * second)
    )


class KeyedFlanks(NamedTuple):
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


def _add_gear(
    grid: FaceGrid,
    blocks: FloatArray,
    key: KeyedFlanks,
    patches: Patches,
    lever: FloatArray,
    teeth: IntArray,
    bounds: tuple[FloatArray, FloatArray],
    present: BoolArray,
    out: FloatArray,
) -> None:
    """Add the compliance of one gear at every position."""
    low, high = bounds
    for p in range(len(present)):
        here = np.flatnonzero(present[p])
        loads = face_loads(
            grid,
            *patches.by_slice(p, here),
            low[here],
            high[here],
        )
        local = np.zeros((here.size, here.size))
        add_compliance(blocks, teeth[here], loads, lever[p, here], local)
        if len(key.rows):
            local += key.compliance(teeth[here], loads) * np.outer(lever[p, here], lever[p, here])
        out[p][np.ix_(here, here)] += local
