"""Meshes of STEP files and reductions kept on disk, by the hash of everything that decides them."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from dataclasses import dataclass, replace
from importlib.metadata import version
from pathlib import Path

import numpy as np

from bounds import at_most
from dynamics.errors import InputError, ResultError
from dynamics.housings.meshed_housing import MeshedHousing
from dynamics.housings.reduced_housing import ReducedHousing
from dynamics.housings.reduction import reduce_housing
from dynamics.housings.reduction_cost import CostLimit, reduction_cost
from dynamics.housings.step_files import WALL_ELEMENTS, mesh_step
from dynamics.housings.tetrahedral_mesh import TetrahedralMesh
from dynamics.types import FloatArray, IntArray
from dynamics.work_cost import Cost, WorkMeter, on_this_host
from model_studies.cached_file import keep_cached, read_cached
from model_studies.netcdf import UnreadableFile
from model_studies.record_file import read_record, write_record

REDUCTION_VERSION = 6
"""Raised with every change of the numbers of a reduction, or of what is kept with them."""
WORK = "housing reduction"
"""Name of a reduction in the log of runs."""
MESH_VERSION = 1
"""Raised with every change of the mesh of a STEP file."""
MESH_SCHEMA = "lineofaction housing mesh"


@dataclass(frozen=True)
class _KeptMesh:
    """Nodes and elements of a mesh, as `TetrahedralMesh` has them."""

    points: FloatArray
    tetrahedra: IntArray


def meshed_step(
    path: str | Path, element_size: float | None = None, cache: Path | None = None
) -> TetrahedralMesh:
    """Return the mesh of a STEP file, from the cache if the cache has it.

    Parameters
    ----------
    path, element_size
        Arguments of `mesh_step`, which decides the errors too.
    cache : Path, optional
        Directory of kept results; None: neither read nor written.
    """
    file = None
    if cache is not None and Path(path).is_file():
        settings = repr([MESH_VERSION, WALL_ELEMENTS, version("gmsh"), version("meshio"), element_size])
        content = hashlib.sha256(Path(path).read_bytes() + settings.encode()).hexdigest()
        file = cache / f"mesh-{content}.nc"
    cached = read_cached(file, _read_mesh, UnreadableFile)
    if cached is not None:
        return cached
    mesh = mesh_step(path, element_size)
    keep_cached(mesh, file, _write_mesh)
    return mesh


def _read_mesh(file: Path) -> TetrahedralMesh:
    record = read_record(file, {MESH_SCHEMA: _KeptMesh})
    return TetrahedralMesh(record.points, record.tetrahedra)


def _write_mesh(mesh: TetrahedralMesh, file: Path) -> None:
    write_record(_KeptMesh(mesh.points, mesh.tetrahedra), file, MESH_SCHEMA)


def reduced_housing(
    housing: MeshedHousing,
    cache: Path | None = None,
    limit: CostLimit | None = None,
    expected: Callable[[Cost], object] = lambda _cost: None,
) -> ReducedHousing:
    """Return a housing's reduction with its cost, from the cache if the cache has it.

    Raises `InputError` as `reduce_housing`, or the predicted cost is above the limit; `SolveError` as
    `reduce_housing`.

    Parameters
    ----------
    cache : Path, optional
        Directory of kept results (see `host.default_cache_directory`) and of what is known of the host; None:
        neither read nor written.
    limit : CostLimit, optional
        Limits of the cost of the reduction. Default: 600 CPU s and 8 GB.
    expected : callable, optional
        Called with the predicted cost before it is computed; not where it is in the cache.
    """
    file = None if cache is None else cache / f"housing-{content_key(housing)}.nc"
    cached = read_cached(file, ReducedHousing.from_netcdf, ResultError)
    if cached is not None:
        return cached
    motions = sum(seat.motions for seat in housing.seats)
    reference = reduction_cost(housing.mesh.freedoms, housing.modes, motions)
    predicted = on_this_host(WORK, reference, cache)
    maximum, size = limit or CostLimit(), f"{housing.mesh.freedoms} freedoms, {housing.modes} modes"
    remedy = f"{size}: use a coarser mesh or fewer modes."
    if predicted.seconds > maximum.seconds:
        raise InputError("predicted_seconds", predicted.seconds, at_most(maximum.seconds, "s"), remedy)
    if predicted.bytes > maximum.bytes:
        raise InputError("predicted_bytes", predicted.bytes, at_most(maximum.bytes), remedy)
    expected(predicted)
    meter = WorkMeter.at_start(WORK, reference, cache)
    body = reduce_housing(housing)
    body = replace(body, cost=meter.finish())
    keep_cached(body, file, ReducedHousing.to_netcdf)
    return body


def content_key(housing: MeshedHousing) -> str:
    """Return the SHA-256 of mesh, settings and versions, hexadecimal."""
    mesh = housing.mesh
    digest = hashlib.sha256()
    for array in (mesh.points, mesh.tetrahedra, *(mesh.groups[name] for name in sorted(mesh.groups))):
        values = np.ascontiguousarray(array)
        digest.update(f"{values.dtype.str} {values.shape}".encode())
        digest.update(values.tobytes())
    settings = [
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
    digest.update(repr(settings).encode())
    return digest.hexdigest()
