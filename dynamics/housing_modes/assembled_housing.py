"""The equations of motion of a meshed housing."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from bounds import inside
from dynamics.housing_modes.elasticity import mass_and_stiffness
from dynamics.housing_modes.feet import Foot
from dynamics.housing_modes.meshed_housing import MeshedHousing
from dynamics.housing_modes.quadrature import over_surface
from dynamics.housing_modes.rigid_faces import Freedoms, RigidFace, independent_freedoms
from dynamics.housing_modes.rigid_motion import RigidBody, rigid_body
from dynamics.housing_modes.seats import (
    SeatBore,
    SeatFrame,
    in_axes,
    mean_motion,
    seat_frame,
    wall_nodes,
)
from dynamics.housing_modes.tetrahedral_mesh import TetrahedralMesh
from dynamics.solid_housing import Ring
from dynamics.types import FloatArray

HELD = 1e-12
"""Stiffness against a rigid motion below which mounts do not hold it, relative to the stiffest."""


@dataclass(frozen=True)
class AssembledHousing:
    """M x'' + C x' + K x = B' f; q = B x.

    Attributes
    ----------
    freedoms : Freedoms
        x, f of them.
    mass, stiffness : (f, f) sparse arrays
        With the mounts' stiffness.
    mounts : tuple of two (f, f) sparse arrays
        Stiffness and damping of the mounts alone.
    seats : (s, f) sparse array
        B: motions q of the seats, one after the other.
    frames : tuple of SeatFrame
    loose : (f, k) array
        Rigid motions that feet and mounts do not hold; six without any.
    body : RigidBody
        Of the mesh.
    """

    freedoms: Freedoms
    mass: sp.csr_array
    stiffness: sp.csr_array
    mounts: tuple[sp.csr_array, sp.csr_array]
    seats: sp.csr_array
    frames: tuple[SeatFrame, ...]
    loose: FloatArray
    body: RigidBody


def assemble(housing: MeshedHousing) -> AssembledHousing:
    """Assemble a housing.

    Raises
    ------
    InputError
        A seat, foot or point is not on the mesh.
    """
    mesh = housing.mesh
    _check_faces(housing)
    frames = tuple(seat_frame(seat) for seat in housing.seats)
    faces = (*_rigid_seats(housing), *_rigid_feet(housing))
    freedoms = independent_freedoms(mesh.points, faces)
    nodal_mass, stiffness = mass_and_stiffness(mesh, housing.material)
    motion = freedoms.motion
    mass = sp.csr_array(sp.kron(nodal_mass, sp.eye_array(3), format="csr"))
    mounts = _mounts(housing.feet, freedoms)
    seats = [_motion(mesh, pair, freedoms) for pair in zip(housing.seats, frames, strict=True)]
    return AssembledHousing(
        freedoms,
        sp.csr_array(motion.T @ mass @ motion),
        sp.csr_array(motion.T @ stiffness @ motion + mounts[0]),
        mounts,
        sp.csr_array(sp.vstack(seats)),
        frames,
        _loose(mesh.points, housing.feet, freedoms, mounts[0]),
        rigid_body(mesh.points, nodal_mass),
    )


def _check_faces(housing: MeshedHousing) -> None:
    """Refuse a seat, a foot or a point that is not on the mesh, before anything costly."""
    for number, seat in enumerate(housing.seats):
        with inside(f"seats[{number}].bore"):
            seat.bore.triangles(housing.mesh)
    for number, foot in enumerate(housing.feet):
        with inside(f"feet[{number}].face"):
            foot.face.triangles(housing.mesh)
    housing.nodes_of_points()


def _rigid_seats(housing: MeshedHousing) -> list[RigidFace]:
    """Return the rigid rings."""
    rigid = [seat for seat in housing.seats if seat.ring is Ring.RIGID]
    return [
        RigidFace(f"seats.{seat.name}", wall_nodes(housing.mesh, seat.bore), np.array(seat.bore.position))
        for seat in rigid
    ]


def _rigid_feet(housing: MeshedHousing) -> list[RigidFace]:
    """Return the feet."""
    return [
        RigidFace(
            f"feet.{foot.name}",
            wall_nodes(housing.mesh, foot.face),
            _centroid(housing.mesh, foot),
            foot.mount is None,
        )
        for foot in housing.feet
    ]


def _centroid(mesh: TetrahedralMesh, foot: Foot) -> FloatArray:
    """Return the centroid of a foot's face."""
    area, point = over_surface(mesh.points, foot.face.triangles(mesh))
    weight = np.linalg.norm(area, axis=2)
    return np.asarray(np.einsum("tp,tpi->i", weight, point) / weight.sum())


def _motion(mesh: TetrahedralMesh, seat: tuple[SeatBore, SeatFrame], freedoms: Freedoms) -> sp.csr_array:
    """Return the motion of a seat along its own axes, (motions, f)."""
    bore, frame = seat
    if bore.ring is Ring.RIGID:
        whole = sp.csr_array(
            sp.eye_array(freedoms.motion.shape[1], format="csr")[freedoms.face(f"seats.{bore.name}")]
        )
    else:
        whole = mean_motion(mesh, bore.bore, frame.position) @ freedoms.motion
    return sp.csr_array(sp.csr_array(in_axes(frame)) @ whole)


def _mounts(feet: tuple[Foot, ...], freedoms: Freedoms) -> tuple[sp.csr_array, sp.csr_array]:
    """Return stiffness and damping of the mounts."""
    size = freedoms.motion.shape[1]
    both = [sp.csr_array((size, size)), sp.csr_array((size, size))]
    for foot in feet:
        if foot.mount is None:
            continue
        rows, columns = np.broadcast_arrays(*np.ix_(*2 * (freedoms.face(f"feet.{foot.name}"),)))
        for number, matrix in enumerate(foot.mount.matrices()):
            entries = (matrix.ravel(), (rows.ravel(), columns.ravel()))
            both[number] = sp.csr_array(both[number] + sp.coo_array(entries, shape=(size, size)))
    return both[0], both[1]


def _loose(
    points: FloatArray, feet: tuple[Foot, ...], freedoms: Freedoms, stiffness: sp.csr_array
) -> FloatArray:
    """Return the rigid motions without any stiffness against them, by freedom."""
    if any(foot.mount is None for foot in feet):
        return np.zeros((freedoms.motion.shape[1], 0))
    center = points.mean(axis=0)
    size = np.array(3 * [1.0] + 3 * [float(np.linalg.norm(points - center, axis=1).max())])
    rigid = freedoms.rigid(points, center) / size
    value, vector = np.linalg.eigh(rigid.T @ (stiffness @ rigid))
    return np.asarray(rigid @ vector[:, value <= HELD * max(value[-1], 1e-300)])
