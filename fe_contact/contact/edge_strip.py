r"""Strips near a tip edge: the center of their load, and the yield of the corner under them.

A strip is the loaded area of one slice of the face width; the patch is the area over which the finite
elements of the compliance were loaded. The patch has one length, but the strip is shorter under less load, so
its middle is nearer to the edge, where the bodies yield more. The strip also moves as the flanks tilt, less
if it ends at the edge than where it is free. Here F is the force, tau the tilt of the flanks by the bodies
(positive towards tip 1), phi the angle by which rigid flanks open from the edge, s = +-1 the direction away
from the edge and R the relative radius. The energy has the additional term

    E = F s tau X(F, phi + s tau/2),    d(F X)/dF = M.

X is the distance of the strip's centroid from the patch's, M the distance of the strip's middle from it: an
increment of load presses like a flat punch over the strip, with its resultant in the middle. X is taken at
half the tilt, as E is the integral over the tilt. A free strip has X = -phi R plus a constant, which leaves
the term -F R tau^2/2 that holds anywhere on a flank.

The corner is softer than a half plane. The local law holds the part w of this additional softness. A strip
that does not reach the edge yields as on a half plane, however long it is. The approach that the law lacks is

    Y = k_c [(1 - w) F ln(a) - int ln(h_G) dF + w int ln(h) dF].

k_c is the additional softness of the corner, a the half-width of the patch on a half plane and h half the
length of the strip; h_G is h, but the distance of the strip's middle from the edge while the strip does not
reach the edge (docs/theory/contact.md).

With the opening of a parabola the length l of a strip that reaches the edge follows from its load,
3 l^2/4 - l d = c R: d is the offset of the touching point from the edge, and c = 4 p/(pi E*) with the load p
over the width, a length, is the `scaled` force of the functions. A free strip has (l/2)^2 = c R.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from fe_contact.contact.kernel import kernel
from fe_contact.types import BoolArray, FloatArray
from host.loops import njit

SIDE, OFFSET, RADIUS, SOFTNESS, PATCH, MISSING, CORNER, LENGTH = range(8)
"""Columns of a table of edge strips (..., n, 8), in the order of the fields of `EdgeStrips`."""
EDGE_REACH = 2.0
"""Distance from an edge, in half-widths of the patch, within which a strip may reach the edge, with a margin
for loads up to twice the largest.
"""
_SHORTEST = 1e-12
"""Least scaled force 4 p/(pi E*) over the radius: keeps quotients and logarithms finite without load."""


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


def edge_table(strips: EdgeStrips, there: BoolArray) -> FloatArray:
    """Return strips of n slices at Q positions as a table (Q, n, 8).

    `there` (Q, n): whether the slice exists at the position; rows of slices that do not, or that are at no
    edge, are 0.
    """
    table = np.stack(np.broadcast_arrays(*strips), axis=-1)
    return np.where(there[..., None] & (table[..., :1] != 0.0), table, 0.0)  # the first column is `side`


def no_edges(slices: int) -> FloatArray:
    """Return a table of slices none of which is at an edge."""
    return np.zeros((1, slices, len(EdgeStrips._fields)))


class EdgeMotion(NamedTuple):
    """Derivatives of the energy E by force and tilt, and the corner's yield that the local law lacks."""

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


@kernel
def edge_position(
    offset: float, radius: float, softness: float, force: float
) -> tuple[float, float, float, float, float]:
    """Return where a strip at an edge presses; it is free while its half-width is below `offset`.

    Returns
    -------
    centroid, middle : float
        Distances from the edge, m.
    by_angle, by_angle_2 : float
        First and second derivative of the centroid by the angle between the flanks, m.
    growth : float
        Derivative of the strip's length by the scaled force 4 p/(pi E*); 0 if the strip is free.
    """
    scaled = max(softness * force, _SHORTEST * radius)  # 4 p/(pi E*)
    if scaled * radius <= offset * max(offset, 0.0):  # half-width below the offset; never for an offset < 0
        return offset, offset, -radius, 0.0, 0.0
    length = (2.0 / 3.0) * (offset + math.sqrt(offset * offset + 3.0 * scaled * radius))
    # the next four follow from 3 l^2/4 - l d = c R by differentiation; d changes by -R per unit of the angle
    growth, square = radius / (1.5 * length - offset), length * length / scaled
    centroid = 0.25 * square * (length - offset) / radius
    return centroid, 0.5 * length, -0.25 * square, 0.5 * square * growth, growth


