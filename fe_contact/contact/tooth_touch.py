"""Touching points of flanks that differ from tooth to tooth, from those that all teeth have in common."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from fe_contact.contact.flank_slope import rolls_at
from fe_contact.contact.model import ContactModel, MeetingTeeth
from fe_contact.contact.parabolic_gap import shifted_gap, touching_offsets
from fe_contact.contact.plain_touch import Touch, conjugate_touch
from fe_contact.contact.rough_flanks import DeviatingTeeth, curvature_bound
from fe_contact.contact.strip import Gap, rounded, with_breaks
from fe_contact.contact.touch import ALLOWED, FLATTEST, STEP, WAVY, modified_touch
from fe_contact.geometry import ParallelAxes
from fe_contact.types import BoolArray, FloatArray, IntArray
from host.loops import njit

_AT_ONCE = 16_384
"""Candidates whose gaps are computed together: their arrays stay in the cache of the processor."""
_SLOPES = ("lag", "slope_1", "slope_2", "turn_1", "turn_2")
_MOVING = ("s_1", "s_2", "gap", "approach_error", *_SLOPES, *Gap._fields)
"""Arrays of touching points that the gaps of single teeth change."""


class _Part(NamedTuple):
    """Some of the candidates (k,): their touching points on the common flanks, and the teeth that meet there.

    The common flanks are those that all teeth of a gear have, without the gaps of single teeth.
    """

    pair: ParallelAxes
    model: ContactModel
    common: Touch
    face: FloatArray
    meeting: IntArray

    def gap(self, way: FloatArray) -> FloatArray:
        """Return the gap of the teeth at distances `way` (k,) in m from the touching points, m."""
        rolls = rolls_at(self.pair, self.common.s_1 + way, self.common.s_2 - way)
        return self.model.gap_of_teeth(MeetingTeeth(self.pair, self.meeting, *rolls, self.face))

    @property
    def deviating(self) -> DeviatingTeeth:
        """The teeth that meet at the candidates, with their gaps."""
        return DeviatingTeeth(self.model.tooth_gaps, self.meeting)

    def rows(self, keep: IntArray) -> _Part:
        """Return some of the candidates."""
        return self._replace(common=self.common.rows(keep), face=self.face[keep], meeting=self.meeting[keep])


def tooth_touch(
    pair: ParallelAxes, touch: Touch, model: ContactModel, meeting: IntArray, face: FloatArray
) -> Touch:
    """Return the touching points with the gaps of the teeth that meet added.

    These gaps have a slope along the flank, so that the least gap is beside the one of the common flanks.

    Parameters
    ----------
    touch : Touch
        Touching points of the flanks that all teeth have in common, with the gaps of the model.
    meeting : ndarray of int, shape (R, m)
        Number of the pair of teeth that meets at each candidate; see `MeetingTeeth`.
    face : ndarray, shape (m,)
        Distance of each candidate from the pinion's mid-face, m.

    Notes
    -----
    Load patches stay where the common flanks touch: they define `shift`. Deviations of single teeth count
    as a lag: a pitch error of gear 2 turns its flank, and a lag of the same size closes it on any slope.
    """
    rows, columns = np.nonzero(touch.gap != np.inf)  # more than a third of the candidates cannot touch
    count = rows.size // _AT_ONCE + 1
    parts = list(zip(np.array_split(rows, count), np.array_split(columns, count), strict=True))
    results = []
    for at in parts:
        common = Touch(*(getattr(touch, name)[at] for name in touch.__dataclass_fields__))
        results.append(_touching(_Part(pair, model, common, face[at[1]], meeting[at])))
    breaks = max(arrays[-1].shape[-1] for arrays in results)
    changed = _with_breaks(tuple(getattr(touch, name).copy() for name in _MOVING), breaks)
    for at, arrays in zip(parts, results, strict=True):
        for all_values, values in zip(changed, _with_breaks(arrays, breaks), strict=True):
            all_values[at] = values
    return replace(touch, **dict(zip(_MOVING, changed, strict=True)))


def _with_breaks(moving: tuple[FloatArray, ...], count: int) -> tuple[FloatArray, ...]:
    """Return arrays of `_MOVING` with at least `count` breaks; the fields of the gap are the last of them."""
    first = len(moving) - len(Gap._fields)
    return *moving[:first], *with_breaks(Gap(*moving[first:]), count)


def _touching(part: _Part) -> tuple[FloatArray, ...]:
    """Return the arrays that `_MOVING` names.

    Where the gap of the teeth is less concave than the common gap is convex, it is replaced by a parabola,
    which gives the point of least gap. Elsewhere, and where the true gap there differs from the parabola, the
    least sum of both gaps is searched for.
    """
    stepped, poor = _stepped(part)
    rough = np.flatnonzero(poor | _sharp(part))
    if rough.size:
        searched = _searched(part.rows(rough))
        stepped = _with_breaks(stepped, searched[-1].shape[-1])
        for values, replaced in zip(stepped, searched, strict=True):
            values[rough] = replaced
    return stepped


def _stepped(part: _Part) -> tuple[tuple[FloatArray, ...], BoolArray]:
    """Return the arrays of `_MOVING` at the least sum of the common gap and a parabola of the teeth's gap.

    With them comes whether the parabola is too inaccurate there (k,).
    """
    common, zero = part.common, np.zeros(part.face.size)
    half = np.minimum(STEP / common.curvature, 0.2 * (common.high - common.low))
    middle = np.clip(zero, common.low + half, common.high - half)
    before, center, after = (part.gap(middle + way) for way in (-half, zero, half))
    # the parabola level + steepness x + bend x^2/2 through the three samples
    bend = (before - 2.0 * center + after) / half**2
    steepness = (after - before) / (2.0 * half) - bend * middle
    level = center - middle * (steepness + 0.5 * bend * middle)
    gap, way, minimum, needs_more = _free_steps(common.about, steepness, bend)
    if needs_more.any():
        _step_on(common, gap, (steepness, bend), (way, minimum), np.flatnonzero(needs_more))
    teeth = part.gap(way)
    remainder = teeth - level - way * (steepness + 0.5 * bend * way)
    poor = (np.abs(way) > half) | (np.abs(remainder) > ALLOWED / common.curvature)
    touching = common.s_1 + way, common.s_2 - way, common.gap + minimum + teeth, common.approach_error
    slopes = (getattr(common, name) for name in _SLOPES)
    return (*touching, *slopes, *gap), poor


@njit(cache=True, error_model="numpy")
def _free_steps(
    gap: Gap, steepness: FloatArray, bend: FloatArray
) -> tuple[Gap, FloatArray, FloatArray, BoolArray]:
    """Step to where gaps (n,) with an added slope and curvature are least, if no break is in between.

    Returns
    -------
    gap : Gap
        The sums about their least points.
    way, minimum : ndarray, shape (n,)
        Step to the least point, and `gap` as given there, without the addition, m.
    needs_more : ndarray of bool, shape (n,)
        Whether such a step is not enough, and none is made: an edge or a break is in between, the flanks
        touch at an edge or a break and leave it, or the sum is nearly concave.
    """
    n, breaks = gap.offset.shape
    slope, curvature, low, high = np.empty(n), np.empty(n), np.empty(n), np.empty(n)
    offset = gap.offset.copy()
    ways, minimum, needs_more = np.zeros(n), np.zeros(n), np.zeros(n, dtype=np.bool_)
    for i in range(n):
        slope[i], curvature[i] = gap.slope[i], gap.curvature[i] + bend[i]
        low[i], high[i] = gap.low[i], gap.high[i]
        steep = slope[i] + steepness[i]
        concave = 0.0
        for k in range(breaks):
            concave += min(gap.bend[i, k], 0.0)
        needs_more[i] = curvature[i] + concave < FLATTEST * gap.curvature[i]
        if slope[i] != 0.0:  # at a tip edge that stays in contact, or at a break
            at_end = (low[i] == 0.0 and steep > 0.0) or (high[i] == 0.0 and steep < 0.0)
            slope[i] = steep
            needs_more[i] = needs_more[i] or not at_end
            continue
        way = -steepness[i] / curvature[i]
        needs_more[i] = needs_more[i] or way <= low[i] or way >= high[i]
        for k in range(breaks):
            position = offset[i, k]
            needs_more[i] = needs_more[i] or (way >= position if position >= 0.0 else way <= position)
        if needs_more[i]:
            continue
        ways[i], minimum[i] = way, 0.5 * gap.curvature[i] * way * way
        low[i], high[i] = low[i] - way, high[i] - way
        for k in range(breaks):
            offset[i, k] -= way
    return (
        Gap(slope, curvature, low, high, offset, gap.jump.copy(), gap.bend.copy()),
        ways,
        minimum,
        needs_more,
    )


def _step_on(
    common: Touch,
    gap: Gap,
    teeth: tuple[FloatArray, FloatArray],
    stepped: tuple[FloatArray, FloatArray],
    candidates: IntArray,
) -> None:
    """Step over breaks and to edges at some candidates, and write the results in place.

    `gap` and `stepped`, the steps and minima, are those of `_free_steps`; `teeth` has slope and curvature of
    the added gaps.
    """
    plain = Gap(*(values[candidates] for values in common.about))
    slope, curvature = plain.slope + teeth[0][candidates], plain.curvature + teeth[1][candidates]
    total = rounded(plain._replace(slope=slope, curvature=curvature), FLATTEST * plain.curvature)
    way = touching_offsets(total, plain.low, plain.high)
    stepped[0][candidates], stepped[1][candidates] = way, shifted_gap(plain, way)[0]
    for values, replaced in zip(gap, shifted_gap(total, way)[1], strict=True):
        values[candidates] = replaced


def _sharp(part: _Part) -> BoolArray:
    """Return where deviations may be too wavy for one parabola."""
    common = part.common
    rolls = rolls_at(part.pair, common.s_1, common.s_2)
    bend = curvature_bound(part.pair, part.deviating.extents(), rolls)
    return np.asarray(bend > WAVY * common.curvature)


def _searched(part: _Part) -> tuple[FloatArray, ...]:
    """Return the arrays of `_MOVING` at the least sum of both gaps, searched from the plain involutes on."""
    pair, roll_1 = part.pair, part.common.roll_1[None]  # candidates of one position
    plain = conjugate_touch(pair, roll_1, pair.mating_roll_length(roll_1), part.model.corner_contact)
    plain = replace(plain, gap=np.where(np.isfinite(plain.gap), plain.gap, 0.0))
    touch = modified_touch(pair, plain, part.face, part.model.gaps, part.deviating)
    return tuple(getattr(touch, name)[0] for name in _MOVING)
