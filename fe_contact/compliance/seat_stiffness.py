"""Stiffness of an elastic seat under the bore: a foundation in cylindrical components."""

from __future__ import annotations

import math

import numpy as np

from fe_contact.body import BoreSeat
from fe_contact.compliance.coarse_face import face_functions
from fe_contact.geometry import Toothing
from fe_contact.mesh.element_stack import LOWER_FACE
from fe_contact.mesh.sector_grid import SectorGrid
from fe_contact.types import FloatArray


def face_mass() -> FloatArray:
    """Return the products of the eight functions of a face integrated over -1 .. 1 squared, (8, 8)."""
    t, weight = np.polynomial.legendre.leggauss(3)
    x, y = (part.ravel() for part in np.meshgrid(t, t))
    functions = face_functions(x, y)
    return np.asarray(functions.T * np.outer(weight, weight).ravel() @ functions)


def seat_stiffness(gear: Toothing, grid: SectorGrid, thickness: float, seat: BoreSeat) -> FloatArray:
    """Return the matrix (60, 60) of the seat below one element on the bore, N/m.

    Nodes on the bore are equally spaced in angle, so the radial, tangential and axial displacements are
    quadratic over a rectangle of the unrolled cylinder: a turn of the whole bore is met exactly, on
    helical meshes too. Only the finite stiffnesses count; freedoms in rigid directions are held.
    """
    area = gear.seat_radius * 2.0 * math.pi / gear.teeth / grid.columns * thickness
    mass = 0.25 * area * face_mass()
    matrix, nodes = np.zeros((20, 3, 20, 3)), np.array(LOWER_FACE)
    for c, stiffness in enumerate(seat.stiffness):
        if math.isfinite(stiffness):
            matrix[nodes[:, None], c, nodes, c] = stiffness * mass
    return matrix.reshape(60, 60)
