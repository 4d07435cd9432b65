"""Meshes of STEP files and reductions kept on disk, by the hash of everything that decides them."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from dataclasses import dataclass, replace
from importlib.metadata import version
from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy.linalg import eigh, null_space

from bounds import MOST_BYTES, at_most
from dynamics.errors import InputError, ResultError, SolveError
from dynamics.housings.assembled_housing import (
    ACCEPTED,
    AssembledHousing,
    FreeModes,
    ModeStatus,
    assemble,
    basis_vectors,
    free_modes,
)
from dynamics.housings.quadrature import over_surface
from dynamics.housings.reduced_housing import (
    PointMotion,
    ReducedHousing,
    ReductionChecks,
    SurfaceMotion,
    rigid_motions,
)
from dynamics.housings.reduced_matrices import MaterialDamping, MeshedHousing
from dynamics.housings.step_files import WALL_ELEMENTS, mesh_step
from dynamics.housings.supports import in_axes
from dynamics.housings.tetrahedral_mesh import TetrahedralMesh
from dynamics.types import FloatArray, IntArray
from dynamics.work_cost import Cost, measured, on_this_host
from model_studies.kept_file import kept_in
from model_studies.netcdf import UnreadableFile
from model_studies.record_file import read_record, write_record

# Component mode synthesis: free modes and residual flexibility, in coordinates of Craig and Bampton.


INDEPENDENT = 1e-12
"""Share of a deflection that is not in the modes kept, in modal mass, below which it adds nothing."""
SINGULAR = 1e-12
REFERENCE = 1e5
"""Freedoms at which the figures below hold: walls 10 mm thick, the reference host of `host_speed`.

Fitted to a thin-walled cast box of 9 500 to 221 000 freedoms and 20 to 80 modes.
"""
ASSEMBLY, FACTOR, SOLVE = 2.9, 6.8, 0.074
"""CPU seconds: matrices and their ordering, factor, one step of Lanczos' method or one deflection."""
ORTHOGONALIZATION, PROJECTION = 2.7e-4, 1.6e-4
"""CPU seconds: of a step against a vector of Lanczos' basis, of a pair of vectors in Galerkin's matrices."""
FIRST_STEPS, STEPS_PER_MODE = 36.0, 1.8
"""Of Lanczos' method, its restarts among them."""
REFINED = 2.0
"""Solutions for a deflection: one, and its refinement."""
FILL = 0.935e9
"""Bytes of the matrices and their factor."""
REDUCTION_VERSION = 5
"""Raised with every change of the numbers of a reduction, or of what is kept with them."""
WORK = "housing reduction"
"""Name of a reduction in the log of runs."""
MESH_VERSION = 1
"""Raised with every change of the mesh of a STEP file."""
MESH_SCHEMA = "lineofaction housing mesh"


@dataclass(frozen=True)
class _Coordinates:
    """Reduced coordinates: their mass and stiffness, and the housing's freedoms per coordinate, (f, r)."""

    mass: FloatArray
    stiffness: FloatArray
    motion: FloatArray


