"""Rigid motions of points, and mass, center of gravity and inertia by them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dynamics.types import FloatArray
from host.optional_modules import sparse as sp


@dataclass(frozen=True)
class RigidBody:
    """A body that does not deform."""

    mass: float
    """Mass, kg."""
    center: FloatArray
    """Center of gravity, m. Shape (3,)."""
    inertia: FloatArray
    """About the center of gravity along the axes of the mesh, kg m^2; products with a minus sign. Shape (3,
    3).
    """


def rigid_motions(points: FloatArray, about: FloatArray) -> FloatArray:
    """Return displacements of points by unit translations and small rotations, (3 n, 6).

    Columns: x, y, z, rotations about x, y, z through `about`: u = t + theta x (p - about).
    """
    motions = np.zeros((len(points), 3, 6))
    motions[:, range(3), range(3)] = 1.0
    for axis, unit in enumerate(np.eye(3)):
        motions[:, :, 3 + axis] = np.cross(unit, points - about)
    return motions.reshape(-1, 6)


def rigid_body(points: FloatArray, mass: sp.csr_array) -> RigidBody:
    """Return mass, center of gravity and inertia by a mass matrix between nodes, (n, n)."""
    share = np.asarray(mass.sum(axis=0)).ravel()
    total_mass = float(share.sum())
    center = share @ points / total_mass
    arm = points - center
    second = arm.T @ (mass @ arm)
    return RigidBody(total_mass, center, np.trace(second) * np.eye(3) - second)
