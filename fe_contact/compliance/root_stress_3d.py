"""Unit-load stress of the tooth roots over the face width.

A stress is a row r of numbers by which it is made of the displacements of a sector. Passed up the elimination
tree like a force, it becomes a row on the kept freedoms, flank f and cuts c. With the flank compliance A and
the transmission B of the sector on held cuts (see `cyclic_ring`),

    sigma = r_f u_f + r_c u_c = r_f A q + (r_c + r_f B') u_c,

and u_c on every sector follows from the harmonics of the ring.
"""

from __future__ import annotations

from typing import NamedTuple

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
from fe_contact.compliance.cyclic_harmonics import LeftCuts
from fe_contact.compliance.cyclic_ring import RingSolution, even_sector, loaded_cuts
from fe_contact.compliance.reduced_harmonics import LEAST_TOLD, row_space
from fe_contact.compliance.root_stress import (
    COMPONENTS,
    STATIONS,
    RootStressChecks,
    RootSurface,
    UnitRootStress,
    between_nodes,
    refuse_broken_stress,
    relative_difference,
    root_coordinate,
)
from fe_contact.compliance.sector_stiffness import above, cylindrical_frames, node_axes, twist
from fe_contact.compliance.substructure import Condensation
from fe_contact.geometry import Toothing, tooth_profile
from fe_contact.geometry.flank_profile import FlankProfile
from fe_contact.geometry.root_tangent import tangent_angle
from fe_contact.material import Material
from fe_contact.mesh.quad_sector import QuadSector, quad_sector
from fe_contact.mesh.recipe import SectorRecipe
from fe_contact.mesh.sector_grid import BoreSupport
from fe_contact.mesh.swept_sector import SweptSector
from fe_contact.types import FloatArray, IntArray
from model_studies.stage_clock import StageClock

ROWS_AT_ONCE = 256  # stresses passed up the tree together: bounds the memory
# Nodes of a surface element over profile (-1 .. 1) and layer (-1 .. 1): corners, then middles.
ALONG = np.array([-1.0, 1.0, 1.0, -1.0, 0.0, 1.0, 0.0, -1.0])
ACROSS = np.array([-1.0, -1.0, 1.0, 1.0, -1.0, 0.0, 1.0, 0.0])


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
    root = _quad_root(section, profile)
    clock.finish("mesh")
    tooth, loads = condensed_tooth(gear, section, recipe, support, clock)
    modes = row_space(even_sector(tooth.held).transmitted, LEAST_TOLD * np.abs(tooth.held.flank).max())
    cuts = loaded_cuts(tooth.held, np.concatenate([modes, loads], axis=1), gear.teeth, reach, modes.shape[1])
    clock.finish("ring")
    functionals = _root_functionals(gear, section, tooth.sector, root)
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
    axes = node_axes(gear, section)
    functionals = []
    for chain in root.nodes:
        elements = _surface_elements(section, sector, chain, axes, twist(gear))
        rows = _face_stress(elements, gear.material, sector.size)
        layers, edges = len(sector.layers.kind), len(chain) // 2
        number = np.arange(rows.shape[0]).reshape(COMPONENTS, layers, edges, 2, 2)
        functionals.append(rows[number.transpose(0, 1, 3, 2, 4).ravel()])
    return sp.csr_array(sp.vstack(functionals))


