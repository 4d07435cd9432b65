"""One gear over its face, condensed to the nodes of its strips: an even and an odd half problem in z.

With z from mid-face, loads that are the same at -z make u_x, u_y even and u_z odd: u_z = 0 at mid-face.
Opposite loads make u_x, u_y odd and u_z even: u_x = u_y = 0 there. Each has half the unknowns.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from scipy.linalg import cho_factor, cho_solve

from fe_contact.material import Material
from fe_contact.types import FloatArray, IntArray
from verification.full_contact.condensation.condensed_body import dissected, mesh_graph
from verification.full_contact.condensation.placed_mesh import PlacedBody
from verification.full_contact.over_face.extruded_stiffness import (
    ExtrudedStiffness,
    X,
    Y,
    Z,
    extruded_stiffness,
)
from verification.full_contact.over_face.layers import Layers
from verification.full_contact.over_face.schur_complement import ColumnMatrix, schur_complement


@dataclass(frozen=True)
class ExtrudedBody:
    """One gear seen from its strips; unknown (2 i + c) f + l is function l of component c of node i.

    Functions are the f hats and bubbles of the layers; a bubble of a mid-side node is the mean of those of
    its neighbors, so that the compliance has the rank of the mesh.
    """

    body: PlacedBody
    layers: Layers
    nodes: IntArray
    """Numbers of all nodes of the strips. Shape (k,)."""
    columns: Mapping[int, IntArray]
    """Positions in `nodes` of the nodes of each strip, by pair index."""
    even: FloatArray
    odd: FloatArray
    """`even`, `odd`: Displacement of half the face per force, m/N, where the other half has the same or the
    opposite displacement. Shape (2 k f, 2 k f) each.
    """
    bore_moment: FloatArray
    """Moment about the center of the reactions at the held circle of half the face by even forces, m. Shape
    (2 k f,).
    """
    unknowns: int
    """Number of unknowns of both half problems."""

    @property
    def arms(self) -> FloatArray:
        """Moment about the center by unit forces on all functions, (2 k f,) m."""
        x, y = (self.points - self.body.center).T
        hats = np.arange(2 * self.layers.count + 1) <= self.layers.count
        return np.asarray((np.stack([-y, x], axis=-1)[:, :, None] * hats).ravel())

    @property
    def points(self) -> FloatArray:
        """Undeformed nodes of the strips, (k, 2) m."""
        return self.body.points[self.nodes]

    def displacement(self, forces: sp.csr_array) -> FloatArray:
        """Return the displacements (2 2 k f, h) by forces (h, 2 2 k f).

        Of either, first those of the half of positive face position, then of the other.
        """
        count = len(self.even)
        positive, negative = forces[:, :count], forces[:, count:]
        alike = (0.5 * (positive + negative)) @ self.even
        opposite = (0.5 * (positive - negative)) @ self.odd
        return np.asarray(np.concatenate([alike + opposite, alike - opposite], axis=1).T)


def extruded_body(body: PlacedBody, layers: Layers, material: Material) -> ExtrudedBody:
    """Assemble, eliminate, condense; raises `SolveError`: the stiffness is not positive definite."""
    stiffness = extruded_stiffness(body.points, body.triangles, layers, material)
    nodes = np.unique(np.concatenate([strip.nodes for strip in body.strips.values()]))
    columns = {ahead: np.searchsorted(nodes, strip.nodes) for ahead, strip in body.strips.items()}
    even, moment = _half(stiffness, body, nodes, odd=False)
    odd, _ = _half(stiffness, body, nodes, odd=True)
    return ExtrudedBody(body, layers, nodes, columns, even, odd, moment, 2 * len(stiffness.node))


def _half(
    stiffness: ExtrudedStiffness, body: PlacedBody, nodes: IntArray, *, odd: bool
) -> tuple[FloatArray, FloatArray]:
    """Return compliance and held moment of one half problem; the turn of the held circle is kept last."""
    graph = mesh_graph(body.triangles, len(body.points))
    inner = np.setdiff1d(np.arange(len(body.points)), np.concatenate([nodes, body.bore_nodes]))
    order = np.concatenate([dissected(graph, inner), nodes])
    free, starts = _columns(stiffness, order, len(body.points), odd=odd)
    lower = _bordered(stiffness.matrix, free, _turned_circle(stiffness, body))
    seat_neighbors = sp.csr_array((graph[body.bore_nodes].sum(axis=0)[order] > 0.0).astype(float)[None])
    bordered = sp.hstack([graph[order][:, order], seat_neighbors.T])
    circle = sp.hstack([seat_neighbors, sp.csr_array(np.ones((1, 1)))])
    joined = sp.csr_array(sp.vstack([bordered, circle], format="csr"))
    matrix = ColumnMatrix(lower, np.append(starts, starts[-1] + 1), joined)
    complement = schur_complement(matrix, len(nodes) + 1)
    retained = free[starts[len(inner)] :]
    in_plane = stiffness.component[retained] != Z
    inverse = cho_solve(cho_factor(complement[:-1, :-1]), np.eye(len(retained)))
    expansion = _expansion(stiffness, retained[in_plane], body, nodes)
    compliance = expansion @ (expansion @ inverse[np.ix_(in_plane, in_plane)]).T
    moment = expansion @ (inverse @ complement[-1, :-1])[in_plane]
    return 0.5 * (compliance + compliance.T), moment


def _columns(
    stiffness: ExtrudedStiffness, order: IntArray, count: int, *, odd: bool
) -> tuple[IntArray, IntArray]:
    """Return the unknowns that are free, node by node in the order of elimination, and where nodes start."""
    rank = np.full(count, -1)
    rank[order] = np.arange(len(order))
    at_middle = (stiffness.function == 0) & ((stiffness.component != Z) == odd)
    free = np.flatnonzero((rank[stiffness.node] >= 0) & ~at_middle)
    free = free[np.argsort(rank[stiffness.node[free]], kind="stable")]
    return free, np.searchsorted(rank[stiffness.node[free]], np.arange(len(order) + 1))


def _turned_circle(stiffness: ExtrudedStiffness, body: PlacedBody) -> FloatArray:
    """Return all unknowns (m,) where the held circle turns by 1 rad counter-clockwise, all else at rest."""
    arms = body.points[stiffness.node] - body.center
    rates = np.select([stiffness.component == X, stiffness.component == Y], [-arms[:, 1], arms[:, 0]])
    hats = stiffness.function <= stiffness.layers
    return np.where(hats & np.isin(stiffness.node, body.bore_nodes), rates, 0.0)


def _bordered(matrix: sp.csc_array, free: IntArray, turned: FloatArray) -> sp.csc_array:
    """Return the lower triangle of the free unknowns, then the turn of the held circle."""
    reaction = matrix @ turned
    last = sp.csr_array(reaction[free][None])
    ends = sp.csr_array(np.array([[turned @ reaction]]))
    return sp.csc_array(
        sp.vstack(
            [
                sp.hstack([sp.tril(matrix[free][:, free]), sp.csr_array((len(free), 1))]),
                sp.hstack([last, ends]),
            ],
            format="csc",
        )
    )


def _expansion(
    stiffness: ExtrudedStiffness, retained: IntArray, body: PlacedBody, nodes: IntArray
) -> sp.csr_array:
    """Return all functions of the strips' nodes (2 k f,) from the unknowns of the mesh there."""
    functions = 2 * stiffness.layers + 1
    node, component, function = (
        stiffness.node[retained],
        stiffness.component[retained],
        stiffness.function[retained],
    )
    bubble = function > stiffness.layers
    to = [node]
    share = [np.ones(len(retained))]
    for strip in body.strips.values():
        corners, middles = strip.nodes[::2], strip.nodes[1::2]
        for ends in (corners[:-1], corners[1:]):
            middle_of = np.full(len(body.points), -1)
            middle_of[ends] = middles
            to.append(np.where(bubble, middle_of[node], -1))
            share.append(np.full(len(retained), 0.5))
    target = np.concatenate(to)
    rows = (2 * np.searchsorted(nodes, target) + np.tile(component, len(to))) * functions
    rows = rows + np.tile(function, len(to))
    columns, used = np.tile(np.arange(len(retained)), len(to)), target >= 0
    entries = np.concatenate(share)[used], (rows[used], columns[used])
    return sp.csr_array(sp.coo_array(entries, shape=(2 * len(nodes) * functions, len(retained))))
