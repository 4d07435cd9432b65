r"""Strips near a tip edge: the center of their load, and the yield of the corner under them.

The load patch of finite elements at an edge has one length. The strip is shorter under less load, so that its
middle is nearer to the edge, where the bodies yield more. It also moves as flanks tilt, less so where the
strip ends at the edge. With tau the tilt of the flanks by the bodies, positive towards tip 1, phi the angle
by which rigid flanks open from the edge, s the direction away from it and h the force, the energy has the
further part

    E = h s tau X(h, phi + s tau/2),    d(h X)/dh = M,

where X is the distance of the strip's centroid from that of the patch, and M that of the strip's middle,
since a small further load presses as a punch does. Half of the tilt counts in X, as E is its integral over
the tilt. Strips that do not end at the edge have X = -phi R, so that the tilt adds -h R tau^2/2, as anywhere
on a flank.

A strip near the edge that does not reach it yields as on a half plane, however long it is. The local law
includes a part of the corner's softness; the approach that it lacks is

    Y = k_c [(1 - w) F ln(a) - int ln(h_G) dF + w int ln(h) dF],

where k_c is the softness of the corner beyond that of a half plane, w the part of it in the law, a the
half-width of the patch, h half the strip, and h_G the distance of the strip's middle from the edge, which is
h where the strip reaches the edge (docs/theory/contact.md).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from fe_contact.types import BoolArray, FloatArray
from host.loops import inner, njit

SIDE, OFFSET, RADIUS, SOFTNESS, PATCH, MISSING, CORNER, LENGTH = range(8)
"""Columns of a table of edge strips (..., n, 8), in the order of the fields of `EdgeStrips`."""
EDGE_REACH = 2.0
"""Distance from an edge over half a patch within which strips may reach it, even under twice the largest
load.
"""
_SHORTEST = 1e-12
"""Least value of 4 p/(pi E*) over the radius, in place of loads too small to divide by."""


class EdgeStrips(NamedTuple):
    """Strips at tip edges, arrays (..., n) over slices."""

    side: FloatArray
    """Direction away from the edge: 1 is towards tip 1, -1 towards tip 2, 0 where no patch is at an edge."""
    offset: FloatArray
    """Distance of the touching point from the edge, m; negative = -phi R off the line of action."""
    radius: FloatArray
    """Relative radius in the normal section, m."""
    softness: FloatArray
    """Softness of a half plane, 4/(pi E*), over the width, 1/N m."""
    patch: FloatArray
    """Distance of the patch's centroid from the edge, m."""
    missing: FloatArray
    """Part of the corner's softness that is missing in the local law, 0 to 1."""
    corner: FloatArray
    """Additional softness of the corner beyond a half plane, over the width, m/N."""
    length: FloatArray
    """Half-width of the patch on a half plane, m."""


def edge_table(strips: EdgeStrips, present: BoolArray) -> FloatArray:
    """Return strips (Q, n) as a table (Q, n, 8), zeros where a slice is not present or not at an edge."""
    table = np.stack(np.broadcast_arrays(*strips), axis=-1)
    return np.where(present[..., None] & (table[..., :1] != 0.0), table, 0.0)


def no_edges(slices: int) -> FloatArray:
    """Return a table of slices none of which is at an edge."""
    return np.zeros((1, slices, len(EdgeStrips._fields)))


class EdgeMotion(NamedTuple):
    """Derivatives of the energy E by force and tilt, and the approach Y by the corner."""

    by_force: float
    by_tilt: float
    """`by_force`, `by_tilt`: First derivatives, m and N m."""
    force_force: float
    force_tilt: float
    tilt_tilt: float
    """`force_force`, `force_tilt`, `tilt_tilt`: Second derivatives, m/N, m and N m."""
    corner: float
    softness: float
    """`corner`, `softness`: Approach that the local law lacks, m, and its derivative by the force, m/N."""


