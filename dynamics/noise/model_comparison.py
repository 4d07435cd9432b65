"""Radiation models side by side at one order and speed, and the panels that sound comes from there."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dynamics.acoustics import Air, ModelLadder, RadiationModel, compare_models, outer_hull, panel_power
from dynamics.acoustics.hull import ComplexArray
from dynamics.housing_modes.reduced_housing import ReducedHousing
from dynamics.noise.coarse_hull import radiating_hull
from dynamics.types import FloatArray
from dynamics.vibration import BearingHarmonics, housing_motion, seat_forces


def models_at(
    response: BearingHarmonics,
    housing: ReducedHousing,
    bearings: Sequence[str] | None,
    at: tuple[int, int],
    models: Sequence[RadiationModel],
    air: Air | None = None,
) -> ModelLadder:
    """Compute the sound power at one speed and order by several radiation models, on one hull.

    Parameters
    ----------
    response, housing, bearings
        As of `radiated_sound`.
    at : (int, int)
        Numbers of speed and order.
    models : sequence of RadiationModel
        From coarse to fine; boundary elements take 7 us times the square of the panels.

    Raises
    ------
    InputError
        As `radiated_sound` does, or nothing moves.
    """
    air, hertz = air or Air(), float(response.frequency[at])
    hull = radiating_hull(outer_hull(housing), hertz, air.sound_speed)
    velocity = hull.shapes @ _velocity(response, housing, bearings, at)
    return compare_models(hull.hull, hertz, velocity, air, models)


def panels_at(
    response: BearingHarmonics,
    housing: ReducedHousing,
    bearings: Sequence[str] | None,
    at: tuple[int, int],
    air: Air | None = None,
) -> FloatArray:
    """Return the equivalent radiated power of each panel of `outer_hull(housing)` at one speed and order.

    Returns
    -------
    (T,) array
        W; the sum is that of the whole by this model, which knows no interference.

    Raises
    ------
    InputError
        As `radiated_sound` does.
    """
    outer = outer_hull(housing)
    velocity = np.asarray(outer.shapes @ _velocity(response, housing, bearings, at))
    return panel_power(outer.hull, velocity, air or Air())


def _velocity(
    response: BearingHarmonics,
    housing: ReducedHousing,
    bearings: Sequence[str] | None,
    at: tuple[int, int],
) -> ComplexArray:
    """Return the velocity of the coordinates at one speed and order, (r,), m/s."""
    force, hertz = seat_forces(response, housing, bearings)[at], response.frequency[at]
    return np.asarray(2j * np.pi * hertz * housing_motion(housing, np.asarray(hertz), force))
