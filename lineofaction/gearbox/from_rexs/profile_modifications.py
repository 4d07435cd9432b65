"""Modifications along the profile: reliefs, crowning and slopes of a flank."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np

from fe_contact.geometry import Toothing
from fe_contact.types import FloatArray
from lineofaction.gearbox.from_rexs.gear_unit import Part
from lineofaction.gearbox.from_rexs.meshing import LoadedFlank
from lineofaction.gearbox.from_rexs.toothing import required
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.units import MM, UM

# Places on the flank of a gear, from diameters, roll lengths and face coordinates of REXS.


Removed = Callable[[FloatArray, FloatArray], FloatArray]
"""Material removed in m at roll lengths and at coordinates from the datum face, both in m."""
_SAME = 1e-6  # of the flank: places that a writer's rounding sets apart are one


@dataclass(frozen=True)
class Modification:
    """A modification of a flank: what it removes, and fields of the case that say the same.

    Attributes
    ----------
    removed : callable
    fields : mapping
        Empty where the case has none for it.
    rolls, faces : tuple of float
        Where it has kinks: roll lengths, coordinates from the datum face, m.
    """

    part: Part
    removed: Removed
    fields: Mapping[str, Any] = field(default_factory=dict)
    rolls: tuple[float, ...] = ()
    faces: tuple[float, ...] = ()


@dataclass(frozen=True)
class FlankPlace:
    """The flank of a gear.

    Attributes
    ----------
    gear : Toothing
        Without modifications.
    loaded : LoadedFlank
    """

    gear: Toothing
    loaded: LoadedFlank

    @property
    def tip(self) -> float:
        """Roll length of the tip circle, m."""
        return self.gear.tip_roll_length

    @property
    def root(self) -> float:
        """Roll length where the involute begins, m."""
        return self.gear.form_roll_length

    @property
    def towards_tip(self) -> float:
        """1 if roll lengths grow towards the tip, -1 of a ring gear."""
        return math.copysign(1.0, self.tip - self.root)

    @property
    def width(self) -> float:
        """Face width, m."""
        return self.gear.face_width

    def roll_length(self, part: Part, diameter: str, words: str) -> float | None:
        """Return the roll length in m of a diameter, None where the file gives none.

        Raises
        ------
        BadInput
            The diameter is inside the base circle.
        """
        value = part.number(diameter, words)
        if not value:
            return None
        radius, base = 0.5 * abs(value), self.gear.base_radius
        if radius <= base:
            bound = f"above the base diameter {2.0 * base / MM:.7g} mm"
            raise BadInput.of(f"{part.place}, {diameter}", value / MM, bound)
        return math.sqrt(radius**2 - base**2)

    def face_field(self, name: str, *, datum: bool) -> str:
        """Return a field of one face: the case's datum face is the end of negative z, whatever the file's."""
        at_negative_z = datum == (self.loaded.datum < 0.0)
        return f"{name}_{'datum_face' if at_negative_z else 'non_datum_face'}"

    def same(self, first: float, second: float) -> bool:
        """Return whether two roll lengths or face coordinates are one."""
        return abs(first - second) <= _SAME * max(abs(self.tip - self.root), self.width)

    def radial(self, roll_length: float, end: float) -> float:
        """Return the radial distance in mm between two roll lengths in m."""
        radii = (math.hypot(self.gear.base_radius, length) for length in (roll_length, end))
        first, second = radii
        return abs(second - first) / MM


def um(value: float) -> float:
    """Return a depth in um without the rounding that a change of units leaves, 12 digits."""
    return float(f"{value / UM:.12g}") + 0.0


def mm(value: float) -> float:
    """Return a length in mm, given in mm, with 12 digits."""
    return float(f"{value:.12g}") + 0.0


# Laws by which a relief grows from nothing where it starts to its amount (ISO 21771-1, clause 7).


Law = Callable[[FloatArray], FloatArray]
"""Relative depth over the fraction of the length; 0 up to 0, 1 at 1."""
_GROWTH = math.e - 1.0

LAWS: dict[str, Law] = {
    "linear": lambda u: u,
    "parabolic": lambda u: u**2,
    "circular": lambda u: u**2,
    "exponential": lambda u: np.expm1(u) / _GROWTH,
    "logarithmic": lambda u: np.log1p(_GROWTH * u),
}

SCALABLE = ("linear", "parabolic", "circular")
"""Shapes that stay the same where the amount is stated at another place than the relief's end."""


def shape_of(part: Part, item: str = "shape_of_relief") -> str:
    """Return the shape of a relief or crowning, linear by default.

    Raises
    ------
    BadInput
        REXS has no such shape.
    """
    word = part.text(item, "shape")
    if word is None:
        part.say(item, "defaulted", "linear")
        return "linear"
    if word not in LAWS:
        raise BadInput.of(f"{part.place}, {item}", word, f"one of {', '.join(LAWS)}")
    return word


