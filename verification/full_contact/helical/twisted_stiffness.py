"""Stiffness of a section that turns along the axis, as products of plane and layer functions.

In the frame that turns with the helix, u = R(k z) v, all sections are alike and a derivative along z is
v' - k d v + k (-v_y, v_x), with d = x d/dy - y d/dx about the axis. All integrals stay products of one over
the plane and one over z. A field that does not vary along the contact line has another derivative along z:
that by k r_b n, with n the direction from the base circle, so that the plane alone is left.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import reduce
from operator import add

import numpy as np
import scipy.sparse as sp

from fe_contact.material import Material
from fe_contact.mesh.quality import shape_derivatives
from fe_contact.types import FloatArray, IntArray
from verification.full_contact.condensation.plane_strain_stiffness import POINTS, WEIGHTS
from verification.full_contact.helical.displacement_gradient import Part, along_line, part_pairs, turning
from verification.full_contact.over_face.extruded_stiffness import (
    ExtrudedStiffness,
    X,
    Y,
    Z,
    layered_products,
    linear_functions,
    quadratic_shapes,
    scattered,
)
from verification.full_contact.over_face.layers import Layers


def outward(points: FloatArray, base_radius: float) -> FloatArray:
    """Return at points (n, 2) the unit tangents to the base circle, normals of right flanks, (n, 2)."""
    radius = np.linalg.norm(points, axis=-1, keepdims=True)
    sine = np.minimum(base_radius / radius, 1.0)
    radial = points / radius
    clockwise = radial[:, ::-1] * [1.0, -1.0]
    return np.asarray(np.sqrt(1.0 - sine**2) * radial + sine * clockwise)


def _plane_matrices(section: Section, names: set[tuple[str, str]]) -> dict[tuple[str, str], sp.csr_array]:
    """Return the integrals of P f Q g over a plane mesh, by the names of P and Q."""
    nodes = section.points[section.triangles]
    totals = {both: np.zeros((len(nodes), 6, 6)) for both in names}
    for slope, value, weight in zip(
        shape_derivatives(POINTS), quadratic_shapes(POINTS), WEIGHTS, strict=True
    ):
        jacobian = slope @ nodes
        area = (weight * np.linalg.det(jacobian))[:, None, None]
        x, y = np.moveaxis(np.linalg.solve(jacobian, np.broadcast_to(slope, (len(nodes), 2, 6))), 1, 0)
        at = np.einsum("a,eax->ex", value, nodes)
        drift = section.twist * section.base_radius * outward(at, section.base_radius)
        applied = {
            "1": np.broadcast_to(value, x.shape),
            "x": x,
            "y": y,
            "d": at[:, :1] * y - at[:, 1:] * x,
            "t": drift[:, :1] * x + drift[:, 1:] * y,
        }
        for one, other in names:
            totals[one, other] += area * applied[one][:, :, None] * applied[other][:, None, :]
    return {both: scattered(local, section.triangles, len(section.points)) for both, local in totals.items()}


@dataclass(frozen=True)
class Section:
    """Plane mesh of one gear about its axis, with its twist along the face."""

    points: FloatArray
    """Nodes in the gear's own frame, m. Shape (n, 2)."""
    triangles: IntArray
    """Corners counter-clockwise, then the middles of sides 0-1, 1-2, 2-0. Shape (e, 6)."""
    twist: float
    """Turn of the section along z, counter-clockwise, rad/m."""
    base_radius: float
    """Base radius of the gear, m."""


def twisted_stiffness(section: Section, layers: Layers, material: Material) -> ExtrudedStiffness:
    """Assemble linear elasticity over all layers; displacements are those in the frame of the section."""
    hats, bubbles = np.split(np.arange(2 * layers.count + 1), [layers.count + 1])
    count, corners = len(section.points), np.unique(section.triangles[:, :3])
    shapes = (sp.eye_array(count, format="csr"), linear_functions(section.triangles, corners, count))
    pairs = part_pairs(turning(section.twist), material)
    plane = _plane_matrices(section, _names(pairs))
    mass, mixed, steep = layers.integrals()
    over = {(False, False): mass, (True, False): mixed, (False, True): mixed.T, (True, True): steep}
    rows = []
    for i in (X, Y, Z):
        row = []
        for k in (X, Y, Z):
            sums: dict[tuple[bool, bool], sp.csr_array] = {}
            for one, other, value in pairs[i, k]:
                key = one.along, other.along
                term = value * plane[one.plane, other.plane]
                sums[key] = sums[key] + term if key in sums else term
            terms = [(term, over[key]) for key, term in sums.items()]
            row.append(layered_products(terms, shapes, (hats, bubbles)))
        rows.append(sp.hstack(row))
    numbering = ((np.arange(count), hats), (corners, bubbles))
    node = np.concatenate([np.repeat(nodes, len(functions)) for nodes, functions in numbering])
    function = np.concatenate([np.tile(functions, len(nodes)) for nodes, functions in numbering])
    matrix = sp.csc_array(sp.vstack(rows, format="csc"))
    component = np.repeat([X, Y, Z], len(node))
    return ExtrudedStiffness(matrix, np.tile(node, 3), component, np.tile(function, 3), layers.count)


def section_stiffness(section: Section, material: Material) -> sp.csc_array:
    """Assemble what does not vary along the contact line, (3 n, 3 n), N/m per m; freedom 3 i + c."""
    pairs = part_pairs(along_line(), material)
    plane = _plane_matrices(section, _names(pairs))
    rows = []
    for i in (X, Y, Z):
        row = []
        for k in (X, Y, Z):
            terms = [value * plane[one.plane, other.plane] for one, other, value in pairs[i, k]]
            row.append(reduce(add, terms))
        rows.append(sp.hstack(row))
    matrix = sp.csr_array(sp.vstack(rows, format="csr"))
    order = np.arange(3 * len(section.points)).reshape(3, -1).T.ravel()
    return sp.csc_array(matrix[order][:, order])


def _names(pairs: dict[tuple[int, int], list[tuple[Part, Part, float]]]) -> set[tuple[str, str]]:
    return {(one.plane, other.plane) for parts in pairs.values() for one, other, _ in parts}
