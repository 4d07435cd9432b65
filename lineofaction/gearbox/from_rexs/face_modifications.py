"""Helix crowning and slope, end reliefs and twist (ISO 21771-1, clauses 7.3 and 7.4).

Coordinates of the face count from the datum face (I) to the non-datum face (II). Where amounts of one end
differ from the other's, > 0 removes at the non-datum face, as it removes at the tip along the profile.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from fe_contact.types import FloatArray
from lineofaction.gearbox.from_rexs.flank_place import FlankPlace, Modification, mm, um
from lineofaction.gearbox.from_rexs.part import Part
from lineofaction.gearbox.from_rexs.profile_modifications import two_parabolas
from lineofaction.gearbox.from_rexs.relief_law import SCALABLE, relative_depth, shape_of
from lineofaction.gearbox.from_rexs.toothing import required
from lineofaction.gearbox.problems import BadInput


def helix_crowning(place: FlankPlace, part: Part) -> Modification:
    """Return a helix crowning, a parabola on either side of its highest point; raises `BadInput`."""
    datum = part.number("helix_crowning_amount_datum_face", "helix_crowning_um")
    other = part.number("helix_crowning_amount_non_datum_face", "helix_crowning_um")
    if datum is None and other is None:
        raise BadInput.of(f"{part.place}, helix_crowning_amount_datum_face", None, "given")
    for item, value in (("datum_face", datum), ("non_datum_face", other)):
        if value is None:
            part.say(f"helix_crowning_amount_{item}", "defaulted", "as at the other face")
    amounts = (datum if datum is not None else other or 0.0, other if other is not None else datum or 0.0)
    words = "where the amount is stated"
    first = part.number("coordinate_where_helix_crowning_is_specified_datum_face", words) or 0.0
    last = part.number("coordinate_where_helix_crowning_is_specified_non_datum_face", words)
    ends = (first, place.width if last is None else last)
    highest = part.number("helix_highest_point", "highest point")
    highest = 0.5 * (ends[0] + ends[1]) if highest is None else highest
    if not ends[0] < highest < ends[1]:
        raise BadInput.of(
            f"{part.place}, helix_highest_point", mm(1e3 * highest), "between the stated amounts"
        )
    part.text("shape_of_helix_crowning", "a parabola; an arc is one to (amount / length)^2")
    return Modification(
        part,
        lambda _roll, face: two_parabolas(face, highest, ends, amounts),
        _crowning_fields(place, highest, ends, amounts),
        faces=(highest,),
    )


def _crowning_fields(
    place: FlankPlace, highest: float, ends: tuple[float, float], amounts: tuple[float, float]
) -> dict[str, float]:
    """Return the fields of a helix crowning: one if it is even, else those of both faces."""
    whole = place.same(ends[0], 0.0) and place.same(ends[1], place.width)
    if whole and place.same(highest, 0.5 * place.width) and amounts[0] == amounts[1]:
        return {"helix_crowning_um": um(amounts[0])}
    fields = {}
    faces = (0.0, place.width)
    for datum, face, stated, amount in zip((True, False), faces, ends, amounts, strict=True):
        name = place.face_field("helix_crowning", datum=datum)
        fields[f"{name}_um"] = um(amount * ((face - highest) / (stated - highest)) ** 2)
        fields[f"{name}_length_mm"] = mm(1e3 * abs(face - highest))
    return fields


def helix_slope(place: FlankPlace, part: Part) -> Modification:
    """Return a helix slope: > 0 removes towards the non-datum face, zero at mid-face; raises `BadInput`."""
    amount = required(part, "helix_slope", "helix_slope_um; > 0 removes at the non-datum face")
    whole = amount * place.width / _slope_length(place, part)
    return Modification(
        part,
        lambda _roll, face: whole * (face / place.width - 0.5),
        {"helix_slope_um": um(-place.loaded.datum * whole)},
    )


def _slope_length(place: FlankPlace, part: Part) -> float:
    """Return the length in m over which the amount of a helix slope is stated."""
    reference = part.text("helix_evaluation_reference", "length of the amount")
    flank = place.loaded.flank
    if reference == "facewidth_usable" and flank is not None:
        start, end = (
            flank.number(f"facewidth_usable_{item}", "length of the helix slope") for item in ("start", "end")
        )
    elif reference == "facewidth":
        return place.width
    else:
        start = part.number("helix_evaluation_start", "length of the amount")
        end = part.number("helix_evaluation_end", "length of the amount")
    start, end = start or 0.0, place.width if end is None else end
    if not end > start:
        raise BadInput.of(
            f"{part.place}, helix_evaluation_end", mm(1e3 * end), "above helix_evaluation_start"
        )
    return end - start


def end_relief(place: FlankPlace, part: Part) -> Modification:
    """Return an end relief at one face, datum or non-datum by its type, with the fields of one at both.

    Raises
    ------
    BadInput
        No depth, or a length that does not fit the face.
    """
    side = part.type.removeprefix("end_relief_")
    depth = required(part, f"end_relief_depth_{side}", "end relief")
    length = required(part, f"end_relief_length_{side}", "length of the end relief")
    shape = shape_of(part)
    end = 0.0 if side == "datum_face" else place.width
    inwards = 1.0 if side == "datum_face" else -1.0
    start = end + inwards * length
    stated = part.number(f"end_relief_evaluation_reference_{side}", "where the amount is stated")
    stated = end if stated is None else stated
    if not 0.0 < length <= place.width or not (start - stated) * inwards > 0.0:
        raise BadInput.of(
            f"{part.place}, end_relief_length_{side}", mm(1e3 * length), "above 0, within the face"
        )
    fields: dict[str, Any] = {}
    if shape in SCALABLE or place.same(stated, end):
        at_end = depth * float(relative_depth(shape, np.asarray((end - start) / (stated - start))))
        name = place.face_field("end_relief", datum=side == "datum_face")
        fields = {f"{name}_um": um(at_end), f"{name}_length_mm": mm(1e3 * length), f"{name}_shape": shape}
    return Modification(part, partial(_end, depth, shape, start, stated), fields, faces=(start,))


def _end(
    depth: float, shape: str, start: float, stated: float, _roll: FloatArray, face: FloatArray
) -> FloatArray:
    return depth * relative_depth(shape, (face - start) / (stated - start))


def at_both_ends(place: FlankPlace, modifications: Sequence[Modification]) -> list[Modification]:
    """Return the modifications with end reliefs that are alike at both faces as one."""
    ends = [entry for entry in modifications if entry.part.type.startswith("end_relief_")]
    plain = [{_both(name): value for name, value in entry.fields.items()} for entry in ends]
    alike = len(ends) == 2 and ends[0].part.type != ends[1].part.type and plain[0] == plain[1]
    if not alike or not plain[0] or plain[0]["end_relief_length_mm"] > 0.5e3 * place.width:
        return list(modifications)
    first, second = ends
    both = replace(
        first,
        removed=lambda roll, face: first.removed(roll, face) + second.removed(roll, face),
        fields=plain[0],
        faces=(*first.faces, *second.faces),
    )
    return [both, *(entry for entry in modifications if entry not in ends)]


def _both(name: str) -> str:
    return name.replace("_non_datum_face", "").replace("_datum_face", "")


def profile_twist(place: FlankPlace, part: Part) -> Modification:
    """Return a twist: the profile slope at the non-datum face less that at the datum face.

    Raises
    ------
    BadInput
        No amount, or no distance between the places that it is stated for.
    """
    amount = required(part, "profile_twist", "flank_twist_um, a quarter of it")
    words = "range of the amount"
    start = place.roll_length(part, "profile_twist_evaluation_start", words)
    end = place.roll_length(part, "diameter_where_profile_twist_amount_is_specified", words)
    end = place.roll_length(part, "profile_twist_evaluation_end", words) if end is None else end
    start, end = (place.root if start is None else start), (place.tip if end is None else end)
    first = part.number("position_of_profile_twist_datum_face", words) or 0.0
    last = part.number("position_of_profile_twist_non_datum_face", words)
    last = place.width if last is None else last
    if not last > first or not (end - start) * place.towards_tip > 0.0:
        raise BadInput.of(
            f"{part.place}, profile_twist", part.name, "stated over a range of profile and face"
        )
    whole = amount * (place.tip - place.root) / (end - start) * place.width / (last - first)
    middle, half = 0.5 * (place.tip + place.root), 0.5 * (place.tip - place.root)
    return Modification(
        part,
        lambda roll, face: (
            0.25 * whole * np.asarray((roll - middle) / half * (2.0 * face / place.width - 1.0))
        ),
        {"flank_twist_um": um(-0.25 * place.loaded.datum * whole)},
    )
