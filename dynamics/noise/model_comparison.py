"""Radiation models side by side at one order and speed."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from dynamics.acoustics import Air, ModelLadder, RadiationModel, compare_models, outer_hull
from dynamics.acoustics.hull import ComplexArray
from dynamics.housing_modes.reduced_housing import ReducedHousing
from dynamics.noise.coarse_hull import radiating_hull
from dynamics.vibration import BearingHarmonics, housing_motion, seat_forces
from model_studies.progress import Progress, silent


def models_at(
    response: BearingHarmonics,
    housing: ReducedHousing,
    bearings: Sequence[str] | None,
    at: tuple[int, int],
    models: Sequence[RadiationModel],
    progress: Progress = silent,
    offered: Sequence[RadiationModel] = (),
    cache: Path | None = None,
) -> ModelLadder:
    """Compute the sound power at one speed and order by several radiation models, on one hull in usual air.

    Parameters
    ----------
    response, housing, bearings
        As of `radiated_sound`.
    at : (int, int)
        Numbers of speed and order.
    models : sequence of RadiationModel
        From coarse to fine.
    progress, offered, cache
        As of `compare_models`.

    Raises
    ------
    InputError
        As `radiated_sound` does, or nothing moves.
    """
    air, hertz = Air(), float(response.frequency[at])
    hull = radiating_hull(outer_hull(housing), hertz, air.sound_speed)
    velocity = hull.shapes @ coordinate_velocity(response, housing, bearings, at)
    return compare_models(hull.hull, hertz, velocity, air, models, progress, offered, cache)


def coordinate_velocity(
    response: BearingHarmonics,
    housing: ReducedHousing,
    bearings: Sequence[str] | None,
    at: tuple[int, int],
) -> ComplexArray:
    """Return the velocity of a housing's coordinates at one speed and order, (r,), m/s."""
    force, hertz = seat_forces(response, housing, bearings)[at], response.frequency[at]
    return np.asarray(2j * np.pi * hertz * housing_motion(housing, np.asarray(hertz), force))
