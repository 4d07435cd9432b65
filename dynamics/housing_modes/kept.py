"""Reductions kept on disk, by the hash of everything that decides them."""

from __future__ import annotations

import hashlib
import os
from contextlib import suppress
from importlib.metadata import version
from pathlib import Path

import numpy as np

from dynamics.errors import ResultError
from dynamics.housing_modes.meshed_housing import MeshedHousing
from dynamics.housing_modes.reduced_housing import ReducedHousing
from dynamics.housing_modes.reduction import reduce_housing
from dynamics.housing_modes.reduction_cost import CostLimit, check_cost

REDUCTION_VERSION = 2
"""Raised with every change of the numbers of a reduction."""


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
    if file is not None:
        with suppress(ResultError):  # absent or damaged: computed again
            kept = ReducedHousing.from_netcdf(file)
            with suppress(OSError):  # of another owner
                os.utime(file)  # its last use, by which caches are kept small
            return kept
    check_cost(housing, limit or CostLimit())
    reduced = reduce_housing(housing)
    if file is not None:
        with suppress(OSError):  # a directory that cannot be written is no reason to lose the result
            file.parent.mkdir(parents=True, exist_ok=True)
            reduced.to_netcdf(file)
    return reduced


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
