"""Where the rigid flanks of each pair come closest, and how far apart they are there."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from fe_contact.contact.model import GapTerm
from fe_contact.geometry import ParallelAxes, Side, Toothing, corner_contact
from fe_contact.hertz import relative_radius
from fe_contact.types import BoolArray, FloatArray, IntArray

_SAMPLES = 65
_FLATTEST = 100.0
_TIE = 1e-15
"""Gaps that differ by less, over the largest modification, are equal: a few times their rounding."""


@dataclass(frozen=True)
class Touch:
    """Touching points of the rigid gears; arrays (P, n).

    Attributes
    ----------
    s_1, s_2 : ndarray
        Flank coordinates, m.
    offset_1, offset_2 : ndarray
        Arc distance to the gear's tip edge in m; negative at an edge that touches while the flanks open by
        phi:
        -phi R.
    gap : ndarray
        On the line of action, m; infinite = the pair cannot touch.
    radius : ndarray
        Relative radius of curvature in the transverse section, m.
    lever_1, lever_2 : ndarray
        Lever arms of the common normal over the base radii.
    """

    s_1: FloatArray
    s_2: FloatArray
    offset_1: FloatArray
    offset_2: FloatArray
    gap: FloatArray
    radius: FloatArray
    lever_1: FloatArray
    lever_2: FloatArray

    def rows(self, keep: IntArray) -> Touch:
        """Keep some positions."""
        return Touch(*(getattr(self, name)[keep] for name in self.__dataclass_fields__))

    def columns(self, keep: BoolArray) -> Touch:
        """Keep some pairs."""
        return Touch(*(getattr(self, name)[:, keep] for name in self.__dataclass_fields__))


def conjugate_touch(pair: ParallelAxes, roll_1: FloatArray, roll_2: FloatArray, corners: bool) -> Touch:
    """Touching points of plain involutes.

    Parameters
    ----------
    pair : GearPair or InternalGearPair
    roll_1, roll_2 : ndarray, shape (P, n)
        Nominal roll lengths, m; beyond A and E too.
    corners : bool
        Whether tip edges may touch before A and after E.
    """
    tip_1, tip_2 = pair.pinion.tip_roll_length, pair.wheel.tip_roll_length
    beyond_1, beyond_2 = roll_1 - tip_1, pair.wheel.sign * (roll_2 - tip_2)
    gap = np.where((beyond_1 <= 0.0) & (beyond_2 <= 0.0), 0.0, np.inf)
    touched_1 = np.clip(roll_1, pair.path_of_contact.start, tip_1)
    ends_2 = float(pair.mating_roll_length(pair.path_of_contact.end)), tip_2
    touched_2 = np.clip(roll_2, min(ends_2), max(ends_2))
    lever_1, lever_2 = np.ones((2, *gap.shape))
    opening_1, opening_2 = np.zeros((2, *gap.shape))
    sides: tuple[tuple[Side, FloatArray, FloatArray, FloatArray], ...] = (
        ("approach", beyond_2, touched_1, opening_2),
        ("exit", beyond_1, touched_2, opening_1),
    )
    for side, overshoot, touched, opening in sides if corners else ():
        at = np.nonzero(overshoot > 0.0)
        corner = corner_contact(pair, side, overshoot[at])
        found = tuple(index[corner.valid] for index in at)
        gap[found], touched[found] = corner.gap[corner.valid], corner.flank_roll_length[corner.valid]
        opening[found] = corner.slope_angle[corner.valid]
        lever_1[found] = corner.lever_arm_ratio_pinion[corner.valid]
        lever_2[found] = corner.lever_arm_ratio_wheel[corner.valid]
    radius = _relative_radius(pair, touched_1, touched_2)
    s_1, s_2 = flank_coordinate(pair.pinion, touched_1), flank_coordinate(pair.wheel, touched_2)
    offset_1 = flank_coordinate(pair.pinion, tip_1) - s_1 - opening_1 * radius
    offset_2 = flank_coordinate(pair.wheel, tip_2) - s_2 - opening_2 * radius
    return Touch(s_1, s_2, offset_1, offset_2, gap, radius, lever_1, lever_2)


def _relative_radius(pair: ParallelAxes, roll_1: FloatArray, roll_2: FloatArray) -> FloatArray:
    """Return the relative radius of curvature in m, at most `_FLATTEST` base radii of gear 2.

    Off the line of action the edge of a ring gear may meet its pinion where the pinion is the flatter one:
    flanks that part at the edge would close in again further away. There they count as flat.
    """
    flattest = _FLATTEST * pair.wheel.base_radius
    radius = relative_radius(roll_1, pair.wheel.sign * roll_2)
    return np.where((radius >= 0.0) & (radius <= flattest), radius, flattest)


def flank_coordinate(gear: Toothing, roll: FloatArray | float) -> FloatArray:
    """Flank coordinate s in m of a roll length; negative on a ring gear (see `FlankProfile`)."""
    return np.asarray(gear.sign * np.square(roll) / (2.0 * gear.base_radius))


def modified_touch(
    pair: ParallelAxes,
    touch: Touch,
    face: FloatArray,
    gaps: tuple[GapTerm, ...],
    largest: float | None = None,
) -> Touch:
    """Touching points of modified flanks.

    Sloping modifications move the touching point off the line of action: over the distance x along the flank
    the gap is (x - x0)^2/(2R) plus the modifications, and its least value counts. On a relief of slope m' it
    is less than the modification on the line of action by R m'^2/2, some tenths of a micrometre.

    Parameters
    ----------
    pair : GearPair or InternalGearPair
    touch : Touch
        Of plain involutes.
    face : ndarray, shape (n,)
        Distance of each candidate from the pinion's mid-face, m.
    gaps : tuple of GapTerm
        At least one.
    largest : float, optional
        `largest_gap` in m where `touch` are some of the positions that are solved: what counts as a
        tie must not depend on which. Default: theirs.
    """
    moving = tuple(term for term in gaps if term.along_profile)
    steady = tuple(term for term in gaps if not term.along_profile)
    if largest is None:
        largest = largest_gap(pair, touch, face, gaps)
    found = _shifted(pair, touch, face, moving, largest) if largest != 0.0 else touch
    roll_1, roll_2 = rolls_at(pair, found.s_1, found.s_2)
    return replace(found, gap=found.gap + sum(term(pair, roll_1, roll_2, face) for term in steady))


def largest_gap(pair: ParallelAxes, touch: Touch, face: FloatArray, gaps: tuple[GapTerm, ...]) -> float:
    """Return the largest gap that varies along the profile, at the touching points of plain involutes, m."""
    moving = tuple(term for term in gaps if term.along_profile)
    if not moving:
        return 0.0
    possible = np.isfinite(touch.gap)
    here = Touch(*(getattr(touch, name)[possible] for name in touch.__dataclass_fields__))
    along = np.broadcast_to(face, possible.shape)[possible][:, None]
    return float(np.abs(_gap_beside(pair, here, along, moving, np.zeros((here.gap.size, 1)))).max())


def _shifted(
    pair: ParallelAxes, touch: Touch, face: FloatArray, gaps: tuple[GapTerm, ...], largest: float
) -> Touch:
    """Move the touching points to where conjugate gap and `gaps`, `largest` at most, together are least."""
    possible = np.isfinite(touch.gap)
    here = Touch(*(getattr(touch, name)[possible] for name in touch.__dataclass_fields__))
    along = np.broadcast_to(face, possible.shape)[possible][:, None]
    low = here.s_2 - flank_coordinate(pair.wheel, pair.wheel.tip_roll_length)
    high = flank_coordinate(pair.pinion, pair.pinion.tip_roll_length) - here.s_1

    def gap(shift: FloatArray) -> FloatArray:
        return _gap_beside(pair, here, along, gaps, shift)

    reach = np.sqrt(4.0 * here.radius * largest)
    shift = _least(gap, np.maximum(low, -reach), np.minimum(high, reach), _TIE * largest)
    step = 1e-3 * reach
    at = gap(np.stack([shift, np.minimum(shift + step, high), np.maximum(shift - step, low)], axis=1))
    # at an edge the flanks open by the slope of the gap there; elsewhere the distance to it is what matters
    opening_1 = np.maximum(at[:, 2] - at[:, 0], 0.0) / step * here.radius
    opening_2 = np.maximum(at[:, 1] - at[:, 0], 0.0) / step * here.radius
    moved = {
        "s_1": here.s_1 + shift,
        "s_2": here.s_2 - shift,
        "offset_1": np.where(shift < high, high - shift, -opening_1),
        "offset_2": np.where(shift > low, shift - low, -opening_2),
        "gap": here.gap + at[:, 0],
    }
    result = {name: getattr(touch, name).copy() for name in moved}
    for name, values in moved.items():
        result[name][possible] = values
    return replace(touch, **result)


def rolls_at(pair: ParallelAxes, s_1: FloatArray, s_2: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Roll lengths in m of flank coordinates of both gears."""
    return (
        np.sqrt(2.0 * pair.pinion.base_radius * np.maximum(s_1, 0.0)),
        np.sqrt(2.0 * pair.wheel.base_radius * np.maximum(pair.wheel.sign * s_2, 0.0)),
    )


