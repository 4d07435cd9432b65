"""The deformed transverse section of a gear under forces on its flanks."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from fe_contact.compliance.deformed_gear import DeformedGear, nodal_mean
from fe_contact.compliance.flank_compliance_2d import condensed_ring
from fe_contact.compliance.plane_hypothesis import PlaneHypothesis
from fe_contact.compliance.ring_2d import Ring
from fe_contact.compliance.ring_checks import Field, field_under
from fe_contact.geometry import Toothing
from fe_contact.mesh import GearMesh, MeshRecipe, mesh_gear
from fe_contact.mesh.export import cell_teeth
from fe_contact.mesh.quality import mesh_quality, shape_derivatives
from fe_contact.types import FloatArray

# Points where the stress of a six-node triangle is most exact, and the nodes they are extrapolated to.
INNER = np.array([[1.0, 1.0], [4.0, 1.0], [1.0, 4.0]]) / 6.0

NODES = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.5, 0.0], [0.5, 0.5], [0.0, 0.5]])


def deformed_sections(
    gear: Toothing,
    recipe: MeshRecipe,
    hypothesis: PlaneHypothesis,
    loads: Sequence[Mapping[int, FloatArray]],
) -> tuple[DeformedGear, ...]:
    """Solve the whole section for each set of loads; mesh and factors are made once.

    Parameters
    ----------
    recipe, hypothesis
        As for `flank_compliance`.
    loads : sequence of mapping
        Tooth number to inward nodal forces along the flank normal (k,), N/m.
    """
    mesh = mesh_gear(gear, recipe)
    ring = condensed_ring(gear, mesh, hypothesis)
    lame = hypothesis.lame_parameters(gear.material)
    out_of_plane = lame[0] if hypothesis is PlaneHypothesis.PLANE_STRAIN else 0.0
    return tuple(_deformed_gear(ring, _field(ring, load), lame, out_of_plane) for load in loads)


def _field(ring: Ring, load: Mapping[int, FloatArray]) -> Field:
    first = int(ring.mesh.teeth[0])
    parts = [field_under(ring, tooth - first, forces) for tooth, forces in load.items()]
    return Field(
        sum((part.displacement for part in parts), np.zeros_like(ring.mesh.points)),
        sum((part.load for part in parts), np.zeros_like(ring.mesh.points)),
        sum((part.internal for part in parts), np.zeros_like(ring.mesh.points)),
    )


def _deformed_gear(ring: Ring, field: Field, lame: tuple[float, float], out_of_plane: float) -> DeformedGear:
    mesh = ring.mesh
    unbalanced = field.load - field.internal
    unbalanced[mesh.bore_nodes] = 0.0  # the bore is held
    quality = mesh_quality(mesh.points, mesh.triangles)
    stress = element_stress(mesh, field.displacement, lame, out_of_plane)
    inward = {
        flank.tooth: -np.sum(field.displacement[flank.nodes] * flank.normals, axis=1) for flank in mesh.flanks
    }
    zero = np.zeros(len(mesh.points))
    return DeformedGear(
        points=np.column_stack([mesh.points, zero]),
        cells=mesh.triangles,
        tooth=cell_teeth(mesh),
        displacement=np.column_stack([field.displacement, zero]),
        stress=nodal_mean(mesh.triangles, stress, len(mesh.points)),
        quality={
            "least_angle_deg": np.degrees(quality.angle),
            "scaled_jacobian": quality.scaled_jacobian,
        },
        flank_displacement=inward,
        residual=float(np.linalg.norm(unbalanced) / np.linalg.norm(field.load)),
    )


def element_stress(
    mesh: GearMesh, displacement: FloatArray, lame: tuple[float, float], out_of_plane: float
) -> FloatArray:
    """Return the stresses (m, 6, 3, 3) of every element at its nodes, Pa.

    `out_of_plane` is the stress along the axis per unit of e_xx + e_yy, Pa.
    """
    nodes, motion = mesh.points[mesh.triangles], displacement[mesh.triangles]
    slopes = shape_derivatives(INNER)  # (q, 2, 6)
    jacobian = np.einsum("qdk,mkx->mqdx", slopes, nodes)
    gradient = np.linalg.solve(jacobian, np.einsum("qdk,mkc->mqdc", slopes, motion))  # d_x u_c
    lam, mu = lame
    trace = gradient[..., 0, 0] + gradient[..., 1, 1]
    stress = np.zeros((*trace.shape, 3, 3))
    stress[..., :2, :2] = mu * (gradient + np.swapaxes(gradient, -1, -2)) + (
        lam * trace[..., None, None] * np.eye(2)
    )
    stress[..., 2, 2] = out_of_plane * trace
    linear = np.column_stack([np.ones(3), INNER])
    extrapolation = np.column_stack([np.ones(6), NODES]) @ np.linalg.inv(linear)
    return np.asarray(np.einsum("aq,mqxy->maxy", extrapolation, stress))
