"""Helix crowning and slope, end reliefs and twist (ISO 21771-1, clauses 7.3 and 7.4).

The face coordinate `face` runs from 0 at the datum face to the face width at the non-datum face, m; `roll` is
the roll length, m. A modification has its law over both, the fields of a case that express it, and the
`faces` at which its slope jumps. `flank.loaded.datum` is the sign, 1 or -1, of the datum face along the case.
"""

from __future__ import annotations

import numpy as np

from lineofaction.gearbox.from_rexs.flank_modification import Modification, PlainFlank
from lineofaction.gearbox.from_rexs.gear_unit import Part, rounded
from lineofaction.gearbox.from_rexs.profile_modifications import Growth, both_amounts
from lineofaction.gearbox.from_rexs.relief_laws import shape_of, two_parabolas
from lineofaction.gearbox.units import UM


def helix_crowning(flank: PlainFlank, part: Part) -> Modification:
    """Return a helix crowning: a parabola on either side of its highest point.

    A symmetric crowning over the full face is one field of a case, any other is one at either face.
    """
    items = ("helix_crowning_amount_datum_face", "helix_crowning_amount_non_datum_face")
    amounts = both_amounts(part, items, "helix_crowning_um", "given", "as at the other face")
    item, meaning = "coordinate_where_helix_crowning_is_specified", "where the amount is stated"
    first = part.number(f"{item}_datum_face", meaning) or 0.0
    ends = (first, part.number(f"{item}_non_datum_face", meaning, flank.width))
    highest = part.number("helix_highest_point", "highest point", 0.5 * (ends[0] + ends[1]))
    if not ends[0] < highest < ends[1]:
        raise part.refusal("helix_highest_point", rounded(1e3 * highest), "between the stated amounts")
    part.text("shape_of_helix_crowning", "a parabola; an arc is one to (amount / length)^2")
    is_full = flank.same(ends[0], 0.0) and flank.same(ends[1], flank.width)
    fields = {}
    if is_full and flank.same(highest, 0.5 * flank.width) and amounts[0] == amounts[1]:
        fields = {"helix_crowning_um": rounded(amounts[0] / UM)}
    else:
        sides = zip((True, False), (0.0, flank.width), ends, amounts, strict=True)
        for datum, face, reference, amount in sides:
            name = flank.face_field("helix_crowning", datum=datum)
            # the parabola through `amount` at `reference`, at the face itself
            fields[f"{name}_um"] = rounded(amount * ((face - highest) / (reference - highest)) ** 2 / UM)
            fields[f"{name}_length_mm"] = rounded(1e3 * abs(face - highest))
    return Modification(
        part, lambda _roll, face: two_parabolas(face, highest, ends, amounts), fields, faces=(highest,)
    )


def helix_slope(flank: PlainFlank, part: Part) -> Modification:
    """Return a helix slope: > 0 removes towards the non-datum face, zero at mid-face."""
    amount = part.required("helix_slope", "helix_slope_um; > 0 removes at the non-datum face")
    total = amount * flank.width / _slope_length(flank, part)
    return Modification(
        part,
        lambda _roll, face: total * (face / flank.width - 0.5),
        {"helix_slope_um": rounded(-flank.loaded.datum * total / UM)},
    )


def _slope_length(flank: PlainFlank, part: Part) -> float:
    """Return the length in m over which the amount of a helix slope is stated."""
    reference = part.text("helix_evaluation_reference", "length of the amount")
    flank_part = flank.loaded.flank
    if reference == "facewidth":
        return flank.width
    if reference == "facewidth_usable" and flank_part is not None:
        owner, item, meaning = flank_part, "facewidth_usable", "length of the helix slope"
    else:
        owner, item, meaning = part, "helix_evaluation", "length of the amount"
    start = owner.number(f"{item}_start", meaning) or 0.0
    end = owner.number(f"{item}_end", meaning, flank.width)
    if not end > start:
        raise part.refusal("helix_evaluation_end", rounded(1e3 * end), "above helix_evaluation_start")
    return end - start


def end_relief(flank: PlainFlank, part: Part) -> Modification:
    """Return the end relief at one face; the type of `part` ends in "datum_face" or "non_datum_face"."""
    side = part.type.removeprefix("end_relief_")
    depth = part.required(f"end_relief_depth_{side}", "end relief")
    length = part.required(f"end_relief_length_{side}", "length of the end relief")
    shape = shape_of(part)
    is_datum = side == "datum_face"
    end, inwards = (0.0, 1.0) if is_datum else (flank.width, -1.0)
    start = end + inwards * length
    reference = part.number(f"end_relief_evaluation_reference_{side}", "where the amount is stated", end)
    growth = Growth(depth, shape, start, reference)
    if not 0.0 < length <= flank.width or not (start - growth.reference) * inwards > 0.0:
        raise part.refusal(f"end_relief_length_{side}", rounded(1e3 * length), "above 0, within the face")
    name = flank.face_field("end_relief", datum=is_datum)
    fields = growth.fields(flank, name, end, 1e3 * length)
    return Modification(part, lambda _roll, face: growth.at(face), fields, faces=(start,))


def profile_twist(flank: PlainFlank, part: Part) -> Modification:
    """Return a twist: the profile slope at the non-datum face less that at the datum face.

    It removes a quarter of its amount at two opposite corners of the flank, and adds as much at the others.
    """
    amount = part.required("profile_twist", "flank_twist_um, a quarter of it")
    ends = ("diameter_where_profile_twist_amount_is_specified", "profile_twist_evaluation_end")
    start, end = flank.roll_range(part, "profile_twist_evaluation_start", ends)
    meaning = "range of the amount"
    first = part.number("position_of_profile_twist_datum_face", meaning) or 0.0
    last = part.number("position_of_profile_twist_non_datum_face", meaning, flank.width)
    if not last > first or not (end - start) * flank.towards_tip > 0.0:
        raise part.refusal("profile_twist", part.name, "stated over a range of profile and face")
    total = amount * (flank.tip - flank.root) / (end - start) * flank.width / (last - first)
    middle, half = 0.5 * (flank.tip + flank.root), 0.5 * (flank.tip - flank.root)
    return Modification(
        part,
        lambda roll, face: (
            0.25 * total * np.asarray((roll - middle) / half * (2.0 * face / flank.width - 1.0))
        ),
        {"flank_twist_um": rounded(-0.25 * flank.loaded.datum * total / UM)},
    )
