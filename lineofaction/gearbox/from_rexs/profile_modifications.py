"""Tip and root relief, profile crowning and slope (ISO 21771-1, clause 7.2).

A place on the profile is its roll length, m. The evaluation reference is the place where a file states the
amount of a modification; it need not be the end of the involute.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from fe_contact.types import FloatArray
from lineofaction.gearbox.from_rexs.flank_modification import Modification, PlainFlank
from lineofaction.gearbox.from_rexs.gear_unit import Part, rounded
from lineofaction.gearbox.from_rexs.relief_laws import LAWS, SCALABLE, blended_depth, shape_of, two_parabolas
from lineofaction.gearbox.units import MM, UM


@dataclass(frozen=True)
class Growth:
    """A relief that grows by a law along roll lengths or face coordinates."""

    depth: float
    """Depth at `reference`, m."""
    shape: str
    """Name of the law, a key of `LAWS`."""
    start: float
    reference: float
    """`start`, `reference`: Coordinates, m, where the relief begins and where its depth is stated."""

    def at(self, coordinate: FloatArray) -> FloatArray:
        """Return the depths (m) at coordinates (m) along the flank; 0 before the start."""
        fraction = np.maximum((coordinate - self.start) / (self.reference - self.start), 0.0)
        return self.depth * np.asarray(LAWS[self.shape](fraction))

    def fields(self, flank: PlainFlank, name: str, end: float, length_mm: float) -> dict[str, Any]:
        """Return the fields of a case for a relief that runs to an `end` of the flank, m.

        There are none where a case cannot state it: the depth is not stated at the end, and the shape of the
        law would change with the place where it is.
        """
        if self.shape not in SCALABLE and not flank.same(self.reference, end):
            return {}
        at_end = float(self.at(np.asarray(end)))
        return {
            f"{name}_um": rounded(at_end / UM),
            f"{name}_length_mm": rounded(length_mm),
            f"{name}_shape": self.shape,
        }


def profile_relief(flank: PlainFlank, part: Part) -> Modification:
    """Return the tip or root relief of a component; the type of the component says which of the two.

    It runs to one end of the involute. It starts at the diameter that the component states, else at the
    stated length before that end.
    """
    name = part.type
    end = flank.tip if name == "tip_relief" else flank.root
    depth = part.required(f"{name}_depth", f"{name}_um")
    shape = shape_of(part)
    start = flank.roll_length(part, f"{name}_datum_diameter", f"{name}_length_mm")
    if start is None:
        length = part.required(f"{name}_datum_length", f"{name}_length_mm, from a roll length")
        towards_end = flank.towards_tip if end == flank.tip else -flank.towards_tip
        start = end - towards_end * abs(length)
    item = f"{name}_evaluation_reference"
    growth = Growth(depth, shape, start, flank.reference_roll(part, item, f"{item}_length", end))
    if not (growth.reference - start) * (end - start) > 0.0:
        bound = "roll lengths in mm of its start and, towards the end of the involute, of its depth"
        raise part.refusal(name, [start / MM, growth.reference / MM], bound)
    transition = _transition(flank, part, growth)
    if transition is not None:
        span = growth.reference - start
        return Modification(
            part, lambda roll, _face: depth * blended_depth((roll - start) / span, *transition)
        )
    fields = growth.fields(flank, name, end, flank.radial(start, end))
    return Modification(part, lambda roll, _face: growth.at(roll), fields, rolls=(start,))


def _transition(flank: PlainFlank, part: Part, growth: Growth) -> tuple[float, float] | None:
    """Return the fractions of its length between which the slope of a linear relief grows; None: nowhere."""
    if part.text("specify_tangential_transition", "slope grows where the relief starts") != "True":
        return None
    first, last = (
        flank.roll_length(
            part, f"{part.type}_diameter_where_tangential_transition_{end}", "tangential transition"
        )
        for end in ("starts", "ends")
    )
    if first is None or last is None:
        part.say("specify_tangential_transition", "ignored", "no diameters: the relief starts with its slope")
        return None
    low, high = ((roll - growth.start) / (growth.reference - growth.start) for roll in (first, last))
    if not low < high < 1.0:
        raise part.refusal("tangential transition", [low, high], "increasing, before the amount")
    return low, high


def both_amounts(
    part: Part, items: tuple[str, str], field: str, bound: str, text: str
) -> tuple[float, float]:
    """Return the amounts of a crowning on both sides, m; an amount that is left out equals the other one.

    `field`, `bound` and `text` word the account of the file: the field of the case, the rule that a file
    without both amounts breaks, and the remark on an amount that is left out.
    """
    amounts = [part.number(item, field) for item in items]
    if amounts == [None, None]:
        raise part.refusal(items[0], None, bound)
    for item, value in zip(items, amounts, strict=True):
        if value is None:
            part.say(item, "defaulted", text)
    first, second = amounts
    if first is None:
        return second or 0.0, second or 0.0  # never None here; `or` says so to the type checker
    return first, first if second is None else second


def profile_crowning(flank: PlainFlank, part: Part) -> Modification:
    """Return a profile crowning, a parabola on either side of its highest point."""
    items = ("profile_crowning_at_tip", "profile_crowning_at_root")
    amounts = both_amounts(
        part, items, "profile_crowning_um", "given, or that at the root", "as at the other end"
    )
    ends = (_crowning_end(flank, part, "tip", flank.tip), _crowning_end(flank, part, "root", flank.root))
    middle = 0.5 * (ends[0] + ends[1])
    highest = flank.roll_length(part, "profile_highest_point", "highest point")
    highest = middle if highest is None else highest
    item = "shape_of_profile_crowning"
    if part.text(item, "a parabola") == "circular":
        part.say(item, "taken", "an arc, which is a parabola to (amount / length)^2")
    if not (ends[0] - highest) * flank.towards_tip > 0.0 > (ends[1] - highest) * flank.towards_tip:
        bound = "between the places of the amounts"
        raise part.refusal("profile_highest_point", highest / MM, bound, "In mm of roll length.")
    is_full = flank.same(ends[0], flank.tip) and flank.same(ends[1], flank.root)
    fields = {}
    if is_full and flank.same(highest, middle) and amounts[0] == amounts[1]:
        fields = {"profile_crowning_um": rounded(amounts[0] / UM)}
    else:
        sides = zip(("tip", "root"), (flank.tip, flank.root), ends, amounts, strict=True)
        for side, end, reference, amount in sides:
            name = f"profile_crowning_{side}"
            # the parabola through the stated amount, evaluated at the end of the involute
            fields[f"{name}_um"] = rounded(amount * ((end - highest) / (reference - highest)) ** 2 / UM)
            fields[f"{name}_length_mm"] = rounded(flank.radial(highest, end))
    return Modification(
        part, lambda roll, _face: two_parabolas(roll, highest, ends, amounts), fields, rolls=(highest,)
    )


def _crowning_end(flank: PlainFlank, part: Part, side: str, end: float) -> float:
    item = f"where_profile_crowning_{side}_is_specified"
    return flank.reference_roll(part, f"diameter_{item}", f"length_{item}", end)


def profile_slope(flank: PlainFlank, part: Part) -> Modification:
    """Return a profile slope: > 0 removes towards the tip, zero at mid-profile."""
    amount = part.required("profile_slope", "profile_slope_um; > 0 removes at the tip")
    ends = ("diameter_where_profile_slope_amount_is_specified", "profile_evaluation_end")
    start, end = flank.roll_range(part, "profile_evaluation_start", ends)
    if not (end - start) * flank.towards_tip > 0.0:
        raise part.refusal("profile_evaluation_end", part.name, "nearer to the tip than the start")
    total = amount * (flank.tip - flank.root) / (end - start)
    middle = 0.5 * (flank.tip + flank.root)
    return Modification(
        part,
        lambda roll, _face: total * (roll - middle) / (flank.tip - flank.root),
        {"profile_slope_um": rounded(total / UM)},
    )
