"""Axial location: the directions along the scene's z axis in which a bearing holds its shaft.

REXS counts these directions along u, the axis of the bearing itself, along z or against it.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from dynamics.bearings import BallBearing, CatalogLine, RollerBearing
from dynamics.bearings.rolling_bearing import AXIAL_PRELOAD, BOTH, DYNAMIC_CAPACITY, NEGATIVE, NONE, POSITIVE
from lineofaction.gearbox.from_rexs.bearings import BearingGeometry
from lineofaction.gearbox.from_rexs.gear_unit import Part, rounded
from lineofaction.gearbox.schemas.declared import figures

Table = dict[str, Any]

STIFFNESSES = ("radial_stiffness", "axial_stiffness", "bending_stiffness")

_ABSORPTION = "axial_force_absorption"

_LOCATING = {"both_directions": BOTH, "positive": POSITIVE, "negative": NEGATIVE, "no_direction": NONE}

_OPPOSITE = {POSITIVE: NEGATIVE, NEGATIVE: POSITIVE}

_SIGN = {POSITIVE: 1, NEGATIVE: -1}


def _axial_location(part: Part, sense: int, item: str = _ABSORPTION) -> str | None:
    """Return the directions along z in which a bearing, or its row, holds its shaft.

    Both, positive, negative, none; None where the file does not say. `sense` is +1 where u of the bearing is
    along z, -1 where it is against it.
    """
    location = _LOCATING.get(part.text(item, "directions in which it holds the shaft, by its own u") or "")
    if location in _OPPOSITE and sense < 0:
        part.say(item, "derived", f"{_OPPOSITE[location]} along z: its u is against z")
        return _OPPOSITE[location]
    return location


def _contact_side(part: Part, row: Part | None, sense: int) -> int | str:
    """Return the sign of the contact angle of a row, +1 where it holds a shaft that is pushed along z.

    The direction of the row counts, else that of the bearing. Where neither is stated or they differ, the
    answer is a text that says so.
    """
    of_bearing = _SIGN.get(_axial_location(part, sense) or "")
    location = None if row is None else _axial_location(row, sense, f"{_ABSORPTION}_of_row")
    of_row = _SIGN.get(location or "")
    if of_bearing is not None and of_row is not None and of_bearing != of_row:
        return f"{_ABSORPTION} of the bearing and of its row are opposite"
    side = of_row or of_bearing
    return side or f"{_ABSORPTION} does not say which direction its contact angle holds: positive or negative"


def located_row(part: Part, geometry: BearingGeometry, sense: int) -> Table | str:
    """Return the row and the directions that it holds, or why there are none."""
    if geometry.row.contact_angle == 0.0:
        return _without_angle(part, geometry, sense)
    rows = part.children("rolling_bearing_row")
    side = _contact_side(part, rows[0] if rows else None, sense)
    if isinstance(side, str):
        return side
    table = _table(replace(geometry.row, contact_angle=side * geometry.row.contact_angle))
    force = part.bounded("preload_force", "axial preload, N", AXIAL_PRELOAD)
    return table | ({"axial_preload_n": side * abs(force)} if force else {})


def _without_angle(part: Part, geometry: BearingGeometry, sense: int) -> Table | str:
    """Return a deep groove ball or cylindrical roller bearing."""
    locating, table = _axial_location(part, sense), _table(geometry.line or geometry.row)
    if isinstance(geometry.row, RollerBearing):
        ribs = "its ribs carry axial force, which rollers by their geometry do not"
        return table if locating in (NONE, None) else ribs
    if locating is None:
        locating = BOTH
        part.say(_ABSORPTION, "defaulted", "both directions: the file does not say")
    for item in ("preload_force", "preload_distance"):
        if part.number(item, "preload"):
            part.say(item, "refused", "without a contact angle it has no direction")
    return table | ({} if locating == BOTH else {"locating": locating})


def further_fields(part: Part) -> Table:
    """Return the rating of a bearing; state that its stiffness follows from the geometry."""
    for item in STIFFNESSES:
        if part.number(item, "stiffness of the bearing") is not None:
            part.say(item, "ignored", "the stiffness follows from the geometry")
    meaning = "dynamic load rating, kN: the rating life"
    rating = part.bounded("radial_dynamic_load_rating", meaning, DYNAMIC_CAPACITY)
    return {"dynamic_capacity_n": rounded(rating)} if rating else {}


def _table(row: BallBearing | RollerBearing | CatalogLine) -> Table:
    """Return a row as a scene file states it; defaults are not written out."""
    names = {BallBearing: "ball", RollerBearing: "roller", CatalogLine: "catalog"}
    values = {
        figure.field: figure.boundary_value(value)
        for figure in figures(type(row))
        if (value := getattr(row, figure.name)) != figure.default
    }
    return {names[type(row)]: values}
