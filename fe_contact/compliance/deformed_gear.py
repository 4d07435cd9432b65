"""The deformed gear, and that of a plane section under its forces."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from fe_contact.compliance.flank_compliance_2d import Field, condensed_ring, field_under
from fe_contact.compliance.plane_elasticity import PlaneHypothesis
from fe_contact.compliance.ring_2d import Ring
from fe_contact.geometry import Toothing
from fe_contact.mesh import GearMesh, MeshRecipe, mesh_gear
from fe_contact.mesh.export import cell_teeth
from fe_contact.mesh.quality import mesh_quality, shape_derivatives
from fe_contact.types import FloatArray, IntArray

# The mesh of a gear as it bends: displacement and stress at its nodes, for viewers and checks.


@dataclass(frozen=True)
class DeformedGear:
    """Finite elements of a gear, or of some of its teeth, under flank loads."""

    points: FloatArray
    """Nodes without load, m. As made: tooth 0 on +y, mid-face at z = 0; see `placed`. Shape (n, 3)."""
    cells: IntArray
    """Six-node triangles of the transverse section or 20-node hexahedra, numbered as in VTK. (m, 6) or (m,
    20) int array.
    """
    tooth: IntArray
    """Tooth number of each element, `fe_contact.mesh.export.HUB` in the hub. Shape (m,)."""
    displacement: FloatArray
    """Elastic displacement with the bore held, m. Shape (n, 3)."""
    stress: FloatArray
    """Mean of the adjoining elements' stresses, each extrapolated from its inner Gauss points, Pa. Shape (n,
    3, 3).
    """
    quality: Mapping[str, FloatArray]
    """Quality measures of the elements by name, (m,)."""
    flank_displacement: Mapping[int, FloatArray]
    """Displacement along the flank's normal by tooth number, m: in the freedoms and with the sign of the
    flank compliance of the gear.
    """
    residual: float
    """Norm of f - K u over that of f, on all free freedoms of these elements but outer cuts."""

    @property
    def von_mises(self) -> FloatArray:
        """Equivalent stress after von Mises (n,), Pa."""
        deviator = self.stress - np.trace(self.stress, axis1=1, axis2=2)[:, None, None] * np.eye(3) / 3.0
        return np.asarray(np.sqrt(1.5 * np.sum(deviator**2, axis=(1, 2))))

    @property
    def principal_stress(self) -> FloatArray:
        """Principal stresses (n, 3), Pa, the least first."""
        return np.asarray(np.linalg.eigvalsh(self.stress))

    def turned_over(self) -> DeformedGear:
        """Return the gear seen from behind: turned by half a turn about y."""
        over = np.diag([-1.0, 1.0, -1.0])
        return replace(
            self,
            points=self.points @ over,
            displacement=self.displacement @ over,
            stress=over @ self.stress @ over,
        )

    def placed(self, angle: float, center: tuple[float, float, float]) -> DeformedGear:
        """Return the gear turned counter-clockwise by `angle` (rad) about its axis, its center moved (m)."""
        turn = turn_about_axis(angle)
        return replace(
            self,
            points=self.points @ turn.T + np.asarray(center),
            displacement=self.displacement @ turn.T,
            stress=turn @ self.stress @ turn.T,
        )


def turn_about_axis(angle: float) -> FloatArray:
    """Return the matrix that turns vectors counter-clockwise about z."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def nodal_mean(cells: IntArray, values: FloatArray, count: int) -> FloatArray:
    """Return the mean (count, ...) over elements of values (m, p, ...) at their nodes (m, p)."""
    total = np.zeros((count, *values.shape[2:]))
    np.add.at(total, cells, values)
    times = np.bincount(cells.ravel(), minlength=count).reshape(-1, *(1,) * (values.ndim - 2))
    return np.asarray(total / np.maximum(times, 1))


def stress_of(gradient: FloatArray, lame: tuple[float, float]) -> FloatArray:
    """Return lambda tr(e) I + mu (g + g') for displacement gradients g (..., 3, 3), Pa."""
    lam, mu = lame
    trace = np.trace(gradient, axis1=-2, axis2=-1)[..., None, None]
    return np.asarray(lam * trace * np.eye(3) + mu * (gradient + np.swapaxes(gradient, -1, -2)))


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
    return tuple(_deformed(ring, _field(ring, load), lame, out_of_plane) for load in loads)


def _field(ring: Ring, load: Mapping[int, FloatArray]) -> Field:
    first = int(ring.mesh.teeth[0])
    parts = [field_under(ring, tooth - first, forces) for tooth, forces in load.items()]
    return Field(
        sum((part.displacement for part in parts), np.zeros_like(ring.mesh.points)),
        sum((part.load for part in parts), np.zeros_like(ring.mesh.points)),
        sum((part.internal for part in parts), np.zeros_like(ring.mesh.points)),
    )


def _deformed(ring: Ring, field: Field, lame: tuple[float, float], out_of_plane: float) -> DeformedGear:
    mesh = ring.mesh
    out = field.load - field.internal
    out[mesh.bore_nodes] = 0.0
    quality = mesh_quality(mesh.points, mesh.triangles)
    stress = _element_stress(mesh, field.displacement, lame, out_of_plane)
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
        residual=float(np.linalg.norm(out) / np.linalg.norm(field.load)),
    )


def _element_stress(
    mesh: GearMesh, displacement: FloatArray, lame: tuple[float, float], out_of_plane: float
) -> FloatArray:
    """Return the stresses (m, 6, 3, 3) of every element at its nodes, Pa.

    `out_of_plane` is the stress along the axis per unit of e_xx + e_yy, Pa.
    """
    nodes, moved = mesh.points[mesh.triangles], displacement[mesh.triangles]
    slopes = shape_derivatives(INNER)  # (q, 2, 6)
    jacobian = np.einsum("qdk,mkx->mqdx", slopes, nodes)
    gradient = np.linalg.solve(jacobian, np.einsum("qdk,mkc->mqdc", slopes, moved))  # d_x u_c
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
