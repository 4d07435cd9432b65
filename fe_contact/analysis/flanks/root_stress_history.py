"""Stress of the tooth roots of one gear over the mesh cycle: history, peaks, where they are."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from fe_contact.types import BoolArray, Estimate, FloatArray, IntArray
from model_studies import in_unit

Root = Literal["tension", "compression"]

ROOTS: tuple[Root, Root] = ("tension", "compression")


@dataclass(frozen=True)
class RootPeak:
    """The largest stress of a cycle, and where it is."""

    stress: Estimate
    """Largest principal stress of the tension root, smallest one of the compression root (< 0), Pa, with the
    error of the root's mesh, of the contact's discretization and of the model.
    """
    position: float
    """Position of the driving gear, base pitches."""
    pair: int
    """Pair of the stressed tooth; position (modulo 1) + pair counts along the passage of one tooth."""
    flank_coordinate: float = field(metadata=in_unit("m"))
    """Coordinate along the profile from the middle of the tooth space, m; between stations by a parabola."""
    tangent_angle: float = field(metadata=in_unit("rad"))
    """Angle between the tangent of the surface and the center line of the tooth at the peak, rad."""
    face_position: float = field(metadata=in_unit("m"))
    """Distance from the pinion's mid-face, m."""


@dataclass(frozen=True)
class RootPassage:
    """The stress in the roots of one tooth on its way through the mesh."""

    position: FloatArray = field(metadata=in_unit("1", "passage"))
    """Position of the tooth's own pair in base pitches, increasing: 0 = its pitch point. Shape (M,)."""
    tension: FloatArray = field(metadata=in_unit("pa", "passage"))
    compression: FloatArray = field(metadata=in_unit("pa", "passage"))
    """`tension`, `compression`: Largest principal stress anywhere in the tension root; smallest one in the
    compression root, Pa. Shape (M,) each.
    """
    at_tension_peak: FloatArray = field(metadata=in_unit("pa", "passage"))
    at_compression_peak: FloatArray = field(metadata=in_unit("pa", "passage"))
    """`at_tension_peak`, `at_compression_peak`: Stress along the profile at the station nearest to the peak:
    what fatigue counts, Pa. Shape (M,) each.
    """


