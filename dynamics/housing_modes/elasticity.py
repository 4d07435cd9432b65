"""Mass and stiffness matrices of quadratic tetrahedra."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp

from dynamics.housing_modes.quadrature import over_volume, tetrahedron
from dynamics.housing_modes.tetrahedral_mesh import TetrahedralMesh
from dynamics.solid_housing import Material
from dynamics.types import FloatArray, IntArray

BATCH = 2000
"""Elements at a time: bounds the memory of what is dense."""


def mass_and_stiffness(mesh: TetrahedralMesh, material: Material) -> tuple[sp.csr_array, sp.csr_array]:
    """Return the consistent mass matrix per direction and the stiffness matrix.

    Parameters
    ----------
    mesh : TetrahedralMesh
    material : Material

    Returns
    -------
    mass : (n, n) sparse array
        kg, between nodes; it is the same for x, y and z.
    stiffness : (3 n, 3 n) sparse array
        N/m; freedom 3 i + k is the displacement of node i along axis k.
    """
    count = len(mesh.points)
    numbers = mesh.tetrahedra
    freedoms = np.reshape(3 * numbers[:, :, None] + np.arange(3), (len(numbers), 30))
    masses = np.empty((len(numbers), 10, 10))
    stiffnesses = np.empty((len(numbers), 30, 30))
    for first in range(0, len(numbers), BATCH):
        part = slice(first, first + BATCH)
        masses[part], stiffnesses[part] = _element_matrices(mesh.points, numbers[part], material)
    return _assembled(masses, numbers, count), _assembled(stiffnesses, freedoms, 3 * count)


def _element_matrices(
    points: FloatArray, tetrahedra: IntArray, material: Material
) -> tuple[FloatArray, FloatArray]:
    """Return the matrices of some elements: (e, 10, 10) and (e, 30, 30)."""
    volume, gradient = over_volume(points, tetrahedra)
    shape, (lame, shear) = tetrahedron().shape, material.lame
    mass = material.density * np.einsum("ap,bp,ep->eab", shape, shape, volume, optimize=True)
    flat = gradient.reshape(len(volume), 30, -1)
    # product[e, a, i, b, j]: integral of the slope of a along i times that of b along j
    product = ((flat * volume[:, None]) @ flat.transpose(0, 2, 1)).reshape(-1, 10, 3, 10, 3)
    stiffness = lame * product + shear * product.transpose(0, 1, 4, 3, 2)
    trace = shear * np.einsum("eakbk->eab", product)
    for axis in range(3):
        stiffness[:, :, axis, :, axis] += trace
    return mass, stiffness.reshape(-1, 30, 30)


def _assembled(matrices: FloatArray, freedoms: IntArray, size: int) -> sp.csr_array:
    """Add element matrices."""
    short = freedoms.astype(np.int32)  # half the memory
    rows, columns = np.broadcast_arrays(short[:, :, None], short[:, None, :])
    entries = (matrices.ravel(), (rows.ravel(), columns.ravel()))
    return sp.coo_array(entries, shape=(size, size)).tocsr()