@kernel
def edge_motion(edge: FloatArray, i: int, force: float, tilt: float) -> EdgeMotion:
    """Return the motion by a force in N on slice i and a tilt of its flanks; `edge` (n, 8) is a table."""
    side, radius, softness, patch = edge[i, SIDE], edge[i, RADIUS], edge[i, SOFTNESS], edge[i, PATCH]
    position = edge_position(edge[i, OFFSET] - 0.5 * radius * side * tilt, radius, softness, force)
    centroid, middle, by_angle, by_angle_2, growth = position
    # the length changes with the angle by -growth times the length; the middle is half the length
    middle_by_angle = -growth * middle if growth > 0.0 else -radius
    corner, slope = _corner(edge, i, force)
    # by_force, by_tilt, force_force, force_tilt, tilt_tilt, corner, softness
    return EdgeMotion(
        side * tilt * (middle - patch),
        force * (side * (centroid - patch) + 0.5 * tilt * by_angle),
        0.5 * side * tilt * growth * softness,
        side * (middle - patch) + 0.5 * tilt * middle_by_angle,
        force * (by_angle + 0.25 * side * tilt * by_angle_2),
        corner,
        slope,
    )


@kernel
def _corner(edge: FloatArray, i: int, force: float) -> tuple[float, float]:
    """Return Y of the file's head in m, and its derivative by the force in m/N; `part` is 1 - w."""
    offset, radius, softness, part = edge[i, OFFSET], edge[i, RADIUS], edge[i, SOFTNESS], edge[i, MISSING]
    if part == 0.0 and offset <= 0.0:
        return 0.0, 0.0  # the local law has all of the corner's softness
    scaled = max(softness * force, _SHORTEST * radius)
    # half is h, far is h_G. By parts the integral of ln h over F is F ln h less that of F/h over h, and
    # `rigid` is half the softness times the latter.
    half, rigid, reached, far = math.sqrt(scaled * radius), 0.25 * scaled, 0.0, offset
    if half >= offset:  # the strip reaches the edge
        half = far = edge_position(offset, radius, softness, force)[1]
        rigid = (0.75 * half * half - offset * half) / radius
        if offset > 0.0:
            rigid += 0.5 * offset * offset / radius  # of the loads under which the strip was free
            reached = offset * offset / (radius * softness)  # force at which the strip reaches the edge, N
    law = force * math.log(half) - 2.0 * rigid / softness  # the integral of ln h over the force
    strip_part = law + 0.5 * reached if half == far else force * math.log(far)  # the integral of ln h_G
    log_patch = math.log(edge[i, LENGTH])
    missing = part * force * log_patch - strip_part + (1.0 - part) * law
    slope = part * log_patch - math.log(far) + (1.0 - part) * math.log(half)
    return edge[i, CORNER] * missing, edge[i, CORNER] * slope


@njit(cache=True, error_model="numpy")
def edge_motions(edge: FloatArray, tilt: FloatArray, pressed: FloatArray, motions: FloatArray) -> None:
    """Add to motions (P, L, n) in m what strips at edges move under forces `pressed` (P, L, n) in N.

    P positions, L loads, n slices. `edge` (Q, n, 8) is a table and `tilt` (Q, n, n) the tilt at a slice by a
    unit force on another; both are repeated along the positions, P a multiple of Q.
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
