"""A gear condensed to its flanks over the face, and the laws that it must keep."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from typing import NamedTuple

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from fe_contact.compliance.cyclic_ring import FreeTurn, HeldSector, RingSolution, close_ring, hold_sector
from fe_contact.compliance.elimination_tree import sector_tree
from fe_contact.compliance.flank import ComplianceChecks, left_by_rounding
from fe_contact.compliance.sector_stiffness import ElementStiffness, sector_stiffness
from fe_contact.compliance.substructure import Condensation, condense
from fe_contact.geometry import Toothing, tooth_profile
from fe_contact.mesh.quad_sector import QuadSector
from fe_contact.mesh.recipe import SectorRecipe
from fe_contact.mesh.sector_grid import BoreSupport
from fe_contact.mesh.swept_sector import SweptSector, swept_sector
from fe_contact.types import FloatArray, IntArray
from model_studies.stage_clock import StageClock

# Checks of a condensed three-dimensional gear on its uncondensed mesh, by the field of one load.


# Share of a uniform pressure that the nodes of an eight-node face carry, by plane and profile node.
FACE_SHARES = np.array([[-1.0, 4.0, -1.0], [4.0, 0.0, 4.0], [-1.0, 4.0, -1.0]]) / 12.0
INVERSE_ITERATIONS = 60


@dataclass(frozen=True)
class CondensedGear:
    """All that the checks need of one solved gear."""

    sector: SweptSector
    """Mesh of one sector."""
    stiffness: ElementStiffness
    """Its element matrices."""
    condensation: Condensation
    """How its freedoms follow from the kept ones: flank, left cut, right cut."""
    held: HeldSector
    """The sector on its cuts."""
    ring: RingSolution
    """The gear under the loads `_probe_loads`."""

    def flank(self, tooth: int, loads: FloatArray) -> FloatArray:
        """Return the flank displacements (nf, p) of a tooth under the probe `loads` (nf, p) on tooth 0."""
        own = self.held.flank @ loads if tooth == 0 else 0.0
        return np.asarray(own + self.held.transmitted.T @ self.cuts(tooth))

    def cuts(self, tooth: int) -> FloatArray:
        """Return the displacement of the left and right cut of a tooth under the probe loads, (2 nc, p)."""
        return np.concatenate([self.ring.left[tooth], self.ring.left[tooth - 1]])

    def cut_forces(self, tooth: int, loads: FloatArray | None = None) -> FloatArray:
        """Return the forces (2 nc, p) that move a sector's cuts as they move, under flank `loads` (nf, p)."""
        passed = 0.0 if loads is None else self.held.transmitted @ loads
        return np.asarray(self.held.cuts @ self.cuts(tooth) - passed)


def _pressure_forces(s: FloatArray, z: FloatArray, index: IntArray, loaded: FloatArray) -> FloatArray:
    """Return the consistent forces (nf,) of a pressure of `loaded` (L, elements) per unit of s and z."""
    forces = np.zeros(index.max() + 1)
    areas = loaded * np.diff(z)[:, None] * (s[2::2] - s[:-2:2])
    planes, profile = len(index) - 2, len(s) - 2
    for i in range(3):
        for j in range(3):
            nodes = index[i : i + planes : 2, j : j + profile : 2]
            if i != 1 or j != 1:
                np.add.at(forces, nodes, FACE_SHARES[i, j] * areas)
    return forces


