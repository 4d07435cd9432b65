"""A bearing of a REXS model as a rolling bearing of the scene, by its geometry."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace
from typing import Any

from dynamics.bearing_rows import BallBearing, CatalogLine, RollerBearing
from dynamics.bearing_rows.locating import BOTH, NONE
from dynamics.joints.rolling_bearing import AXIAL_PRELOAD, DYNAMIC_CAPACITY
from lineofaction.gearbox.from_rexs.axial_location import ITEM, axial_location, contact_side
from lineofaction.gearbox.from_rexs.bearing_geometry import BearingGeometry, bearing_geometry
from lineofaction.gearbox.from_rexs.bearing_stiffness import operating_point, stated_stiffness
from lineofaction.gearbox.from_rexs.bounded_number import bounded_number
from lineofaction.gearbox.from_rexs.connections import Connection
from lineofaction.gearbox.from_rexs.layout import Layout
from lineofaction.gearbox.from_rexs.part import Part
from lineofaction.gearbox.from_rexs.placement import placement
from lineofaction.gearbox.schemas.declared import figures

_STIFFNESSES = ("radial_stiffness", "axial_stiffness", "bending_stiffness")


def rolling_bearing(layout: Layout, entry: Connection, loose: Collection[int]) -> dict[str, Any] | str:
    """Return what a scene file states of a bearing by its geometry, or why it is a bushing.

    Name, shaft and position are left to the caller.

    Parameters
    ----------
    layout : Layout
    entry : Connection
        A bearing on the ground.
    loose : collection of int
        Components in an elastic housing that is not held in all directions.
    """
    part = entry.part
    if part.id in loose:
        return "the matrix of the casing is singular, and only linear bearings sit in it"
    if entry.held.id != entry.inner.id:
        return "the shaft is on its outer side"
    if operating_point(part) is not None or any(stated_stiffness(part, item) for item in _STIFFNESSES):
        return "its stiffness is stated"
    absorbs = part.attribute("radial_force_absorption")
    if absorbs is not None and absorbs.value is False:
        return "it carries no radial force"
    geometry = bearing_geometry(layout.unit, part)
    if isinstance(geometry, str):
        return geometry
    located = _located(layout, entry, geometry)
    return located if isinstance(located, str) else located | _further(part, geometry)


def _located(layout: Layout, entry: Connection, geometry: BearingGeometry) -> dict[str, Any] | str:
    """Return the row and the directions that it holds, or why there are none."""
    place = placement(layout.unit, entry.part) or layout.shafts[entry.held.id].place
    sense = 1 if float(layout.axes.turn(place)[2, 0]) > 0.0 else -1
    if geometry.row.contact_angle == 0.0:
        return _without_angle(entry.part, geometry, sense)
    rows = layout.unit.children(entry.part, "rolling_bearing_row")
    side = contact_side(entry.part, rows[0] if rows else None, sense)
    if isinstance(side, str):
        return side
    row = replace(geometry.row, contact_angle=side * geometry.row.contact_angle)
    return _table(row) | _preload(entry.part, side)


def _without_angle(part: Part, geometry: BearingGeometry, sense: int) -> dict[str, Any] | str:
    """Return a deep groove ball or cylindrical roller bearing."""
    locating, table = axial_location(part, sense), _table(geometry.line or geometry.row)
    if isinstance(geometry.row, RollerBearing):
        ribs = "its ribs carry axial force, which rollers by their geometry do not"
        return table if locating in (NONE, None) else ribs
    if locating is None:
        locating = BOTH
        part.say(ITEM, "defaulted", "both directions: the file does not say")
    for item in ("preload_force", "preload_distance"):
        if part.number(item, "preload"):
            part.say(item, "refused", "without a contact angle it has no direction")
    return table | ({} if locating == BOTH else {"locating": locating})


def _preload(part: Part, side: int) -> dict[str, Any]:
    """Return the axial preload of a row with a contact angle."""
    force = bounded_number(part, "preload_force", "axial preload, N", AXIAL_PRELOAD)
    return {"axial_preload_n": side * abs(force)} if force else {}


def _further(part: Part, geometry: BearingGeometry) -> dict[str, Any]:
    """Return the rating of a bearing; state that its stiffness follows from the geometry."""
    for item in _STIFFNESSES:
        if part.number(item, "stiffness of the bearing") is not None:
            part.say(item, "ignored", "the stiffness follows from the geometry")
    words = "dynamic load rating, kN: the rating life"
    rating = bounded_number(part, "radial_dynamic_load_rating", words, DYNAMIC_CAPACITY)
    return {"dynamic_capacity_n": float(f"{rating:.12g}")} if rating else {}


def _table(row: BallBearing | RollerBearing | CatalogLine) -> dict[str, Any]:
    """Return a row as a scene file states it; defaults are not written out."""
    names = {BallBearing: "ball", RollerBearing: "roller", CatalogLine: "catalog"}
    values = {
        figure.field: figure.own(value)
        for figure in figures(type(row))
        if (value := getattr(row, figure.name)) != figure.default
    }
    return {names[type(row)]: values}
