"""Opposite points of the flanks of a pair of teeth in a section, and the hats of pressure on them.

Coordinates of a section: e from the slave's axis to where the line of action leaves its base circle, t along
that line. Of the two flanks the one whose root is nearer is the slave: it carries the pressure along its
normal, as far as its own tip edge and up to that of the mate.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from fe_contact.geometry import ParallelAxes
from fe_contact.types import BoolArray, FloatArray
from verification.full_contact.condensation.modified_flank import removed_at_roll

_STEPS, _SEARCHED = 8, 801
_GAUSS, _WEIGHTS = np.polynomial.legendre.leggauss(3)


class Facing(NamedTuple):
    """Points of the mate opposite points of the slave: roll length, gap (q,), normal and place (q, 2), m."""

    mate: FloatArray
    gap: FloatArray
    normal: FloatArray
    at: FloatArray


@dataclass(frozen=True)
class FacingFlanks:
    """A pair of flanks in one section, undeformed."""

    pair: ParallelAxes
    roll: float
    """Roll length of gear 1 at the touching point on the line of action, or on its extension beyond the ends,
    m.
    """
    face: float
    """Distance of the section from mid-face, m."""

    @cached_property
    def slave(self) -> int:
        """Number of the gear whose root is nearer."""
        path = self.pair.path_of_contact
        return 0 if self.roll < 0.5 * (path.start + path.end) else 1

    @property
    def line_length(self) -> float:
        """Length of the line of action between the base circles, m."""
        return float(self.pair.mating_roll_length(0.0))

    def facing(self, rolls: FloatArray) -> Facing:
        """Follow the normals of the slave at roll lengths (q,) to the mate."""
        gears = (self.pair.pinion, self.pair.wheel)
        slave_gear, mate = gears[self.slave], gears[1 - self.slave]
        touching = self.roll if self.slave == 0 else self.line_length - self.roll
        angle = (rolls - touching) / slave_gear.base_radius
        normal, slope = _turned(angle)
        at = slave_gear.base_radius * slope + rolls[:, None] * normal
        center = np.array([slave_gear.base_radius + mate.base_radius, self.line_length])
        arc = 0.5 * np.maximum(self.line_length - rolls, 0.0) ** 2 / mate.base_radius
        for _ in range(_STEPS):
            met = np.sqrt(2.0 * mate.base_radius * arc)
            theirs, outward = _turned((met - (self.line_length - touching)) / mate.base_radius)
            point = center - mate.base_radius * outward - met[:, None] * theirs
            off = np.einsum("qx,qx->q", point - at, slope)
            arc = np.maximum(arc + off / np.einsum("qx,qx->q", outward, slope), 0.0)
        gap = np.einsum("qx,qx->q", point - at, normal)
        gap = gap + removed_at_roll(slave_gear, rolls, self.face) + removed_at_roll(mate, met, self.face)
        return Facing(met, gap, normal, point)

    def arms(self, facing: Facing) -> tuple[FloatArray, FloatArray]:
        """Return arms of the normals about gear 1 and gear 2 over the base radii (q,)."""
        gears = (self.pair.pinion, self.pair.wheel)
        slave_gear, mate = gears[self.slave], gears[1 - self.slave]
        center = np.array([slave_gear.base_radius + mate.base_radius, self.line_length])
        arm = facing.at - center
        about = np.abs(arm[:, 0] * facing.normal[:, 1] - arm[:, 1] * facing.normal[:, 0]) / mate.base_radius
        ones = np.ones(len(about))
        return (ones, about) if self.slave == 0 else (about, ones)

    @cached_property
    def ends(self) -> tuple[float, float]:
        """Roll lengths of the slave from its form circle to its tip, or to the mate's tip opposite, m."""
        gears = (self.pair.pinion, self.pair.wheel)
        slave_gear, mate = gears[self.slave], gears[1 - self.slave]
        touching = self.roll if self.slave == 0 else self.line_length - self.roll
        reach = 0.5 * self.pair.base_pitch
        low, high = (
            max(slave_gear.form_roll_length, touching - reach),
            min(slave_gear.tip_roll_length, touching + reach),
        )
        if not low < high:
            return low, high
        rolls = np.linspace(low, high, _SEARCHED)
        met = self.facing(rolls).mate
        tip, foot = mate.tip_roll_length, mate.form_roll_length
        if met[0] > tip:
            low = float(np.interp(-tip, -met, rolls))
        if met[-1] < foot:
            high = float(np.interp(-foot, -met, rolls))
        return low, high

    @cached_property
    def closest(self) -> tuple[float, float]:
        """Roll length of the slave where the gap is least, and that gap, m."""
        low, high = self.ends
        if not low < high:
            return low, np.inf
        rolls = np.linspace(low, high, _SEARCHED)
        gap = self.facing(rolls).gap
        minimum = int(np.argmin(gap))
        if 0 < minimum < len(rolls) - 1:
            before, least, after = gap[minimum - 1 : minimum + 2]
            step = 0.5 * (before - after) / (before - 2.0 * least + after)
            return float(rolls[minimum] + step * (rolls[1] - rolls[0])), float(least)
        return float(rolls[minimum]), float(gap[minimum])


def _turned(angle: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the normal and the direction to the tip of gear 1's flank (q, 2), in e and t."""
    sine, cosine = np.sin(angle), np.cos(angle)
    return np.stack([sine, cosine], axis=-1), np.stack([cosine, -sine], axis=-1)


class Hats(NamedTuple):
    """Quadrature points of a section: roll lengths of the slave, weights in m, hats (q, i).

    `cut` (i,) says which hats stand at a side of the strip that is no end of the flanks.
    """

    rolls: FloatArray
    weights: FloatArray
    values: FloatArray
    cut: BoolArray


def hats(flanks: FacingFlanks, half: float, count: int) -> Hats:
    """Lay linear hats over the strip within `half` of where flanks are closest, towards gear 1's tip."""
    gears = (flanks.pair.pinion, flanks.pair.wheel)
    radius = gears[flanks.slave].base_radius
    low, high = (0.5 * roll**2 / radius for roll in flanks.ends)
    middle = 0.5 * flanks.closest[0] ** 2 / radius
    knots = np.linspace(max(low, middle - half), min(high, middle + half), count)
    center, width = 0.5 * (knots[1:] + knots[:-1]), 0.5 * np.diff(knots)
    s = (center[:, None] + width[:, None] * _GAUSS).ravel()
    weights = (width[:, None] * _WEIGHTS).ravel()
    values = np.stack([np.interp(s, knots, hat) for hat in np.eye(count)], axis=-1)
    cut = np.zeros(count, dtype=bool)
    cut[0], cut[-1] = middle - half > low, middle + half < high
    if flanks.slave == 1:
        values, cut = values[:, ::-1], cut[::-1]
    return Hats(np.sqrt(2.0 * radius * s), weights, values, cut)
