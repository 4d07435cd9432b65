"""The radiating surface: triangles with outward normals, and linear functions on them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from bounds import at_most
from dynamics.checks import positive
from dynamics.errors import InputError
from dynamics.types import BoolArray, ComplexArray, FloatArray, IntArray
from host.optional_modules import sparse

PANELS_PER_WAVELENGTH = 6.0
"""Least number of longest edges in a wavelength with which a model resolves the waves on the hull."""
ROUNDED_DOWN = 1.0 - 1e-12
"""Factor on a limit of wavelength or frequency: no panel exceeds the limit by rounding alone."""
FLAT = 1e-9
"""A triangle of less height over its longest edge has no normal."""


@dataclass(frozen=True)
class Hull:
    """A surface of plane triangles (panels), closed or open.

    Raises `InputError`: shapes are others, a node does not exist or is not finite, or a triangle has no area.
    """

    nodes: FloatArray
    """Positions of the nodes, m. Shape (N, 3)."""
    triangles: IntArray
    """Nodes of each panel, counterclockwise as seen from the air. Shape (T, 3)."""

    def __post_init__(self) -> None:
        nodes, triangles = np.asarray(self.nodes, dtype=float), np.asarray(self.triangles)
        if nodes.ndim != 2 or nodes.shape[1] != 3 or not np.all(np.isfinite(nodes)):
            raise InputError("nodes", nodes.shape, "finite positions of shape (N, 3)")
        if (
            triangles.ndim != 2
            or triangles.shape[1] != 3
            or not triangles.size
            or triangles.dtype.kind != "i"
        ):
            raise InputError("triangles", triangles.shape, "at least one triangle of integers, (T, 3)")
        if triangles.min() < 0 or triangles.max() >= len(nodes):
            raise InputError("triangles", int(triangles.max()), f"nodes from 0 to {len(nodes) - 1}")
        object.__setattr__(self, "nodes", nodes)
        object.__setattr__(self, "triangles", triangles)
        flat = flat_triangles(nodes, triangles)
        if np.any(flat):
            suggestion = "Remove triangles without an area."
            raise InputError(f"triangles[{int(np.argmax(flat))}]", 0.0, "a triangle with an area", suggestion)

    @cached_property
    def corners(self) -> FloatArray:
        """Return the corners of the panels, (T, 3, 3), m."""
        return self.nodes[self.triangles]

    @cached_property
    def centers(self) -> FloatArray:
        """Return the centroids of the panels, (T, 3), m."""
        return np.asarray(self.corners.mean(axis=1))

    @cached_property
    def area_vectors(self) -> FloatArray:
        """Return outward normals times areas, (T, 3), m^2."""
        a, b, c = np.moveaxis(self.corners, 1, 0)
        return np.asarray(0.5 * np.cross(b - a, c - a))

    @cached_property
    def areas(self) -> FloatArray:
        """Return the areas of the panels, (T,), m^2."""
        return np.asarray(np.linalg.norm(self.area_vectors, axis=1))

    @cached_property
    def normals(self) -> FloatArray:
        """Return the outward unit normals, (T, 3)."""
        return np.asarray(self.area_vectors / self.areas[:, None])

    @cached_property
    def area(self) -> float:
        """Return the whole area, m^2."""
        return float(self.areas.sum())

    @cached_property
    def volume(self) -> float:
        """Return the enclosed volume, m^3; negative where normals point inwards; of a closed hull alone."""
        return float(np.sum(self.centers * self.area_vectors) / 3.0)

    @property
    def equivalent_radius(self) -> float:
        """Return the radius of the sphere of the same volume, m; of a closed hull alone."""
        return float(np.cbrt(3.0 * abs(self.volume) / (4.0 * np.pi)))

    @cached_property
    def outer_radius(self) -> float:
        """Return the largest distance of a panel from the middle of all, m."""
        return float(np.linalg.norm(self.centers - self.centers.mean(axis=0), axis=1).max())

    @cached_property
    def _edges(self) -> FloatArray:
        """Return the lengths of the edges, (T, 3), m."""
        return np.asarray(np.linalg.norm(self.corners - np.roll(self.corners, 1, axis=1), axis=2))

    @property
    def longest_edge(self) -> float:
        """Return the length of the longest edge, m."""
        return float(self._edges.max())

    @cached_property
    def highest_wavenumber(self) -> float:
        """Return the wavenumber at which `PANELS_PER_WAVELENGTH` longest edges make a wavelength, 1/m."""
        return float(2.0 * np.pi / (PANELS_PER_WAVELENGTH * self.longest_edge))

    @property
    def closed(self) -> bool:
        """Whether every edge joins exactly two panels that run through it in opposite directions."""
        return self.open_edges.size == 0

    @cached_property
    def open_edges(self) -> IntArray:
        """Return nodes of the edges at which the hull is open, turned, or joined to itself, (E, 2)."""
        # an edge from node s to node e has the number s N + e, and e N + s in the opposite direction
        starts, ends = self.triangles, np.roll(self.triangles, -1, axis=1)
        along, against = starts * len(self.nodes) + ends, ends * len(self.nodes) + starts
        once, times = np.unique(along, return_counts=True)
        wrong = np.concatenate([np.setdiff1d(once, against), once[times > 1]])
        return np.stack(np.divmod(wrong, len(self.nodes)), axis=1)

    def longer_edges(self, length: float) -> IntArray:
        """Return nodes of the edges longer than `length` (m), (E, 2), once for each panel."""
        edges = np.stack([np.roll(self.triangles, 1, axis=1), self.triangles], axis=2)
        return edges[self._edges > length]

    def require_closed(self) -> None:
        """Refuse a hull that does not enclose a volume with its normals outwards.

        Raises `InputError`: an edge does not join exactly two panels that run through it in opposite
        directions, or the normals point inwards.
        """
        if not self.closed:
            suggestion = "Join nodes at the same position and close the openings of the outer hull."
            raise InputError(
                "triangles", f"{len(self.open_edges)} open or turned edges", "a closed hull", suggestion
            )
        positive("volume", self.volume, "Turn the triangles: their normals point inwards.")

    def require_resolved(
        self, wavenumber: float, sound_speed: float, edges: float = PANELS_PER_WAVELENGTH
    ) -> None:
        """Refuse a frequency whose waves the panels do not resolve.

        Raises `InputError`: fewer of the longest edges than `edges` fit in a wavelength.
        """
        highest = self.highest_wavenumber * PANELS_PER_WAVELENGTH / edges
        if wavenumber > highest:
            frequency = sound_speed / (2.0 * np.pi)
            bound = at_most(highest * frequency, "Hz", note=f", {edges:g} edges in a wavelength")
            raise InputError("frequency", wavenumber * frequency, bound, "Use smaller triangles.")


def shared_edges(triangles: IntArray) -> tuple[IntArray, IntArray, IntArray]:
    """Return pairs of triangles that share an edge, (E,) and (E,), and its nodes, (E, 2)."""
    edges = np.sort(np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=2), axis=2).reshape(-1, 2)
    _, edge = np.unique(edges, axis=0, return_inverse=True)  # three edges a triangle, one after the other
    order = np.argsort(edge.ravel(), kind="stable")
    shared = np.flatnonzero(np.diff(edge.ravel()[order]) == 0)
    return order[shared] // 3, order[shared + 1] // 3, edges[order[shared]]


def flat_triangles(nodes: FloatArray, triangles: IntArray) -> BoolArray:
    """Return which triangles have no area, (T,)."""
    corners = nodes[triangles]
    edges = corners - np.roll(corners, 1, axis=1)
    area = np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1)
    return np.asarray(area <= FLAT * np.sum(edges**2, axis=2).max(axis=1))


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