def relative_depth(shape: str, fraction: FloatArray) -> FloatArray:
    """Return the depth of a relief by that at its end, at fractions of its length; 0 before it starts."""
    return np.asarray(LAWS[shape](np.maximum(fraction, 0.0)))


def _blended_depth(fraction: FloatArray, start: float, end: float) -> FloatArray:
    """Return the depth of a linear relief whose slope grows evenly between two fractions.

    1 at the fraction 1; tangential to the involute at `start`, straight from `end` on.
    """
    inside = np.clip(fraction, start, end)
    rise = 0.5 * (inside - start) ** 2 / (end - start) + np.maximum(fraction - end, 0.0)
    return np.asarray(rise / (1.0 - 0.5 * (start + end)))


# Tip and root relief, profile crowning and slope (ISO 21771-1, clause 7.2).


def tip_relief(place: FlankPlace, part: Part) -> Modification:
    """Return a tip relief; raises `BadInput`."""
    return _relief(place, part, "tip_relief", place.tip)


def root_relief(place: FlankPlace, part: Part) -> Modification:
    """Return a root relief; raises `BadInput`."""
    return _relief(place, part, "root_relief", place.root)


def _relief(place: FlankPlace, part: Part, name: str, end: float) -> Modification:
    """Return a relief that runs to one end of the involute, by its start and the place of its amount."""
    depth = required(part, f"{name}_depth", f"{name}_um")
    shape = shape_of(part)
    start = _start(place, part, name, end)
    stated = _stated(place, part, name, end)
    if not (stated - start) * (end - start) > 0.0:
        lengths = [start / MM, stated / MM]
        bound = "roll lengths in mm of its start and, towards the end of the involute, of its depth"
        raise BadInput.of(f"{part.place}, {name}", lengths, bound)
    transition = _transition(place, part, name, start, stated)
    if transition is not None:
        return Modification(part, partial(_blended, depth, start, stated, transition))
    fields = {}
    if shape in SCALABLE or place.same(stated, end):
        at_end = depth * float(relative_depth(shape, np.asarray((end - start) / (stated - start))))
        fields = {
            f"{name}_um": um(at_end),
            f"{name}_length_mm": mm(place.radial(start, end)),
            f"{name}_shape": shape,
        }
    return Modification(part, partial(_grown, depth, shape, start, stated), fields, rolls=(start,))


def _grown(
    depth: float, shape: str, start: float, stated: float, roll: FloatArray, _face: FloatArray
) -> FloatArray:
    return depth * relative_depth(shape, (roll - start) / (stated - start))


def _blended(
    depth: float,
    start: float,
    stated: float,
    transition: tuple[float, float],
    roll: FloatArray,
    _face: FloatArray,
) -> FloatArray:
    return depth * _blended_depth((roll - start) / (stated - start), *transition)


def _start(place: FlankPlace, part: Part, name: str, end: float) -> float:
    """Return the roll length where a relief starts: of its diameter, or its length before the end."""
    start = place.roll_length(part, f"{name}_datum_diameter", f"{name}_length_mm")
    if start is not None:
        return start
    length = required(part, f"{name}_datum_length", f"{name}_length_mm, from a roll length")
    towards_end = place.towards_tip if end == place.tip else -place.towards_tip
    return end - towards_end * abs(length)


def _stated(place: FlankPlace, part: Part, name: str, end: float) -> float:
    """Return the roll length where the amount is stated, the end of the involute by default."""
    words = "where the amount is stated"
    stated = place.roll_length(part, f"{name}_evaluation_reference", words)
    if stated is None:
        stated = part.number(f"{name}_evaluation_reference_length", f"{words}: a roll length")
    return stated or end


def _transition(
    place: FlankPlace, part: Part, name: str, start: float, stated: float
) -> tuple[float, float] | None:
    """Return the fractions between which the slope of a linear relief grows, None without a transition."""
    if part.text("specify_tangential_transition", "slope grows where the relief starts") != "True":
        return None
    words = "tangential transition"
    first = place.roll_length(part, f"{name}_diameter_where_tangential_transition_starts", words)
    last = place.roll_length(part, f"{name}_diameter_where_tangential_transition_ends", words)
    if first is None or last is None:
        part.say("specify_tangential_transition", "ignored", "no diameters: the relief starts with its slope")
        return None
    low, high = ((roll - start) / (stated - start) for roll in (first, last))
    if not low < high < 1.0:
        raise BadInput.of(
            f"{part.place}, tangential transition", [low, high], "increasing, before the amount"
        )
    return low, high


