"""Touching points of plain involutes, with or without tip edges, and their local geometry.

Arrays run over P positions and n points of contact lines. A flank coordinate s is the arc length of an
involute from its base circle; it is negative on a ring gear.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from fe_contact.contact.strip import Gap, with_breaks
from fe_contact.geometry import ParallelAxes, Side, Toothing, corner_contact
from fe_contact.hertz import relative_radius
from fe_contact.types import BoolArray, FloatArray, IntArray

FLAT = 100.0
"""Largest relative radius of curvature over the base radius of gear 2."""


@dataclass(frozen=True)
class Touch:
    """Touching points of the rigid gears; arrays (P, n)."""

    s_1: FloatArray
    s_2: FloatArray
    """`s_1`, `s_2`: Flank coordinates, m."""
    gap: FloatArray
    """Gap on the line of action, m; infinite where the pair cannot touch."""
    radius: FloatArray
    """Relative radius of curvature in the transverse section, m."""
    lever_1: FloatArray
    lever_2: FloatArray
    """`lever_1`, `lever_2`: Lever arms of the common normal over the base radii."""
    slope: FloatArray
    curvature: FloatArray
    low: FloatArray
    high: FloatArray
    """`slope`, `curvature`, `low`, `high`: Gap in the transverse section, towards tip 1; see `strip.Gap`."""
    offset: FloatArray
    jump: FloatArray
    bend: FloatArray
    """`offset`, `jump`, `bend`: Position of each break of the gap, and slope and curvature added beyond it;
    see `strip.Gap`. Shape (P, n, B) each.
    """
    shift: FloatArray
    """Distance by which modifications move the touching point, or the strip's middle, towards tip 1, m."""
    approach_error: FloatArray
    """Error of the approach on rough flanks; see `RoughStrip`."""
    lag: FloatArray
    """Lag of gear 2 that closes a removed depth at the touching point, over that depth."""
    slope_1: FloatArray
    slope_2: FloatArray
    """`slope_1`, `slope_2`: Growth of the material removed from each flank per roll length towards the tip
    (ring gear: towards the root); zero at its edge.
    """
    turn_1: FloatArray
    turn_2: FloatArray
    """`turn_1`, `turn_2`: Changes of these slopes along the flanks towards tip 1, 1/m."""
    roll_1: FloatArray
    """Nominal roll lengths of gear 1, m."""

    @property
    def offset_1(self) -> FloatArray:
        """Arc distance to the tip edge of gear 1, m; -phi R at an edge that touches as flanks open by phi."""
        return np.where(self.high > 0.0, self.high, np.minimum(self.slope, 0.0) / self.curvature)

    @property
    def offset_2(self) -> FloatArray:
        """Arc distance to the tip edge of gear 2, m; negative as `offset_1`."""
        return np.where(self.low < 0.0, -self.low, -np.maximum(self.slope, 0.0) / self.curvature)

    @property
    def about(self) -> Gap:
        """The gap about the touching points in the transverse section."""
        return Gap(*(getattr(self, name) for name in Gap._fields))

    def with_breaks(self, count: int) -> Touch:
        """Return the touching points with at least `count` breaks; added ones are at infinity."""
        return replace(self, **with_breaks(self.about, count)._asdict())

    def rows(self, keep: IntArray) -> Touch:
        """Return the touching points at the positions `keep`."""
        return Touch(*(getattr(self, name)[keep] for name in self.__dataclass_fields__))

    def columns(self, keep: BoolArray) -> Touch:
        """Return the touching points of the pairs `keep`."""
        return Touch(*(getattr(self, name)[:, keep] for name in self.__dataclass_fields__))


