"""Meshes of quadratic tetrahedra on a lattice, mapped to bodies in closed form."""

from collections.abc import Callable
from itertools import permutations

import numpy as np

from dynamics.housings import TetrahedralMesh
from dynamics.housings.tetrahedral_mesh import EDGES

Array = np.ndarray


def lattice_mesh(cells: tuple[int, int, int], place: Callable[[Array], Array], closed: bool = False):
    """Six tetrahedra a cell; `place` maps points of the unit cube; `closed` joins the ends along its x."""
    count = 2 * np.array(cells)
    corner = np.stack(np.meshgrid(*(2 * np.arange(n) for n in cells), indexing="ij"), -1).reshape(-1, 3)
    elements = []
    for order in permutations(range(3)):
        steps = np.vstack([np.zeros(3, int), np.cumsum(2 * np.eye(3, dtype=int)[list(order)], axis=0)])
        if np.linalg.det(steps[1:]) < 0:
            steps = steps[[0, 2, 1, 3]]
        ten = np.vstack([steps, (steps[EDGES[:, 0]] + steps[EDGES[:, 1]]) // 2])
        elements.append(corner[:, None] + ten)
    lattice = np.concatenate(elements)
    if closed:
        lattice[..., 0] %= count[0]
    flat, inverse = np.unique(lattice.reshape(-1, 3), axis=0, return_inverse=True)
    return TetrahedralMesh(place(flat / count), inverse.reshape(-1, 10))


def box(size: tuple[float, float, float], cells: tuple[int, int, int]) -> TetrahedralMesh:
    return lattice_mesh(cells, lambda unit: unit * np.array(size))


def tube(outer: float, bore: float, length: float, cells: tuple[int, int, int]) -> TetrahedralMesh:
    """Around z; cells around, through the wall, along."""

    def place(unit: Array) -> Array:
        angle, radius = -2.0 * np.pi * unit[:, 0], 0.5 * (bore + (outer - bore) * unit[:, 1])
        return np.stack([radius * np.cos(angle), radius * np.sin(angle), length * unit[:, 2]], axis=1)

    return lattice_mesh(cells, place, closed=True)