def _probe_loads(s: FloatArray, z: FloatArray, index: IntArray, s_form: float) -> FloatArray:
    """Return two loads (nf, 2): unit pressure on the whole involute, and on its uppermost layer.

    Elements that begin below `s_form` carry nothing, since their normals miss the base circle.
    """
    on = np.broadcast_to(s[:-2:2] >= s_form, (len(z) - 1, len(s) // 2)).astype(float)
    end = np.zeros_like(on)
    end[-1] = on[-1]
    return np.stack([_pressure_forces(s, z, index, part) for part in (on, end)], axis=1)


def gear_checks(gear: CondensedGear, loads: FloatArray, lever: float, bore_radius: float) -> ComplianceChecks:
    """Check a gear.

    Parameters
    ----------
    gear : CondensedGear
        Solved for the probe loads `loads` (nf, 2), `_probe_loads`.
    lever : float
        Moment about the axis per unit force along the involute's inward normal, r_b cos(beta_b), m.
    bore_radius : float
        m.
    """
    load, ring, sector = loads[:, :1], gear.ring, gear.sector
    solved = replace(gear, ring=replace(ring, left=ring.solved))
    everywhere = np.tile(ring.solved.sum(axis=0), (2, 1))[:, :1]
    turning = gear.held.flank @ load * ring.shares.sum() + gear.held.transmitted.T @ everywhere
    values = [np.concatenate([each.flank(0, loads)[:, :1], each.cuts(0)[:, :1]]) for each in (gear, solved)]
    values.append(np.concatenate([turning, everywhere]))
    fields = gear.condensation.expand(np.concatenate(values, axis=1)).T
    forces = [element_forces(sector, gear.stiffness, field) for field in fields]
    cuts = np.concatenate([ring.left, np.roll(ring.left, 1, axis=0)], axis=1)[1:, :, 0]
    moved = float(np.sum(cuts @ gear.held.cuts * cuts) + np.sum(ring.left[:, :, 0] @ ring.restraining[:, 0]))
    free = sector.element_freedoms >= 0
    inside = float(np.sum(fields[0][sector.element_freedoms] * forces[0] * free))
    works = [inside + moved, float(load[:, 0] @ values[0][: len(load), 0])]
    works.append(float(load[:, 0] @ ring.blocks[0] @ load[:, 0]))
    moment = _bore_moment(solved, forces[2], bore_radius)
    diagonals = np.einsum("mii->mi", gear.stiffness.matrices)[gear.stiffness.of_element]
    added = np.bincount(sector.element_freedoms[free], diagonals[free], minlength=sector.size)
    alone = added.astype(float)  # stiffness of each freedom with all others held: the diagonal
    _, energy = left_by_rounding(alone, fields[0], load, works[0])
    unbalanced, _ = left_by_rounding(alone, fields[1], load, works[0])
    return ComplianceChecks(
        residual=residual(solved, forces[1], load, ring.shares),
        reciprocity=_reciprocity(gear, loads),
        bore_moment=abs(moment / (lever * float(load.sum() * ring.shares.sum())) - 1.0),
        energy=float(np.ptp(works) / works[0]),
        least_eigenvalue=_least_eigenvalue(ring.blocks[0]),
        residual_rounding=unbalanced,
        energy_rounding=energy,
    )


def element_forces(sector: SweptSector, stiffness: ElementStiffness, field: FloatArray) -> FloatArray:
    """Return the nodal forces (e, 60) of all elements under the displacement `field` (n,)."""
    local = np.where(sector.element_freedoms >= 0, field[sector.element_freedoms], 0.0)
    forces = np.empty_like(local)
    for batch in sector.batches:
        first = stiffness.of_element[batch.elements[0, 0]]
        matrices = stiffness.matrices[first : first + len(batch.quads)]
        forces[batch.elements] = np.einsum("mij,cmj->cmi", matrices, local[batch.elements])
    return forces


def residual(gear: CondensedGear, forces: FloatArray, load: FloatArray, shares: FloatArray) -> float:
    """Return the norm of f - K u over that of f, on all free freedoms of sector 0 with both cuts.

    `forces` (e, 60) are those of its elements; of the `load` (nf, 1) each tooth has its share. The neighbors
    act on the cuts by their condensed stiffness.
    """
    sector = gear.sector
    free = sector.element_freedoms >= 0
    inside = np.bincount(sector.element_freedoms[free], forces[free], minlength=sector.size)
    out: FloatArray = -inside.astype(float)
    out[sector.loaded] += shares[0] * load[:, 0]
    size = gear.held.cut_size
    out[sector.left] -= gear.cut_forces(1, shares[1] * load)[size:, 0]
    out[sector.right] -= gear.cut_forces(-1, shares[-1] * load)[:size, 0]
    for cut in (sector.left, sector.right):
        out[cut] -= gear.ring.restraining[:, 0]
    return float(np.linalg.norm(out) / np.linalg.norm(load))


def _bore_moment(gear: CondensedGear, forces: FloatArray, bore_radius: float) -> float:
    """Return the moment about the axis that the bore takes up under the first probe load, N m.

    The load is along the outward normal of the right flank, which turns the gear clockwise; so the reactions
    turn it counter-clockwise, positive. `forces` (e, 60) of the elements are those of harmonic 0, the sum
    over all sectors. What a key will take up is here taken by the restraint of the ring.
    """
    if gear.ring.restraint:
        return -len(gear.ring.left) * float(gear.ring.turn @ gear.ring.restraining[:, 0])
    nodes = gear.sector.nodes[:, gear.sector.grid.bore]
    on_bore = np.isin(gear.sector.elements, nodes[nodes >= 0])
    on_bore[gear.sector.bodies :] = False  # an elastic seat takes up what the bodies pass to it
    return bore_radius * float(forces.reshape(-1, 20, 3)[on_bore][:, 1].sum())


def _reciprocity(gear: CondensedGear, loads: FloatArray) -> float:
    """Return how far the work of one probe load on the other's displacement, tooth to tooth, is not mutual.

    Also the asymmetry of S_0 over its largest entry.
    """
    reach = len(gear.ring.blocks) - 1
    works = {m: loads.T @ gear.flank(m, loads) for m in range(-reach, reach + 1)}
    scale = float(np.abs(works[0]).max())
    mutual = max(float(np.abs(works[m] - works[-m].T).max()) for m in range(reach + 1)) / scale
    own = gear.ring.blocks[0]
    return max(mutual, float(np.abs(own - own.T).max() / np.abs(own).max()))


def _least_eigenvalue(matrix: FloatArray) -> float:
    """Return the least eigenvalue of a symmetric matrix by inverse iteration, minus its norm if none."""
    try:
        factor = cho_factor(matrix, lower=True)
    except np.linalg.LinAlgError:
        return -float(np.linalg.norm(matrix))
    vector = np.cos(np.arange(len(matrix), dtype=float))  # of no particular shape, and the same every time
    value = np.inf
    for _ in range(INVERSE_ITERATIONS):
        vector /= np.linalg.norm(vector)
        vector = cho_solve(factor, vector)
        last, value = value, 1.0 / float(np.linalg.norm(vector))
        if abs(last - value) <= 1e-3 * value:
            break
    return value


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
        Right hand or spur.
    reach : int
        Largest distance in teeth that is kept.
    clock : StageClock
        Gets the stages ``assembly``, ``condensation``, ``ring`` and their progress.

    Returns
    -------
    CondensedGear, (nf, p) array
        The solution and the loads `_probe_loads` it was solved for, N.
    """
    tooth, loads = condensed_tooth(gear, section, recipe, support, clock)
    free = free_turn(section, tooth.sector)
    ring = close_ring(tooth.held, gear.teeth, reach, loads, free, partial(clock.progress, "ring"))
    clock.finish("ring")
    return CondensedGear(*tooth, ring), loads


class CondensedTooth(NamedTuple):
    """One sector before it meets the others: the first four parts of a `CondensedGear`."""

    sector: SweptSector
    stiffness: ElementStiffness
    condensation: Condensation
    held: HeldSector


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
    held = hold_sector(matrix, len(sector.loaded))
    s_form = tooth_profile(gear).s_form
    loads = np.zeros((len(sector.loaded), 2))
    loads[: len(sector.flank)] = _probe_loads(section.s, sector.layers.ends, sector.flank_index, s_form)
    return CondensedTooth(sector, stiffness, condensation, held), loads


def free_turn(section: QuadSector, sector: SweptSector) -> FreeTurn | None:
    """Return how a gear moves that nothing but a key keeps from turning; None for one that cannot turn."""
    if sector.seat.key is None:
        return None
    radius = np.zeros((len(sector.freedoms), 3))
    planes, columns = np.nonzero(sector.nodes >= 0)
    radius[sector.nodes[planes, columns], 1] = np.linalg.norm(section.points, axis=1)[columns]
    turn = np.zeros(sector.size)
    turn[sector.freedoms[sector.freedoms >= 0]] = radius[sector.freedoms >= 0]
    return FreeTurn(turn[sector.left], len(sector.flank), sector.key_cut)
