"""Shapes of a housing's surface: natural modes and operating deflections."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dynamics.checks import integer
from dynamics.errors import InputError
from dynamics.housing_modes.reduced_housing import ReducedHousing, SurfaceMotion
from dynamics.types import FloatArray, IntArray
from dynamics.vibration.seat_forces import ComplexArray

QUARTERS = np.array([[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]])
"""Nodes of the four plane facets of a triangle with six nodes."""


@dataclass(frozen=True)
class SurfaceShape:
    """Complex peak amplitudes of the motion of a surface.

    Attributes
    ----------
    points : (p, 3) array
        m.
    triangles : (t, 6) int array
        Corners, counter-clockwise from outside, then mid-side nodes.
    motion : (p, 3) complex array
        m, m/s or m/s^2; of a mode, real, with the largest motion 1.
    """

    points: FloatArray
    triangles: IntArray
    motion: ComplexArray

    @property
    def facets(self) -> IntArray:
        """Return plane triangles, four for each of six nodes, (4 t, 3)."""
        return np.asarray(self.triangles[:, QUARTERS].reshape(-1, 3))

    @property
    def normal_motion(self) -> ComplexArray:
        """Return the mean outward motion of each facet, (4 t,)."""
        a, b, c = np.moveaxis(self.points[self.facets], 1, 0)
        normal = np.cross(b - a, c - a)
        normal /= np.linalg.norm(normal, axis=1)[:, None]
        return np.asarray(np.sum(self.motion[self.facets].mean(axis=1) * normal, axis=1))


def operating_deflection(housing: ReducedHousing, motion: ComplexArray) -> SurfaceShape:
    """Return the surface's motion by that of the reduced coordinates, (r,), of any quantity."""
    surface = _surface(housing)
    return SurfaceShape(surface.points, surface.triangles, np.asarray(surface.motion @ motion, dtype=complex))


def mode_shape(housing: ReducedHousing, number: int) -> SurfaceShape:
    """Return a natural mode of the housing with its seats free; `number` counts from 1, rigid motions first.

    Raises
    ------
    InputError
        There is no such mode, or the housing has no surface.
    """
    integer("number", number, 1, len(housing.frequency))
    shape = operating_deflection(housing, housing.modes[1][:, number - 1].astype(complex))
    largest = np.linalg.norm(shape.motion, axis=1).max()
    return SurfaceShape(shape.points, shape.triangles, shape.motion / largest)


def _surface(housing: ReducedHousing) -> SurfaceMotion:
    """Return the surface, or say that there is none."""
    if housing.surface is None:
        advice = "Reduce its mesh or STEP file: matrices alone have no surface."
        raise InputError("surface", "none", "a housing with a surface", advice)
    return housing.surface
