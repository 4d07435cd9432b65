"""The contact problem of all positions as plain arrays, independent of their source.

The common face is divided into slices. A candidate is a point at which a pair of teeth can touch; in three
dimensions a slice has several. A load patch is the stretch of the profile over which a mesh takes the force
of a candidate. A strip is the true contact width, which the local law resolves within the patch.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from fe_contact.contact.edge_strip import (
    EDGE_REACH,
    OFFSET,
    SIDE,
    EdgeStrips,
    edge_motions,
    edge_table,
    no_edges,
)
from fe_contact.contact.free_end import ENDLESS, SMOOTH, FreeEnds, end_excess
from fe_contact.contact.patch import Patches
from fe_contact.contact.plain_touch import Touch
from fe_contact.contact.strip import Gap, StripMiddles, gap_table, rolling_radii, strip_middles
from fe_contact.types import BoolArray, FloatArray, IntArray
from host.loops import njit

_SMALL_LOAD = 0.01
"""Small load over `PatchRule.edge_load`: its strips are so short that their middles hardly move with load."""

_USUAL_STRIP = 0.012
"""Half strip over the relative radius of curvature; gears under rated loads have 0.01 to 0.04."""
ALONG_FLANK = 1.1
"""Displacement of bodies along a flank per roll angle over their displacement across it, under a load.

A gear that turns about its axis has 1. Teeth in finite elements have 1.0 to 1.4 (12 to 90 teeth and ring
gears). The value was chosen on five pairs: their points on reliefs are then as far off full contact as points
on plain flanks.
"""


@dataclass(frozen=True)
class LoadedSlices:
    """Slices of tooth pairs that carry force: P positions, n slices each, one a pair in the plane."""

    pair: IntArray
    """Pair index; +1 is ahead. Slices of one pair stand together. Shape (n,)."""
    face_position: FloatArray
    """Distance of the slice's middle from the pinion's mid-face, m. Shape (n,)."""
    present: BoolArray
    """Whether any contact can press on a slice; else its other entries are harmless numbers. Shape (P, n)."""
    touch: Touch
    """Touching points of plain involutes at the middles, at most at the ends of the path; arrays (P, n)."""
    patch_1: Patches
    patch_2: Patches
    """`patch_1`, `patch_2`: Load patches on both gears, one under each point of the contact line."""
    slice_width: float
    """Width of a slice along the face, m."""
    base_helix_angle: float
    """beta_b of gear 1 in rad, > 0 right hand."""
    corner_1: float
    corner_2: float
    """`corner_1`, `corner_2`: Softness of the tip corner of either gear over that of a half plane; see
    `fe_contact.hertz.wedge_softness`.
    """
    tip_inclinations: tuple[float, float]
    """Tangent of the pressure angle at the tip of either gear."""
    law_length: float
    """Reference length that separates the contact from the bodies, m. Compliance nearer to the strip is in
    the local law, compliance further away in the finite elements.
    """
    edge_load: float
    """Load whose strips the patches at tip edges follow; see `PatchRule`."""
    lateral_shares: tuple[float, float]
    """`fe_contact.hertz.lateral_share` of both gears."""
    turned_normals: FloatArray
    """Angle by which normals turn within the strip under each patch, rad. Shape (P, m)."""
    end_1: FreeEnds = ENDLESS
    end_2: FreeEnds = ENDLESS
    """`end_1`, `end_2`: Free ends of the bodies of either gear, in the face positions of the slices."""

    @property
    def edge_side(self) -> FloatArray:
        """Direction (P, m) away from the edge where patches begin: 1 is towards tip 1, 0 without edge."""
        return np.where(self.patch_1.at_tip, -1.0, np.where(self.patch_2.at_tip, 1.0, 0.0))

    @property
    def width(self) -> float:
        """Width of a slice along the contact line, m."""
        return self.slice_width / math.cos(self.base_helix_angle)

    @property
    def endless(self) -> bool:
        """Whether the contact runs to no free end."""
        return self.end_1 == ENDLESS and self.end_2 == ENDLESS

    def half_planes(self, first: float, second: float) -> tuple[FloatArray, FloatArray]:
        """Return 2 (1 - nu^2)/(pi E) of both gears under each patch (P, m): more at the gear's tip edge."""
        return (
            first * (1.0 + (self.corner_1 - 1.0) * self.patch_1.at_edge),
            second * (1.0 + (self.corner_2 - 1.0) * self.patch_2.at_edge),
        )

    def mean(self, values: FloatArray) -> FloatArray:
        """Return the mean over the patches (P, m) of each slice (P, n)."""
        return np.asarray(values.reshape(*self.present.shape, -1).mean(axis=2))

    def rows(self, keep: IntArray) -> LoadedSlices:
        """Return the slices at the positions `keep`."""
        return replace(
            self,
            present=self.present[keep],
            touch=self.touch.rows(keep),
            patch_1=self.patch_1.rows(keep),
            patch_2=self.patch_2.rows(keep),
            turned_normals=self.turned_normals[keep],
        )


