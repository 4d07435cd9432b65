"""Unit-load stress of the tooth roots in the transverse plane.

With the sector's stiffness split as in `sector_2d` and R the rows that make stresses of displacements,

    sigma = R_i u_i + R_b u_b = (N' X)' q + (R_b - X' K_ib) u_b,    X = K_ii^-1 R_i',

so a stress costs one right-hand side, however many forces it is wanted for.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp

from fe_contact.compliance.flank_compliance_2d import (
    condensed_ring,
    field_under,
    tooth_indices,
    uniform_pressure,
)
from fe_contact.compliance.plane_elasticity import PlaneHypothesis
from fe_contact.compliance.ring_2d import Ring, freedoms
from fe_contact.compliance.root_stress import (
    RootStressChecks,
    UnitRootStress,
    refuse_broken_stress,
    relative_difference,
)
from fe_contact.compliance.solvers import Solver
from fe_contact.compliance.surface_stress import COMPONENTS, between_nodes, edge_stress, triangle_root
from fe_contact.geometry import Toothing, tooth_profile
from fe_contact.geometry.flank_profile import tangent_angle
from fe_contact.mesh import MeshRecipe, mesh_gear
from fe_contact.stage_clock import StageClock
from fe_contact.types import FloatArray, IntArray


def compute_root_stress(
    gear: Toothing, recipe: MeshRecipe, hypothesis: PlaneHypothesis, teeth: int, solver: Solver
) -> UnitRootStress:
    """Mesh, condense, solve for the stresses and check; no cache.

    Parameters
    ----------
    gear : Toothing
        Modification and face width play no part.
    recipe : MeshRecipe
        Element sizes.
    hypothesis : PlaneHypothesis
        Plane strain or plane stress.
    teeth : int
        Number of distances, odd.
    solver : Solver
        Factorises.
    """
    clock = StageClock()
    mesh, profile = mesh_gear(gear, recipe), tooth_profile(gear)
    root = triangle_root(mesh.sector, profile)
    clock.finish("mesh")
    ring = condensed_ring(gear, mesh, hypothesis, solver)
    clock.finish("factorisation")
    rows = [edge_stress(mesh.sector.points, chain, gear.material, hypothesis) for chain in root.nodes]
    functionals = sp.csr_array(sp.vstack(rows))
    own, index = tooth_indices(mesh, 1), tooth_indices(mesh, teeth)
    stress = _unit_load_stress(ring, functionals, int(own[0]), index)
    clock.finish("stress")
    forces = uniform_pressure(mesh.sector.s, profile.s_form, gear.base_radius).forces
    checks = _checks(ring, functionals, int(own[0]), forces, stress[teeth // 2])
    clock.finish("checks")
    stations = between_nodes(root.s)
    count = mesh.sector.s.size
    return refuse_broken_stress(
        UnitRootStress(
            distance=np.arange(teeth) - teeth // 2,
            stress=stress.reshape(teeth, 2, COMPONENTS, stations.size, 1, count),
            station_s=stations,
            station_z=np.zeros(1),
            tangent_angle=tangent_angle(profile, stations),
            s=mesh.sector.s,
            z=np.empty(0),
            index=np.arange(count)[None],
            checks=checks,
            unknowns=2 * (len(mesh.points) - len(mesh.bore_nodes)),
            seconds=clock.seconds,
            solver=solver.name,
        )
    )


def _unit_load_stress(ring: Ring, functionals: sp.csr_array, own: int, index: IntArray) -> FloatArray:
    """Return the stresses (t, r, k) of tooth `own` by how far it is ahead of the loaded ones of `index`."""
    sector = ring.sector
    inner, border = sector.interior, freedoms(sector.boundary)
    by_row = sector.solve(functionals[:, inner].T.toarray())
    local = np.asarray((sector.loads[inner].T @ by_row).T)
    on_border = functionals[:, border].toarray() - (sector.matrix[border][:, inner] @ by_row).T
    right = np.zeros((ring.matrix.shape[0], len(on_border)))
    right[ring.rows(own)] = ring.turned(own, on_border.T)
    shared = ring.solve(right)
    # Tooth `own` is n ahead of tooth own - n.
    loaded = 2 * own - index
    stress = np.stack([shared[ring.rows(int(i))].T @ ring.turned(int(i), sector.transmitted) for i in loaded])
    stress[len(index) // 2] += local
    return stress


def _checks(
    ring: Ring, functionals: sp.csr_array, own: int, forces: FloatArray, stress: FloatArray
) -> RootStressChecks:
    """Compare with the displacement of the whole mesh under `forces` (k,) on tooth `own`."""
    mesh = ring.mesh
    field = field_under(ring, own, forces)
    out_of_balance = field.load - field.internal
    out_of_balance[mesh.bore_nodes] = 0.0
    direct = functionals @ field.displacement[mesh.sector_nodes[own]].ravel()
    return RootStressChecks(
        residual=float(np.linalg.norm(out_of_balance) / np.linalg.norm(field.load)),
        recovery=relative_difference(stress @ forces, direct),
    )