def profile_crowning(place: FlankPlace, part: Part) -> Modification:
    """Return a profile crowning, a parabola on either side of its highest point; raises `BadInput`."""
    at_tip = part.number("profile_crowning_at_tip", "profile_crowning_um")
    at_root = part.number("profile_crowning_at_root", "profile_crowning_um")
    if at_tip is None and at_root is None:
        raise BadInput.of(f"{part.place}, profile_crowning_at_tip", None, "given, or that at the root")
    for item, value in (("profile_crowning_at_tip", at_tip), ("profile_crowning_at_root", at_root)):
        if value is None:
            part.say(item, "defaulted", "as at the other end")
    tip = at_tip if at_tip is not None else at_root or 0.0
    root = at_root if at_root is not None else tip
    ends = tuple(_crowning_end(place, part, side) for side in ("tip", "root"))
    middle = 0.5 * (ends[0] + ends[1])
    highest = place.roll_length(part, "profile_highest_point", "highest point")
    highest = middle if highest is None else highest
    _say_shape(part, "shape_of_profile_crowning")
    if not (ends[0] - highest) * place.towards_tip > 0.0 > (ends[1] - highest) * place.towards_tip:
        bound = "between the places of the amounts"
        raise BadInput.of(
            f"{part.place}, profile_highest_point", highest / MM, bound, "In mm of roll length."
        )
    whole = place.same(ends[0], place.tip) and place.same(ends[1], place.root)
    fields = {}
    if whole and place.same(highest, middle) and tip == root:
        fields = {"profile_crowning_um": um(tip)}
    else:
        for side, end, stated, amount in (
            ("tip", place.tip, ends[0], tip),
            ("root", place.root, ends[1], root),
        ):
            name = f"profile_crowning_{side}"
            fields[f"{name}_um"] = um(amount * ((end - highest) / (stated - highest)) ** 2)
            fields[f"{name}_length_mm"] = mm(place.radial(highest, end))
    return Modification(part, partial(_bowed, highest, ends, (tip, root)), fields, rolls=(highest,))


def _bowed(
    highest: float,
    ends: tuple[float, ...],
    amounts: tuple[float, float],
    roll: FloatArray,
    _face: FloatArray,
) -> FloatArray:
    return two_parabolas(roll, highest, ends, amounts)


def two_parabolas(
    place: FloatArray, highest: float, ends: tuple[float, ...], amounts: tuple[float, ...]
) -> FloatArray:
    """Return the depths of two half parabolas that touch at the highest point.

    Parameters
    ----------
    place : array
        Roll lengths or face coordinates, m.
    ends, amounts : tuple of float
        Where each side has its amount, m; on either side of the highest point.
    """
    sides = [
        amount
        * np.where((place - highest) * (end - highest) > 0.0, ((place - highest) / (end - highest)) ** 2, 0.0)
        for end, amount in zip(ends, amounts, strict=True)
    ]
    return np.asarray(sum(sides))


def _crowning_end(place: FlankPlace, part: Part, side: str) -> float:
    """Return the roll length where the amount at tip or root is stated, by default the involute's end."""
    words = "where the amount is stated"
    stated = place.roll_length(part, f"diameter_where_profile_crowning_{side}_is_specified", words)
    if stated is None:
        stated = part.number(f"length_where_profile_crowning_{side}_is_specified", f"{words}: a roll length")
    return stated or (place.tip if side == "tip" else place.root)


def _say_shape(part: Part, item: str) -> None:
    """Read the shape of a crowning: an arc this flat is a parabola to 1e-6 of its amount."""
    word = part.text(item, "a parabola")
    if word == "circular":
        part.say(item, "taken", "an arc, which is a parabola to (amount / length)^2")


def profile_slope(place: FlankPlace, part: Part) -> Modification:
    """Return a profile slope: > 0 removes towards the tip, zero at mid-profile; raises `BadInput`."""
    amount = required(part, "profile_slope", "profile_slope_um; > 0 removes at the tip")
    words = "range of the amount"
    start = place.roll_length(part, "profile_evaluation_start", words)
    end = place.roll_length(part, "diameter_where_profile_slope_amount_is_specified", words)
    end = place.roll_length(part, "profile_evaluation_end", words) if end is None else end
    start, end = (place.root if start is None else start), (place.tip if end is None else end)
    if not (end - start) * place.towards_tip > 0.0:
        raise BadInput.of(
            f"{part.place}, profile_evaluation_end", part.name, "nearer to the tip than the start"
        )
    whole = amount * (place.tip - place.root) / (end - start)
    middle = 0.5 * (place.tip + place.root)
    return Modification(
        part,
        lambda roll, _face: whole * (roll - middle) / (place.tip - place.root),
        {"profile_slope_um": um(whole)},
    )