@dataclass(frozen=True)
class Candidates:
    """Points where teeth can touch: P positions, m points each (a pair in 2-D, several a slice in 3-D).

    A candidate that does not exist at a position has an infinite gap; its other entries are then harmless
    numbers.
    """

    position: FloatArray
    """Position of the driving gear, base pitches. Shape (P,)."""
    pair: IntArray
    """Pair index; +1 is ahead. Candidates of one pair stand together. Shape (m,)."""
    face_position: FloatArray
    """Distance from the pinion's mid-face, m. Shape (m,)."""
    touch: Touch
    """Touching points of the rigid flanks, arrays (P, m)."""
    width: FloatArray
    """Length of the contact line of each candidate, m; less than usual where the line ends. Shape (P, m)."""
    point_width: float
    """Part of the face that each candidate represents, m."""
    slices: LoadedSlices
    """Slices on which the candidates press, at Q positions: position p has row p modulo Q."""
    curves: FloatArray
    heights: FloatArray
    """`curves`, `heights`: Interpolation of the motion over the face; see `Slices.curves`. Shapes (points of
    a pair, K), (K, slices of a pair).
    """

    @property
    def blend(self) -> FloatArray:
        """Parts of the force of each point on the slices of its pair, (points, slices)."""
        return np.asarray(self.curves @ self.heights)

    @property
    def gap(self) -> FloatArray:
        """Rigid gap (P, m) on the line of action in m, as deflection of the driven gear that closes it."""
        return self.touch.gap

    @property
    def base_helix_angle(self) -> float:
        """beta_b of gear 1 in rad, > 0 right hand."""
        return self.slices.base_helix_angle

    @property
    def radius(self) -> FloatArray:
        """Relative radius of curvature (P, m) in the normal section, m."""
        return self.touch.radius / math.cos(self.base_helix_angle)

    @property
    def gap_about(self) -> Gap:
        """Gap about the touching points in the normal section, arrays (P, m) and (P, m, B)."""
        return self.gap_at(...)

    def gap_at(self, index: Any) -> Gap:
        """Return the gap about some of the candidates, which `index` selects from arrays (P, m)."""
        normal, touch = math.cos(self.base_helix_angle), self.touch
        return Gap(
            touch.slope[index] * normal,
            touch.curvature[index] * normal,
            touch.low[index],
            touch.high[index],
            touch.offset[index],
            touch.jump[index] * normal,
            touch.bend[index] * normal,
        )

    @cached_property
    def strips(self) -> StripMiddles:
        """Middles of strips under a load small enough that they hardly depend on it, arrays (P, m)."""
        middles = strip_middles(*self._small_strips)
        return StripMiddles(*(values.reshape(self.gap.shape) for values in middles))

    @property
    def rolling_radius(self) -> FloatArray:
        """Motion of the middles of small strips away from tip 1, per tilt of the flanks (P, m), m."""
        return rolling_radii(*self._small_strips).reshape(self.gap.shape)

    @cached_property
    def _small_strips(self) -> tuple[FloatArray, FloatArray]:
        """Return gaps about all touching points, and half strips there in m; 0 without a candidate."""
        table = gap_table(self.gap_about)
        half = np.sqrt(_SMALL_LOAD * self.slices.edge_load * self.radius)
        half = np.where(np.isfinite(self.gap), half, 0.0)
        return table.reshape(-1, table.shape[2]), half.ravel()

    @property
    def motion_arm(self) -> FloatArray:
        """Normal approach per unit deflection of the driven gear (P, m)."""
        return self.touch.lever_2 * math.cos(self.base_helix_angle)

    @property
    def torque_share(self) -> FloatArray:
        """Share of T_1/(r_b1 cos beta_b) per unit normal force (P, m)."""
        return self.touch.lever_1

    def on_mean(self, values: FloatArray) -> FloatArray:
        """Return the means (P, n) of values (P, m) over the candidates of each slice that exist."""
        can_touch = np.isfinite(self.gap).reshape(len(values), self.slices.pair.size, -1)
        total = np.where(can_touch, values.reshape(can_touch.shape), 0.0).sum(axis=2)
        return np.asarray(total / np.maximum(can_touch.sum(axis=2), 1))

    def on_slices(self, force: FloatArray) -> FloatArray:
        """Return forces (..., m) of the candidates as forces (..., n) on the slices."""
        shape = force.shape[:-1]
        by_pair = force.reshape(*shape, -1, len(self.curves))
        return np.asarray((by_pair @ self.blend).reshape(*shape, -1))

    def at_points(self, motion: FloatArray) -> FloatArray:
        """Return motions (..., n) of the slices at the candidates (..., m)."""
        shape = motion.shape[:-1]
        by_pair = motion.reshape(*shape, -1, self.heights.shape[1])
        return np.asarray((by_pair @ self.blend.T).reshape(*shape, -1))

    def rows(self, keep: IntArray) -> Candidates:
        """Return the candidates, in one base pitch, at the positions `keep`."""
        return replace(
            self,
            position=self.position[keep],
            touch=self.touch.rows(keep),
            width=self.width[keep],
            slices=self.slices.rows(keep),
        )

    def touching(self, touch: Touch) -> Candidates:
        """Return the same candidates with other touching points."""
        return replace(self, touch=touch)

    def following(self, touch: Touch) -> Candidates:
        """Return the candidates with other touching points, and patches moved with the middles of strips.

        The motion of a middle from this gap to the other adds to the `shift` of `touch`.
        """
        middle = self.touching(touch).strips.middle
        return self.touching(replace(touch, shift=touch.shift + middle - self.strips.middle))


