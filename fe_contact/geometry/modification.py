"""Flank modifications (ISO 21771-1, clause 7; ISO 1328-1 for the slopes).

All amounts are material removed, in m, normal to the involute in the transverse plane (along the line of
action).
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import ArrayLike

from bounds import Quantity, SiNote, Text, at_least
from fe_contact.checks import finite, positive, within
from fe_contact.errors import InputError
from fe_contact.geometry.flank_grid import FlankGrid
from fe_contact.geometry.tip_edge import (
    FLATTEST,
    STEEPEST,
    chamfer_start,
    check_chamfer,
    check_rounding,
    rounding_start,
)
from fe_contact.types import FloatArray

if TYPE_CHECKING:
    from fe_contact.geometry.toothing import Toothing

Shape = Literal["linear", "parabolic"]
SHAPES: tuple[Shape, ...] = ("linear", "parabolic")
AMOUNTS = (
    "tip_relief",
    "root_relief",
    "end_relief",
    "profile_crowning",
    "profile_slope",
    "helix_crowning",
    "helix_slope",
    "flank_twist",
)
"""Fields of a modification that are depths, m."""
_ACROSS_FACE = (
    "helix_crowning",
    "helix_slope",
    "end_relief",
    "end_relief_length",
    "end_relief_shape",
    "flank_twist",
)
_LARGEST = 0.01  # m; catches micrometres given as metres
_LARGEST_EDGE = 0.1  # m; of a tip rounding or chamfer


@dataclass(frozen=True)
class ReliefStart:
    """Where a relief or the tip's edge begins along the profile; a distance d inside to jump d + bend d^2/2.

    Attributes
    ----------
    roll_length : float
        m.
    towards_tip : bool
        Whether it runs to the tip; else to the root.
    jump, bend : float
        Slope and curvature with which it begins, over the arc length of the flank; 1 and 1/m.
    ends_flank : bool
        Whether it is the edge of a rounded or chamfered tip, where the usable flank ends.
    """

    roll_length: float
    towards_tip: bool
    jump: float
    bend: float
    ends_flank: bool = False


@dataclass(frozen=True)
class FlankModification:
    """Intended departures of one gear's flanks from the involute helicoid.

    Attributes
    ----------
    tip_relief, root_relief : float
        Amount removed at the tip circle and at the form circle, m, >= 0.
    tip_relief_length, root_relief_length : float
        Radial extent from the tip circle inwards and from the form circle outwards, m; must be given with an
        amount.
    tip_relief_shape, root_relief_shape : {"linear", "parabolic"}
        Course over the roll length, from zero where the relief starts.
    profile_crowning : float
        Removed at both ends of the involute, m, >= 0; parabolic over the roll length, zero at its middle.
    profile_slope : float
        Difference in m between tip and form point, linear over the roll length and zero at its middle: > 0
        removes half of it at the tip and adds half at the form point.
    helix_crowning : float
        Removed at both ends of the face, m, >= 0; parabolic, zero at mid-face.
    helix_slope : float
        Difference in m between the two ends of the face, linear and zero at mid-face: > 0 removes half of it
        at the end of positive face position.
    end_relief, end_relief_length : float
        Amount removed at both ends of the face, m, >= 0, and its extent along the face, m.
    end_relief_shape : {"linear", "parabolic"}
        Course over the face.
    flank_twist : float
        Removed in m at the tip end of positive face position and at the opposite corner, added at the other
        two; bilinear over roll length and face, zero at the middle of either. The profile slope so grows by
        four times the amount from one end of the face to the other.
    flank_grid : FlankGrid, optional
        Free-form flank, removed besides all of the above.
    tip_rounding : float
        Radius in m, >= 0, in the transverse plane, of the arc from the tip form point to the tip circle,
        tangent to both. All amounts at the tip stay those at the tip circle.
    tip_chamfer : float
        Radial height h_K in m, >= 0, of the tip chamfer: d_Fa = d_a - 2 h_K (internal: +). Or a rounding.
    tip_chamfer_angle : float
        Angle between flank and chamfer at the tip form point in the transverse plane, rad.
    """

    tip_relief: float = 0.0
    tip_relief_length: float = 0.0
    tip_relief_shape: Shape = "linear"
    root_relief: float = 0.0
    root_relief_length: float = 0.0
    root_relief_shape: Shape = "linear"
    profile_crowning: float = 0.0
    profile_slope: float = 0.0
    helix_crowning: float = 0.0
    helix_slope: float = 0.0
    end_relief: float = 0.0
    end_relief_length: float = 0.0
    end_relief_shape: Shape = "linear"
    flank_twist: float = 0.0
    flank_grid: FlankGrid | None = None
    tip_rounding: float = 0.0
    tip_chamfer: float = 0.0
    tip_chamfer_angle: float = math.radians(30.0)

    def __post_init__(self) -> None:
        for kind in ("tip", "root", "end"):
            _check_relief(self, f"{kind}_relief")
        for crowning in ("profile_crowning", "helix_crowning"):
            within(crowning, getattr(self, crowning), 0.0, _LARGEST, SiNote("In m: 5 um is 5e-6."))
        for slope in ("profile_slope", "helix_slope", "flank_twist"):
            within(slope, getattr(self, slope), -_LARGEST, _LARGEST, SiNote("In m: 5 um is 5e-6."))
        _check_tip_edge(self)

    @property
    def neutral(self) -> bool:
        """Whether nothing is removed anywhere."""
        return not (self.varies_along_profile or self.varies_along_face)

    @property
    def varies_along_profile(self) -> bool:
        """Whether the modification depends on the roll length, at any place of the face."""
        alone = (self.tip_relief, self.root_relief, self.profile_crowning, self.profile_slope)
        edge = (self.tip_rounding, self.tip_chamfer)
        return any((*alone, *edge, self.flank_twist)) or any(not grid.neutral for grid in self._grids)

    @property
    def varies_along_face(self) -> bool:
        """Whether the modification depends on the face position, at any roll length."""
        alone = (self.helix_crowning, self.helix_slope, self.end_relief)
        return any((*alone, self.flank_twist)) or any(grid.varies_along_face for grid in self._grids)

    @property
    def along_profile(self) -> FlankModification:
        """The part that is the same all over the face."""
        plain = {name: getattr(UNMODIFIED, name) for name in _ACROSS_FACE}
        grids = (grid for grid in self._grids if not grid.varies_along_face)
        return replace(self, **plain, flank_grid=next(grids, None))

    @property
    def along_face(self) -> FlankModification:
        """The part that differs over the face; twisted or free, it varies along the profile too."""
        own = {name: getattr(self, name) for name in _ACROSS_FACE}
        grids = (grid for grid in self._grids if grid.varies_along_face)
        return FlankModification(**own, flank_grid=next(grids, None))

    @property
    def _grids(self) -> tuple[FlankGrid, ...]:
        """The free-form flank, if there is one."""
        return () if self.flank_grid is None else (self.flank_grid,)

    def check_fits(self, gear: Toothing) -> None:
        """Raise `InputError` if a relief is longer than the involute or half the face, a grid beside it.

        And if the tip's edge leaves no involute or no tip.
        """
        height = abs(gear.tip_radius - gear.form_radius)
        advice = SiNote("Lengths are in m: 1 mm is 0.001.")
        within("modification.tip_relief_length", self.tip_relief_length, 0.0, height, advice)
        within("modification.root_relief_length", self.root_relief_length, 0.0, height, advice)
        within("modification.end_relief_length", self.end_relief_length, 0.0, 0.5 * gear.face_width, advice)
        half = 0.5 * gear.face_width
        for grid in self._grids:
            _check_reach("modification.flank_grid.roll_length", grid.roll_length, *_involute(gear))
            _check_reach("modification.flank_grid.face_position", grid.face_position, -half, half)
        if self.tip_rounding:
            check_rounding(gear, self.tip_rounding)
        if self.tip_chamfer:
            check_chamfer(gear, self.tip_chamfer, self.tip_chamfer_angle)

    def tip_form_roll_length(self, gear: Toothing) -> float:
        """Roll length in m at which the usable flank of `gear` ends and its tip's edge begins."""
        edge = self._tip_edge(gear)
        return gear.tip_roll_length if edge is None else edge.roll_length

    def material_removed(
        self, gear: Toothing, roll_length: ArrayLike, face_position: ArrayLike = 0.0
    ) -> FloatArray:
        """Material removed normal to the involute, in the transverse plane.

        Parameters
        ----------
        gear : Gear or RingGear
            The gear the modification belongs to.
        roll_length : array_like
            Roll lengths in m; outside the involute its end value is taken.
        face_position : array_like, optional
            Distance from mid-face in m, broadcast against `roll_length`.

        Returns
        -------
        array
            m, >= 0 except where a slope or twist adds material; exactly zero for a neutral modification.
        """
        roll, face = np.broadcast_arrays(np.asarray(roll_length, float), np.asarray(face_position, float))
        removed = np.zeros(roll.shape)
        roll = np.clip(roll, *_involute(gear))
        if self.varies_along_profile:
            removed += self._along_profile(gear, roll)
        if self.varies_along_face:
            removed += self._along_face(gear, face)
        if self.flank_twist:
            removed += self.flank_twist * _across_profile(gear, roll) * _across_face(gear, face)
        for grid in self._grids:
            removed += grid.material_removed(roll, face)
        return removed

    def relief_starts(self, gear: Toothing) -> tuple[ReliefStart, ...]:
        """Return where reliefs, and the tip's edge if it is not sharp, begin along the profile."""
        starts = tuple(
            ReliefStart(start, end == gear.tip_roll_length, *_beginning(gear, amount, shape, start, end))
            for amount, shape, start, end in self._reliefs(gear)
        )
        edge = self._tip_edge(gear)
        return starts if edge is None else (*starts, edge)

    def _tip_edge(self, gear: Toothing) -> ReliefStart | None:
        """Return where the tip's rounding or chamfer begins, None for a sharp edge.

        The involute turns away from its tangent too, with the curvature 1/l; hollow in a ring gear.
        """
        if self.tip_rounding:
            start = rounding_start(gear, self.tip_rounding)
            return ReliefStart(start, True, 0.0, 1.0 / self.tip_rounding - gear.sign / start, True)
        if self.tip_chamfer:
            start = chamfer_start(gear, self.tip_chamfer)
            return ReliefStart(start, True, math.tan(self.tip_chamfer_angle), -gear.sign / start, True)
        return None

    def _along_profile(self, gear: Toothing, roll: FloatArray) -> FloatArray:
        """Reliefs, crowning, slope and tip edge over the roll length."""
        across = _across_profile(gear, roll)
        removed = self.profile_crowning * across**2 + 0.5 * self.profile_slope * across
        for amount, shape, start, end in self._reliefs(gear):
            removed += amount * _course(shape, (roll - start) / (end - start))
        edge = self._tip_edge(gear)
        if edge is not None:
            start = edge.roll_length
            inside = np.maximum(gear.sign * (roll - start) * (roll + start) / (2.0 * gear.base_radius), 0.0)
            removed += inside * (edge.jump + 0.5 * edge.bend * inside)
        return np.asarray(removed, dtype=float)

    def _reliefs(self, gear: Toothing) -> Iterator[tuple[float, Shape, float, float]]:
        """Give amount, shape and the roll lengths of beginning and end of each relief along the profile."""
        if self.tip_relief:
            start = gear.roll_length(gear.tip_radius - gear.sign * self.tip_relief_length)
            yield self.tip_relief, self.tip_relief_shape, start, gear.tip_roll_length
        if self.root_relief:
            start = gear.roll_length(gear.form_radius + gear.sign * self.root_relief_length)
            yield self.root_relief, self.root_relief_shape, start, gear.form_roll_length

    def _along_face(self, gear: Toothing, face: FloatArray) -> FloatArray:
        """End relief, crowning and slope over the face."""
        across = _across_face(gear, face)
        removed = self.helix_crowning * across**2 + 0.5 * self.helix_slope * across
        if self.end_relief:
            from_start = (np.abs(face) - 0.5 * gear.face_width) / self.end_relief_length + 1.0
            removed = removed + self.end_relief * _course(self.end_relief_shape, from_start)
        return np.asarray(removed, dtype=float)


