"""Unit-load stress of the tooth roots over the face width.

A stress is a row r of numbers by which it is made of the displacements of a sector. Passed up the elimination
tree like a force, it becomes a row on the kept freedoms, flank f and cuts c. With the flank compliance A and
the transmission B of the sector on held cuts (see `cyclic_ring`),

    sigma = r_f u_f + r_c u_c = r_f A q + (r_c + r_f B') u_c,

and u_c on every sector follows from the harmonics of the ring.
"""

from __future__ import annotations

import numpy as np

from fe_contact.compliance.condensed_gear import CondensedGear, CondensedTooth, condensed_tooth
from fe_contact.compliance.cyclic_compliance import SOLVER
from fe_contact.compliance.cyclic_harmonics import LeftCuts
from fe_contact.compliance.cyclic_ring import RingSolution, even_sector, loaded_cuts
from fe_contact.compliance.gear_checks import element_forces, residual
from fe_contact.compliance.reduced_harmonics import MIN_SIGNIFICANT, row_space
from fe_contact.compliance.root_stress import (
    RootStressChecks,
    UnitRootStress,
    refuse_broken_stress,
    relative_difference,
)
from fe_contact.compliance.root_surface import COMPONENTS, RootSurface, between_nodes
from fe_contact.compliance.root_surface_3d import face_stress, quad_root, surface_elements
from fe_contact.compliance.sector_stiffness import node_axes, twist
from fe_contact.compliance.substructure import Condensation
from fe_contact.geometry import Toothing, tooth_profile
from fe_contact.geometry.root_tangent import tangent_angle
from fe_contact.mesh.bore_support import BoreSupport
from fe_contact.mesh.quad_sector import QuadSector, quad_sector
from fe_contact.mesh.sector_recipe import SectorRecipe
from fe_contact.mesh.swept_sector import SweptSector
from fe_contact.types import FloatArray
from host.optional_modules import linalg
from host.optional_modules import sparse as sp
from model_studies.stage_clock import StageClock

ROWS_AT_ONCE = 256  # stresses passed up the tree together: bounds the memory


def compute_root_stress_3d(
    gear: Toothing, recipe: SectorRecipe, reach: int, support: BoreSupport
) -> UnitRootStress:
    """Mesh, condense, close the ring, solve for the stresses and check; no cache.

    Parameters
    ----------
    gear : Toothing
        Right hand or spur.
    reach : int
        Largest distance in teeth that is kept.
    """
    clock = StageClock()
    profile = tooth_profile(gear)
    section = quad_sector(gear, recipe)
    root = quad_root(section, profile)
    clock.finish("mesh")
    tooth, loads = condensed_tooth(gear, section, recipe, support, clock)
    modes = row_space(
        even_sector(tooth.condensed).transmitted, MIN_SIGNIFICANT * np.abs(tooth.condensed.flank).max()
    )
    cuts = loaded_cuts(
        tooth.condensed, np.concatenate([modes, loads], axis=1), gear.teeth, reach, modes.shape[1]
    )
    clock.finish("ring")
    functionals = root_functionals(gear, section, tooth.sector, root)
    stress = _unit_load_stress(tooth, functionals, modes, cuts, reach)
    clock.finish("stress")
    checks = _checks(tooth, functionals, loads, cuts, stress[reach])
    clock.finish("checks")
    stations, ends = between_nodes(root.s), tooth.sector.layers.ends
    planes = np.empty(2 * len(ends) - 1)
    planes[::2], planes[1::2] = ends, 0.5 * (ends[1:] + ends[:-1])
    across = between_nodes(planes)
    shape = (2 * reach + 1, 2, COMPONENTS, across.size, stations.size, len(loads))
    return refuse_broken_stress(
        UnitRootStress(
            distance=np.arange(2 * reach + 1) - reach,
            # flank freedoms are along the outward normal
            stress=-stress.reshape(shape).swapaxes(3, 4),
            station_s=stations,
            station_z=across,
            tangent_angle=tangent_angle(profile, stations),
            s=section.s,
            z=ends,
            index=tooth.sector.flank_index,
            checks=checks,
            unknowns=gear.teeth * (tooth.sector.size - tooth.condensed.cut_size),
            seconds=clock.seconds,
            solver=SOLVER,
        )
    )


