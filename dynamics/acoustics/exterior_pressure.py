"""Sound pressure in the air around a hull whose surface pressure is known."""

from __future__ import annotations

import numpy as np

from dynamics.acoustics.air import Air
from dynamics.acoustics.boundary_elements import surface_pressure
from dynamics.acoustics.far_field import MIDDLES
from dynamics.acoustics.hull import ComplexArray, Hull
from dynamics.types import FloatArray


def exterior_pressure(
    hull: Hull, frequency: float, shapes: ComplexArray, points: FloatArray, air: Air
) -> ComplexArray:
    """Return the sound pressure around a hull by boundary elements, its own scattering included.

    The Kirchhoff-Helmholtz integral of the pressure on the hull and its normal derivative. Points lie
    outside, a few of the longest edges away.

    Parameters
    ----------
    shapes : (T, M) array
        Normal velocities of the panels, > 0 outwards.
    points : (P, 3) array
        m.

    Returns
    -------
    (P, M) complex array
        Pa per m/s, peak amplitudes of e^{+i omega t}.

    Raises
    ------
    InputError, MissingExtra, SolveError
        As `surface_pressure` does.
    """
    wavenumber = 2.0 * np.pi * frequency / air.sound_speed
    pressure = surface_pressure(hull, frequency, shapes, air).pressure
    slope = -1j * wavenumber * air.impedance * shapes
    found = np.zeros((len(points), shapes.shape[1]), dtype=complex)
    for middle in MIDDLES:  # quadrature of second degree on every panel
        away = np.asarray(points)[:, None] - np.einsum("c,tcd->td", middle, hull.corners)
        distance = np.linalg.norm(away, axis=2)
        kernel = np.exp(-1j * wavenumber * distance) / (4.0 * np.pi * distance) * hull.areas / 3.0
        cosine = np.einsum("ptd,td->pt", away, hull.normals) / distance
        at = np.einsum("c,tcm->tm", middle, pressure[hull.triangles])
        found += (kernel * (1j * wavenumber + 1.0 / distance) * cosine) @ at - kernel @ slope
    return found