@inner(error_model="numpy")
def edge_position(
    offset: float, radius: float, softness: float, force: float
) -> tuple[float, float, float, float, float]:
    """Return the position of a strip at an edge, and its derivatives.

    `offset` is that of `EdgeStrips` with the tilt of the flanks added.

    Returns
    -------
    centroid, middle : float
        Distances from the edge, m.
    by_angle, second_by_angle : float
        First and second derivative of the centroid with respect to the angle between the flanks, m.
    growth : float
        Derivative of the strip's length with respect to 4 p/(pi E*); 0 if it does not end at the edge.
    """
    scaled = max(softness * force, _SHORTEST * radius)  # 4 p/(pi E*)
    if scaled * radius <= offset * max(offset, 0.0):
        return offset, offset, -radius, 0.0, 0.0
    length = (2.0 / 3.0) * (offset + math.sqrt(offset * offset + 3.0 * scaled * radius))
    growth, square = radius / (1.5 * length - offset), length * length / scaled
    centroid = 0.25 * square * (length - offset) / radius
    return centroid, 0.5 * length, -0.25 * square, 0.5 * square * growth, growth


@inner(error_model="numpy")
def edge_motion(edge: FloatArray, i: int, force: float, tilt: float) -> EdgeMotion:
    """Return the motion under a force in N on slice i and a tilt of its flanks; `edge` (n, 8) is a table."""
    side, radius, softness, patch = edge[i, SIDE], edge[i, RADIUS], edge[i, SOFTNESS], edge[i, PATCH]
    position = edge_position(edge[i, OFFSET] - 0.5 * radius * side * tilt, radius, softness, force)
    centroid, middle, by_angle, second_by_angle, growth = position
    # derivative of the middle by the angle: that of the length is -growth times the length
    middle_by_angle = -growth * middle if growth > 0.0 else -radius
    corner, slope = _corner(edge, i, force)
    return EdgeMotion(
        side * tilt * (middle - patch),
        force * (side * (centroid - patch) + 0.5 * tilt * by_angle),
        0.5 * side * tilt * growth * softness,
        side * (middle - patch) + 0.5 * tilt * middle_by_angle,
        force * (by_angle + 0.25 * side * tilt * second_by_angle),
        corner,
        slope,
    )


@inner(error_model="numpy")
def _corner(edge: FloatArray, i: int, force: float) -> tuple[float, float]:
    """Return Y in m, and its derivative by the force in m/N."""
    offset, radius, softness, part = edge[i, OFFSET], edge[i, RADIUS], edge[i, SOFTNESS], edge[i, MISSING]
    if part == 0.0 and offset <= 0.0:
        return 0.0, 0.0  # the law has all of the corner's softness
    scaled = max(softness * force, _SHORTEST * radius)
    half, rigid, reached, far = math.sqrt(scaled * radius), 0.25 * scaled, 0.0, offset
    if half >= offset:
        half = far = edge_position(offset, radius, softness, force)[1]
        rigid = (0.75 * half * half - offset * half) / radius
        if offset > 0.0:
            rigid += 0.5 * offset * offset / radius
            reached = offset * offset / (radius * softness)
    law = force * math.log(half) - 2.0 * rigid / softness  # the integral of ln h over the force
    strip_part = law + 0.5 * reached if half == far else force * math.log(far)
    length = math.log(edge[i, LENGTH])
    missing = part * force * length - strip_part + (1.0 - part) * law
    steep = part * length - math.log(far) + (1.0 - part) * math.log(half)
    return edge[i, CORNER] * missing, edge[i, CORNER] * steep


@njit(cache=True, error_model="numpy")
def edge_motions(edge: FloatArray, tilt: FloatArray, pressed: FloatArray, motions: FloatArray) -> None:
    """Add the motions by strips at edges under forces `pressed` (P, L, n) in N to `motions` (P, L, n) in m.

    `edge` (Q, n, 8) is a table, `tilt` (Q, n, n) that of the contact problem, and P a multiple of Q.
    """
    for p in range(pressed.shape[0]):
        row, edges = tilt[p % tilt.shape[0]], edge[p % edge.shape[0]]
        for k in range(pressed.shape[1]):
            for j in range(pressed.shape[2]):
                if edges[j, SIDE] != 0.0:
                    slope = 0.0
                    for i in range(pressed.shape[2]):
                        slope += row[j, i] * pressed[p, k, i]
                    motion = edge_motion(edges, j, pressed[p, k, j], slope)
                    motions[p, k, j] += motion.by_force + motion.corner
                    for i in range(pressed.shape[2]):
                        motions[p, k, i] += motion.by_tilt * row[j, i]
