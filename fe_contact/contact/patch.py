"""Load patches on a flank and their consistent nodal forces.

Away from the tip a patch is semi-elliptic, (2/(pi a)) sqrt(1 - x^2/a^2) about its center. Near a tip edge
it takes the form that contact has there (see `fe_contact.hertz`): over a length c from the
edge a mixture of the semi-ellipse and of (2/(pi c)) sqrt((c - x)/x), singular at the edge. With t the arc
distance of the contact from the edge (negative, -phi R, off the line of action) the singular share is (c/2
- t)/(3c/4 - t): none at t = c/2, where the patch is the semi-ellipse that just reaches the edge, so that
nothing jumps as a contact runs out.

Nodal forces are f_k = integral of p phi_k ds with the quadratic shape functions of the flank. Substituting
s = s0 + a sin(theta) removes the roots: the moments of the load on an element are elementary. Patches are
built at the exact position: an interpolated self compliance would ripple with the element length.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from fe_contact.contact.kernel import kernel
from fe_contact.types import BoolArray, FloatArray, IntArray


@dataclass(frozen=True)
class Patches:
    """Patches of one gear at P positions, Q side by side on each of n slices. Arrays are (P, n Q)."""

    center: FloatArray
    half_width: FloatArray
    """`center`, `half_width`: Flank coordinate of the middle and half the length, m."""
    edge_share: FloatArray
    """Share of the load that is singular at the tip edge, 0 to 1."""
    count: int = 1
    """Number Q of patches on a slice."""
    bulge: FloatArray | float = 0.0
    """`fe_contact.hertz.lateral_share` times the curvature of the flank, 1/m; 0 of a half plane."""
    at_tip: BoolArray | bool = False
    """Whether a patch ends at the tip edge."""

    def rows(self, keep: IntArray) -> Patches:
        """Return the patches at the positions `keep`."""
        shape = self.center.shape
        return replace(
            self,
            center=self.center[keep],
            half_width=self.half_width[keep],
            edge_share=self.edge_share[keep],
            bulge=np.asarray(np.broadcast_to(self.bulge, shape)[keep]),
            at_tip=np.asarray(np.broadcast_to(self.at_tip, shape)[keep]),
        )

    def by_slice(
        self, position: int | IntArray, slices: IntArray
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return centers, half-widths and edge shares (k, Q) on some slices, at one position or one each."""
        center, half_width, edge_share = (
            values.reshape(len(values), -1, self.count)[position, slices]
            for values in (self.center, self.half_width, self.edge_share)
        )
        return center, half_width, edge_share

    @property
    def centroid(self) -> FloatArray:
        """Flank coordinate of the load's centroid, m."""
        return self.center + 0.5 * self.edge_share * self.half_width

    @property
    def edge_distance(self) -> FloatArray:
        """Distance of the load's centroid from the upper end of the patch, where an edge may be, m."""
        return self.half_width * (1.0 - 0.5 * self.edge_share)

    @property
    def at_edge(self) -> FloatArray:
        """Share of the strip at the edge: 0 until it reaches the edge, 1 where rigid flanks touch there."""
        return np.minimum(1.5 * self.edge_share, 1.0)

    def stretched(self, part: float, mate: Patches) -> Patches:
        """Return patches of the same form whose length at a tip edge is larger by a part of it.

        Where only the patch of the mate is at its edge, the patch on this gear moves with the load on the
        mate, towards the tip.
        """
        half = np.where(self.at_tip, (1.0 + part) * self.half_width, self.half_width)
        moves_with_mate = np.logical_and(mate.at_tip, np.logical_not(self.at_tip))
        # a longer patch at an edge keeps its upper end there
        shift = np.where(moves_with_mate, part * mate.edge_distance, self.half_width - half)
        center = self.center + shift
        return replace(self, center=center, half_width=half)

    @cached_property
    def law_width(self) -> FloatArray:
        """Half-width a in m of the semi-elliptic patch with the same mean displacement on a half plane.

        The mean is weighted by the load. Let w be the density of the load over the patch, of length c from
        the edge x = 0, and t the distance of the contact from the edge. Then ln a = ln 2 + 1/4 + E_w[ln x] +
        E_w[x^2 - 2 t x]/(c (3c/4 - t)), with the moments E_w of Beta distributions. Without an edge share it
        is the half-width of the patch itself. The normals of a curved flank turn under the patch, which adds
        `bulge` E|x - y| to the displacement over k p.
        """
        share, c = self.edge_share, 2.0 * self.half_width
        logarithm = np.log(c / 4.0) + 0.5 - 1.5 * share
        first, second = 0.5 - 0.25 * share, 0.3125 - 0.1875 * share
        # t/c = (1/2 - 3/4 share)/(1 - share); both terms are multiplied by 1 - share, which may be 0
        moments = (second * (1.0 - share) - first * (1.0 - 1.5 * share)) / 0.25
        curved = self.bulge * self.mean_distance
        return np.asarray(np.exp(math.log(2.0) + 0.25 + logarithm + moments - curved))

    @property
    def mean_distance(self) -> FloatArray:
        """Mean distance E|x - y| in m of two points of the load, 0.576 half-widths of a semi-ellipse."""
        smooth, edge = 1.0 - self.edge_share, self.edge_share
        # E|x - y| of two points of the semi-ellipse, of one point each, and of two of the singular load
        parts = 256.0 * smooth**2 + 640.0 * smooth * edge + 240.0 * edge**2
        return np.asarray(parts * self.half_width / (45.0 * math.pi**2))


