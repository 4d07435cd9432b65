"""Sound pressure of a housing by boundary elements: the check of that by its panels as monopoles."""

from __future__ import annotations

from typing import cast

import numpy as np

from dynamics.acoustics import Air, exterior_pressure, outer_hull
from dynamics.acoustics.hull import ComplexArray
from dynamics.housing_modes.reduced_housing import ReducedHousing
from dynamics.noise.coarse_hull import radiating_hull
from dynamics.types import FloatArray
from dynamics.vibration.modal_amplitudes import modal_amplitudes


def scattered_pressure_transfer(
    housing: ReducedHousing, microphones: FloatArray, frequency: float, air: Air | None = None
) -> ComplexArray:
    """Return the sound pressure at microphones per force on the seats, scattering of the housing included.

    What `pressure_transfer` neglects. Each frequency takes 10 to 60 CPU s.

    Parameters
    ----------
    housing : ReducedHousing
        With mass and a surface.
    microphones : (P, 3) array
        In the frame of the housing's mesh, m.
    frequency : float
        Hz.

    Returns
    -------
    (P, s) complex array
        By the seats' motions, Pa/N and Pa/(N m).

    Raises
    ------
    InputError, MissingExtra, SolveError
        As `outer_hull`, `modal_amplitudes` and `exterior_pressure` do.
    """
    air = air or Air()
    hull = radiating_hull(outer_hull(housing), frequency, air.sound_speed)
    shapes = cast(ComplexArray, hull.shapes @ housing.modes[1])
    per_mode = exterior_pressure(hull.hull, frequency, shapes, np.atleast_2d(microphones), air)
    unit = np.eye(housing.motions, dtype=complex)[None]
    amplitude = modal_amplitudes(housing, np.array([frequency]), unit)[0]
    return np.asarray(2j * np.pi * frequency * per_mode @ amplitude.T)