def conjugate_touch(pair: ParallelAxes, roll_1: FloatArray, roll_2: FloatArray, corners: bool) -> Touch:
    """Return the touching points of plain involutes.

    Parameters
    ----------
    roll_1, roll_2 : ndarray, shape (P, n)
        Nominal roll lengths, also before A and after E, m.
    corners : bool
        Whether tip edges may touch before A and after E.
    """
    tip_1, tip_2 = pair.pinion.tip_roll_length, pair.wheel.tip_roll_length
    beyond_1, beyond_2 = roll_1 - tip_1, pair.wheel.sign * (roll_2 - tip_2)
    gap = np.where((beyond_1 <= 0.0) & (beyond_2 <= 0.0), 0.0, np.inf)
    touch_roll_1 = np.clip(roll_1, pair.path_of_contact.start, tip_1)
    ends_2 = float(pair.mating_roll_length(pair.path_of_contact.end)), tip_2
    touch_roll_2 = np.clip(roll_2, min(ends_2), max(ends_2))
    lever_1, lever_2 = np.ones((2, *gap.shape))
    opening_1, opening_2 = np.zeros((2, *gap.shape))
    sides: tuple[tuple[Side, FloatArray, FloatArray, FloatArray], ...] = (
        ("approach", beyond_2, touch_roll_1, opening_2),
        ("exit", beyond_1, touch_roll_2, opening_1),
    )
    for side, overshoot, touch_roll, opening in sides if corners else ():
        beyond = np.nonzero(overshoot > 0.0)
        corner = corner_contact(pair, side, overshoot[beyond])
        valid = tuple(index[corner.valid] for index in beyond)
        gap[valid] = corner.gap[corner.valid]
        touch_roll[valid] = corner.flank_roll_length[corner.valid]
        opening[valid] = corner.slope_angle[corner.valid]
        lever_1[valid] = corner.lever_arm_ratio_pinion[corner.valid]
        lever_2[valid] = corner.lever_arm_ratio_wheel[corner.valid]
    radius = _relative_radius(pair, touch_roll_1, touch_roll_2)
    s_1, s_2 = pair.pinion.flank_coordinate(touch_roll_1), pair.wheel.flank_coordinate(touch_roll_2)
    high = pair.pinion.flank_coordinate(tip_1) - s_1
    low = s_2 - pair.wheel.flank_coordinate(tip_2)
    no_breaks, zero = np.zeros((*gap.shape, 0)), np.zeros(gap.shape)
    return Touch(
        s_1=s_1,
        s_2=s_2,
        gap=gap,
        radius=radius,
        lever_1=lever_1,
        lever_2=lever_2,
        slope=opening_2 - opening_1,
        curvature=1.0 / radius,
        low=np.minimum(low, 0.0),
        high=np.maximum(high, 0.0),
        offset=no_breaks,
        jump=no_breaks,
        bend=no_breaks,
        shift=zero,
        approach_error=zero,
        lag=_lag_at_edges(pair, lever_1, lever_2),
        slope_1=zero,
        slope_2=zero,
        turn_1=zero,
        turn_2=zero,
        roll_1=roll_1,
    )


def _lag_at_edges(pair: ParallelAxes, lever_1: FloatArray, lever_2: FloatArray) -> FloatArray:
    """Return the lag of gear 2 (P, n) that closes a depth removed at tip edges, over that depth; 1 elsewhere.

    An edge is removed along the normal of its own flank, which the angle between the flanks turns from the
    normal of the mate. A lag of gear 2 closes the gap at an edge times the lever arm only.
    """
    lag = np.ones(lever_2.shape)
    edges = np.nonzero((lever_1 != 1.0) | (lever_2 != 1.0))
    angle = _angle_at_edge(pair.pinion, lever_1[edges]) + _angle_at_edge(pair.wheel, lever_2[edges])
    lag[edges] = np.cos(angle) / lever_2[edges]
    return lag


def _angle_at_edge(gear: Toothing, lever: FloatArray) -> FloatArray:
    """Return the angle in rad between a flank's normal at its tip edge and a force of a given lever arm."""
    arm = gear.base_radius / gear.tip_radius
    return np.asarray(np.arccos(lever * arm) - np.arccos(arm))


def _relative_radius(pair: ParallelAxes, roll_1: FloatArray, roll_2: FloatArray) -> FloatArray:
    """Return the relative radius of curvature in m, at most `FLAT` base radii of gear 2.

    Off the line of action the edge of a ring gear may touch the pinion where the pinion has less curvature:
    flanks that open from the edge would approach each other again further away. There they count as flat.
    """
    flattest = FLAT * pair.wheel.base_radius
    radius = relative_radius(roll_1, pair.wheel.sign * roll_2)
    return np.where((radius >= 0.0) & (radius <= flattest), radius, flattest)