def _gap_beside(
    pair: ParallelAxes, touch: Touch, face: FloatArray, gaps: tuple[GapTerm, ...], shift: FloatArray
) -> FloatArray:
    """Gap in m over the conjugate one at `shift` (n, k) from the touching points (n,) towards tip 1."""
    roll_1, roll_2 = rolls_at(pair, touch.s_1[:, None] + shift, touch.s_2[:, None] - shift)
    # beside an edge the flanks open by phi = -offset/R
    opening = np.maximum(-touch.offset_1, 0.0)[:, None] * np.maximum(-shift, 0.0)
    opening += np.maximum(-touch.offset_2, 0.0)[:, None] * np.maximum(shift, 0.0)
    rigid = (0.5 * shift**2 + opening) / touch.radius[:, None]
    return np.asarray(rigid + sum(term(pair, roll_1, roll_2, face) for term in gaps))


def _least(
    gap: Callable[[FloatArray], FloatArray], low: FloatArray, high: FloatArray, tie: float
) -> FloatArray:
    """Where the gap is least between `low` and `high` (n,): nested searches.

    A tie, gaps that differ by less than `tie` in m, goes to the middle. It must be in proportion to the gaps:
    a fixed one takes the contact off the tip edge wherever flanks open by less.
    """
    fraction = np.linspace(0.0, 1.0, _SAMPLES)
    for _ in range(3):
        shift = low[:, None] + (high - low)[:, None] * fraction
        best = np.argmin(gap(shift) + tie * np.abs(fraction - 0.5), axis=1)[:, None]
        low, high = (
            np.take_along_axis(shift, np.clip(best + k, 0, _SAMPLES - 1), axis=1)[:, 0] for k in (-1, 1)
        )
    return np.asarray(np.take_along_axis(shift, best, axis=1)[:, 0])
