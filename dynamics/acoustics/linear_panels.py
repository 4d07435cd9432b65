"""Linear functions on the panels of a hull as sparse matrices from nodes to panels."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from scipy import sparse

from dynamics.acoustics.hull import ComplexArray, Hull
from dynamics.types import FloatArray


class LinearPanels:
    """Hat functions of the nodes: their means, surface curls and products on plane triangles."""

    def __init__(self, hull: Hull) -> None:
        self.hull = hull

    def _by_corner(self, values: FloatArray) -> sparse.csr_array:
        """Return the (T, N) matrix of values (T, 3) at the corners of panels."""
        panels, nodes = len(self.hull.triangles), len(self.hull.nodes)
        rows = np.repeat(np.arange(panels), 3)
        return sparse.csr_array((values.ravel(), (rows, self.hull.triangles.ravel())), (panels, nodes))

    @cached_property
    def mean(self) -> sparse.csr_array:
        """Return the means over the panels, (T, N)."""
        return self._by_corner(np.full(self.hull.triangles.shape, 1.0 / 3.0))

    @cached_property
    def curls(self) -> list[sparse.csr_array]:
        """Return x, y and z of n x grad of the hats, constant on a panel, 3 times (T, N), 1/m."""
        corners = self.hull.corners
        opposite = np.roll(corners, -2, axis=1) - np.roll(corners, -1, axis=1)
        slopes = opposite / (2.0 * self.hull.areas[:, None, None])
        return [self._by_corner(slopes[:, :, axis]) for axis in range(3)]

    @cached_property
    def mass(self) -> sparse.csr_array:
        """Return the integrals of the products of two hats, (N, N), m^2."""
        triangles, nodes = self.hull.triangles, len(self.hull.nodes)
        products = self.hull.areas[:, None, None] * (np.ones((3, 3)) + np.eye(3)) / 12.0
        rows, columns = np.repeat(triangles, 3, axis=1), np.tile(triangles, (1, 3))
        return sparse.csr_array((products.ravel(), (rows.ravel(), columns.ravel())), (nodes, nodes))

    def hypersingular(self, single: ComplexArray, wavenumber: float) -> ComplexArray:
        """Return the hypersingular operator, (N, N), by parts from the single layer of panels, (T, T).

        The part without derivatives takes the means of the hats: an error of second order in the edges, as
        that of the plane panels themselves.
        """
        normal_means = [sparse.diags_array(self.hull.normals[:, axis]) @ self.mean for axis in range(3)]
        total = np.zeros((len(self.hull.nodes),) * 2, dtype=complex)
        for curl, mean in zip(self.curls, normal_means, strict=True):
            total += np.asarray(curl.T @ (single @ curl))
            total -= wavenumber**2 * np.asarray(mean.T @ (single @ mean))
        return total
