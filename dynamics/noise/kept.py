"""Radiation resistances kept on disk, by the hash of everything that decides them."""

from __future__ import annotations

import hashlib
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from dynamics.acoustics import Air, RadiationModel
from dynamics.errors import ResultError
from dynamics.housing_modes.reduced_housing import ReducedHousing
from dynamics.noise.housing_radiation import HousingRadiation, housing_radiation
from dynamics.work_cost import announce
from model_studies.kept_file import kept_in
from model_studies.progress import Progress, silent

RADIATION_VERSION = 3
"""Raised with every change of the numbers of a resistance, or of what is kept with them."""
STAGE = "radiation"
LEAST_COST = 1.0
"""CPU seconds."""


def kept_radiation(
    housing: ReducedHousing,
    model: RadiationModel,
    frequencies: ArrayLike,
    air: Air | None = None,
    cache: Path | None = None,
    progress: Progress = silent,
) -> HousingRadiation:
    """Return `housing_radiation`, from the cache if it is there.

    Parameters
    ----------
    cache : Path, optional
        Directory of kept results and of what is known of the host; None: neither read nor written. What takes
        below a second is not kept.
    progress : callable, optional
        Called as progress("radiation", fraction), before costly work with its predicted cost behind it.

    Raises
    ------
    InputError
        As `housing_radiation` does.
    """
    ends = float(np.min(frequencies)), float(np.max(frequencies))
    file = None if cache is None else cache / f"radiation-{_content_key(housing, model, ends, air)}.nc"

    def computed() -> HousingRadiation:
        return housing_radiation(
            housing,
            model,
            ends,
            air,
            lambda fraction: progress(STAGE, fraction),
            lambda cost: announce(progress, STAGE, model.model_name.replace("_", " "), cost),
            cache,
        )

    def costly(made: HousingRadiation) -> bool:
        return bool(made.facts["cost"]["seconds"] > LEAST_COST)

    read, write = HousingRadiation.from_netcdf, HousingRadiation.to_netcdf
    return kept_in(file, read, computed, write, ResultError, costly)


def _content_key(
    housing: ReducedHousing, model: RadiationModel, ends: tuple[float, float], air: Air | None
) -> str:
    """Return the SHA-256 of surface, modes, model, range and version, hexadecimal."""
    digest = hashlib.sha256(repr((RADIATION_VERSION, model, ends, air or Air())).encode())
    surface = housing.surface
    arrays = () if surface is None else (surface.points, surface.triangles, surface.motion)
    for array in (*arrays, housing.mass, housing.stiffness):
        values = np.ascontiguousarray(array)
        digest.update(f"{values.dtype.str} {values.shape}".encode())
        digest.update(values.tobytes())
    return digest.hexdigest()
