"""Unit-load stress of the tooth roots over the face width.

A stress is a row r of numbers by which it is made of the displacements of a sector. Passed up the elimination
tree like a force, it becomes a row on the kept freedoms, flank f and cuts c. With the flank compliance A and
the transmission B of the sector on held cuts (see `cyclic_ring`),

    sigma = r_f u_f + r_c u_c = r_f A q + (r_c + r_f B') u_c,

and u_c on every sector follows from the harmonics of the ring.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from scipy.linalg import blas

from fe_contact.compliance.condensed_gear import (
    CondensedGear,
    CondensedTooth,
    condensed_tooth,
    element_forces,
    residual,
)
from fe_contact.compliance.cyclic_compliance import SOLVER
from fe_contact.compliance.cyclic_ring import LeftCuts, RingSolution, left_cuts, row_space
from fe_contact.compliance.root_stress import (
    RootStressChecks,
    UnitRootStress,
    refuse_broken_stress,
    relative_difference,
)
from fe_contact.compliance.sector_stiffness import above, cylindrical_frames, flank_frames, twist
from fe_contact.compliance.substructure import Condensation
from fe_contact.compliance.surface_stress import (
    ACROSS,
    ALONG,
    COMPONENTS,
    RootSurface,
    SurfaceElements,
    between_nodes,
    face_stress,
    quad_root,
)
from fe_contact.geometry import Toothing, tooth_profile
from fe_contact.geometry.flank_profile import tangent_angle
from fe_contact.mesh.quad_sector import QuadSector, quad_sector
from fe_contact.mesh.recipe import SectorRecipe
from fe_contact.mesh.sector_grid import BoreSupport
from fe_contact.mesh.swept_sector import SweptSector
from fe_contact.stage_clock import StageClock
from fe_contact.types import FloatArray, IntArray

ROWS_AT_ONCE = 256  # stresses passed up the tree together: bounds the memory


def compute_root_stress_3d(
    gear: Toothing, recipe: SectorRecipe, reach: int, support: BoreSupport
) -> UnitRootStress:
    """Mesh, condense, close the ring, solve for the stresses and check; no cache.

    Parameters
    ----------
    gear : Toothing
        Right hand or spur.
    recipe : SectorRecipe
        Element sizes and layers.
    reach : int
        Largest distance in teeth that is kept.
    support : BoreSupport
        How the bore is held.
    """
    clock = StageClock()
    profile = tooth_profile(gear)
    section = quad_sector(gear, recipe)
    root = quad_root(section, profile)
    clock.finish("mesh")
    tooth, loads = condensed_tooth(gear, section, recipe, support, clock)
    modes = row_space(tooth.held.transmitted)
    right = tooth.held.transmitted @ np.concatenate([modes, loads], axis=1)
    cuts = left_cuts(tooth.held, right, gear.teeth, reach, modes.shape[1])
    clock.finish("ring")
    functionals = _root_functionals(gear, section, tooth.sector, root)
    stress = _unit_load_stress(tooth, functionals, modes, cuts, reach)
    clock.finish("stress")
    checks = _checks(tooth, functionals, loads, cuts, stress[reach])
    clock.finish("checks")
    stations, ends = between_nodes(root.s), tooth.sector.layers.ends
    across = between_nodes(_with_middles(ends))
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
            unknowns=gear.teeth * (tooth.sector.size - tooth.held.cut_size),
            seconds=clock.seconds,
            solver=SOLVER,
        )
    )


def _root_functionals(
    gear: Toothing, section: QuadSector, sector: SweptSector, root: RootSurface
) -> sp.csr_array:
    """Return the rows that make root stresses of the freedoms of a sector, (2 * 3 * 2 L * p, n).

    In the order of root side, component, station across and station along.
    """
    axes = np.tile(np.eye(3), (section.grid.nodes, 1, 1))
    axes[section.grid.flank] = flank_frames(section, twist(gear))
    functionals = []
    for chain in root.nodes:
        elements = _surface_elements(section, sector, chain, axes, twist(gear))
        rows = face_stress(elements, gear.material, sector.size)
        layers, edges = len(sector.layers.kind), len(chain) // 2
        number = np.arange(rows.shape[0]).reshape(COMPONENTS, layers, edges, 2, 2)
        functionals.append(rows[number.transpose(0, 1, 3, 2, 4).ravel()])
    return sp.csr_array(sp.vstack(functionals))


def _surface_elements(
    section: QuadSector, sector: SweptSector, chain: IntArray, axes: FloatArray, turn_per_length: float
) -> SurfaceElements:
    first = 2 * np.arange(len(chain) // 2)
    on_section = chain[first[:, None] + (1 + ALONG).astype(int)]  # (e, 8)
    positions, frames, freedoms = [], [], []
    for layer, kind in enumerate(sector.layers.kind):
        thickness = float(sector.layers.thickness[kind])
        nodes = above(section.points[on_section], 0.5 * ACROSS, thickness, thickness * turn_per_length)
        positions.append(nodes)
        frames.append(cylindrical_frames(nodes) @ axes[on_section])
        freedoms.append(sector.freedoms[sector.nodes[2 * layer + (1 + ACROSS).astype(int), on_section]])
    return SurfaceElements(np.concatenate(positions), np.concatenate(frames), np.concatenate(freedoms))


def _unit_load_stress(
    tooth: CondensedTooth, functionals: sp.csr_array, modes: FloatArray, cuts: LeftCuts, reach: int
) -> FloatArray:
    """Return the stresses (2 reach + 1, r, nf) of tooth m = -reach .. reach by forces on tooth 0."""
    kept = _kept_functionals(tooth.condensation, functionals)
    held, count = tooth.held, len(tooth.sector.flank)
    by_cuts = kept[:, count:] + kept[:, :count] @ held.transmitted.T
    stress = np.empty((2 * reach + 1, len(kept), count))
    for m in range(-reach, reach + 1):
        moved = np.concatenate([cuts.near[m], cuts.near[m - 1]])
        stress[reach + m] = (by_cuts @ moved) @ modes.T
    stress[reach] += kept[:, :count] @ held.flank
    return stress


def _kept_functionals(condensation: Condensation, rows: sp.csr_array) -> FloatArray:
    """Return the rows (r, k) on the kept freedoms of a condensation that stand for `rows` (r, n) on all.

    The transpose of `Condensation.expand`: what a front eliminates it hands to its border.
    """
    functionals = np.empty((rows.shape[0], len(condensation.kept)))
    for start in range(0, rows.shape[0], ROWS_AT_ONCE):
        part = np.asfortranarray(rows[start : start + ROWS_AT_ONCE].T.toarray())
        for front in reversed(condensation.factors):
            inner = part[front.front.inner]
            used = np.flatnonzero(inner.any(axis=0))
            if used.size:
                solved = blas.dtrsm(1.0, front.factor, np.asfortranarray(inner[:, used]), lower=1)
                part[np.ix_(front.front.border, used)] -= front.coupling @ solved
        functionals[start : start + ROWS_AT_ONCE] = part[condensation.kept].T
    return functionals


def _checks(
    tooth: CondensedTooth, functionals: sp.csr_array, loads: FloatArray, cuts: LeftCuts, stress: FloatArray
) -> RootStressChecks:
    """Compare with the displacement of all nodes under the first of `loads`."""
    ring = RingSolution(np.empty((0, len(loads), len(loads))), cuts.everywhere, len(stress))
    gear = CondensedGear(*tooth, ring)
    values = np.concatenate([gear.flank(0, loads)[:, :1], gear.cuts(0)[:, :1]])
    field = gear.condensation.expand(values)[:, 0]
    forces = element_forces(gear.sector, gear.stiffness, field)
    return RootStressChecks(
        residual=residual(gear, forces, loads[:, 0]),
        recovery=relative_difference(stress @ loads[:, 0], functionals @ field),
    )


def _with_middles(ends: FloatArray) -> FloatArray:
    planes = np.empty(2 * len(ends) - 1)
    planes[::2], planes[1::2] = ends, 0.5 * (ends[1:] + ends[:-1])
    return planes