def reduce_housing(housing: MeshedHousing) -> ReducedHousing:
    """Reduce a housing to its seats and modes.

    Its motion is a sum of the natural modes with the seats free and the static deflections under forces on
    the seats (Craig and Chang, AIAA paper 77-405; Rubin, AIAA Journal 13 (1975) 995-1006), projected by
    Galerkin's method: natural frequencies kept are those of the mesh, static motion is exact, and so are
    rigid motions. The coordinates are those of Craig and Bampton (AIAA Journal 6 (1968) 1313-1319) there.
    Raises `InputError`: a seat, foot or point is not on the mesh, or two seats are one; `SolveError`: the
    stiffness is singular or the modes do not converge.
    """
    assembled = assemble(housing)
    modes = free_modes(assembled, housing.modes)
    _require_converged(modes, housing.modes)
    space = _independent(assembled, modes)
    coordinates = _craig_bampton(assembled, space)
    frequency = np.concatenate([np.zeros(modes.rigid.shape[1]), modes.frequency])
    motion, law = coordinates.motion, housing.damping
    springs, mounts = (_symmetric(motion.T @ (part @ motion)) for part in assembled.mounts)
    ratio, own = _own_damping(housing, assembled, coordinates, springs)
    nodes, triangles = np.unique(housing.mesh.surface, return_inverse=True)
    return ReducedHousing(
        mass=coordinates.mass,
        stiffness=coordinates.stiffness,
        damping=own + mounts,
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
        advice = "Ask for fewer modes, or check the mesh for parts that hardly hold together."
        raise SolveError(f"{len(modes.frequency)} of {count} modes of the housing converged. {advice}")
    if modes.status is ModeStatus.ILL_CONDITIONED:
        advice = "Check the quality of the mesh and the stiffness of the mounts."
        lost = f"{modes.solve_residual:.1e}, above {ACCEPTED:g}"
        raise SolveError(
            f"Of the work of forces on the housing's seats {lost}, is lost to rounding. {advice}"
        )


def _independent(housing: AssembledHousing, modes: FreeModes) -> FloatArray:
    """Return rigid motions, modes and what the deflections add to them, unit modal masses, (f, r)."""
    kept = np.hstack([modes.rigid, modes.shape])
    rest = modes.deflection
    for _ in range(2):  # the second time takes out what rounding left
        rest = rest - kept @ (kept.T @ (housing.mass @ rest))
    own = np.einsum("fs,fs->s", modes.deflection, housing.mass @ modes.deflection)
    gram = rest.T @ (housing.mass @ rest) / np.sqrt(np.outer(own, own))
    value, vector = np.linalg.eigh(gram)
    if value[0] <= INDEPENDENT * value[-1]:
        names = [frame.name for frame in housing.frames]
        raise InputError(
            "seats", names, "independent of each other", "Two seats share a bore: make them one."
        )
    return np.hstack([kept, rest / np.sqrt(own) @ (vector / np.sqrt(value))])


def _craig_bampton(housing: AssembledHousing, space: FloatArray) -> _Coordinates:
    """Change to coordinates of which the first are the motions of the seats."""
    mass, stiffness = (_symmetric(space.T @ (matrix @ space)) for matrix in (housing.mass, housing.stiffness))
    seats = housing.seats @ space
    held = null_space(seats)
    static = np.linalg.pinv(seats)
    inside = held.T @ stiffness @ held
    static = static - held @ (
        np.linalg.pinv(inside, SINGULAR, hermitian=True) @ (held.T @ stiffness @ static)
    )
    _, shape = eigh(inside, held.T @ mass @ held)
    change = np.hstack([static, held @ shape])
    return _Coordinates(
        _symmetric(change.T @ mass @ change), _symmetric(change.T @ stiffness @ change), space @ change
    )


def _own_damping(
    housing: MeshedHousing, assembled: AssembledHousing, coordinates: _Coordinates, springs: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return damping ratios of all reduced modes, and their damping matrix, without that of the mounts."""
    square, shape = eigh(coordinates.stiffness, coordinates.mass)
    square[: assembled.loose.shape[1]] = 0.0
    energy = np.einsum("rm,rs,sm->m", shape, springs, shape, optimize=True)
    share = np.where(square > 0.0, 1.0 - energy / np.where(square > 0.0, square, 1.0), 0.0)
    ratio = housing.damping.ratios(np.clip(share, 0.0, 1.0))
    impulse = coordinates.mass @ shape
    own = impulse @ np.diag(2.0 * ratio * np.sqrt(np.maximum(square, 0.0))) @ impulse.T
    return ratio, _symmetric(own)


def _residuals(housing: MeshedHousing, assembled: AssembledHousing, modes: FreeModes) -> ReductionChecks:
    mesh = housing.mesh
    area, point = over_surface(mesh.points, mesh.surface)
    volume = float(np.einsum("tpi,tpi->", area, point)) / 3.0
    # how far the motion of seats is off in rigid motions of all nodes and rigid faces
    center = assembled.body.center
    mean = assembled.seats @ assembled.freedoms.rigid(housing.mesh.points, center)
    turned = np.hstack([np.zeros((3, 3)), np.eye(3)])
    bodies = (np.vstack([rigid_motions(frame.position[None], center), turned]) for frame in assembled.frames)
    expected = np.vstack(
        [in_axes(frame) @ body for frame, body in zip(assembled.frames, bodies, strict=True)]
    )
    return ReductionChecks(
        abs(housing.material.density * volume / assembled.body.mass - 1.0),
        modes.eigen_residual,
        modes.solve_residual,
        modes.rigid_ratio,
        float(np.abs(mean - expected).max() / np.abs(expected).max()),
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


# Time and memory of a reduction, predicted before it runs.


class CostLimit(NamedTuple):
    """What a reduction may cost: CPU seconds and bytes."""

    seconds: float = 600.0
    bytes: float = MOST_BYTES


def reduction_cost(freedoms: int, modes: int, motions: int) -> Cost:
    """Predict the cost of `reduce_housing` on the reference host.

    A solid block fills its factor more.

    Parameters
    ----------
    freedoms : int
        Of the mesh.
    motions : int
        Of all seats.
    """
    size = freedoms / REFERENCE
    steps, basis = FIRST_STEPS + STEPS_PER_MODE * modes, basis_vectors(modes)
    seconds = (
        ASSEMBLY * size**1.3
        + FACTOR * size**1.55
        + SOLVE * size**1.25 * (steps + REFINED * motions)
        + size**1.1 * (ORTHOGONALIZATION * steps * basis + PROJECTION * (modes + motions) ** 2)
    )
    vectors = basis + modes + 4.0 * motions
    return Cost(seconds, FILL * size**1.1 + 8.0 * freedoms * vectors)


@dataclass(frozen=True)
class _KeptMesh:
    """Nodes and elements of a mesh, as `TetrahedralMesh` has them."""

    points: FloatArray
    tetrahedra: IntArray


def meshed_step(
    path: str | Path, element_size: float | None = None, cache: Path | None = None
) -> TetrahedralMesh:
    """Return the mesh of a STEP file, from the cache if it is there.

    Parameters
    ----------
    path, element_size
        As `mesh_step` takes them, and it raises the same.
    cache : Path, optional
        Directory of kept results; None: neither read nor written.
    """
    file = None
    if cache is not None and Path(path).is_file():
        facts = repr([MESH_VERSION, WALL_ELEMENTS, version("gmsh"), version("meshlane"), element_size])
        content = hashlib.sha256(Path(path).read_bytes() + facts.encode()).hexdigest()
        file = cache / f"mesh-{content}.nc"
    return kept_in(file, _read_mesh, lambda: mesh_step(path, element_size), _write_mesh, UnreadableFile)


def _read_mesh(file: Path) -> TetrahedralMesh:
    kept = read_record(file, {MESH_SCHEMA: _KeptMesh})
    return TetrahedralMesh(kept.points, kept.tetrahedra)


def _write_mesh(mesh: TetrahedralMesh, file: Path) -> None:
    write_record(_KeptMesh(mesh.points, mesh.tetrahedra), file, MESH_SCHEMA)


def reduced_housing(
    housing: MeshedHousing,
    cache: Path | None = None,
    limit: CostLimit | None = None,
    expected: Callable[[Cost], object] = lambda _cost: None,
) -> ReducedHousing:
    """Return a housing's reduction with what it cost, from the cache if it is there.

    Raises `InputError` as `reduce_housing`, or the predicted cost is above the limit; `SolveError` as
    `reduce_housing`.

    Parameters
    ----------
    cache : Path, optional
        Directory of kept results (see `host.default_cache_directory`) and of what is known of the host; None:
        neither read nor written.
    limit : CostLimit, optional
        What computing it may cost. Default: 600 CPU s and 8 GB.
    expected : callable, optional
        Called with the predicted cost before it is computed; not where it is in the cache.
    """
    file = None if cache is None else cache / f"housing-{content_key(housing)}.nc"

    def reduced() -> ReducedHousing:
        motions = sum(seat.motions for seat in housing.seats)
        reference = reduction_cost(housing.mesh.freedoms, housing.modes, motions)
        predicted = on_this_host(WORK, reference, cache)
        most, own = limit or CostLimit(), f"{housing.mesh.freedoms} freedoms, {housing.modes} modes"
        advice = f"{own}: use a coarser mesh or fewer modes."
        if predicted.seconds > most.seconds:
            raise InputError("predicted_seconds", predicted.seconds, at_most(most.seconds, "s"), advice)
        if predicted.bytes > most.bytes:
            raise InputError("predicted_bytes", predicted.bytes, at_most(most.bytes), advice)
        expected(predicted)
        body, cost = measured(WORK, reference, cache, lambda: reduce_housing(housing))
        return replace(body, cost=cost)

    return kept_in(file, ReducedHousing.from_netcdf, reduced, ReducedHousing.to_netcdf, ResultError)


def content_key(housing: MeshedHousing) -> str:
    """Return the SHA-256 of mesh, settings and versions, hexadecimal."""
    mesh = housing.mesh
    digest = hashlib.sha256()
    for array in (mesh.points, mesh.tetrahedra, *(mesh.groups[name] for name in sorted(mesh.groups))):
        values = np.ascontiguousarray(array)
        digest.update(f"{values.dtype.str} {values.shape}".encode())
        digest.update(values.tobytes())
    facts = [
        REDUCTION_VERSION,
        *(version(name) for name in ("scipy", "scikit-fem")),
        sorted(mesh.groups),
        housing.material,
        housing.seats,
        housing.feet,
        list(housing.points.items()),
        housing.modes,
        housing.damping,
    ]
    digest.update(repr(facts).encode())
    return digest.hexdigest()