def tip_patches(
    s: FloatArray, offset: FloatArray, tip: float, half_width: float, edge_length: FloatArray | float
) -> Patches:
    """Return the patches on a flank for contacts at `s`.

    Parameters
    ----------
    s : ndarray
        Flank coordinate of the contact, m.
    offset : ndarray
        Distance t of the contact from the tip edge, m; negative = -phi R off the line of action.
    tip : float
        Flank coordinate of the tip edge, m.
    half_width : float
        Half-width away from the edge, m.
    edge_length : ndarray or float
        Length c of the patch at the edge, m, at most 2 `half_width`.
    """
    half = np.clip(offset, 0.5 * edge_length, half_width)
    missing = np.maximum(0.5 * edge_length - offset, 0.0)
    share = missing / (missing + 0.25 * edge_length)
    center = np.where(offset < half, tip - half, s)
    return Patches(center, half, share, at_tip=offset < half_width)


@kernel
def load_vector(
    nodes: FloatArray, center: float, half_width: float, edge_share: float, out: FloatArray
) -> tuple[int, int]:
    """Fill `out` with the nodal forces of a patch of unit load, and return the range of its nodes.

    Parameters
    ----------
    nodes : ndarray, shape (k,)
        Increasing flank coordinates; element e has nodes 2e, 2e+1, 2e+2 with 2e+1 at its middle.
    center, half_width : float
        Patch center s0 and half-width a in the unit of `nodes`; the patch must lie within the nodes.
    edge_share : float
        Share of the load that is singular at the upper end of the patch, 0 to 1 (see `Patches`).
    out : ndarray, shape (k,)
        Receives the forces; only the returned range is written.

    Returns
    -------
    first, last : int
        Nodes first .. last - 1 carry the load.
    """
    elements = (nodes.size - 1) // 2
    low, high = center - half_width, center + half_width
    first = 0
    while first < elements - 1 and nodes[2 * first + 2] <= low:
        first += 1
    last = first
    out[2 * first] = 0.0
    for e in range(first, elements):
        if nodes[2 * e] >= high:
            break
        last = e + 1
        out[2 * e + 1] = 0.0
        out[2 * e + 2] = 0.0
        zeroth, first_moment, second = profile_moments(nodes, e, center, half_width, edge_share)
        out[2 * e] += 0.5 * (second - first_moment)
        out[2 * e + 1] += zeroth - second
        out[2 * e + 2] += 0.5 * (second + first_moment)
    return 2 * first, 2 * last + 1


@kernel
def patch_angles(nodes: FloatArray, e: int, center: float, half_width: float) -> tuple[float, float]:
    """Return the angles of a patch, from -pi/2 to pi/2, between which it lies on element e.

    On the last element a patch always ends at pi/2. At a tip edge, rounding may put its end beside the last
    node; the angle, and a singular load with it, would change by the root of that distance.
    """
    start = math.asin(min(max((nodes[2 * e] - center) / half_width, -1.0), 1.0))
    if 2 * e + 3 == nodes.size:
        return start, 0.5 * math.pi
    return start, math.asin(min(max((nodes[2 * e + 2] - center) / half_width, -1.0), 1.0))


@kernel
def profile_moments(
    nodes: FloatArray, e: int, center: float, half_width: float, edge_share: float
) -> tuple[float, float, float]:
    """Return moments 0 to 2 of a patch of unit load on element e, over its coordinate from -1 to 1."""
    start, stop = patch_angles(nodes, e, center, half_width)
    first, last = _sine_moments(start, edge_share), _sine_moments(stop, edge_share)
    # moments of powers 0 to 2 of the sine; the coordinate of the element is middle + half sin t
    zeroth, tilt, square = last[0] - first[0], last[1] - first[1], last[2] - first[2]
    left, length = nodes[2 * e], nodes[2 * e + 2] - nodes[2 * e]
    middle, half = 2.0 * (center - left) / length - 1.0, 2.0 * half_width / length
    first_moment = middle * zeroth + half * tilt
    return zeroth, first_moment, middle * first_moment + half * (middle * tilt + half * square)


@kernel
def _sine_moments(angle: float, edge_share: float) -> tuple[float, float, float]:
    """Return antiderivatives at an angle of a patch of unit load times powers 0 to 2 of the sine."""
    sine, cosine = math.sin(angle), math.cos(angle)
    product, cube = sine * cosine, cosine * cosine * cosine / 3.0
    smooth, edge = (1.0 - edge_share) / math.pi, edge_share / math.pi
    return (
        smooth * (angle + product) + edge * (angle - cosine),
        -2.0 * smooth * cube + edge * (0.5 * (angle - product) - cosine),
        smooth * 0.25 * (angle - product * (1.0 - 2.0 * sine * sine))
        + edge * (0.5 * (angle - product) - cosine + cube),
    )
