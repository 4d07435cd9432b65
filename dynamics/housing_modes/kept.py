"""Meshes of STEP files and reductions kept on disk, by the hash of everything that decides them."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path

import numpy as np

from dynamics.errors import ResultError
from dynamics.housing_modes.meshed_housing import MeshedHousing
from dynamics.housing_modes.reduced_housing import ReducedHousing
from dynamics.housing_modes.reduction import reduce_housing
from dynamics.housing_modes.reduction_cost import CostLimit, check_cost
from dynamics.housing_modes.step_mesh import WALL_ELEMENTS, mesh_step
from dynamics.housing_modes.tetrahedral_mesh import TetrahedralMesh
from dynamics.types import FloatArray, IntArray
from model_studies.array_file import UnreadableFile
from model_studies.kept_file import kept_in
from model_studies.record_file import read_record, write_record

REDUCTION_VERSION = 3
"""Raised with every change of the numbers of a reduction."""
MESH_VERSION = 1
"""Raised with every change of the mesh of a STEP file."""
MESH_SCHEMA = "lineofaction housing mesh"


@dataclass(frozen=True)
class KeptMesh:
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
        facts = repr([MESH_VERSION, WALL_ELEMENTS, version("gmsh"), version("meshio"), element_size])
        content = hashlib.sha256(Path(path).read_bytes() + facts.encode()).hexdigest()
        file = cache / f"mesh-{content}.nc"
    return kept_in(file, _read_mesh, lambda: mesh_step(path, element_size), _write_mesh, UnreadableFile)


def _read_mesh(file: Path) -> TetrahedralMesh:
    """Return a kept mesh."""
    kept = read_record(file, {MESH_SCHEMA: KeptMesh})
    return TetrahedralMesh(kept.points, kept.tetrahedra)


def _write_mesh(mesh: TetrahedralMesh, file: Path) -> None:
    """Keep a mesh."""
    write_record(KeptMesh(mesh.points, mesh.tetrahedra), file, MESH_SCHEMA)


def reduced_housing(
    housing: MeshedHousing, cache: Path | None = None, limit: CostLimit | None = None
) -> ReducedHousing:
    """Return a housing's reduction, from the cache if it is there.

    Parameters
    ----------
    housing : MeshedHousing
    cache : Path, optional
        Directory of kept results (see `host.default_cache_directory`); None: neither read nor written.
    limit : CostLimit, optional
        What computing it may cost. Default: 600 CPU s and 8 GB.

    Raises
    ------
    InputError
        As `reduce_housing`, or the predicted cost is above the limit.
    SolveError
        As `reduce_housing`.
    """
    file = None if cache is None else cache / f"housing-{content_key(housing)}.nc"
    read, write = ReducedHousing.from_netcdf, ReducedHousing.to_netcdf
    return kept_in(file, read, lambda: _reduced(housing, limit), write, ResultError)


def _reduced(housing: MeshedHousing, limit: CostLimit | None) -> ReducedHousing:
    """Reduce a housing unless it costs too much."""
    check_cost(housing, limit or CostLimit())
    return reduce_housing(housing)


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