def _involute(gear: Toothing) -> tuple[float, float]:
    """Least and largest roll length of the involute, m."""
    ends = gear.form_roll_length, gear.tip_roll_length
    return min(ends), max(ends)


def _across_profile(gear: Toothing, roll: FloatArray) -> FloatArray:
    """Place on the involute: -1 at the form point, +1 at the tip, linear over the roll length."""
    form, tip = gear.form_roll_length, gear.tip_roll_length
    return np.asarray((2.0 * roll - form - tip) / (tip - form))


def _across_face(gear: Toothing, face: FloatArray) -> FloatArray:
    """Place on the face: -1 and +1 at its ends."""
    return np.asarray(2.0 * face / gear.face_width)


def _course(shape: Shape, fraction: FloatArray) -> FloatArray:
    """Relative depth of a relief at `fraction` of its length: 0 before it starts, 1 from its end on."""
    inside = np.clip(fraction, 0.0, 1.0)
    return inside if shape == "linear" else inside**2


def _beginning(gear: Toothing, amount: float, shape: Shape, start: float, end: float) -> tuple[float, float]:
    """Return slope and curvature of a relief where it begins, over the arc length of the flank.

    The fraction u of its length grows with the arc d as du/dd = r_b/(l |end - start|), and l l' = +-r_b.
    """
    slope = gear.base_radius / (start * abs(end - start))
    if shape == "parabolic":
        return 0.0, 2.0 * amount * slope**2
    return amount * slope, -amount * gear.base_radius**2 / (start**3 * (end - start))


