"""The sound power that passes a sphere far away."""

from __future__ import annotations

import numpy as np

from dynamics.acoustics.hull import ComplexArray, Hull
from dynamics.acoustics.plane_waves import directions

MARGIN = 8
"""Spherical harmonics above the wavenumber times the radius, whose part of the far field is below 1e-6."""
MIDDLES = 0.5 * (np.ones((3, 3)) - np.eye(3))  # barycentric coordinates of the edges' middles


def far_field_resistance(
    hull: Hull, wavenumber: float, pressure: ComplexArray, slope: ComplexArray
) -> ComplexArray:
    """Return the integral over all directions of conj(p_i) p_j, (M, M), Pa^2 m^2, p r in the far field.

    Parameters
    ----------
    pressure : (N, M) array
        At the nodes, linear in between, of the kernel e^{+ikr}.
    slope : (T, M) array
        dp/dn of the panels.
    """
    center = hull.areas @ hull.centers / hull.area
    radius = float(np.linalg.norm(hull.nodes - center, axis=1).max())
    vectors, weights = directions(int(np.ceil(wavenumber * radius)) + MARGIN)
    cosines = vectors @ hull.normals.T
    far = np.zeros((len(vectors), pressure.shape[1]), dtype=complex)
    for middle in MIDDLES:  # quadrature of second degree on every panel
        points = np.einsum("c,tcd->td", middle, hull.corners) - center
        at = np.einsum("c,tcm->tm", middle, pressure[hull.triangles])
        phase = np.exp(-1j * wavenumber * vectors @ points.T) * hull.areas / 3.0
        far += (-1j * wavenumber * cosines * phase) @ at - phase @ slope
    far /= 4.0 * np.pi
    return np.asarray((far.conj().T * weights) @ far)