@dataclass(frozen=True)
class ContactProblem:
    """Candidates with the finite-element compliance between the slices on which they press.

    The candidates may repeat the Q positions of the compliance in further base pitches: all teeth have the
    same compliance.
    """

    candidates: Candidates
    compliance: FloatArray
    """Normal approach of slice i per unit normal force on slice j, both gears, m/N. Position p has row p
    modulo Q, and P is a multiple of Q. Shape (Q, n, n).
    """
    modulus: float
    """Contact modulus E*, Pa."""
    half_plane_1: float
    half_plane_2: float
    """`half_plane_1`, `half_plane_2`: 2 (1 - nu^2)/(pi E) of the gears, 1/Pa."""
    tilt: FloatArray = field(default_factory=lambda: np.zeros((0, 0, 0)))
    """Tilt of the flanks at slice i per force on slice j, 1/N. It is also the growth of the compliance per
    motion of the patches of slice i towards tip 1. Patches move with the slope of the flanks, and in the
    plane also with their tilt. Shape (Q, n, n), or (0, 0, 0) where patches stay.
    """
    share_1: FloatArray | float = 0.5
    """Part of gear 1 in the compliance of each slice. Ndarray, shape (Q, n), or float."""

    @property
    def half_planes(self) -> tuple[FloatArray, FloatArray]:
        """`half_plane_1` and `half_plane_2` at each candidate (Q, m), 1/Pa: more at the gear's tip edge."""
        return self.candidates.slices.half_planes(self.half_plane_1, self.half_plane_2)

    @cached_property
    def bodies(self) -> FloatArray:
        """The compliance (Q, n, n) without the approach nearer to the strips than the reference length, m/N.

        The local law has that part. It is k [ln(l/a) + e(a) - e(l)]/w of each gear on slices of the width w,
        where a is the half width of the load patch, l the reference length and e the excess of
        `fe_contact.contact.free_end`. Normals that turn within a strip add to one gear as much as they take
        from the other, unless the materials differ. Patches are displaced to where modified flanks press, by
        no more than the reference length; the slope there turns forces, lever arms and motions
        (`turned_by`).
        """
        slices = self.candidates.slices
        k_1, k_2 = self.half_planes
        patch_1, patch_2 = slices.patch_1.law_width, slices.patch_2.law_width
        local = k_1 * (np.log(slices.law_length / patch_1) + self._end_excess(slices.end_1, patch_1))
        local = local + k_2 * (np.log(slices.law_length / patch_2) + self._end_excess(slices.end_2, patch_2))
        lateral_1, lateral_2 = slices.lateral_shares
        local = local - (k_1 * lateral_1 - k_2 * lateral_2) * slices.turned_normals
        local = slices.mean(local) / slices.width
        compliance, diagonal = self.compliance.copy(), np.arange(slices.pair.size)
        if self.tilt.size and self.candidates.touch.shift.any():
            shift = np.clip(self.candidates.touch.shift, -slices.law_length, slices.law_length)
            _displace(compliance, self.tilt, self.candidates.on_mean(shift))
        compliance[:, diagonal, diagonal] -= np.where(slices.present, local, 0.0)
        touch = self.candidates.touch
        if touch.slope_1.any() or touch.slope_2.any():
            slopes = self.candidates.on_mean(touch.slope_1), self.candidates.on_mean(touch.slope_2)
            change = self.turned_by(*slopes)[: len(compliance)]
            compliance *= 1.0 + change[:, :, None] + change[:, None, :]
        return compliance

    def turned_by(self, slope_1: FloatArray, slope_2: FloatArray) -> FloatArray:
        """Return the relative change (P, n) that slopes of flanks (P, n) add to the compliance by each slice.

        The compliance between slices i and j changes by the sum of the values at i and at j.

        A flank of slope s presses along a normal whose lever arm is 1 - s of that on a plain one: forces grow
        by 1 + s_1 under the same torque, and lags by 1 + s_2 for the same approach. Along that normal a body
        moves less by 2 s times `ALONG_FLANK`.
        """
        share = np.resize(np.broadcast_to(self.share_1, self.compliance.shape[:2]), slope_1.shape)
        along = share * slope_1 + (1.0 - share) * slope_2
        return np.asarray(0.5 * (slope_1 + slope_2) - ALONG_FLANK * along)

    @property
    def law_length(self) -> FloatArray:
        """Reference length of the local law of each candidate (Q, m), m: greater near free ends.

        Near a free end the approach is greater by k p [e(h) - e(l)], as with a longer reference length (p is
        the line load, e as in `bodies`). h is a usual half strip instead of the real one, so that the
        length does not depend on the load.
        """
        slices, (first, second) = self.candidates.slices, self.half_planes
        if slices.endless:
            return np.full(first.shape, slices.law_length)
        strip = _USUAL_STRIP * self.candidates.radius[: len(first)]
        excess = self._end_excess(slices.end_1, strip)
        if slices.end_2 != slices.end_1:
            of_second = second / (first + second)
            excess = (1.0 - of_second) * excess + of_second * self._end_excess(slices.end_2, strip)
        return np.asarray(slices.law_length * np.exp(excess))

    def _end_excess(self, ends: FreeEnds, strip: FloatArray) -> FloatArray:
        """Return the excess e of half strips (Q, m) less that of the reference length."""
        candidates = self.candidates
        if candidates.slices.endless:
            return np.zeros(strip.shape)
        length = SMOOTH * candidates.slices.law_length
        return end_excess(ends, candidates.face_position, candidates.point_width, strip, length)

    @property
    def rolling(self) -> FloatArray:
        """The `tilt` by which flanks roll under load, in the plane; empty over the face.

        With several slices along the face rolling changes STE by up to 0.01 um, and a solution takes 1.5
        times as long.
        """
        return self.tilt if len(self.candidates.heights) == 1 else self.tilt[:0, :0, :0]

    @property
    def radius(self) -> FloatArray:
        """Motion of the middles of strips away from tip 1 per tilt of rolling flanks, m.

        The shape is (P, n), one row per position; zeros (Q, n) where no flank rolls.
        """
        if not self.rolling.size:
            return np.zeros(self.candidates.slices.present.shape)
        return self.candidates.on_mean(self.candidates.rolling_radius)

    @property
    def edges(self) -> FloatArray:
        """Table (Q, n, 8) of `EdgeStrips`; where no flank rolls, a table (1, n, 8) that has no edge.

        It is that of plain flanks, since modifications displace a strip together with its patch. Modified
        flanks whose gap opens from an edge at some position press at the edge, and not where plain ones
        touch: then the table is (P, n, 8).
        """
        slices, touch = self.candidates.slices, self.candidates.slices.touch
        if not self.rolling.size:
            return no_edges(slices.pair.size)
        first = touch.offset_1 < touch.offset_2  # whether the edge of gear 1 is the nearer one
        corner_1 = self.half_plane_1 * (slices.corner_1 - 1.0)
        corner_2 = self.half_plane_2 * (slices.corner_2 - 1.0)
        under_1, under_2 = self.half_planes
        at_tip, half, distance, at_edge, length = (
            np.where(first, getattr(slices.patch_1, name), getattr(slices.patch_2, name))
            for name in ("at_tip", "half_width", "edge_distance", "at_edge", "law_width")
        )
        nearest = np.minimum(touch.offset_1, touch.offset_2)
        strips = EdgeStrips(
            side=np.where(nearest < EDGE_REACH * half, np.where(first, -1.0, 1.0), 0.0),
            offset=nearest,
            radius=touch.radius,
            softness=2.0 * (under_1 + under_2) / slices.width,
            patch=np.where(at_tip, distance, nearest),
            missing=1.0 - at_edge,
            corner=np.where(first, corner_1, corner_2) / slices.width,
            length=np.where(at_tip, length, nearest),
        )
        table = edge_table(strips, slices.present)
        offset = self._opening_from_edge(first)
        opens_from_edge = (offset < 0.0) & (np.resize(nearest, offset.shape) > 0.0)
        if not opens_from_edge.any():
            return table
        table = np.resize(table, (*offset.shape, table.shape[2]))
        changed = opens_from_edge & (table[..., SIDE] != 0.0)
        table[..., OFFSET] = np.where(changed, offset, table[..., OFFSET])
        return table

    def _opening_from_edge(self, first: BoolArray) -> FloatArray:
        """Return `Touch.offset_1` where `first` (Q, n), else `offset_2`, (P, n); 0 where patches moved."""
        touch = self.candidates.touch
        of_first = np.resize(first, touch.gap.shape)
        return np.where(touch.shift == 0.0, np.where(of_first, touch.offset_1, touch.offset_2), 0.0)

    def displacement(self, force: FloatArray) -> FloatArray:
        """Return how far forces (P, L, m) in N move the flanks apart at every candidate (P, L, m), m.

        The local approach of a loaded candidate is not part of it.
        """
        pressed = self.candidates.on_slices(force)
        edges, longest = self.edges, self.candidates.slices.law_length
        # axes: base pitches, positions Q (one row of edges stands for all), loads, slices
        radius = self.radius
        positions, slices = len(self.compliance), radius.shape[1]
        side = edges[..., SIDE].reshape(-1, positions if len(edges) > 1 else 1, 1, slices)
        radius = np.where(side == 0.0, radius.reshape(-1, positions, 1, slices), 0.0)
        by_pitch = pressed.reshape(-1, positions, *pressed.shape[1:])

        def times(matrices: FloatArray, forces: FloatArray) -> FloatArray:
            return np.asarray(np.einsum("qij,tqlj->tqli", matrices, forces, optimize=True))

        if not self.rolling.size:
            return self.candidates.at_points(times(self.bodies, by_pitch).reshape(pressed.shape))
        tilt = times(self.tilt, by_pitch)
        way = np.clip(-radius * tilt, -longest, longest)
        rolled = way * (tilt + np.divide(0.5 * way, radius, out=np.zeros(way.shape), where=radius > 0.0))
        motion = times(self.bodies, by_pitch) + rolled + times(np.swapaxes(self.tilt, 1, 2), way * by_pitch)
        motion = np.ascontiguousarray(motion.reshape(pressed.shape))
        edge_motions(edges, self.tilt, np.ascontiguousarray(pressed), motion)
        return self.candidates.at_points(motion)

    def rows(self, keep: IntArray) -> ContactProblem:
        """Return the problem of some positions, one row of compliance each."""
        return replace(
            self,
            candidates=self.candidates.rows(keep),
            compliance=self.compliance[keep],
            tilt=self.tilt[keep] if self.tilt.size else self.tilt,
            share_1=np.broadcast_to(self.share_1, self.compliance.shape[:2])[keep],
        )

    def touching(self, candidates: Candidates) -> ContactProblem:
        """Return the same compliance with candidates of other gaps."""
        return replace(self, candidates=candidates)


@njit(cache=True)
def _displace(compliance: FloatArray, tilt: FloatArray, way: FloatArray) -> None:
    """Add the change of the compliance (Q, n, n) by patches that are displaced by `way` (Q, n) in m."""
    for q in range(tilt.shape[0]):
        for i in range(tilt.shape[1]):
            for j in range(tilt.shape[1]):
                compliance[q, i, j] += way[q, i] * tilt[q, i, j] + way[q, j] * tilt[q, j, i]