def _surface_elements(
    section: QuadSector, sector: SweptSector, chain: IntArray, axes: FloatArray, turn_per_length: float
) -> _SurfaceElements:
    first = 2 * np.arange(len(chain) // 2)
    on_section = chain[first[:, None] + (1 + ALONG).astype(int)]  # (e, 8)
    positions, frames, freedoms = [], [], []
    for layer, kind in enumerate(sector.layers.kind):
        thickness = float(sector.layers.thickness[kind])
        nodes = above(section.points[on_section], 0.5 * ACROSS, thickness, thickness * turn_per_length)
        positions.append(nodes)
        frames.append(cylindrical_frames(nodes) @ axes[on_section])
        freedoms.append(sector.freedoms[sector.nodes[2 * layer + (1 + ACROSS).astype(int), on_section]])
    return _SurfaceElements(np.concatenate(positions), np.concatenate(frames), np.concatenate(freedoms))


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
    ring = RingSolution(np.empty((0, len(loads), len(loads))), cuts.everywhere)
    gear = CondensedGear(*tooth, ring)
    values = np.concatenate([gear.flank(0, loads)[:, :1], gear.cuts(0)[:, :1]])
    field = gear.condensation.expand(values)[:, 0]
    forces = element_forces(gear.sector, gear.stiffness, field)
    return RootStressChecks(
        residual=residual(gear, forces, loads[:, :1], np.eye(len(ring.left))[0]),
        recovery=relative_difference(stress @ loads[:, 0], functionals @ field),
    )


# The surface of the tooth root in eight-node quadrilaterals, and the stress on it.


def _quad_root(section: QuadSector, profile: FlankProfile) -> RootSurface:
    """Return the root of a sector of eight-node quadrilaterals."""
    grid = section.grid
    land = grid.number[2 * grid.body_rows]
    below_form = int(np.argmin(np.abs(section.s[::2] - profile.s_form)))
    tooth = grid.number[2 * grid.body_rows : 2 * (grid.body_rows + below_form) + 1]
    low, high = 2 * grid.land, 2 * (grid.land + grid.across)
    right = np.concatenate([land[:low], tooth[:, low]])
    left = np.concatenate([land[:high:-1], tooth[:, high]])
    return RootSurface(np.array([right, left]), root_coordinate(profile, section.points[right]))


class _SurfaceElements(NamedTuple):
    """Eight-node quadrilaterals of a surface."""

    nodes: FloatArray
    """Places in the order of `ALONG` and `ACROSS`, m. Shape (m, 8, 3)."""
    frames: FloatArray
    """Axes of the freedoms of each node, one per column. Shape (m, 8, 3, 3)."""
    freedoms: IntArray
    """Their numbers; -1 where held. Shape (m, 8, 3)."""


def _face_stress(elements: _SurfaceElements, material: Material, size: int) -> sp.csr_array:
    """Return the stresses of surface elements by the freedoms of a mesh, (3 * 4 m, size) in Pa/m.

    All stations of one component stand together, those of an element by position across, then along.
    "Along" is the profile in the transverse section; "across" is perpendicular to it in the surface,
    towards larger z.
    """
    strains = _surface_strains(elements.nodes)  # (3, m, 4, 8, 3)
    nu = material.poissons_ratio
    plane, shear = material.plane_strain_modulus, material.youngs_modulus / (1.0 + nu)
    along, across, between = strains
    stresses = np.stack([plane * (along + nu * across), plane * (across + nu * along), shear * between])
    own = np.einsum("kmgia,miab->kmgib", stresses, elements.frames)
    freedoms = np.broadcast_to(elements.freedoms[:, None], own.shape)
    rows = np.arange(own[..., 0, 0].size).reshape(*own.shape[:3], 1, 1)
    free = freedoms >= 0
    entries = own[free], (np.broadcast_to(rows, own.shape)[free], freedoms[free])
    return sp.csr_array(sp.coo_array(entries, shape=(own[..., 0, 0].size, size)))


def _surface_strains(nodes: FloatArray) -> FloatArray:
    """Return e_11, e_22, e_12 by Cartesian displacements, (3, m, 4, 8, 3), in orthonormal surface axes."""
    y, x = (grid.ravel() for grid in np.meshgrid(STATIONS, STATIONS, indexing="ij"))
    slopes = _slopes(x, y)
    g1, g2 = np.einsum("tgi,mia->tmga", slopes, nodes)
    t1 = g1 / np.linalg.norm(g1, axis=-1, keepdims=True)
    t2 = g2 - np.sum(g2 * t1, axis=-1, keepdims=True) * t1
    t2 /= np.linalg.norm(t2, axis=-1, keepdims=True)
    # g_a = A_ab t_b with A triangular; covariant strains are e_ab = (g_a . u_,b + g_b . u_,a) / 2.
    a11, a21, a22 = (np.sum(g * t, axis=-1)[..., None, None] for g, t in ((g1, t1), (g2, t1), (g2, t2)))
    d1, d2 = (d[None, :, :, None] for d in slopes)
    e11, e22 = d1 * g1[:, :, None], d2 * g2[:, :, None]
    e12 = 0.5 * (d2 * g1[:, :, None] + d1 * g2[:, :, None])
    skew = a21 / a11
    return np.stack(
        [e11 / a11**2, (skew**2 * e11 - 2.0 * skew * e12 + e22) / a22**2, (e12 - skew * e11) / (a11 * a22)]
    )


def _slopes(x: FloatArray, y: FloatArray) -> FloatArray:
    """Return the derivatives of the eight-node functions along x and y at points (n,), (2, n, 8)."""
    slopes = np.empty((2, len(x), 8))
    for i, (a, b) in enumerate(zip(ALONG, ACROSS, strict=True)):
        if a and b:
            slopes[0, :, i] = 0.25 * a * (1.0 + b * y) * (2.0 * a * x + b * y)
            slopes[1, :, i] = 0.25 * b * (1.0 + a * x) * (a * x + 2.0 * b * y)
        elif b:
            slopes[0, :, i], slopes[1, :, i] = -x * (1.0 + b * y), 0.5 * b * (1.0 - x * x)
        else:
            slopes[0, :, i], slopes[1, :, i] = 0.5 * a * (1.0 - y * y), -y * (1.0 + a * x)
    return slopes
