"""Additional approach of a quarter space near its free end under an even load, by finite elements.

The closed form of `fe_contact.contact.free_end` against a quarter of a disc, 24 half strips in radius, that
is extruded from its free end over 36 half strips: `python -m benchmarks.quarter_space` prints both along the
surface.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu

from benchmarks.figures import Figure
from fe_contact.contact.free_end import FreeEnds, end_excess, end_softness
from fe_contact.material import Material
from fe_contact.types import BoolArray, FloatArray, IntArray
from verification.full_contact.over_face.extruded_stiffness import (
    ExtrudedStiffness,
    X,
    Y,
    Z,
    extruded_stiffness,
)
from verification.full_contact.over_face.layers import Layers, graded_layers

SUBJECT = "free end of a quarter space"
MODULUS = 1e9
"""Modulus of elasticity, Pa. The result does not depend on it."""
_GAUSS, _WEIGHTS = np.polynomial.legendre.leggauss(8)


@dataclass(frozen=True)
class QuarterDisc:
    """Six-node triangles on a grid of radii and angles; lengths in half strips, the surface on y = 0."""

    radius: float = 24.0
    """Radius of the outer arc, which is fixed, in half strips."""
    under_strip: int = 6
    angles: int = 8
    """`under_strip`, `angles`: Elements along half the strip, and from the surface to the plane of symmetry x
    = 0.
    """

    @cached_property
    def radii(self) -> FloatArray:
        """Radii of the corners: finest at the end of the strip, growing beyond it."""
        inside = np.sin(np.linspace(0.0, 0.5 * math.pi, self.under_strip + 1))
        count = round(2.3 * self.under_strip)
        outside = 1.0 + (self.radius - 1.0) * np.geomspace(1.0, 100.0, count + 1)[1:] / 100.0
        return np.concatenate([inside, outside])

    @cached_property
    def grid(self) -> tuple[IntArray, FloatArray]:
        """Numbers of the nodes by radius and angle, mid-side nodes in turn, and their places (n, 2)."""
        radii = _with_middles(self.radii)
        angle = -_with_middles(np.linspace(0.0, 0.5 * math.pi, self.angles + 1))
        number = np.zeros((radii.size, angle.size), dtype=np.int64)
        number[1:] = 1 + np.arange((radii.size - 1) * angle.size).reshape(-1, angle.size)
        along = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
        places = (radii[1:, None, None] * along).reshape(-1, 2)
        return number, np.concatenate([np.zeros((1, 2)), places])

    @property
    def triangles(self) -> IntArray:
        """Nodes of the triangles (e, 6), corners counter-clockwise, then middles of sides 0-1, 1-2, 2-0."""
        number, _ = self.grid
        found = []
        for i in range(0, number.shape[0] - 2, 2):
            for j in range(0, number.shape[1] - 2, 2):
                low, high = (i, j), (i + 2, j + 2)
                if i:
                    found.append(_triangle(number, low, (i, j + 2), high))
                found.append(_triangle(number, low if i else (0, j), high, (i + 2, j)))
        return np.array(found)

    @property
    def surface(self) -> IntArray:
        """Nodes of the sides under the strip (k, 3), outwards."""
        number, _ = self.grid
        return np.array([number[2 * i : 2 * i + 3, 0] for i in range(self.under_strip)])


def _with_middles(corners: FloatArray) -> FloatArray:
    values = np.repeat(corners, 2)[:-1]
    values[1::2] = 0.5 * (corners[1:] + corners[:-1])
    return values


Place = tuple[int, int]


def _triangle(number: IntArray, *corners: Place) -> list[int]:
    """Return corners and the middles of the sides between them; all places of row 0 are the center."""
    following = (*corners[1:], corners[0])
    middles = []
    for (i, j), (k, m) in zip(corners, following, strict=True):
        on_ray = j if k == 0 else m  # a side to the center runs along one angle
        middles.append(((i + k) // 2, on_ray if 0 in (i, k) else (j + m) // 2))
    return [int(number[place]) for place in (*corners, *middles)]


def quarter_space_excess(
    disc: QuarterDisc, poissons_ratio: float, layers: int = 18, length: float = 36.0
) -> tuple[FloatArray, FloatArray]:
    """Return distances from the end in half strips, and what the surface gives way more than far from it.

    Over k p, the mean over the semi-elliptic pressure.
    """
    over = graded_layers(2.0 * length, layers, 0.01)
    _, points = disc.grid
    body = extruded_stiffness(points, disc.triangles, over, Material(MODULUS, poissons_ratio))
    free = np.flatnonzero(~_fixed(disc, points, body))
    load = _loads(disc, body, over, len(points))
    matrix = sp.csc_array(body.matrix[free][:, free])
    moved = np.zeros(load.size)
    moved[free] = splu(
        matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True}
    ).solve(load[free])
    weights = _strip_weights(disc, len(points))[0]
    at_planes = np.zeros(layers + 1)
    on_surface = np.flatnonzero((body.component == Y) & (body.function <= layers))
    np.add.at(at_planes, body.function[on_surface], 2.0 * weights[body.node[on_surface]] * moved[on_surface])
    soft = 2.0 * (1.0 - poissons_ratio**2) / (math.pi * MODULUS)
    return over.planes[-1] - over.planes, -(at_planes - at_planes[0]) / soft


def _fixed(disc: QuarterDisc, points: FloatArray, body: ExtrudedStiffness) -> BoolArray:
    """Say which unknowns are zero: on the outer arc, across the plane of symmetry, across the far end.

    And those of no triangle: between the rays that meet in the center.
    """
    unused = np.isin(body.node, disc.triangles, invert=True)
    on_arc = np.isclose(np.linalg.norm(points, axis=1), disc.radius)[body.node]
    symmetric = (np.abs(points[:, 0]) < 1e-9)[body.node] & (body.component == X)
    return np.asarray(unused | on_arc | symmetric | ((body.component == Z) & (body.function == 0)))


def _loads(disc: QuarterDisc, body: ExtrudedStiffness, over: Layers, count: int) -> FloatArray:
    """Return the forces of the pressure, half a unit per length on the half that is meshed."""
    z, weights = over.quadrature
    functions = over.functions(z).T @ weights
    quadratic, linear = _strip_weights(disc, count)
    across = np.where(body.function <= over.count, quadratic[body.node], linear[body.node])
    return np.asarray(np.where(body.component == Y, -across * functions[body.function], 0.0))


def _strip_weights(disc: QuarterDisc, count: int) -> tuple[FloatArray, FloatArray]:
    """Integrate a semi-ellipse, of 1/2 over the half strip, times quadratic and linear functions (n,)."""
    _, points = disc.grid
    quadratic, linear = np.zeros((2, count))
    for side in disc.surface:
        low, high = points[side[0], 0], points[side[2], 0]
        ends = np.arcsin(np.clip([low, high], 0.0, 1.0))  # x = sin(t): the pressure has no root at its end
        t = 0.5 * (ends.sum() + np.diff(ends) * _GAUSS)
        force = 2.0 / math.pi * np.cos(t) ** 2 * 0.5 * np.diff(ends) * _WEIGHTS
        u = (np.sin(t) - low) / (high - low)
        quadratic[side] += np.stack([(1 - u) * (1 - 2 * u), 4 * u * (1 - u), u * (2 * u - 1)]) @ force
        linear[side[::2]] += np.stack([1 - u, u]) @ force
    return quadratic, linear


def closed_form(poissons_ratio: float, distance: FloatArray, far: float) -> FloatArray:
    """Return the closed form at distances from the end, less that at a `far` one, in half strips."""
    ends = FreeEnds(0.0, math.inf, end_softness(poissons_ratio))
    near = 1e-6
    both = np.append(distance, far) + near
    value = end_excess(ends, both, 2.0 * near, np.ones(both.size), 1e6)
    return np.asarray(value[:-1] - value[-1])


FAR = 5.0
"""Distance from the end up to which the disc, a finite body, deforms as a quarter space does, half strips."""


def largest_difference(disc: QuarterDisc, poissons_ratio: float, layers: int) -> float:
    """Return the largest difference of the closed form from finite elements, up to `FAR` from the end."""
    distance, excess = quarter_space_excess(disc, poissons_ratio, layers)
    near = np.flatnonzero(distance < FAR + 1.0)
    far = distance[near[0]]
    formula = closed_form(poissons_ratio, distance[near], float(far))
    return float(np.max(np.abs(excess[near] - excess[near[0]] - formula)))


def figures() -> list[Figure]:
    """Return the largest differences, over k p."""
    return [
        Figure(SUBJECT, f"closed form, nu {ratio:g}", largest_difference(QuarterDisc(), ratio, 18), "1", 0.03)
        for ratio in (0.2, 0.3, 0.35)
    ]


if __name__ == "__main__":
    for ratio in (0.2, 0.3, 0.4):
        distances, values = quarter_space_excess(QuarterDisc(), ratio)
        inside = distances < FAR + 1.0
        formula = closed_form(ratio, distances[inside], float(distances[inside][0]))
        print(f"nu {ratio:g}: distance, finite elements, closed form")
        for row in zip(distances[inside], values[inside] - values[inside][0], formula, strict=True):
            print("{:8.3f} {:8.4f} {:8.4f}".format(*row))
