"""Component mode synthesis: free modes and residual flexibility, in coordinates of Craig and Bampton.

The reduced coordinates are the motions of the bearing seats, then amplitudes of modes with the seats held.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dynamics.errors import InputError, SolveError
from dynamics.housings.assembled_housing import AssembledHousing, assemble
from dynamics.housings.free_modes import ACCEPTED, FreeModes, ModeStatus, free_modes
from dynamics.housings.meshed_housing import MaterialDamping, MeshedHousing
from dynamics.housings.quadrature import over_surface
from dynamics.housings.reduced_housing import PointMotion, ReducedHousing, ReductionChecks, SurfaceMotion
from dynamics.housings.rigid_body import rigid_motions
from dynamics.housings.supports import in_axes
from dynamics.types import FloatArray, IntArray
from host.optional_modules import linalg

INDEPENDENT = 1e-12
"""Least share of the modal mass of a deflection that lies outside the natural modes and the other
deflections. Below it, two deflections are the same.
"""
SINGULAR = 1e-12  # relative eigenvalue, below which a direction has no stiffness


@dataclass(frozen=True)
class _Coordinates:
    """Reduced coordinates of a housing with f freedoms."""

    mass: FloatArray
    stiffness: FloatArray
    """`mass`, `stiffness`: Mass and stiffness of the coordinates. Shape (r, r) each."""
    motion: FloatArray
    """Displacements of the freedoms per coordinate. Shape (f, r)."""


def reduce_housing(housing: MeshedHousing) -> ReducedHousing:
    """Reduce a housing to its seats and modes.

    The motion of the housing is a sum of natural modes with free seats and of static deflections under forces
    on the seats (Craig and Chang, AIAA paper 77-405; Rubin, AIAA Journal 13 (1975) 995-1006), by Galerkin's
    method. So the frequencies of these modes are those of the mesh, and static and rigid motions are exact.
    In this space of motions, the coordinates are those of Craig and Bampton (AIAA Journal 6 (1968)
    1313-1319). Raises `InputError`: a seat, foot or point is not on the mesh, or two seats are one;
    `SolveError`: the stiffness is singular or the modes do not converge.
    """
    assembled = assemble(housing)
    modes = free_modes(assembled, housing.modes)
    _require_converged(modes, housing.modes)
    space = _independent(assembled, modes)
    coordinates = _craig_bampton(assembled, space)
    frequency = np.concatenate([np.zeros(modes.rigid.shape[1]), modes.frequency])
    motion, law = coordinates.motion, housing.damping
    springs, mounts = (_symmetric(motion.T @ (part @ motion)) for part in assembled.mounts)
    ratio, material_damping = _material_damping(housing, assembled, coordinates, springs)
    nodes, triangles = np.unique(housing.mesh.surface, return_inverse=True)
    return ReducedHousing(
        mass=coordinates.mass,
        stiffness=coordinates.stiffness,
        damping=material_damping + mounts,
        seats=assembled.frames,
        frequency=frequency,
        damping_ratio=ratio[: len(frequency)],
        body=assembled.body,
        checks=_residuals(housing, assembled, modes),
        surface=SurfaceMotion(
            housing.mesh.points[nodes], triangles.reshape(-1, 6), _motion_of(nodes, assembled, coordinates)
        ),
        points=_points(housing, assembled, coordinates),
        mount_damping=mounts if np.any(mounts) else None,
        mount_stiffness=springs if np.any(springs) else None,
        loss_factor=law.loss_factor if isinstance(law, MaterialDamping) else None,
    )


def _require_converged(modes: FreeModes, count: int) -> None:
    if modes.status is ModeStatus.ITERATION_LIMIT:
        remedy = "Ask for fewer modes, or check the mesh for parts that hardly hold together."
        raise SolveError(f"{len(modes.frequency)} of {count} modes of the housing converged. {remedy}")
    if modes.status is ModeStatus.ILL_CONDITIONED:
        remedy = "Check the quality of the mesh and the stiffness of the mounts."
        share = f"{modes.solve_residual:.1e}, above {ACCEPTED:g}"
        raise SolveError(
            f"Of the work of forces on the housing's seats {share}, is lost to rounding. {remedy}"
        )


def _independent(housing: AssembledHousing, modes: FreeModes) -> FloatArray:
    """Return rigid motions, modes and independent parts of the deflections, (f, r), of modal masses 1."""
    basis = np.hstack([modes.rigid, modes.shape])
    rest = modes.deflection
    for _ in range(2):  # the second pass removes the rounding of the first
        rest = rest - basis @ (basis.T @ (housing.mass @ rest))
    norm = np.einsum("fs,fs->s", modes.deflection, housing.mass @ modes.deflection)
    gram = rest.T @ (housing.mass @ rest) / np.sqrt(np.outer(norm, norm))
    value, vector = np.linalg.eigh(gram)
    if value[0] <= INDEPENDENT * value[-1]:
        names = [frame.name for frame in housing.frames]
        raise InputError(
            "seats", names, "independent of each other", "Two seats share a bore: make them one."
        )
    return np.hstack([basis, rest / np.sqrt(norm) @ (vector / np.sqrt(value))])


def _craig_bampton(housing: AssembledHousing, space: FloatArray) -> _Coordinates:
    """Return coordinates in a space of motions (f, r), of which the first are the motions of the seats."""
    mass, stiffness = (_symmetric(space.T @ (matrix @ space)) for matrix in (housing.mass, housing.stiffness))
    seats = housing.seats @ space
    fixed_space = linalg.null_space(seats)  # motions that leave the seats at rest
    inside = fixed_space.T @ stiffness @ fixed_space
    # a unit motion of each seat, in static equilibrium
    static = np.linalg.pinv(seats)
    unbalanced = fixed_space.T @ stiffness @ static
    static = static - fixed_space @ (np.linalg.pinv(inside, SINGULAR, hermitian=True) @ unbalanced)
    _, shape = linalg.eigh(inside, fixed_space.T @ mass @ fixed_space)
    basis = np.hstack([static, fixed_space @ shape])
    return _Coordinates(
        mass=_symmetric(basis.T @ mass @ basis),
        stiffness=_symmetric(basis.T @ stiffness @ basis),
        motion=space @ basis,
    )


def _material_damping(
    housing: MeshedHousing, assembled: AssembledHousing, coordinates: _Coordinates, springs: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return damping ratios of all reduced modes, and their damping matrix, without that of the mounts.

    The material damps the part of a mode's energy that is not in the `springs` (r, r) of the mounts.
    """
    square, shape = linalg.eigh(coordinates.stiffness, coordinates.mass)  # squares of the angular frequencies
    square[: assembled.loose.shape[1]] = 0.0  # rigid motions, which have rounding alone
    energy = np.einsum("rm,rs,sm->m", shape, springs, shape, optimize=True)  # of mode m in the springs
    share = np.where(square > 0.0, 1.0 - energy / np.where(square > 0.0, square, 1.0), 0.0)
    ratio = housing.damping.ratios(np.clip(share, 0.0, 1.0))
    impulse = coordinates.mass @ shape  # inverse of shape.T, as modal masses are 1
    damping = impulse @ np.diag(2.0 * ratio * np.sqrt(np.maximum(square, 0.0))) @ impulse.T
    return ratio, _symmetric(damping)


