"""A gear condensed to its flanks over the face.

A sector is the part of the gear with one tooth. Its cuts are the faces to the neighboring sectors.
Condensation expresses all freedoms of a sector by those of its flank and cuts; the sectors close to a ring.
The flank has a coordinate s along the profile and z along the face. Its element faces have eight nodes:
element k has the profile nodes 2k, 2k + 1, 2k + 2, and so along z. Shapes: nf flank freedoms, nc freedoms of
a cut, p loads.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

import numpy as np

from fe_contact.compliance.cyclic_ring import FreeTurn, HeldSector, RingSolution, close_ring, hold_sector
from fe_contact.compliance.elimination_tree import sector_tree
from fe_contact.compliance.sector_stiffness import ElementStiffness, sector_stiffness
from fe_contact.compliance.substructure import Condensation, condense
from fe_contact.geometry import Toothing, tooth_profile
from fe_contact.mesh.bore_support import BoreSupport
from fe_contact.mesh.quad_sector import QuadSector
from fe_contact.mesh.sector_recipe import SectorRecipe
from fe_contact.mesh.swept_sector import SweptSector, swept_sector
from fe_contact.types import FloatArray, IntArray
from model_studies.stage_clock import StageClock

# Share of a uniform pressure that the nodes of an eight-node face carry, by its 3 nodes along z and s; the
# middle is no node.
FACE_SHARES = np.array([[-1.0, 4.0, -1.0], [4.0, 0.0, 4.0], [-1.0, 4.0, -1.0]]) / 12.0


@dataclass(frozen=True)
class CondensedGear:
    """A condensed gear: mesh, matrices and factors of one sector, and the ring that sectors close."""

    sector: SweptSector
    """Mesh of one sector."""
    stiffness: ElementStiffness
    """Element matrices of the sector."""
    condensation: Condensation
    """Map from the kept freedoms (flank, left cut, right cut) to all freedoms of the sector."""
    condensed: HeldSector
    """Sector condensed on its cuts."""
    ring: RingSolution
    """Solution of the ring under the loads `probe_loads`."""

    def flank(self, tooth: int, loads: FloatArray) -> FloatArray:
        """Return the flank displacements (nf, p) of a tooth under the probe `loads` (nf, p) on tooth 0."""
        direct = self.condensed.flank @ loads if tooth == 0 else 0.0
        return np.asarray(direct + self.condensed.transmitted.T @ self.cuts(tooth))

    def cuts(self, tooth: int) -> FloatArray:
        """Return the displacement of the left and right cut of a tooth under the probe loads, (2 nc, p)."""
        return np.concatenate([self.ring.left[tooth], self.ring.left[tooth - 1]])

    def cut_forces(self, tooth: int, loads: FloatArray | None = None) -> FloatArray:
        """Return the forces (2 nc, p) that move a sector's cuts as they move, under flank `loads` (nf, p)."""
        passed = 0.0 if loads is None else self.condensed.transmitted @ loads
        return np.asarray(self.condensed.cuts @ self.cuts(tooth) - passed)


def pressure_forces(s: FloatArray, z: FloatArray, index: IntArray, loaded: FloatArray) -> FloatArray:
    """Return the consistent forces (nf,) of a pressure on the elements of the flank.

    `s` and `z`: coordinates of the nodes along the profile and of the layers' ends, m. `index`: freedoms of
    the nodes by z and s. `loaded` (layers, elements): pressure per unit of s and z.
    """
    forces = np.zeros(index.max() + 1)
    areas = loaded * np.diff(z)[:, None] * (s[2::2] - s[:-2:2])
    planes, profile = len(index) - 2, len(s) - 2
    for i in range(3):
        for j in range(3):
            nodes = index[i : i + planes : 2, j : j + profile : 2]
            if i != 1 or j != 1:
                np.add.at(forces, nodes, FACE_SHARES[i, j] * areas)
    return forces


def probe_loads(s: FloatArray, z: FloatArray, index: IntArray, s_form: float) -> FloatArray:
    """Return two loads (nf, 2): unit pressure on the whole involute, and on its uppermost layer.

    Elements that begin below `s_form` carry nothing, since their normals miss the base circle.
    """
    whole = np.broadcast_to(s[:-2:2] >= s_form, (len(z) - 1, len(s) // 2)).astype(float)
    uppermost = np.zeros_like(whole)
    uppermost[-1] = whole[-1]
    return np.stack([pressure_forces(s, z, index, part) for part in (whole, uppermost)], axis=1)


def condensed_gear(
    gear: Toothing,
    section: QuadSector,
    recipe: SectorRecipe,
    reach: int,
    support: BoreSupport,
    clock: StageClock,
) -> tuple[CondensedGear, FloatArray]:
    """Sweep, condense one sector and close the ring.

    Parameters
    ----------
    gear : Gear
        Gear with right-hand helix or spur.
    reach : int
        Largest distance in teeth that is kept.
    clock : StageClock
        Gets the stages ``assembly``, ``condensation``, ``ring`` and their progress.

    Returns
    -------
    CondensedGear, (nf, p) array
        The solution and the loads `probe_loads` it was solved for, N.
    """
    tooth, loads = condensed_tooth(gear, section, recipe, support, clock)
    free = free_turn(section, tooth.sector)
    ring = close_ring(tooth.condensed, gear.teeth, reach, loads, free, partial(clock.progress, "ring"))
    clock.finish("ring")
    return CondensedGear(*tooth, ring), loads


class CondensedTooth(NamedTuple):
    """One condensed sector before the ring is closed: the first four fields of a `CondensedGear`."""

    sector: SweptSector
    stiffness: ElementStiffness
    condensation: Condensation
    condensed: HeldSector


def condensed_tooth(
    gear: Toothing, section: QuadSector, recipe: SectorRecipe, support: BoreSupport, clock: StageClock
) -> tuple[CondensedTooth, FloatArray]:
    """Sweep and condense one sector; parameters are those of `condensed_gear`.

    Returns
    -------
    CondensedTooth, (nf, 2) array
        The sector, and probe loads for the checks, N.
    """
    sector = swept_sector(section.grid, gear.face_width, recipe, support, gear.web)
    stiffness = sector_stiffness(gear, section, sector)
    clock.finish("assembly")
    report = partial(clock.progress, "condensation")
    matrix, condensation = condense(sector_tree(sector), sector.element_freedoms, stiffness, report)
    clock.finish("condensation")
    clamped = hold_sector(matrix, len(sector.loaded))
    s_form = tooth_profile(gear).s_form
    loads = np.zeros((len(sector.loaded), 2))
    loads[: len(sector.flank)] = probe_loads(section.s, sector.layers.ends, sector.flank_index, s_form)
    return CondensedTooth(sector, stiffness, condensation, clamped), loads


def free_turn(section: QuadSector, sector: SweptSector) -> FreeTurn | None:
    """Return the rotation of a gear's sector that only a key prevents; None: the bore is fixed otherwise."""
    if sector.seat.key is None:
        return None
    # a rotation by 1 rad in the cylindrical directions of the nodes: the second, tangential, by the radius
    radius = np.zeros((len(sector.freedoms), 3))
    planes, columns = np.nonzero(sector.nodes >= 0)
    radius[sector.nodes[planes, columns], 1] = np.linalg.norm(section.points, axis=1)[columns]
    turn = np.zeros(sector.size)
    turn[sector.freedoms[sector.freedoms >= 0]] = radius[sector.freedoms >= 0]
    return FreeTurn(turn[sector.left], len(sector.flank), sector.key_cut)