def root_functionals(
    gear: Toothing, section: QuadSector, sector: SweptSector, root: RootSurface
) -> sp.csr_array:
    """Return the rows that make root stresses of the freedoms of a sector, (2 * 3 * 2 L * p, n).

    In the order of root side, component, station across and station along.
    """
    axes = node_axes(gear, section)
    functionals = []
    for chain in root.nodes:
        elements = surface_elements(section, sector, chain, axes, twist(gear))
        rows = face_stress(elements, gear.material, sector.size)
        layers, edges = len(sector.layers.kind), len(chain) // 2
        number = np.arange(rows.shape[0]).reshape(COMPONENTS, layers, edges, 2, 2)
        functionals.append(rows[number.transpose(0, 1, 3, 2, 4).ravel()])
    return sp.csr_array(sp.vstack(functionals))


def _unit_load_stress(
    tooth: CondensedTooth, functionals: sp.csr_array, modes: FloatArray, cuts: LeftCuts, reach: int
) -> FloatArray:
    """Return the stresses (2 reach + 1, r, nf) of tooth m = -reach .. reach by forces on tooth 0."""
    retained = _on_retained(tooth.condensation, functionals)
    clamped, count = tooth.condensed, len(tooth.sector.flank)
    by_cuts = retained[:, count:] + retained[:, :count] @ clamped.transmitted.T
    stress = np.empty((2 * reach + 1, len(retained), count))
    for m in range(-reach, reach + 1):
        motion = np.concatenate([cuts.near[m], cuts.near[m - 1]])
        stress[reach + m] = (by_cuts @ motion) @ modes.T
    stress[reach] += retained[:, :count] @ clamped.flank
    return stress


def _on_retained(condensation: Condensation, rows: sp.csr_array) -> FloatArray:
    """Return the rows (r, k) on the kept freedoms of a condensation that stand for `rows` (r, n) on all.

    The transpose of `Condensation.expand`: what a front eliminates it hands to its border.
    """
    functionals = np.empty((rows.shape[0], len(condensation.retained)))
    for start in range(0, rows.shape[0], ROWS_AT_ONCE):
        part = np.asfortranarray(rows[start : start + ROWS_AT_ONCE].T.toarray())
        for front in reversed(condensation.factors):
            inner = part[front.front.inner]
            used = np.flatnonzero(inner.any(axis=0))
            if used.size:
                solved = linalg.blas.dtrsm(1.0, front.factor, np.asfortranarray(inner[:, used]), lower=1)
                part[np.ix_(front.front.border, used)] -= front.coupling @ solved
        functionals[start : start + ROWS_AT_ONCE] = part[condensation.retained].T
    return functionals


def _checks(
    tooth: CondensedTooth, functionals: sp.csr_array, loads: FloatArray, cuts: LeftCuts, stress: FloatArray
) -> RootStressChecks:
    """Compare with the displacement of all nodes under the first of `loads`."""
    ring = RingSolution(np.empty((0, len(loads), len(loads))), cuts.everywhere)
    gear = CondensedGear(*tooth, ring)
    values = np.concatenate([gear.flank(0, loads)[:, :1], gear.cuts(0)[:, :1]])
    field = gear.condensation.expand(values)[:, 0]
    forces = element_forces(gear.sector, gear.stiffness, field)
    return RootStressChecks(
        residual=residual(gear, forces, loads[:, :1], np.eye(len(ring.left))[0]),
        recovery=relative_difference(stress @ loads[:, 0], functionals @ field),
    )
