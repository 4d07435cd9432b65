"""Touching points of modified flanks, and the gaps there.

The touching point of a pair of teeth on a contact line is the point at which the gap of the rigid flanks is
least. Breaks are points at which slope or curvature of the gap jump: a relief begins, or a tip is cut. A way
is a distance along the flank from the touching point of plain involutes.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import NamedTuple, TypeAlias

import numpy as np

from fe_contact.contact.flank_slope import flank_slope, rolls_at
from fe_contact.contact.least_gap import Nodes, least_gap, samples
from fe_contact.contact.model import GapTerm
from fe_contact.contact.parabolic_gap import shifted_gap, touching_offsets
from fe_contact.contact.plain_touch import FLAT, Touch
from fe_contact.contact.rough_flanks import DesignedSurface, DeviatingTeeth, curvature_bound
from fe_contact.contact.rough_strip import BREAKS, rough_strip
from fe_contact.contact.strip import Gap, rounded, with_breaks
from fe_contact.flank.extent import Extent
from fe_contact.geometry import ParallelAxes, Side, edge_gap
from fe_contact.types import BoolArray, FloatArray, IntArray
from host.loops import njit

_SAMPLES = 17
"""Number of samples of a gap over the reach of its touching point."""
_PASSES, _CUT_TIP_PASSES = 2, 4
"""Most passes of the search from the lowest sample on; more for a cut tip, whose sample may be far off."""
STEP = 0.01
"""Step of differences along the flank over the relative radius: about half a contact strip."""
_REACH = 0.5
"""Largest way of a touching point over the length of the flank from its base circle."""
FLATTEST = 0.25
"""Least curvature of the gap over that of plain involutes."""
ALLOWED = 1e-7
"""Allowed gap above the least gap, over the relative radius: 0.5 nm at 5 mm."""
ROUGH, WAVY = 0.25, 0.05
"""Curvature of deviations over that of plain flanks above which flanks may touch at another crest, and above
which no parabola describes them under load."""
_STEP_ERROR = 10.0
"""Allowed difference of the true gap after a step from its parabola, over `ALLOWED`."""
_ALIKE = 1e-4
"""Distance of samples over the step of differences below which they count as one."""
_AT_ONCE = 8192
"""Touching points that are followed together: their arrays stay in the cache of the processor."""
_AT_EDGE = 1e-12
"""Distance from an edge in m below which a touching point is at it."""
STEEPEST = 0.5
"""Largest slope of a relief over the roll length by which gear 2 is turned; usual ones have 0.02."""
_NEAR = 1e-4
"""Step of differences of the exact gap over `STEP`. The slope of the exact gap is nowhere rounded."""
_Arrays: TypeAlias = tuple[FloatArray, ...]
_SIDES: tuple[Side, Side] = ("exit", "approach")
"""Ends of the path of contact, at the tip of the pinion and at the tip of the wheel."""


def modified_touch(
    pair: ParallelAxes,
    touch: Touch,
    face: FloatArray,
    gaps: tuple[GapTerm, ...],
    teeth: DeviatingTeeth | None = None,
) -> Touch:
    """Return the touching points of modified flanks, and the gap about them.

    Sloping modifications move the touching point off the line of action. Over the distance x along the flank
    the gap is x^2/(2R) plus the modifications, and the flanks touch where it is least. On a relief of slope
    m' the least gap is smaller than the modification on the line of action by R m'^2/2, some tenths of a
    micrometer. Between their breaks, the modifications are parabolas about the touching point of plain
    involutes.

    As gear 2 lags, its flank turns back, and a part of it further out meets the mate. So the lag that closes
    a gap by removed material is larger than the gap: by the slope of that flank, at a tip edge by the lever
    arm (`docs/theory/contact.md`).

    Parameters
    ----------
    touch : Touch
        Touching points of plain involutes.
    face : ndarray, shape (n,)
        Distance of each candidate from the pinion's mid-face, m.
    gaps : tuple of GapTerm
        At least one, or teeth that differ.
    teeth : DeviatingTeeth or None
        Gaps that differ from tooth to tooth, for the teeth that meet at each candidate.
    """
    moving = tuple(term for term in gaps if term.along_profile)
    steady = tuple(term for term in gaps if not term.along_profile)
    modified = _shifted_touch(pair, touch, face, moving, teeth) if moving or teeth else touch
    if not steady:
        return modified
    roll_2 = pair.mating_roll_length(touch.roll_1)
    removed = sum(term(pair, touch.roll_1, roll_2, face) for term in steady)
    return replace(modified, gap=modified.gap + removed * modified.lag)


def _shifted_touch(
    pair: ParallelAxes,
    touch: Touch,
    face: FloatArray,
    gaps: tuple[GapTerm, ...],
    teeth: DeviatingTeeth | None,
) -> Touch:
    """Move the touching points to the least sum of conjugate gap, `gaps` and gaps of the teeth."""
    # points that can touch, in one row
    shape, possible = touch.gap.shape, np.flatnonzero(np.isfinite(touch.gap))
    plain = {name: values.reshape(touch.gap.size, *values.shape[2:]) for name, values in vars(touch).items()}
    near = Touch(**{name: values[possible] for name, values in plain.items()})
    faces = np.broadcast_to(face, shape).ravel()[possible]
    if teeth is not None:
        teeth = teeth._replace(meeting=np.broadcast_to(teeth.meeting, shape).ravel()[possible])
    surfaces = tuple(
        DesignedSurface.of(pair, gear, grid)
        for term in gaps
        for gear, grid in enumerate(term.grids)
        if grid is not None
    )
    flanks = _Flanks(pair, near, faces, gaps, teeth, surfaces)
    touching = _touching(flanks)
    shift, about = touching.shift, touching.about
    changed = {"s_1": near.s_1 + shift, "s_2": near.s_2 - shift}
    changed |= {"shift": shift + touching.off, "approach_error": touching.approach_error}
    changed |= flanks.closed(shift, touching.gap) | about._asdict()
    result = {}
    for name, values in changed.items():
        all_values = plain[name].copy()
        if plain[name].shape[1:] != values.shape[1:]:  # more breaks than plain flanks have
            all_values = np.zeros((touch.gap.size, *values.shape[1:]))
        all_values[possible] = values
        result[name] = all_values.reshape(*shape, *values.shape[1:])
    return replace(touch, **result)


class _Touching(NamedTuple):
    """Touching points of n flanks."""

    shift: FloatArray
    """Distance from the touching point of plain involutes, m."""
    gap: FloatArray
    """True gap, m."""
    off: FloatArray
    """Distance of the load's centroid from the touching point, m."""
    approach_error: FloatArray
    """Error of the approach, as in `Touch`."""
    about: Gap
    """Gap about the touching points."""


