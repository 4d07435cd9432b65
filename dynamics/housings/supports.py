"""Supports and loads of a housing: its bearing seats, and its feet, fixed or on elastic mounts."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from dynamics.bearings.matrix import Matrix, check_matrix
from dynamics.errors import InputError
from dynamics.housings.mesh_faces import Bore, Face, unit
from dynamics.housings.quadrature import over_parts, over_surface, triangle
from dynamics.housings.tetrahedral_mesh import TetrahedralMesh
from dynamics.solid_housing import Ring
from dynamics.types import FloatArray
from host.optional_modules import sparse as sp

MOTIONS = ("x", "y", "z", "tilt_x", "tilt_y", "rotation_z")
"""Directions of motion in the seat's own axes, z along the bore."""

PRECISION = 1e-6
"""Relative asymmetry of a stiffness or damping matrix that counts as rounding: a data sheet or a finite-
element program writes its matrices with six digits."""
OBLIQUE = 0.9
"""Largest cosine between the bore's axis and the mesh's x with which x is the reference of the seat's x."""


@dataclass(frozen=True)
class SeatBore:
    """A bearing seat on the bore of a housing."""

    name: str
    bore: Bore
    ring: Ring = Ring.WEIGHTED_AVERAGE
    """Whether the bore is a rigid ring, or elastic with a weighted average of its displacements."""
    motions: int = 5
    """Number of directions of `MOTIONS` in which the bearing holds its seat: 3 displacements, 5 with tilts, 6
    with the rotation about the axis."""

    def __post_init__(self) -> None:
        if self.motions not in (3, 5, 6):
            raise InputError("motions", self.motions, "3, 5 or 6", "A rolling bearing holds five.")

    @property
    def frame(self) -> SeatFrame:
        """Position and axes of the seat."""
        z = unit("axis", self.bore.axis)
        near = np.eye(3)[0 if abs(z[0]) < OBLIQUE else 1]
        x = near - (near @ z) * z
        x /= np.linalg.norm(x)
        axes = np.stack([x, np.cross(z, x), z], axis=1)
        return SeatFrame(self.name, np.array(self.bore.position), axes, self.ring, MOTIONS[: self.motions])


@dataclass(frozen=True)
class SeatFrame:
    """Position and axes of a seat."""

    name: str
    position: FloatArray
    """Position of the seat in the mesh, m. Shape (3,)."""
    axes: FloatArray
    """Columns: the seat's x, y, z in the mesh. z is the bore's axis; x is as near as it can be to the mesh's
    x, or to its y where the axis is along x. Shape (3, 3).
    """
    ring: Ring
    """Whether the seat is elastic or a rigid ring."""
    motions: tuple[str, ...]
    """Directions of the seat's freedoms, of `MOTIONS`."""


def in_axes(frame: SeatFrame) -> FloatArray:
    """Return the matrix (motions, 6) from motions along the axes of the mesh to those of a seat."""
    # two equal blocks: displacements and rotations turn alike
    return np.asarray(np.kron(np.eye(2), frame.axes.T)[: len(frame.motions)], dtype=float)


def mean_motion(mesh: TetrahedralMesh, bore: Bore, about: FloatArray) -> sp.csr_array:
    """Return the matrix (6, 3 n) from displacements of n nodes to the nearest rigid motion of a bore's wall.

    The motion, about the point `about`, is the least-squares fit over the area of the wall between the bore's
    ends with the shape functions of the elements: exact for rigid motions. The transpose spreads a force and
    moment at `about` over the nodes.
    """
    parts = bore.parts(mesh)
    shape = triangle().shape
    fits = [_rigid_fit(*over_surface(mesh.points, parts.whole), shape, about)]
    if len(parts.cut):
        fits.append(_rigid_fit(*over_parts(mesh.points, parts.cut, parts.corners), about))
    normal = sum(fit.normal for fit in fits)
    freedoms = 3 * np.vstack([parts.whole, parts.cut])[:, :, None] + np.arange(3)
    values = np.linalg.solve(normal, np.hstack([fit.right for fit in fits]))
    rows = np.repeat(np.arange(6), freedoms.size)
    entries = (values.ravel(), (rows, np.tile(freedoms.ravel(), 6)))
    return sp.coo_array(entries, shape=(6, mesh.freedoms)).tocsr()


class _RigidFit(NamedTuple):
    """Normal equations of the rigid motion nearest to that of a surface: its six motions, nodes of triangles.

    `normal` has the shape (6, 6), `right` (6, 18 t) of t triangles.
    """

    normal: FloatArray
    right: FloatArray


def _rigid_fit(area: FloatArray, point: FloatArray, shape: FloatArray, about: FloatArray) -> _RigidFit:
    """Return the normal equations over points (t, p, 3) with `shape` (a, p), or (t, a, p)."""
    weight = np.linalg.norm(area, axis=2)
    motion = np.zeros((*point.shape[:2], 3, 6))  # displacement of a point by the rigid motion
    motion[..., range(3), range(3)] = 1.0
    for axis, direction in enumerate(np.eye(3)):
        motion[..., 3 + axis] = np.cross(direction, point - about)
    # t triangles, p points of quadrature, a nodes of a triangle, i directions x, y, z; c, d the six motions
    normal = np.einsum("tp,tpic,tpid->cd", weight, motion, motion, optimize=True)
    shapes = "ap" if shape.ndim == 2 else "tap"
    right = np.einsum(f"tp,{shapes},tpic->ctai", weight, shape, motion, optimize=True)
    return _RigidFit(normal, right.reshape(6, -1))


@dataclass(frozen=True)
class Mount:
    """A spring and damper between a rigid foot and the ground, at the centroid of the foot's face."""

    stiffness: Matrix
    """Along the axes of the mesh: forces per displacements in N/m, and with six rows moments and rotations,
    N, N m per m, rad. Symmetric, positive semidefinite.
    """
    damping: Matrix | None = None
    """Damping along the axes of the mesh, N s/m, and with six rows like the stiffness; None: none."""

    def __post_init__(self) -> None:
        rows = len(check_matrix("stiffness", self.stiffness, (3, 6), PRECISION))
        if self.damping is not None:
            check_matrix("damping", self.damping, (rows,), PRECISION)

    def matrices(self) -> tuple[FloatArray, FloatArray]:
        """Return stiffness and damping, both (6, 6)."""
        return _with_rotations(self.stiffness), _with_rotations(self.damping)


@dataclass(frozen=True)
class Foot:
    """A rigid face of the housing that stands on the ground, fixed or on a mount."""

    name: str
    face: Face
    mount: Mount | None = None
    """Mount under the foot; None: the foot is fixed."""

    def __post_init__(self) -> None:
        if not self.name:
            raise InputError("name", self.name, "a name")


def _with_rotations(matrix: Matrix | None) -> FloatArray:
    """Return a matrix of 3 or 6 rows as (6, 6), zero where it has no entries, without its asymmetry."""
    full = np.zeros((6, 6))
    if matrix is not None:
        rows = len(matrix)
        full[:rows, :rows] = 0.5 * (np.array(matrix) + np.array(matrix).T)
    return full