def _check_relief(modification: FlankModification, kind: str) -> None:
    """Check amount, length and shape of one relief."""
    amount, length = getattr(modification, kind), getattr(modification, f"{kind}_length")
    shape = getattr(modification, f"{kind}_shape")
    within(kind, amount, 0.0, _LARGEST, SiNote("In m: 20 um is 20e-6."))
    if shape not in SHAPES:
        raise InputError(f"{kind}_shape", shape, 'one of "linear" and "parabolic"')
    finite(f"{kind}_length", length)
    if amount:
        advice = SiNote(f"{kind} needs the length over which it acts, in m.")
        positive(f"{kind}_length", length, advice)
    elif length < 0.0:
        raise InputError(f"{kind}_length", length, at_least(0.0))


def _check_tip_edge(modification: FlankModification) -> None:
    """Check rounding and chamfer of the tip, of which there is at most one."""
    for field in ("tip_rounding", "tip_chamfer"):
        within(field, getattr(modification, field), 0.0, _LARGEST_EDGE, SiNote("In m: 0.2 mm is 2e-4."))
    angle = SiNote("In rad, between flank and chamfer: 30 deg is 0.524.")
    within("tip_chamfer_angle", modification.tip_chamfer_angle, FLATTEST, STEEPEST, angle)
    if modification.tip_rounding and modification.tip_chamfer:
        advice = "The tip has a rounding or a chamfer: give one of them."
        raise InputError("tip_chamfer", modification.tip_chamfer, "0 where tip_rounding is given", advice)


def _check_reach(field: str, axis: tuple[float, ...], low: float, high: float) -> None:
    """Refuse an axis of a grid that lies beside the flank: a wrong unit or origin."""
    if axis[-1] <= low or axis[0] >= high:
        ends = Quantity(low, "m", digits=6), " to ", Quantity(high, "m", digits=6)
        bound = Text.of("a range that reaches into the flank, which spans ", *ends)
        raise InputError(field, [axis[0], axis[-1]], bound, "Is the unit or the origin another one?")


UNMODIFIED = FlankModification()