@dataclass(frozen=True)
class RootStressHistory:
    """Surface stress of the tooth roots of one gear."""

    position: FloatArray
    """Position of the driving gear, base pitches. Shape (P,)."""
    pair: IntArray
    """Pair index of each tooth: the touching teeth, and one more at either end, which only neighbors load.
    Shape (N,).
    """
    flank_coordinate: FloatArray
    """Coordinates of the stations along the profile, m, from the middle of the tooth space to the form point.
    Shape (p,).
    """
    tangent_angle: FloatArray
    """Angle between the tangent of the surface and the center line of the tooth at each station, rad. Shape
    (p,).
    """
    face_position: FloatArray
    """Positions of the stations across the face, as distance from the pinion's mid-face, m; a single one in
    the plane. Shape (q,).
    """
    stress: FloatArray
    """Stress, Pa. Third axis: tension root (next to the loaded flank), compression root. Fourth: along the
    profile, across it in the surface, shear between the two. Shape (P, N, 2, 3, p, q).
    """
    near_load: BoolArray
    """Whether a station of the tension root lies under a load patch of its tooth or within half a patch of
    it. The surface there is not free, and the patch is wider than the contact: such stations count for no
    peak. Shape (P, N, p, q).
    """
    relative_error: float
    """Relative error of the peaks: by the mesh of the root, by positions, slices and mesh of the contact, and
    by the model.
    """
    critical_coordinate: float
    """Flank coordinate of the critical section of ISO 6336-3, m: the tangent has 30 degrees (internal gears:
    60) with the center line of the tooth.
    """

    def at(self, positions: BoolArray) -> RootStressHistory:
        """Return the stress at some of the positions (P,)."""
        rows = {name: getattr(self, name)[positions] for name in ("position", "stress", "near_load")}
        return replace(self, **rows)

    def principal(self, root: Root) -> FloatArray:
        """Largest principal stress of the tension root or smallest of the compression root, (P, N, p, q)."""
        along, across, shear = np.moveaxis(self.stress[:, :, ROOTS.index(root)], 2, 0)
        mean, radius = 0.5 * (along + across), np.hypot(0.5 * (along - across), shear)
        return np.asarray(mean + radius if root == "tension" else mean - radius)

    def peak(self, root: Root) -> RootPeak:
        """Return the peak of one root over all positions, teeth and stations."""
        sign = 1.0 if root == "tension" else -1.0
        values, at = self._crests(root)
        i, j, q = np.unravel_index(int(np.argmax(values)), values.shape)
        value, s = sign * float(values[i, j, q]), float(at[i, j, q])
        error = abs(value) * self.relative_error
        return RootPeak(
            stress=Estimate(value, error, "Pa"),
            position=float(self.position[i]),
            pair=int(self.pair[j]),
            flank_coordinate=s,
            tangent_angle=float(np.interp(s, self.flank_coordinate, self.tangent_angle)),
            face_position=float(self.face_position[q]),
        )

    def _crests(self, root: Root) -> tuple[FloatArray, FloatArray]:
        """Return the extreme along the profile, > 0 as it should be, and its place, (P, N, q)."""
        if root == "compression":
            values = -self.principal(root)
        else:
            values = np.where(self.near_load, -np.inf, self.principal(root))
        return crest_values(self.flank_coordinate, np.moveaxis(values, 2, -1))

    def passage(self) -> RootPassage:
        """Return the stress of one tooth over its passage through mesh, the positions of all pairs in a row.

        Positions in several base pitches are of several teeth, which then stand beside each other.
        """
        # In a later base pitch pair j stands where pair j stood before: other teeth, the same way.
        position = (self.position[:, None] % 1.0 + self.pair).ravel()
        order = np.argsort(position, kind="stable")
        extremes, fixed = [], []
        for root, sign in zip(ROOTS, (1.0, -1.0), strict=True):
            values, _ = self._crests(root)
            extremes.append(sign * values.max(axis=-1).ravel()[order])
            peak = self.peak(root)
            station = np.argmin(np.abs(self.flank_coordinate - peak.flank_coordinate))
            across = np.argmin(np.abs(self.face_position - peak.face_position))
            along = self.stress[:, :, ROOTS.index(root), 0, station, across]
            fixed.append(along.ravel()[order])
        return RootPassage(position[order], extremes[0], extremes[1], fixed[0], fixed[1])


def crest_values(s: FloatArray, values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the largest value (...) along the last axis and its place, by a parabola through its neighbors.

    `s` (p >= 3,) increases; in `values` (..., p) minus infinity does not count, and beside it there is no
    parabola.
    """
    middle = np.clip(np.argmax(values, axis=-1), 1, s.size - 2)
    low, crest, high = (s[middle + step] for step in (-1, 0, 1))
    y = [np.take_along_axis(values, (middle + step)[..., None], axis=-1)[..., 0] for step in (-1, 0, 1)]
    finite = np.all(np.isfinite(y), axis=0)
    first, second = (
        np.subtract(b, a, out=np.zeros_like(a), where=finite) / way
        for a, b, way in ((y[0], y[1], crest - low), (y[1], y[2], high - crest))
    )
    bend = (second - first) / (high - low)
    slope = first + bend * (crest - low)  # at the middle
    flat = bend >= 0.0  # no crest inside: a rising end, all alike, or no three values
    way = np.clip(-slope / np.where(flat, -1.0, 2.0 * bend), low - crest, high - crest)
    value = np.where(flat, np.max(y, axis=0), y[1] + way * (slope + bend * way))
    position = np.where(flat, np.choose(np.argmax(y, axis=0), [low, crest, high]), crest + way)
    return value, position