def _residuals(housing: MeshedHousing, assembled: AssembledHousing, modes: FreeModes) -> ReductionChecks:
    mesh = housing.mesh
    area, point = over_surface(mesh.points, mesh.surface)
    volume = float(np.einsum("tpi,tpi->", area, point)) / 3.0
    # the motion of seats in rigid motions of all nodes, and as it must be on rigid faces
    center = assembled.body.center
    seat_motion = assembled.seats @ assembled.freedoms.rigid(housing.mesh.points, center)
    rotations = np.hstack([np.zeros((3, 3)), np.eye(3)])
    bodies = (
        np.vstack([rigid_motions(frame.position[None], center), rotations]) for frame in assembled.frames
    )
    expected = np.vstack(
        [in_axes(frame) @ body for frame, body in zip(assembled.frames, bodies, strict=True)]
    )
    return ReductionChecks(
        volume=abs(housing.material.density * volume / assembled.body.mass - 1.0),
        eigen=modes.eigen_residual,
        solve=modes.solve_residual,
        rigid_frequency=modes.rigid_ratio,
        seat_rigid=float(np.abs(seat_motion - expected).max() / np.abs(expected).max()),
    )


def _points(
    housing: MeshedHousing, assembled: AssembledHousing, coordinates: _Coordinates
) -> tuple[PointMotion, ...]:
    nodes = housing.nodes_of_points()
    motion = _motion_of(nodes, assembled, coordinates)
    position = housing.mesh.points[nodes]
    return tuple(PointMotion(*point) for point in zip(housing.points, position, motion, strict=True))


def _motion_of(nodes: IntArray, assembled: AssembledHousing, coordinates: _Coordinates) -> FloatArray:
    """Return displacements of nodes per coordinate, (n, 3, r)."""
    rows = (3 * nodes[:, None] + np.arange(3)).ravel()
    motion = assembled.freedoms.motion[rows] @ coordinates.motion
    return np.asarray(motion).reshape(len(nodes), 3, coordinates.motion.shape[1])


def _symmetric(matrix: FloatArray) -> FloatArray:
    return np.asarray(0.5 * (matrix + matrix.T))
