"""Stiffness of an extruded plane mesh: 15-node wedges as products of plane and layer functions.

The functions of a wedge are the six quadratics of the triangle times the two hats of the layer, and its three
linear functions times the bubble. All integrals are products of one over the plane and one over z, so that
layers need no assembly of their own.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from fe_contact.material import Material
from fe_contact.mesh.quality import shape_derivatives
from fe_contact.types import FloatArray, IntArray
from verification.full_contact.condensation.plane_strain_stiffness import POINTS, WEIGHTS
from verification.full_contact.over_face.layers import Layers

Term = tuple[sp.csr_array, FloatArray]
X, Y, Z = range(3)


@dataclass(frozen=True)
class ExtrudedStiffness:
    """Stiffness of all unknowns of half the face."""

    matrix: sp.csc_array
    """Stiffness of the body, N/m. (m, m) sparse array."""
    node: IntArray
    component: IntArray
    function: IntArray
    """`node`, `component`, `function`: Node of the plane mesh, direction, and number of the layer function of
    each unknown. Shape (m,) each.
    """
    layers: int
    """Number of functions that are hats; the later ones are bubbles."""


def extruded_stiffness(
    points: FloatArray, triangles: IntArray, layers: Layers, material: Material
) -> ExtrudedStiffness:
    """Assemble linear elasticity over half the face.

    Parameters
    ----------
    points : (n, 2) array
        Nodes of the plane mesh, m.
    triangles : (e, 6) int array
        Corners counter-clockwise, then the middles of sides 0-1, 1-2, 2-0.
    """
    hats, bubbles = np.split(np.arange(2 * layers.count + 1), [layers.count + 1])
    corners = np.unique(triangles[:, :3])
    shapes = (sp.eye_array(len(points), format="csr"), linear_functions(triangles, corners, len(points)))
    rows = [
        sp.hstack([layered_products(terms, shapes, (hats, bubbles)) for terms in row])
        for row in _terms(points[triangles], triangles, len(points), layers, material)
    ]
    numbering = ((np.arange(len(points)), hats), (corners, bubbles))
    node = np.concatenate([np.repeat(nodes, len(over)) for nodes, over in numbering])
    function = np.concatenate([np.tile(over, len(nodes)) for nodes, over in numbering])
    component = np.repeat([X, Y, Z], len(node))
    matrix = sp.csc_array(sp.vstack(rows, format="csc"))
    return ExtrudedStiffness(matrix, np.tile(node, 3), component, np.tile(function, 3), layers.count)


def layered_products(
    terms: list[Term], shapes: tuple[sp.csr_array, sp.csr_array], over: tuple[IntArray, IntArray]
) -> sp.csr_array:
    """Return the sum of products of plane and layer integrals: quadratics x hats, then linears x bubbles."""
    return sp.csr_array(
        sp.vstack(
            [
                sp.hstack(
                    [
                        sum(
                            sp.kron(left.T @ plane @ right, z[np.ix_(layer, other)], format="csr")
                            for plane, z in terms
                        )
                        for right, other in zip(shapes, over, strict=True)
                    ]
                )
                for left, layer in zip(shapes, over, strict=True)
            ],
            format="csr",
        )
    )


def linear_functions(triangles: IntArray, corners: IntArray, count: int) -> sp.csr_array:
    """Return the linear functions of corners in quadratic ones, (n, c): 1 there, 1/2 at mid-side nodes."""
    number = np.full(count, -1)
    number[corners] = np.arange(len(corners))
    sides = np.concatenate([triangles[:, [0, 1, 3]], triangles[:, [1, 2, 4]], triangles[:, [2, 0, 5]]])
    _, first = np.unique(sides[:, 2], return_index=True)
    sides = sides[first]
    rows = np.concatenate([corners, sides[:, 2], sides[:, 2]])
    columns = np.concatenate([number[corners], number[sides[:, 0]], number[sides[:, 1]]])
    values = np.concatenate([np.ones(len(corners)), np.full(2 * len(sides), 0.5)])
    return sp.csr_array((values, (rows, columns)), shape=(count, len(corners)))


def _terms(
    nodes: FloatArray, triangles: IntArray, count: int, layers: Layers, material: Material
) -> Iterator[list[list[Term]]]:
    """Give for every pair of directions the products of plane and layer integrals of their stiffness."""
    modulus, nu = material.youngs_modulus, material.poissons_ratio
    shear = modulus / (2.0 * (1.0 + nu))
    bulk = modulus * nu / ((1.0 + nu) * (1.0 - 2.0 * nu))  # Lame's first constant
    plane = {name: scattered(local, triangles, count) for name, local in _integrals(nodes).items()}
    mass, mixed, steep = layers.integrals()
    gradients = plane["xx"] + plane["yy"]
    for a in "xyz":
        row = []
        for b in "xyz":
            if "z" not in (a, b):
                both = bulk * plane[a + b] + shear * plane[b + a]
                shear_term = [(shear * plane["1"], steep)] if a == b else []
                row.append([(both + shear * gradients if a == b else both, mass), *shear_term])
            elif a == b:
                row.append([((bulk + 2.0 * shear) * plane["1"], steep), (shear * gradients, mass)])
            elif b == "z":
                row.append([(bulk * plane[a], mixed.T), (shear * plane[a].T, mixed)])
            else:
                row.append([(bulk * plane[b].T, mixed), (shear * plane[b], mixed.T)])
        yield row


def _integrals(nodes: FloatArray) -> dict[str, FloatArray]:
    """Return the element integrals (e, 6, 6) of f g, f,x g, f,y g and f,a g,b of nodes (e, 6, 2)."""
    slopes, values = shape_derivatives(POINTS), quadratic_shapes(POINTS)
    integrals = {name: np.zeros((len(nodes), 6, 6)) for name in ("1", "x", "y", "xx", "xy", "yx", "yy")}
    for slope, value, weight in zip(slopes, values, WEIGHTS, strict=True):
        jacobian = slope @ nodes  # (e, d, x)
        determinant = np.linalg.det(jacobian)
        x, y = np.moveaxis(np.linalg.solve(jacobian, np.broadcast_to(slope, (len(nodes), 2, 6))), 1, 0)
        area = (weight * determinant)[:, None, None]
        integrals["1"] += area * np.outer(value, value)
        for name, left in (("x", x), ("y", y)):
            integrals[name] += area * left[:, :, None] * value
            for other, right in (("x", x), ("y", y)):
                integrals[name + other] += area * left[:, :, None] * right[:, None, :]
    return integrals


def quadratic_shapes(at: FloatArray) -> FloatArray:
    """Return the quadratic functions (q, 6) at reference points (q, 2)."""
    x, y = at.T
    z = 1.0 - x - y
    parts = [z * (2 * z - 1), x * (2 * x - 1), y * (2 * y - 1), 4 * z * x, 4 * x * y, 4 * y * z]
    return np.stack(parts, axis=-1)


def scattered(local: FloatArray, triangles: IntArray, count: int) -> sp.csr_array:
    """Add element matrices to one of all nodes."""
    rows = np.broadcast_to(triangles[:, :, None], local.shape).ravel()
    columns = np.broadcast_to(triangles[:, None, :], local.shape).ravel()
    return sp.csr_array(sp.coo_array((local.ravel(), (rows, columns)), shape=(count, count)))
