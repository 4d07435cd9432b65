"""Checks of a condensed three-dimensional gear on its uncondensed mesh, by the field of one load."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fe_contact.compliance.condensed_gear import CondensedGear
from fe_contact.compliance.flank import ComplianceChecks
from fe_contact.compliance.rounding import left_by_rounding
from fe_contact.compliance.sector_stiffness import ElementStiffness
from fe_contact.mesh.swept_sector import SweptSector
from fe_contact.types import FloatArray
from host.optional_modules import linalg

INVERSE_ITERATIONS = 60


def gear_checks(gear: CondensedGear, loads: FloatArray, lever: float, bore_radius: float) -> ComplianceChecks:
    """Check a gear.

    Parameters
    ----------
    gear : CondensedGear
        Solved for the probe loads `loads` (nf, 2), `probe_loads`.
    lever : float
        Moment about the axis per unit force along the involute's inward normal, r_b cos(beta_b), m.
    bore_radius : float
        m.
    """
    # fields of sector 0 under the first probe load: on tooth 0; with the `shares` on all teeth, which consist
    # of solved harmonics alone (`solved`); and the sum of the latter over all sectors (`turning`)
    load, ring, sector = loads[:, :1], gear.ring, gear.sector
    solved = replace(gear, ring=replace(ring, left=ring.solved))
    everywhere = np.tile(ring.solved.sum(axis=0), (2, 1))[:, :1]
    turning = gear.condensed.flank @ load * ring.shares.sum() + gear.condensed.transmitted.T @ everywhere
    values = [
        np.concatenate([solution.flank(0, loads)[:, :1], solution.cuts(0)[:, :1]])
        for solution in (gear, solved)
    ]
    values.append(np.concatenate([turning, everywhere]))
    fields = gear.condensation.expand(np.concatenate(values, axis=1)).T
    forces = [element_forces(sector, gear.stiffness, field) for field in fields]
    cuts = np.concatenate([ring.left, np.roll(ring.left, 1, axis=0)], axis=1)[1:, :, 0]
    at_cuts = float(
        np.sum(cuts @ gear.condensed.cuts * cuts) + np.sum(ring.left[:, :, 0] @ ring.restraining[:, 0])
    )
    free = sector.element_freedoms >= 0
    inside = float(np.sum(fields[0][sector.element_freedoms] * forces[0] * free))
    works = [inside + at_cuts, float(load[:, 0] @ values[0][: len(load), 0])]
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
        least_eigenvalue=least_eigenvalue(ring.blocks[0]),
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
    unbalanced: FloatArray = -inside.astype(float)
    unbalanced[sector.loaded] += shares[0] * load[:, 0]
    size = gear.condensed.cut_size
    unbalanced[sector.left] -= gear.cut_forces(1, shares[1] * load)[size:, 0]
    unbalanced[sector.right] -= gear.cut_forces(-1, shares[-1] * load)[:size, 0]
    for cut in (sector.left, sector.right):
        unbalanced[cut] -= gear.ring.restraining[:, 0]
    return float(np.linalg.norm(unbalanced) / np.linalg.norm(load))


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
    """Return the largest relative error of reciprocity between loads on two teeth.

    The work of one probe load on tooth m by the displacement under another on tooth 0 must equal that with
    both exchanged. The asymmetry of S_0 over its largest entry counts too.
    """
    reach = len(gear.ring.blocks) - 1
    works = {m: loads.T @ gear.flank(m, loads) for m in range(-reach, reach + 1)}
    scale = float(np.abs(works[0]).max())
    mutual = max(float(np.abs(works[m] - works[-m].T).max()) for m in range(reach + 1)) / scale
    block = gear.ring.blocks[0]
    return max(mutual, float(np.abs(block - block.T).max() / np.abs(block).max()))


def least_eigenvalue(matrix: FloatArray) -> float:
    """Return the least eigenvalue of a symmetric matrix by inverse iteration.

    The result is minus the norm of the matrix if it is not positive definite.
    """
    try:
        factor = linalg.cho_factor(matrix, lower=True)
    except np.linalg.LinAlgError:
        return -float(np.linalg.norm(matrix))
    vector = np.cos(np.arange(len(matrix), dtype=float))  # an arbitrary start, the same every time
    value = np.inf
    for _ in range(INVERSE_ITERATIONS):
        vector /= np.linalg.norm(vector)
        vector = linalg.cho_solve(factor, vector)
        last, value = value, 1.0 / float(np.linalg.norm(vector))
        if abs(last - value) <= 1e-3 * value:
            break
    return value
