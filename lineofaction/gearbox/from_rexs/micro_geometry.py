"""Flank modifications of the loaded flank as fields of a case (ISO 21771-1, clause 7)."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

from bounds import engineering
from fe_contact.geometry import Toothing
from lineofaction.gearbox.from_rexs.account import Fate
from lineofaction.gearbox.from_rexs.face_modifications import (
    at_both_ends,
    end_relief,
    helix_crowning,
    helix_slope,
    profile_twist,
)
from lineofaction.gearbox.from_rexs.flank_place import FlankPlace, Modification, mm
from lineofaction.gearbox.from_rexs.flank_raster import rasterized
from lineofaction.gearbox.from_rexs.flank_sides import LoadedFlank
from lineofaction.gearbox.from_rexs.gear_unit import GearUnit
from lineofaction.gearbox.from_rexs.part import Part
from lineofaction.gearbox.from_rexs.profile_modifications import (
    profile_crowning,
    profile_slope,
    root_relief,
    tip_relief,
)
from lineofaction.gearbox.from_rexs.topography import topography
from lineofaction.gearbox.units import MM, UM

Table = dict[str, Any]

READERS: dict[str, Callable[[FlankPlace, Part], Modification]] = {
    "tip_relief": tip_relief,
    "root_relief": root_relief,
    "profile_crowning": profile_crowning,
    "profile_slope": profile_slope,
    "helix_crowning": helix_crowning,
    "helix_slope": helix_slope,
    "end_relief_datum_face": end_relief,
    "end_relief_non_datum_face": end_relief,
    "profile_twist": profile_twist,
    "topographical_modification": topography,
}
"""What reads each component that modifies a flank."""

_WITHOUT_EXTENT: tuple[Fate, str] = ("refused", "REXS states no extent of it along the face")
_MEASURED: tuple[Fate, str] = ("ignored", "measured deviations are no part of the nominal flank")
UNREAD = {
    "triangular_tip_relief": _WITHOUT_EXTENT,
    "triangular_root_relief": _WITHOUT_EXTENT,
    "profile_deviation": _MEASURED,
    "helix_deviation": _MEASURED,
}
"""What becomes of the components of a flank that nothing here reads."""


def micro_geometry(unit: GearUnit, gear: Toothing, loaded: LoadedFlank) -> Table:
    """Return the fields of the loaded flank's modifications, empty for an involute helicoid.

    What has no field, or a field that another modification takes, is summed on the case's `flank_grid`; the
    account has the grid's largest difference.

    Parameters
    ----------
    gear : Toothing
        The gear without modifications.

    Raises
    ------
    BadInput
        A modification without its amount, or at a place that the flank does not have.
    """
    if loaded.flank is None:
        return {}
    place = FlankPlace(gear, loaded)
    entries = at_both_ends(place, list(_modifications(unit, place, loaded.flank)))
    fields: Table = _tip_edge(place, loaded.flank)
    rest: list[Modification] = []
    for entry in entries:
        if entry.fields and not set(entry.fields) & set(fields):
            fields |= entry.fields
        else:
            rest.append(entry)
    if rest:
        raster = rasterized(place, rest)
        fields["flank_grid"] = raster.table
        lines = f"{raster.counts[0]} roll lengths by {raster.counts[1]} face positions"
        words = f"{', '.join(entry.part.name for entry in rest)} on {lines}; differs by at most"
        loaded.flank.say("flank_grid", "derived", f"{words} {engineering(raster.difference / UM, 2)} um")
    return fields


def _modifications(unit: GearUnit, place: FlankPlace, flank: Part) -> Iterator[Modification]:
    """Yield the modifications of a flank; state which are left aside, or read otherwise than written."""
    for part in (*unit.related(flank, "reference", "origin", "referenced"), *unit.children(flank)):
        if part.type in UNREAD:
            part.say("", *UNREAD[part.type])
        if part.type not in READERS:
            continue
        if part.attribute("position_of_profile_modification") is not None:
            part.say(
                "position_of_profile_modification", "ignored", "the profile is the same all over the face"
            )
        additive = part.text("is_additive_modification", "modifications add up")
        if additive == "False":
            part.say("is_additive_modification", "ignored", "modifications add up")
        yield READERS[part.type](place, part)


def _tip_edge(place: FlankPlace, flank: Part) -> Table:
    """Return the tip chamfer: of the flank, else of the gear's tip form diameter."""
    height = flank.number("tooth_tip_chamfer", "tip_chamfer_mm")
    gear = place.loaded.gear
    form = None if height else gear.number("tip_form_diameter", "tip_chamfer_mm")
    if form:
        height = place.towards_tip * (place.gear.tip_radius - 0.5 * abs(form))
        gear.say("tip_form_diameter", "derived", f"tip_chamfer_mm {height / MM:.6g} = (d_a - d_Fa) / 2")
    if not height or height <= 1e-9:
        return {}
    flank.say("tip_chamfer_angle", "defaulted", "30 deg to the flank")
    return {"tip_chamfer_mm": mm(height / MM)}
