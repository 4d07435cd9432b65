"""Tip and root relief, profile crowning and slope (ISO 21771-1, clause 7.2)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from fe_contact.types import FloatArray
from lineofaction.gearbox.from_rexs.flank_modification import FlankPlace, Modification
from lineofaction.gearbox.from_rexs.gear_unit import Part, rounded
from lineofaction.gearbox.from_rexs.relief_laws import LAWS, SCALABLE, blended_depth, shape_of, two_parabolas
from lineofaction.gearbox.units import MM, UM


@dataclass(frozen=True)
class Growth:
    """A relief along roll lengths or face coordinates (m): from its start to its depth (m) where stated."""

    depth: float
    shape: str
    start: float
    stated: float

    def at(self, place: FloatArray) -> FloatArray:
        """Return the depths (m) at places (m) along the flank."""
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


def profile_relief(place: FlankPlace, part: Part) -> Modification:
    """Return a tip or root relief by the type of its component: it runs to one end of the involute.

    It starts at its diameter, or its length before the end.
    """
    name = part.type
    end = place.tip if name == "tip_relief" else place.root
    depth = part.required(f"{name}_depth", f"{name}_um")
    shape = shape_of(part)
    start = place.roll_length(part, f"{name}_datum_diameter", f"{name}_length_mm")
    if start is None:
        length = part.required(f"{name}_datum_length", f"{name}_length_mm, from a roll length")
        towards_end = place.towards_tip if end == place.tip else -place.towards_tip
        start = end - towards_end * abs(length)
    item = f"{name}_evaluation_reference"
    growth = Growth(depth, shape, start, place.stated_roll(part, item, f"{item}_length", end))
    if not (growth.stated - start) * (end - start) > 0.0:
        bound = "roll lengths in mm of its start and, towards the end of the involute, of its depth"
        raise part.refusal(name, [start / MM, growth.stated / MM], bound)
    transition = _transition(place, part, growth)
    if transition is not None:
        whole = growth.stated - start
        return Modification(
            part, lambda roll, _face: depth * blended_depth((roll - start) / whole, *transition)
        )
    fields = growth.fields(place, name, end, place.radial(start, end))
    return Modification(part, lambda roll, _face: growth.at(roll), fields, rolls=(start,))


def _transition(place: FlankPlace, part: Part, growth: Growth) -> tuple[float, float] | None:
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


def both_amounts(
    part: Part, items: tuple[str, str], field: str, bound: str, words: str
) -> tuple[float, float]:
    """Return the amounts of a crowning on both sides, one that is left out as on the other."""
    amounts = [part.number(item, field) for item in items]
    if amounts == [None, None]:
        raise part.refusal(items[0], None, bound)
    for item, value in zip(items, amounts, strict=True):
        if value is None:
            part.say(item, "defaulted", words)
    first, second = (
        value if value is not None else other or 0.0 for value, other in (amounts, amounts[::-1])
    )
    return first, second


def profile_crowning(place: FlankPlace, part: Part) -> Modification:
    """Return a profile crowning, a parabola on either side of its highest point."""
    items = ("profile_crowning_at_tip", "profile_crowning_at_root")
    amounts = both_amounts(
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
        for side, end, reference, amount in sides:
            name = f"profile_crowning_{side}"
            fields[f"{name}_um"] = rounded(amount * ((end - highest) / (reference - highest)) ** 2 / UM)
            fields[f"{name}_length_mm"] = rounded(place.radial(highest, end))
    return Modification(
        part, lambda roll, _face: two_parabolas(roll, highest, ends, amounts), fields, rolls=(highest,)
    )


def _crowning_end(place: FlankPlace, part: Part, side: str, end: float) -> float:
    item = f"where_profile_crowning_{side}_is_specified"
    return place.stated_roll(part, f"diameter_{item}", f"length_{item}", end)


def profile_slope(place: FlankPlace, part: Part) -> Modification:
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