def _touching(flanks: _Flanks) -> _Touching:
    """Return where flanks touch.

    Gaps of few parabolas are solved from the lowest of a few samples. The true gap is searched from many
    samples where the deviations are more curved than `ROUGH`, or where the true gap differs from the
    parabolas.
    """
    sharp, wavy = flanks.rougher(ROUGH), flanks.rougher(WAVY)
    smooth = flanks.rows(np.flatnonzero(~sharp)) if sharp.any() else flanks
    shift, gap, poor, about = _by_parabolas(smooth)
    zero = np.zeros(shift.size)
    if not wavy.any() and not poor.any():
        return _Touching(shift, gap, zero, zero, about)
    rough = sharp.copy()
    rough[~sharp] = poor
    about = with_breaks(about, BREAKS) if wavy.any() else about
    arrays: _Arrays = (shift, gap, zero, zero.copy(), *about)
    if sharp.any():
        every = tuple(np.zeros((sharp.size, *values.shape[1:])) for values in arrays)
        arrays = _replaced_arrays(every, np.flatnonzero(~sharp), arrays)
    uncertain = np.flatnonzero(rough | wavy)
    for part in np.array_split(uncertain, uncertain.size // _AT_ONCE + 1):
        flanks_of_part, searched = flanks.rows(part), np.flatnonzero(rough[part])
        position, minimum = arrays[0][part], arrays[1][part]
        if searched.size:
            position[searched], minimum[searched] = flanks_of_part.rows(searched).minimum(position[searched])
        off, error, local_gap = flanks_of_part.loaded_gap(position, wavy=wavy[part])
        local_gap = with_breaks(local_gap, about.offset.shape[1])
        arrays = _replaced_arrays(arrays, part, (position, minimum, off, error, *local_gap))
    shift, gap, off, error, *local_gaps = arrays
    return _Touching(shift, gap, off, error, Gap(*local_gaps))


def _by_parabolas(flanks: _Flanks) -> tuple[FloatArray, FloatArray, BoolArray, Gap]:
    """Return touching points by gaps of parabolas.

    Returns their shift, the true gap at them, where it differs from the parabolas, and the gap about them.
    """
    shift, gap_at_shift = flanks.lowest_sample()
    of: IntArray = np.arange(gap_at_shift.size)  # numbers of the `flanks` that are searched still
    poor, arrays = np.zeros(gap_at_shift.size, dtype=bool), ()  # type: BoolArray, _Arrays
    step: FloatArray = np.zeros(0)
    for _ in range(_CUT_TIP_PASSES if flanks.cut_tips else _PASSES):
        if arrays:  # a flank without a step has found its touching point
            moving = np.flatnonzero(step)
            flanks, of = flanks.rows(moving), of[moving]
        x = shift[of]
        about = flanks.about(x)
        step = touching_offsets(about, flanks.first - x, flanks.last - x)
        # bumps of a measured flank are no parabolas: the step must lead down, unless it is next to nothing
        next_gap = flanks.gap(x + step)
        leads_down = (next_gap <= gap_at_shift[of]) | (np.abs(step) < 1e-3 * flanks.step)
        step = np.where(leads_down, step, 0.0)
        minimum, local_gap = shifted_gap(about, step)
        arrays = _replaced_arrays(arrays, of, tuple(local_gap))
        step_error = np.abs(gap_at_shift[of] + minimum - next_gap)
        poor[of] = ~leads_down | (step_error > _STEP_ERROR * flanks.allowed)
        shift[of] = x + step
        gap_at_shift[of] = np.where(leads_down, next_gap, gap_at_shift[of])
    return shift, gap_at_shift, poor, Gap(*arrays)


def _replaced_arrays(arrays: _Arrays, of: IntArray, part: _Arrays) -> _Arrays:
    """Return arrays in which the entries `of` have the values of `part`; all entries if they are empty."""
    if not arrays or len(of) == len(arrays[0]):
        return part
    for every, values in zip(arrays, part, strict=True):
        every[of] = values
    return arrays


class _Flanks:
    """Gaps over the conjugate ones of n touching points, functions of the way x (n,) in m along the flank."""

    def __init__(
        self,
        pair: ParallelAxes,
        touch: Touch,
        face: FloatArray,
        gaps: tuple[GapTerm, ...],
        teeth: DeviatingTeeth | None,
        surfaces: tuple[DesignedSurface, ...],
    ) -> None:
        self._pair, self._touch, self._face, self._gaps = pair, touch, face, gaps
        self._teeth, self._surfaces = teeth, surfaces
        self._breaks = [line for term in gaps for line in term.breaks(pair, face)]
        cut = {_SIDES[line.gear] for line in self._breaks if line.ends_flank}
        self.cut_tips = [side for side in _SIDES if side in cut]
        # towards a base circle; away from both on the flank of a ring gear
        inwards = np.minimum(touch.s_1, np.where(touch.s_2 < 0.0, -touch.s_2, np.inf))
        self.first = np.maximum(touch.low, -_REACH * inwards)
        self.last = np.minimum(touch.high, np.where(touch.s_2 < 0.0, np.inf, _REACH * touch.s_2))
        self.step = np.minimum(STEP / touch.curvature, 0.2 * (self.last - self.first))
        self.allowed = ALLOWED / touch.curvature
        self._tilt = {side: self._excess_slope(side) for side in self.cut_tips}

    def rows(self, of: IntArray) -> _Flanks:
        """Return the flanks of some of the touching points."""
        teeth = None if self._teeth is None else self._teeth.rows(of)
        return _Flanks(self._pair, self._touch.rows(of), self._face[of], self._gaps, teeth, self._surfaces)

    def gap(self, x: FloatArray) -> FloatArray:
        """Return the gap at x, m."""
        excess = sum(self._excess(side, x) for side in self.cut_tips)
        return np.asarray(self._plain(x) + self._removed(x) + excess)

    def gap_of(self, x: FloatArray, of: IntArray) -> FloatArray:
        """Return the gap in m at ways x (k,) of some of the touching points (k,)."""
        if self.cut_tips:
            return self.rows(of).gap(x)
        touch, pinion, wheel = self._touch, self._pair.pinion, self._pair.wheel
        doubled = 2.0 * pinion.base_radius, 2.0 * wheel.base_radius
        flanks = touch.s_1, touch.s_2, touch.slope, touch.curvature
        plain, roll_1, roll_2 = _plain_at_ways(x, of, flanks, doubled, float(wheel.sign))
        return plain + self._removed_at((roll_1, roll_2), of)

    def rougher(self, part: float) -> BoolArray:
        """Return where deviations may have more than this part of the curvature of plain flanks."""
        touch = self._touch
        if not self._surfaces and self._teeth is None:
            return np.zeros(touch.s_1.size, dtype=bool)
        rolls = rolls_at(self._pair, touch.s_1, touch.s_2)
        return np.asarray(curvature_bound(self._pair, self._extents(), rolls) > part * touch.curvature)

    def _extents(self) -> list[tuple[int, Extent]]:
        """Return gear and extent of the gaps that may be rough."""
        surfaces = [(surface.gear, surface.extent) for surface in self._surfaces]
        return surfaces if self._teeth is None else surfaces + self._teeth.extents()

    def minimum(self, start: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return where the gap is least (n,), and the gap there, m; `start` is a point with a low gap.

        The search covers a window. Outside it the gap of plain flanks exceeds the largest fall of the
        deviations.
        """
        touch, fall = self._touch, self._largest_fall()
        steepness = np.abs(touch.slope)
        reach = (np.sqrt(steepness**2 + 2.0 * touch.curvature * fall) - steepness) / touch.curvature
        reach = np.maximum(1.1 * reach, self.step)  # a valley at its end has samples to either side
        low, high = np.maximum(self.first, -reach), np.minimum(self.last, reach)
        parts = np.linspace(0.0, 1.0, _SAMPLES)
        x, of = samples((low, high), start, parts, self._nodes(), _ALIKE * self.step)
        return least_gap(self.gap_of, x, of, self.allowed)

    def _largest_fall(self) -> FloatArray:
        """Return a bound of the fall of removed material from the touching points within their reach, m."""
        fall = np.zeros(self.step.size)
        for _, extent in self._extents():
            fall = fall + extent.spread
        if self._gaps:
            part = np.linspace(0.0, 1.0, _SAMPLES)[:, None]
            ways = np.concatenate([np.zeros((1, fall.size)), self.first + (self.last - self.first) * part])
            rolls = rolls_at(self._pair, self._touch.s_1 + ways, self._touch.s_2 - ways)
            designed = self._designed(rolls, slice(None))
            fall = fall + np.maximum(designed[0] - designed[1:].min(axis=0), 0.0)
        return fall

    def _nodes(self) -> Nodes:
        """Return the nodes of all gaps along the flanks; the nodes of the wheel run the other way."""
        touch, pair = self._touch, self._pair
        count = touch.s_1.size
        # gear, lists of nodes, and the list of each touching point; list 0 of all is empty
        every = np.zeros(count, dtype=np.int64)
        sets = [(surface.gear, [surface.nodes], every) for surface in self._surfaces]
        sets += [] if self._teeth is None else self._teeth.nodes(pair)
        along, list_of = [np.zeros(0)], np.zeros((len(sets), count), dtype=np.int64)
        for k, (gear, lists, of) in enumerate(sets):
            sign, toothing = (1.0, pair.pinion) if gear == 0 else (-1.0, pair.wheel)
            list_of[k] = of + len(along)
            along += [np.sort(sign * toothing.flank_coordinate(nodes)) for nodes in lists]
        start = np.cumsum([0, *(surface.size for surface in along)])
        gears = np.array([gear for gear, _, _ in sets], dtype=bool)[:, None]
        return Nodes(np.concatenate(along), start, list_of, np.where(gears, -touch.s_2, touch.s_1))

    def lowest_sample(self) -> tuple[FloatArray, FloatArray]:
        """Return where the gap is least among samples over the whole reach and at 0, and the gap there, m.

        Removed material only widens the gap of plain flanks. So where modifications only remove material,
        most samples need not be computed: their plain gap alone is larger than the gap at 0.
        """
        lowest = np.zeros(self.step.size)
        minimum = self.gap(lowest)
        are_alike = self._teeth is None
        bounded = are_alike and not self.cut_tips and all(term.only_removes for term in self._gaps)
        uncertain = np.flatnonzero(minimum > 0.0) if bounded else np.arange(lowest.size)
        part, near = np.linspace(0.0, 1.0, _SAMPLES)[:, None], self.rows(uncertain)
        x = near.first + (near.last - near.first) * part  # (samples, uncertain)
        if bounded:
            gap = near._plain(x)
            below = gap < minimum[uncertain]
            gap[below] += near._removed(x[below], np.nonzero(below)[1])
        else:
            gap = np.array([near.gap(way) for way in x]) if self.cut_tips else near.gap(x)
        best = gap.argmin(axis=0), np.arange(uncertain.size)
        lower = gap[best] < minimum[uncertain]
        lowest[uncertain[lower]] = x[best][lower]
        minimum[uncertain[lower]] = gap[best][lower]
        return lowest, minimum

    def about(self, x: FloatArray) -> Gap:
        """Return the gap about x.

        Slope and curvature follow from differences over the length of a strip within the flanks. They are
        taken of the removed material without the parts beyond breaks, which is smooth.
        """
        touch, step = self._touch, self.step
        breaks = [(line, line.distance(touch.s_1, touch.s_2) - x) for line in self._breaks]
        middle = np.clip(x, self.first + step, self.last - step)
        smooth = []
        for position in (middle - step, middle, middle + step):
            beyond_breaks = sum(line.height(position - x - distance) for line, distance in breaks)
            smooth.append(self._removed(position) - beyond_breaks)
        below, center, above = smooth
        bend = (above - 2.0 * center + below) / step**2
        slope = touch.slope + touch.curvature * x + (above - below) / (2.0 * step) + bend * (x - middle)
        near = _NEAR * step
        for side in self.cut_tips:
            slope = slope + (self._excess(side, x + near) - self._excess(side, x - near)) / (2.0 * near)
        curvature = touch.curvature + bend
        position, jump, bends = np.zeros((3, x.size, len(breaks)))
        for k, (line, distance) in enumerate(breaks):
            inside = distance < 0.0 if line.side > 0 else distance >= 0.0
            depth = np.where(inside, np.abs(distance), 0.0)
            slope = slope + np.where(inside, line.side * (line.jump + line.bend * depth), 0.0)
            curvature = curvature + np.where(inside, line.bend, 0.0)
            position[:, k], jump[:, k] = distance, line.jump
            bends[:, k] = np.where(inside, -line.bend, line.bend)
        ends = touch.low - x, touch.high - x
        # a flank that is more hollow than its mate is round would touch at several points
        return rounded(Gap(slope, curvature, *ends, position, jump, bends), FLATTEST * touch.curvature)

    def loaded_gap(self, x: FloatArray, wavy: BoolArray) -> tuple[FloatArray, FloatArray, Gap]:
        """Return the offset of the load at touching points x (n,), m, the error, and the gap about them.

        For `wavy` flanks it is the even gap with the same approach under load (`rough_strip`), except where
        an edge touches.
        """
        touch = self._touch
        off, error = np.zeros((2, x.size))
        _, gap = shifted_gap(self.about(x), np.zeros(x.size))
        inside = np.flatnonzero(wavy & (gap.slope == 0.0) & (gap.low < 0.0) & (gap.high > 0.0))
        if not inside.size:
            return off, error, gap

        def within_flanks(way: FloatArray, of: IntArray) -> FloatArray:
            """Return the gap; beyond the ends of the flanks it is at least that of plain flanks."""
            contacts, gap = inside[of], self.gap_of(way, inside[of])
            beyond = np.maximum(touch.low[contacts] - way, way - touch.high[contacts])
            plain = touching_gap[contacts] + 0.5 * touch.curvature[contacts] * (way - x[contacts]) ** 2
            return np.where(beyond > 0.0, np.maximum(gap, plain), gap)

        touching_gap = self.gap(x)
        fall = self._largest_fall()[inside]
        strip = rough_strip(within_flanks, x[inside], touch.curvature[inside], fall)
        gap = with_breaks(gap, BREAKS)
        even_gap = strip.gap._replace(low=gap.low[inside], high=gap.high[inside])
        even_gap = with_breaks(even_gap, gap.offset.shape[1])
        off[inside], error[inside] = strip.center, strip.approach_error
        return off, error, Gap(*_replaced_arrays(tuple(gap), inside, tuple(even_gap)))

    def closed(self, x: FloatArray, gap: FloatArray) -> dict[str, FloatArray]:
        """Return gap, lag, slopes and turns of a `Touch` at x.

        `gap` is the gap at x less that of plain flanks at 0, m. On the flank of gear 2 the slope of that
        flank turns the normal; at an edge the normal is that of the mate. Gaps of single teeth count as lags.
        """
        touch, (s_1, s_2), (end_1, end_2) = self._touch, self._places(x), self._ends
        slope_1, turn_1 = self._slope_of(0, x, s_1 >= end_1)
        slope_2, turn_2 = self._slope_of(1, x, s_2 >= end_2)
        turn_factor = 1.0 / (1.0 - slope_2)
        at_edge = (s_1 >= end_1) | (s_2 >= end_2)
        rolls = rolls_at(self._pair, s_1, s_2)
        depth = gap + np.where(at_edge, self._designed(rolls) * (touch.lag - 1.0), 0.0)
        of_teeth = self._of_teeth(rolls)
        # a relief moved the touching point off the line of action, clear of the edge of gear 2
        clear_of_edge_2 = ~at_edge & (touch.lever_2 != 1.0) & (slope_2 != 0.0)
        plain = touch.gap * np.where(clear_of_edge_2, touch.lever_2 * turn_factor, 1.0)
        return {
            "gap": plain + (depth - of_teeth) * turn_factor + of_teeth,
            "lag": np.where(at_edge, touch.lag, 1.0) * turn_factor,
            # the lever arms contain part of the slope off the line of action, and all of it at the edge
            "slope_1": np.where(s_1 >= end_1, 0.0, slope_1 - (1.0 - touch.lever_1)),
            "slope_2": np.where(s_2 >= end_2, 0.0, slope_2 - (1.0 - touch.lever_2)),
            "turn_1": turn_1,
            "turn_2": turn_2,
        }

    def _places(self, x: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the flank coordinates of both gears at x, m."""
        return self._touch.s_1 + x, self._touch.s_2 - x

    @property
    def _ends(self) -> list[float]:
        """Flank coordinates of the edges of both gears, those that a cut tip leaves, m."""
        gears = (self._pair.pinion, self._pair.wheel)
        return [float(gear.flank_coordinate(gear.tip_form_roll_length)) - _AT_EDGE for gear in gears]

    def _slope_of(self, gear: int, x: FloatArray, at_edge: BoolArray) -> tuple[FloatArray, FloatArray]:
        """Return the slope of the material removed from all flanks of a gear at x, and its change along them.

        Slopes are limited to `STEEPEST`. A steeper flank recedes nearly as fast as the gear turns, so that
        the mate does not touch it.
        """
        near = _NEAR * self.step
        slope, next_slope = (
            np.clip(flank_slope(self._pair, gear, self._designed, s, self.step), -STEEPEST, STEEPEST)
            for s in (self._places(x), self._places(x + near))
        )
        return np.where(at_edge, 0.0, slope), np.where(at_edge, 0.0, (next_slope - slope) / near)

    def _plain(self, x: FloatArray) -> FloatArray:
        """Return the gap of plain flanks at x, m."""
        return np.asarray(x * (self._touch.slope + 0.5 * self._touch.curvature * x))

    def _removed(self, x: FloatArray, of: IntArray | slice = slice(None)) -> FloatArray:
        """Return the material removed at x from the flanks of some of the touching points, m."""
        return self._removed_at(rolls_at(self._pair, self._touch.s_1[of] + x, self._touch.s_2[of] - x), of)

    def _removed_at(self, rolls: tuple[FloatArray, FloatArray], of: IntArray | slice) -> FloatArray:
        """Return the material removed at roll lengths of both gears, m."""
        return self._designed(rolls, of) + self._of_teeth(rolls, of)

    def _of_teeth(
        self, rolls: tuple[FloatArray, FloatArray], of: IntArray | slice = slice(None)
    ) -> FloatArray | float:
        """Return the removed material that differs from tooth to tooth, at roll lengths of both gears, m."""
        if self._teeth is None:
            return 0.0
        return self._teeth.rows(of).gap(self._pair, rolls, self._face[of])

    def _designed(
        self, rolls: tuple[FloatArray, FloatArray], of: IntArray | slice = slice(None)
    ) -> FloatArray:
        """Return the removed material that all teeth have in common, at roll lengths of both gears, m."""
        terms = (term(self._pair, *rolls, self._face[of]) for term in self._gaps)
        return np.asarray(sum(terms, np.zeros(())))

    def _excess(self, side: Side, x: FloatArray) -> FloatArray:
        """Return the gap of plain flanks behind a cut tip less their parabola, m.

        A rounding or chamfer moves touching points off the line of action by up to its length, further than a
        relief does. The excess has no slope at the touching point of plain flanks, next to which the parabola
        is exact.
        """
        return self._beyond_parabola(side, x) - np.where(self._behind(side, x), self._tilt[side] * x, 0.0)

    def _excess_slope(self, side: Side) -> FloatArray:
        """Return the slope of exact gap less parabola at the touching point of plain flanks, behind it."""
        near = _NEAR * (self.step if side == "approach" else -self.step)
        return self._beyond_parabola(side, near) / near

    def _beyond_parabola(self, side: Side, x: FloatArray) -> FloatArray:
        """Return the exact gap of plain flanks less their parabola at x, m, where x is behind a tip."""
        touch, pair = self._touch, self._pair
        behind = self._behind(side, x)
        rolls = rolls_at(pair, (touch.s_1 + x)[behind], (touch.s_2 - x)[behind])
        nominal = touch.roll_1[behind]
        if side == "exit":
            exact = edge_gap(pair, side, rolls[0], nominal)
        else:
            exact = edge_gap(pair, side, rolls[1], pair.mating_roll_length(nominal))
        parabola = touch.gap + x * (touch.slope + 0.5 * touch.curvature * x)
        excess = np.zeros(x.shape)
        excess[behind] = np.nan_to_num(exact - parabola[behind])
        return excess

    def _behind(self, side: Side, x: FloatArray) -> BoolArray:
        """Return where x lies towards the root of the gear whose tip leaves on that side, on round flanks."""
        flattest = FLAT * self._pair.wheel.base_radius
        return np.asarray((x < 0.0 if side == "exit" else x > 0.0) & (self._touch.radius < flattest))


@njit(cache=True, error_model="numpy")
def _plain_at_ways(
    x: FloatArray,
    of: IntArray,
    flanks: tuple[FloatArray, FloatArray, FloatArray, FloatArray],
    doubled: tuple[float, float],
    sign: float,
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the gap of plain flanks at ways x (k,) of touching points `of` (k,), and both roll lengths, m.

    `flanks` are both flank coordinates, slope and curvature at the touching points; `doubled` are twice the
    base radii, and `sign` is that of the wheel.
    """
    s_1, s_2, slope, curvature = flanks
    plain, roll_1, roll_2 = np.empty(x.size), np.empty(x.size), np.empty(x.size)
    for k in range(x.size):
        n, way = of[k], x[k]
        plain[k] = way * (slope[n] + 0.5 * curvature[n] * way)
        roll_1[k] = math.sqrt(doubled[0] * max(s_1[n] + way, 0.0))
        roll_2[k] = math.sqrt(doubled[1] * max(sign * (s_2[n] - way), 0.0))
    return plain, roll_1, roll_2
