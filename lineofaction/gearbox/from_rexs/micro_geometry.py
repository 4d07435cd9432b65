"""The modified flank of a gear: fields of a case, and a grid of modifications without a field."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

from bounds import engineering
from fe_contact.geometry import Toothing
from lineofaction.gearbox.from_rexs.flank_modification import Modification, PlainFlank
from lineofaction.gearbox.from_rexs.flank_raster import ALLOWED_DIFFERENCE, COUNTS, raster_of
from lineofaction.gearbox.from_rexs.gear_unit import Part, rounded
from lineofaction.gearbox.from_rexs.loaded_flank import LoadedFlank
from lineofaction.gearbox.from_rexs.modifications import READERS, UNREAD
from lineofaction.gearbox.units import MM, UM

Table = dict[str, Any]

_LEAST_CHAMFER = 1e-9
"""Height of a tip chamfer, m, below which it is the rounding of diameters."""


def micro_geometry(gear: Toothing, flank: LoadedFlank) -> Table:
    """Return the fields of the loaded flank's modifications, empty for an involute helicoid.

    Modifications without a field of the case, or whose field another one has already, are summed on the
    case's `flank_grid`; the account states the grid's largest difference. `gear` is without modifications.
    """
    if flank.flank is None:
        return {}
    helicoid = PlainFlank(gear, flank)
    entries = _at_both_ends(helicoid, list(_modifications(helicoid, flank.flank)))
    fields: Table = _tip_edge(helicoid, flank.flank)
    rest: list[Modification] = []
    for entry in entries:
        if entry.fields and not set(entry.fields) & set(fields):
            fields |= entry.fields
        else:
            rest.append(entry)
    if rest:
        for count in COUNTS:  # finer until the difference is allowed; else the finest is taken
            raster = raster_of(helicoid, rest, count)
            if raster.difference <= ALLOWED_DIFFERENCE:
                break
        fields["flank_grid"] = raster.table
        names = ", ".join(entry.part.name for entry in rest)
        lines = f"{raster.counts[0]} roll lengths by {raster.counts[1]} face positions"
        difference = f"differs by at most {engineering(raster.difference / UM, 2)} µm"
        flank.flank.say("flank_grid", "derived", f"{names} on {lines}; {difference}")
    return fields


def _modifications(helicoid: PlainFlank, flank: Part) -> Iterator[Modification]:
    """Yield the modifications of a flank; the account gets those that are ignored or read with a change."""
    for part in (*flank.referenced, *flank.children()):
        if part.type in UNREAD:
            part.say("", *UNREAD[part.type])
        if part.type not in READERS:
            continue
        item = "position_of_profile_modification"
        if part.attribute(item) is not None:
            part.say(item, "ignored", "the profile is the same all over the face")
        item, meaning = "is_additive_modification", "modifications add up"
        if part.text(item, meaning) == "False":
            part.say(item, "ignored", meaning)
        yield READERS[part.type](helicoid, part)


def _at_both_ends(helicoid: PlainFlank, modifications: Sequence[Modification]) -> list[Modification]:
    """Return the modifications; two equal end reliefs, one at each face, become one of both ends.

    They stay two if they are longer than half the face, where they overlap.
    """
    ends = [entry for entry in modifications if entry.part.type.startswith("end_relief_")]
    plain = [{_both(name): value for name, value in entry.fields.items()} for entry in ends]
    alike = len(ends) == 2 and ends[0].part.type != ends[1].part.type and plain[0] == plain[1]
    half_face_mm = 0.5e3 * helicoid.width
    if not alike or not plain[0] or plain[0]["end_relief_length_mm"] > half_face_mm:
        return list(modifications)
    first, second = ends
    joined = replace(
        first,
        removed=lambda roll, face: first.removed(roll, face) + second.removed(roll, face),
        fields=plain[0],
        faces=(*first.faces, *second.faces),
    )
    return [joined, *(entry for entry in modifications if entry not in ends)]


def _both(name: str) -> str:
    return name.replace("_non_datum_face", "").replace("_datum_face", "")


def _tip_edge(helicoid: PlainFlank, flank: Part) -> Table:
    """Return the tip chamfer: of the flank, else of the gear's tip form diameter."""
    height = flank.number("tooth_tip_chamfer", "tip_chamfer_mm")
    gear = helicoid.loaded.gear
    form = None if height else gear.number("tip_form_diameter", "tip_chamfer_mm")
    if form:
        height = helicoid.towards_tip * (helicoid.gear.tip_radius - 0.5 * abs(form))
        gear.say("tip_form_diameter", "derived", f"tip_chamfer_mm {height / MM:.6g} = (d_a - d_Fa) / 2")
    if not height or height <= _LEAST_CHAMFER:
        return {}
    flank.say("tip_chamfer_angle", "defaulted", "30 deg to the flank")
    return {"tip_chamfer_mm": rounded(height / MM)}
