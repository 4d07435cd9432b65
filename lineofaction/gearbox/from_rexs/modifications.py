"""Modifications of a flank from their components: what they remove, and fields that say the same."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from fe_contact.geometry import Toothing
from fe_contact.types import FloatArray
from lineofaction.gearbox.from_rexs.account import Fate
from lineofaction.gearbox.from_rexs.gear_unit import Part, rounded
from lineofaction.gearbox.from_rexs.meshing import LoadedFlank
from lineofaction.gearbox.units import MM, UM

Removed = Callable[[FloatArray, FloatArray], FloatArray]
"""Material removed in m at roll lengths and at coordinates from the datum face, both in m."""
_SAME = 1e-6  # of the flank: places that a writer's rounding sets apart are one


@dataclass(frozen=True)
class Modification:
    """A modification of a flank: what it removes, and fields of the case that say the same."""

    part: Part
    removed: Removed
    fields: Mapping[str, Any] = field(default_factory=dict)
    """Empty where the case has none for it."""
    rolls: tuple[float, ...] = ()
    faces: tuple[float, ...] = ()
    """`rolls`, `faces`: Where it has kinks: roll lengths, coordinates from the datum face, m."""


@dataclass(frozen=True)
class FlankPlace:
    """The flank of a gear without modifications, and places on it: roll lengths and face coordinates, m."""

    gear: Toothing
    loaded: LoadedFlank

    @property
    def tip(self) -> float:
        """Roll length of the tip circle."""
        return self.gear.tip_roll_length

    @property
    def root(self) -> float:
        """Roll length where the involute begins."""
        return self.gear.form_roll_length

    @property
    def towards_tip(self) -> float:
        """1 if roll lengths grow towards the tip, -1 of a ring gear."""
        return math.copysign(1.0, self.tip - self.root)

    @property
    def width(self) -> float:
        """Face width."""
        return self.gear.face_width

    def roll_length(self, part: Part, diameter: str, words: str) -> float | None:
        """Return the roll length of a diameter outside the base circle, None where the file gives none."""
        value = part.number(diameter, words)
        if not value:
            return None
        radius, base = 0.5 * abs(value), self.gear.base_radius
        if radius <= base:
            raise part.refusal(diameter, value / MM, f"above the base diameter {2.0 * base / MM:.7g} mm")
        return math.sqrt(radius**2 - base**2)

    def stated_roll(self, part: Part, diameter: str, length: str, end: float) -> float:
        """Return the roll length where an amount is stated, by a diameter or as such; else an end."""
        words = "where the amount is stated"
        stated = self.roll_length(part, diameter, words)
        return (part.number(length, f"{words}: a roll length") if stated is None else stated) or end

    def roll_range(self, part: Part, start: str, ends: Sequence[str]) -> tuple[float, float]:
        """Return the roll lengths over which an amount is stated, those of the whole flank by default."""
        first = self.roll_length(part, start, "range of the amount")
        rolls = (self.roll_length(part, end, "range of the amount") for end in ends)
        last = next((roll for roll in rolls if roll is not None), None)
        return (self.root if first is None else first), (self.tip if last is None else last)

    def face_field(self, name: str, *, datum: bool) -> str:
        """Return a field of one face: the case's datum face is the end of negative z, whatever the file's."""
        at_negative_z = datum == (self.loaded.datum < 0.0)
        return f"{name}_{'datum_face' if at_negative_z else 'non_datum_face'}"

    def same(self, first: float, second: float) -> bool:
        """Return whether two roll lengths or face coordinates are one."""
        return abs(first - second) <= _SAME * max(abs(self.tip - self.root), self.width)

    def radial(self, roll_length: float, end: float) -> float:
        """Return the radial distance in mm between two roll lengths."""
        first, second = (math.hypot(self.gear.base_radius, length) for length in (roll_length, end))
        return abs(second - first) / MM


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


def _shape_of(part: Part) -> str:
    item = "shape_of_relief"
    word = part.text(item, "shape")
    if word is None:
        part.say(item, "defaulted", "linear")
        return "linear"
    if word not in LAWS:
        raise part.refusal(item, word, f"one of {', '.join(LAWS)}")
    return word


def _blended_depth(fraction: FloatArray, start: float, end: float) -> FloatArray:
    """Return the depth of a linear relief whose slope grows evenly between two fractions.

    1 at the fraction 1; tangential to the involute at `start`, straight from `end` on.
    """
    inside = np.clip(fraction, start, end)
    rise = 0.5 * (inside - start) ** 2 / (end - start) + np.maximum(fraction - end, 0.0)
    return np.asarray(rise / (1.0 - 0.5 * (start + end)))


def _two_parabolas(
    place: FloatArray, highest: float, ends: tuple[float, ...], amounts: tuple[float, ...]
) -> FloatArray:
    """Return the depths (m) of two half parabolas that touch at the highest point, at places (m).

    `ends` are the places on either side where the amounts are stated.
    """
    sides = [
        amount
        * np.where((place - highest) * (end - highest) > 0.0, ((place - highest) / (end - highest)) ** 2, 0.0)
        for end, amount in zip(ends, amounts, strict=True)
    ]
    return np.asarray(sum(sides))


# Tip and root relief, profile crowning and slope (ISO 21771-1, clause 7.2).


@dataclass(frozen=True)
class _Growth:
    """A relief along roll lengths or face coordinates (m): from its start to its depth (m) where stated."""

    depth: float
    shape: str
    start: float
    stated: float

    def at(self, place: FloatArray) -> FloatArray:
        fraction = np.maximum((place - self.start) / (self.stated - self.start), 0.0)
        return self.depth * np.asarray(LAWS[self.shape](fraction))

    def fields(self, place: FlankPlace, name: str, end: float, length_mm: float) -> dict[str, Any]:
        """Return the fields of a relief that runs to an end of the flank, none where its law has no place."""
        if self.shape not in SCALABLE and not place.same(self.stated, end):
            return {}
        at_end = float(self.at(np.asarray(end)))
        return {
            f"{name}_um": rounded(at_end / UM),
            f"{name}_length_mm": rounded(length_mm),
            f"{name}_shape": self.shape,
        }


def _profile_relief(place: FlankPlace, part: Part) -> Modification:
    """Return a tip or root relief by the type of its component: it runs to one end of the involute.

    It starts at its diameter, or its length before the end.
    """
    name = part.type
    end = place.tip if name == "tip_relief" else place.root
    depth = part.required(f"{name}_depth", f"{name}_um")
    shape = _shape_of(part)
    start = place.roll_length(part, f"{name}_datum_diameter", f"{name}_length_mm")
    if start is None:
        length = part.required(f"{name}_datum_length", f"{name}_length_mm, from a roll length")
        towards_end = place.towards_tip if end == place.tip else -place.towards_tip
        start = end - towards_end * abs(length)
    item = f"{name}_evaluation_reference"
    growth = _Growth(depth, shape, start, place.stated_roll(part, item, f"{item}_length", end))
    if not (growth.stated - start) * (end - start) > 0.0:
        bound = "roll lengths in mm of its start and, towards the end of the involute, of its depth"
        raise part.refusal(name, [start / MM, growth.stated / MM], bound)
    transition = _transition(place, part, growth)
    if transition is not None:
        whole = growth.stated - start
        return Modification(
            part, lambda roll, _face: depth * _blended_depth((roll - start) / whole, *transition)
        )
    fields = growth.fields(place, name, end, place.radial(start, end))
    return Modification(part, lambda roll, _face: growth.at(roll), fields, rolls=(start,))


def _transition(place: FlankPlace, part: Part, growth: _Growth) -> tuple[float, float] | None:
    """Return the fractions between which the slope of a linear relief grows, None without a transition."""
    if part.text("specify_tangential_transition", "slope grows where the relief starts") != "True":
        return None
    first, last = (
        place.roll_length(
            part, f"{part.type}_diameter_where_tangential_transition_{end}", "tangential transition"
        )
        for end in ("starts", "ends")
    )
    if first is None or last is None:
        part.say("specify_tangential_transition", "ignored", "no diameters: the relief starts with its slope")
        return None
    low, high = ((roll - growth.start) / (growth.stated - growth.start) for roll in (first, last))
    if not low < high < 1.0:
        raise part.refusal("tangential transition", [low, high], "increasing, before the amount")
    return low, high


def _both_amounts(
    part: Part, items: tuple[str, str], field: str, bound: str, words: str
) -> tuple[float, float]:
    """Return the amounts of a crowning on both sides, one that is left out as on the other."""
    stated = [part.number(item, field) for item in items]
    if stated == [None, None]:
        raise part.refusal(items[0], None, bound)
    for item, value in zip(items, stated, strict=True):
        if value is None:
            part.say(item, "defaulted", words)
    first, second = (value if value is not None else other or 0.0 for value, other in (stated, stated[::-1]))
    return first, second


def _profile_crowning(place: FlankPlace, part: Part) -> Modification:
    """Return a profile crowning, a parabola on either side of its highest point."""
    items = ("profile_crowning_at_tip", "profile_crowning_at_root")
    amounts = _both_amounts(
        part, items, "profile_crowning_um", "given, or that at the root", "as at the other end"
    )
    ends = (_crowning_end(place, part, "tip", place.tip), _crowning_end(place, part, "root", place.root))
    middle = 0.5 * (ends[0] + ends[1])
    highest = place.roll_length(part, "profile_highest_point", "highest point")
    highest = middle if highest is None else highest
    item = "shape_of_profile_crowning"
    if part.text(item, "a parabola") == "circular":
        part.say(item, "taken", "an arc, which is a parabola to (amount / length)^2")
    if not (ends[0] - highest) * place.towards_tip > 0.0 > (ends[1] - highest) * place.towards_tip:
        bound = "between the places of the amounts"
        raise part.refusal("profile_highest_point", highest / MM, bound, "In mm of roll length.")
    whole = place.same(ends[0], place.tip) and place.same(ends[1], place.root)
    fields = {}
    if whole and place.same(highest, middle) and amounts[0] == amounts[1]:
        fields = {"profile_crowning_um": rounded(amounts[0] / UM)}
    else:
        sides = zip(("tip", "root"), (place.tip, place.root), ends, amounts, strict=True)
        for side, end, stated, amount in sides:
            name = f"profile_crowning_{side}"
            fields[f"{name}_um"] = rounded(amount * ((end - highest) / (stated - highest)) ** 2 / UM)
            fields[f"{name}_length_mm"] = rounded(place.radial(highest, end))
    return Modification(
        part, lambda roll, _face: _two_parabolas(roll, highest, ends, amounts), fields, rolls=(highest,)
    )


def _crowning_end(place: FlankPlace, part: Part, side: str, end: float) -> float:
    item = f"where_profile_crowning_{side}_is_specified"
    return place.stated_roll(part, f"diameter_{item}", f"length_{item}", end)


def _profile_slope(place: FlankPlace, part: Part) -> Modification:
    """Return a profile slope: > 0 removes towards the tip, zero at mid-profile."""
    amount = part.required("profile_slope", "profile_slope_um; > 0 removes at the tip")
    ends = ("diameter_where_profile_slope_amount_is_specified", "profile_evaluation_end")
    start, end = place.roll_range(part, "profile_evaluation_start", ends)
    if not (end - start) * place.towards_tip > 0.0:
        raise part.refusal("profile_evaluation_end", part.name, "nearer to the tip than the start")
    whole = amount * (place.tip - place.root) / (end - start)
    middle = 0.5 * (place.tip + place.root)
    return Modification(
        part,
        lambda roll, _face: whole * (roll - middle) / (place.tip - place.root),
        {"profile_slope_um": rounded(whole / UM)},
    )


# Helix crowning and slope, end reliefs and twist (ISO 21771-1, clauses 7.3 and 7.4).


def _helix_crowning(place: FlankPlace, part: Part) -> Modification:
    """Return a helix crowning, a parabola on either side of its highest point."""
    items = ("helix_crowning_amount_datum_face", "helix_crowning_amount_non_datum_face")
    amounts = _both_amounts(part, items, "helix_crowning_um", "given", "as at the other face")
    item, words = "coordinate_where_helix_crowning_is_specified", "where the amount is stated"
    first = part.number(f"{item}_datum_face", words) or 0.0
    ends = (first, part.number(f"{item}_non_datum_face", words, place.width))
    highest = part.number("helix_highest_point", "highest point", 0.5 * (ends[0] + ends[1]))
    if not ends[0] < highest < ends[1]:
        raise part.refusal("helix_highest_point", rounded(1e3 * highest), "between the stated amounts")
    part.text("shape_of_helix_crowning", "a parabola; an arc is one to (amount / length)^2")
    whole = place.same(ends[0], 0.0) and place.same(ends[1], place.width)
    fields = {}
    if whole and place.same(highest, 0.5 * place.width) and amounts[0] == amounts[1]:
        fields = {"helix_crowning_um": rounded(amounts[0] / UM)}
    else:
        sides = zip((True, False), (0.0, place.width), ends, amounts, strict=True)
        for datum, face, stated, amount in sides:
            name = place.face_field("helix_crowning", datum=datum)
            fields[f"{name}_um"] = rounded(amount * ((face - highest) / (stated - highest)) ** 2 / UM)
            fields[f"{name}_length_mm"] = rounded(1e3 * abs(face - highest))
    return Modification(
        part, lambda _roll, face: _two_parabolas(face, highest, ends, amounts), fields, faces=(highest,)
    )


def _helix_slope(place: FlankPlace, part: Part) -> Modification:
    """Return a helix slope: > 0 removes towards the non-datum face, zero at mid-face."""
    amount = part.required("helix_slope", "helix_slope_um; > 0 removes at the non-datum face")
    whole = amount * place.width / _slope_length(place, part)
    return Modification(
        part,
        lambda _roll, face: whole * (face / place.width - 0.5),
        {"helix_slope_um": rounded(-place.loaded.datum * whole / UM)},
    )


def _slope_length(place: FlankPlace, part: Part) -> float:
    """Return the length in m over which the amount of a helix slope is stated."""
    reference = part.text("helix_evaluation_reference", "length of the amount")
    flank = place.loaded.flank
    if reference == "facewidth":
        return place.width
    if reference == "facewidth_usable" and flank is not None:
        owner, item, words = flank, "facewidth_usable", "length of the helix slope"
    else:
        owner, item, words = part, "helix_evaluation", "length of the amount"
    start = owner.number(f"{item}_start", words) or 0.0
    end = owner.number(f"{item}_end", words, place.width)
    if not end > start:
        raise part.refusal("helix_evaluation_end", rounded(1e3 * end), "above helix_evaluation_start")
    return end - start


def _end_relief(place: FlankPlace, part: Part) -> Modification:
    """Return an end relief at one face, datum or non-datum by its type, with the fields of one at both."""
    side = part.type.removeprefix("end_relief_")
    depth = part.required(f"end_relief_depth_{side}", "end relief")
    length = part.required(f"end_relief_length_{side}", "length of the end relief")
    shape = _shape_of(part)
    is_datum = side == "datum_face"
    end, inwards = (0.0, 1.0) if is_datum else (place.width, -1.0)
    start = end + inwards * length
    stated = part.number(f"end_relief_evaluation_reference_{side}", "where the amount is stated", end)
    growth = _Growth(depth, shape, start, stated)
    if not 0.0 < length <= place.width or not (start - growth.stated) * inwards > 0.0:
        raise part.refusal(f"end_relief_length_{side}", rounded(1e3 * length), "above 0, within the face")
    name = place.face_field("end_relief", datum=is_datum)
    fields = growth.fields(place, name, end, 1e3 * length)
    return Modification(part, lambda _roll, face: growth.at(face), fields, faces=(start,))


def _profile_twist(place: FlankPlace, part: Part) -> Modification:
    """Return a twist: the profile slope at the non-datum face less that at the datum face."""
    amount = part.required("profile_twist", "flank_twist_um, a quarter of it")
    ends = ("diameter_where_profile_twist_amount_is_specified", "profile_twist_evaluation_end")
    start, end = place.roll_range(part, "profile_twist_evaluation_start", ends)
    words = "range of the amount"
    first = part.number("position_of_profile_twist_datum_face", words) or 0.0
    last = part.number("position_of_profile_twist_non_datum_face", words, place.width)
    if not last > first or not (end - start) * place.towards_tip > 0.0:
        raise part.refusal("profile_twist", part.name, "stated over a range of profile and face")
    whole = amount * (place.tip - place.root) / (end - start) * place.width / (last - first)
    middle, half = 0.5 * (place.tip + place.root), 0.5 * (place.tip - place.root)
    return Modification(
        part,
        lambda roll, face: (
            0.25 * whole * np.asarray((roll - middle) / half * (2.0 * face / place.width - 1.0))
        ),
        {"flank_twist_um": rounded(-0.25 * place.loaded.datum * whole / UM)},
    )


# A flank's topographical modification: amounts at the nodes of a grid.


_AMOUNTS = "topographical_modification_amounts"
_DIAMETERS, _LENGTHS = "diameters_of_topographical_modification", "length_of_topographical_modification"


def _topography(place: FlankPlace, part: Part) -> Modification:
    """Return a topographical modification: an amount for each pair of a coordinate and a diameter.

    The three lists have an entry for each node. Between the nodes the amounts are linear, beyond them those
    of the border.
    """
    from scipy.interpolate import RegularGridInterpolator  # noqa: PLC0415 (start-up time)

    amounts = part.numbers(_AMOUNTS, "flank_grid")
    faces = part.numbers("coordinates_of_topographical_modification", "flank_grid, from the datum face")
    rolls = _roll_lengths(place, part)
    if amounts is None or faces is None or rolls is None or not len(amounts) == len(faces) == len(rolls):
        counts = [None if entry is None else len(entry) for entry in (faces, rolls, amounts)]
        raise part.refusal(_AMOUNTS, counts, "as many coordinates, diameters and amounts")
    nodes = dict(zip(zip(rolls, faces, strict=True), amounts, strict=True))
    axes = [np.array(sorted({node[axis] for node in nodes})) for axis in (0, 1)]
    if len(nodes) != len(axes[0]) * len(axes[1]) or min(map(len, axes)) < 2 or len(nodes) != len(amounts):
        raise part.refusal(_AMOUNTS, len(amounts), "on a grid of coordinates and diameters")
    values = np.array([[nodes[roll, face] for face in axes[1]] for roll in axes[0]])
    surface = RegularGridInterpolator(tuple(axes), values)

    def removed(roll: FloatArray, face: FloatArray) -> FloatArray:
        inside = [np.clip(x, axis[0], axis[-1]) for x, axis in zip((roll, face), axes, strict=True)]
        return np.asarray(surface(np.stack(np.broadcast_arrays(*inside), axis=-1)))

    return Modification(part, removed, rolls=tuple(axes[0]), faces=tuple(axes[1]))


def _roll_lengths(place: FlankPlace, part: Part) -> tuple[float, ...] | None:
    """Return the roll lengths in m of the nodes, from their diameters or as such."""
    diameters = part.numbers(_DIAMETERS, "flank_grid, as roll lengths")
    if diameters is None:
        return part.numbers(_LENGTHS, "flank_grid")
    base = place.gear.base_radius
    if min(abs(value) for value in diameters) <= 2.0 * base:
        raise part.refusal(_DIAMETERS, 1e3 * min(diameters), f"above {2e3 * base:.7g} mm")
    return tuple(float(np.sqrt((0.5 * value) ** 2 - base**2)) for value in diameters)


READERS: dict[str, Callable[[FlankPlace, Part], Modification]] = {
    "tip_relief": _profile_relief,
    "root_relief": _profile_relief,
    "profile_crowning": _profile_crowning,
    "profile_slope": _profile_slope,
    "helix_crowning": _helix_crowning,
    "helix_slope": _helix_slope,
    "end_relief_datum_face": _end_relief,
    "end_relief_non_datum_face": _end_relief,
    "profile_twist": _profile_twist,
    "topographical_modification": _topography,
}
"""What reads each component that modifies a flank; it raises `BadInput` where an amount is missing, or stated
at a place that the flank does not have."""

_WITHOUT_EXTENT: tuple[Fate, str] = ("refused", "REXS states no extent of it along the face")
_MEASURED: tuple[Fate, str] = ("ignored", "measured deviations are no part of the nominal flank")
UNREAD = {
    "triangular_tip_relief": _WITHOUT_EXTENT,
    "triangular_root_relief": _WITHOUT_EXTENT,
    "profile_deviation": _MEASURED,
    "helix_deviation": _MEASURED,
}
"""What becomes of the components of a flank that nothing here reads."""
