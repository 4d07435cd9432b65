"""Tip and root relief, profile crowning and slope (ISO 21771-1, clause 7.2)."""

from __future__ import annotations

from functools import partial

import numpy as np

from fe_contact.types import FloatArray
from lineofaction.gearbox.from_rexs.flank_place import FlankPlace, Modification, mm, um
from lineofaction.gearbox.from_rexs.part import Part
from lineofaction.gearbox.from_rexs.relief_law import SCALABLE, blended_depth, relative_depth, shape_of
from lineofaction.gearbox.from_rexs.toothing import required
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.units import MM


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
    return depth * blended_depth((roll - start) / (stated - start), *transition)


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
