"""The bearings of the scene: rolling bearings and bushings, planet bearings, couplings between shafts."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from bounds.types import FloatArray
from dynamics.bearings import BallBearing, CatalogLine, RollerBearing
from dynamics.bearings.roller_bearing import BOTH, NEGATIVE, NONE, POSITIVE
from dynamics.bearings.rolling_bearing import AXIAL_PRELOAD, DYNAMIC_CAPACITY
from lineofaction.gearbox.from_rexs.bearings import (
    BearingGeometry,
    BearingStiffness,
    bearing_geometry,
    bearing_stiffness,
    operating_point,
    stated_stiffness,
)
from lineofaction.gearbox.from_rexs.gear_unit import (
    Connection,
    Names,
    Part,
    bearings,
    bounded_number,
    couplings,
)
from lineofaction.gearbox.from_rexs.housing import loosely_housed
from lineofaction.gearbox.from_rexs.layout import Layout
from lineofaction.gearbox.from_rexs.placement import placement
from lineofaction.gearbox.from_rexs.scene_shafts import SceneShafts
from lineofaction.gearbox.schemas.declared import figures

# A bearing of a REXS model as a rolling bearing of the scene, by its geometry.


# In which directions a bearing of a REXS model holds its shaft along the axis of the scene.


ITEM, ROW_ITEM = "axial_force_absorption", "axial_force_absorption_of_row"
_LOCATING = {"both_directions": BOTH, "positive": POSITIVE, "negative": NEGATIVE, "no_direction": NONE}
_OPPOSITE = {POSITIVE: NEGATIVE, NEGATIVE: POSITIVE}


def _axial_location(part: Part, sense: int, item: str = ITEM) -> str | None:
    """Return the directions along z in which a bearing, or its row, holds its shaft.

    Parameters
    ----------
    part : Part
        The bearing, or its row.
    sense : int
        +1 where u of the bearing is along z, -1 where it is against it.
    item : str
        The attribute.

    Returns
    -------
    str or None
        both, positive, negative, none; None where the file does not say.
    """
    stated = _LOCATING.get(part.text(item, "directions in which it holds the shaft, by its own u") or "")
    if stated in _OPPOSITE and sense < 0:
        part.say(item, "derived", f"{_OPPOSITE[stated]} along z: its u is against z")
        return _OPPOSITE[stated]
    return stated


def _contact_side(part: Part, row: Part | None, sense: int) -> int | str:
    """Return the sign of the contact angle of a row, +1 where it holds a shaft that is pushed along z.

    The row's own direction counts, else that of the bearing; the reason where neither says or they differ.
    """
    senses = {POSITIVE: 1, NEGATIVE: -1}
    own = senses.get(_axial_location(part, sense) or "")
    of_row = None if row is None else senses.get(_axial_location(row, sense, ROW_ITEM) or "")
    if own is not None and of_row is not None and own != of_row:
        return f"{ITEM} of the bearing and of its row are opposite"
    side = of_row or own
    return side or f"{ITEM} does not say which direction its contact angle holds: positive or negative"


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
    side = _contact_side(entry.part, rows[0] if rows else None, sense)
    if isinstance(side, str):
        return side
    row = replace(geometry.row, contact_angle=side * geometry.row.contact_angle)
    return _table(row) | _preload(entry.part, side)


def _without_angle(part: Part, geometry: BearingGeometry, sense: int) -> dict[str, Any] | str:
    """Return a deep groove ball or cylindrical roller bearing."""
    locating, table = _axial_location(part, sense), _table(geometry.line or geometry.row)
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


RIGID_COUPLING, RIGID_TORSION = 1e9, 1e7
"""N/m, and N m/rad, of a coupling that does not yield."""
_CLEARANCES = ("radial_clearance", "axial_clearance", "operating_axial_bearing_clearance", "preload_distance")


@dataclass
class SceneBearings:
    """Tables of what holds the shafts.

    Attributes
    ----------
    bushings, rolling_bearings, planet_bearings, couplings : list of dict
        Tables of a scene file.
    seats : dict of int to str
        The bushing or rolling bearing of each bearing on the ground, by its component.
    loose : frozenset of int
        The components in an elastic housing that is not held in all directions.
    """

    bushings: list[dict[str, Any]] = field(default_factory=list)
    rolling_bearings: list[dict[str, Any]] = field(default_factory=list)
    planet_bearings: list[dict[str, Any]] = field(default_factory=list)
    couplings: list[dict[str, Any]] = field(default_factory=list)
    seats: dict[int, str] = field(default_factory=dict)
    loose: frozenset[int] = frozenset()


def scene_bearings(layout: Layout, shafts: SceneShafts) -> SceneBearings:
    """Return bearings and couplings of the scene; the account says what is left out and why."""
    tables, names = SceneBearings(loose=frozenset(loosely_housed(layout))), Names()
    for entry in bearings(layout.unit):
        _enter(layout, shafts, tables, names, entry)
    for entry in couplings(layout.unit):
        if entry.on_ground is not None and _rotor(layout, shafts, entry.held) is not None:
            _enter(layout, shafts, tables, names, entry)
    for entry in layout.rotors.couplings:
        _enter_coupling(layout, shafts, tables, names, entry)
    return tables


def _enter(
    layout: Layout, shafts: SceneShafts, tables: SceneBearings, names: Names, entry: Connection
) -> None:
    """Enter a bearing, or a coupling on the ground, by what it joins."""
    ends = [_rotor(layout, shafts, side) for side in (entry.inner, entry.outer)]
    planets = {planets.planets[0].id: planets for planets in layout.rotors.sets}
    planet = next((side for side in (entry.inner, entry.outer) if side.id in planets), None)
    if entry.on_ground is not None and _rotor(layout, shafts, entry.held) is not None:
        _enter_on_ground(layout, shafts, tables, names, entry)
    elif planet is not None and ends[0] is not None and ends[1] is not None:
        carrier = layout.rotor(planets[planet.id].carrier[0].id)
        if layout.rotor(entry.other(planet).id) == carrier:
            table = _seat(layout, shafts, names, entry, planet) | _bushing(layout, entry, planet)
            tables.planet_bearings.append(table | {"carrier": shafts.by_rotor[carrier].name})
            _say_clearances(entry.part)
            entry.part.say("", "taken", f"bearing of shaft {table['shaft']}")
    elif ends[0] is not None and ends[1] is not None and ends[0] != ends[1]:
        _say_clearances(entry.part)
        tables.couplings.append(_between(layout, shafts, names, entry))
    else:
        copies = {copy.id for planets in layout.rotors.sets for copy in planets.planets[1:]}
        is_copy = bool(copies & {entry.inner.id, entry.outer.id})
        words = "that of an equal planet" if is_copy else "what it holds is not in the scene"
        entry.part.say("", "derived" if is_copy else "refused", words)


def _enter_on_ground(
    layout: Layout, shafts: SceneShafts, tables: SceneBearings, names: Names, entry: Connection
) -> None:
    """Enter a bearing by its geometry, or as a bushing for the reason that the account has."""
    rolling = rolling_bearing(layout, entry, tables.loose)
    seat = _seat(layout, shafts, names, entry, entry.held)
    if isinstance(rolling, str):
        _say_clearances(entry.part)
        tables.bushings.append(seat | _bushing(layout, entry, entry.held))
        entry.part.say("", "taken", f"bushing on shaft {seat['shaft']}: {rolling}")
    else:
        tables.rolling_bearings.append(seat | rolling)
        entry.part.say("", "taken", f"rolling bearing on shaft {seat['shaft']}, by its geometry")
    tables.seats[entry.part.id] = seat["name"]


def _rotor(layout: Layout, shafts: SceneShafts, side: Part) -> int | None:
    """Return the rotor of a side if the scene has it."""
    rotor = layout.rotors.of.get(side.id)
    return rotor if rotor in shafts.by_rotor else None


def _seat(layout: Layout, shafts: SceneShafts, names: Names, entry: Connection, held: Part) -> dict[str, Any]:
    """Return name, shaft and position of a bearing on a shaft."""
    shaft = shafts.by_rotor[layout.rotor(held.id)]
    side = "inner" if held.id == entry.inner.id else "outer"
    return {
        "name": names.of(entry.part),
        "shaft": shaft.name,
        "position_mm": shaft.position_mm(_z(layout, entry.part, held, side)),
    }


def _bushing(layout: Layout, entry: Connection, held: Part) -> dict[str, Any]:
    """Return the stiffness of a bearing on a shaft as a bushing states it."""
    stiffness = bearing_stiffness(layout.unit, entry.part)
    matrix = _matrix(layout, entry.part, held, stiffness)
    if stiffness.matrix is not None:
        return {"stiffness_matrix": matrix.tolist()}
    linear = {"radial_stiffness_n_per_m": stiffness.radial, "axial_stiffness_n_per_m": stiffness.axial}
    return linear | ({"stiffness_matrix": matrix.tolist()} if stiffness.tilt > 0.0 else {})


def _matrix(layout: Layout, part: Part, held: Part, stiffness: BearingStiffness) -> FloatArray:
    """Return the stiffness in x, y, z, tilt_x, tilt_y that is beside radial and axial stiffness."""
    if stiffness.matrix is None:
        return np.diag([0.0, 0.0, 0.0, stiffness.tilt, stiffness.tilt])
    place = placement(layout.unit, part) or layout.shafts[held.id].place
    turn = layout.axes.turn(place)
    full = np.zeros((6, 6))
    kept = np.array([0, 1, 2, 4, 5])
    full[np.ix_(kept, kept)] = stiffness.matrix
    both = np.kron(np.eye(2), turn)
    return np.asarray((both @ full @ both.T)[:5, :5])


def _z(layout: Layout, part: Part, held: Part, side: str) -> float:
    """Return z of a bearing, m."""
    if held.id not in layout.shafts:
        place = placement(layout.unit, part)
        return 0.0 if place is None else float(layout.axes.point(place.origin)[2])
    return layout.z_on(layout.shafts[held.id], part, f"u_coordinate_on_shaft_{side}_side")


def _between(layout: Layout, shafts: SceneShafts, names: Names, entry: Connection) -> dict[str, Any]:
    """Return a bearing between two shafts: a coupling that leaves their rotations free."""
    stiffness = bearing_stiffness(layout.unit, entry.part)
    if stiffness.matrix is None:
        rows = [stiffness.radial, stiffness.radial, stiffness.axial, stiffness.tilt, stiffness.tilt, 0.0]
        full = np.diag(np.minimum(rows, RIGID_COUPLING))
    else:
        full = np.zeros((6, 6))
        full[:5, :5] = _matrix(layout, entry.part, entry.inner, stiffness)
    entry.part.say("", "taken", "bearing between two shafts")
    return _joint(layout, shafts, names, entry) | {
        "torsional_stiffness_n_m_per_rad": 0.0,
        "stiffness_matrix": full.tolist(),
    }


def _joint(layout: Layout, shafts: SceneShafts, names: Names, entry: Connection) -> dict[str, Any]:
    """Return what every coupling states."""
    first, second = (shafts.by_rotor[layout.rotor(side.id)] for side in (entry.inner, entry.outer))
    z = _z(layout, entry.part, entry.inner, "inner")
    return {
        "name": names.of(entry.part),
        "first": first.name,
        "second": second.name,
        "position_mm": first.position_mm(z),
    }


def _enter_coupling(
    layout: Layout, shafts: SceneShafts, tables: SceneBearings, names: Names, entry: Connection
) -> None:
    if any(_rotor(layout, shafts, side) is None for side in (entry.inner, entry.outer)):
        return
    radial = _limited(entry.part, "radial_stiffness", RIGID_COUPLING)
    axial = _limited(entry.part, "axial_stiffness", RIGID_COUPLING)
    tilt = _limited(entry.part, "bending_stiffness", RIGID_TORSION)
    torsion = _limited(entry.part, "rotational_stiffness", RIGID_TORSION)
    entry.part.say("", "taken", "coupling")
    tables.couplings.append(
        _joint(layout, shafts, names, entry)
        | {
            "torsional_stiffness_n_m_per_rad": torsion or RIGID_TORSION,
            "stiffness_matrix": np.diag([radial, radial, axial, tilt, tilt, 0.0]).tolist(),
        }
    )


def _limited(part: Part, item: str, rigid: float) -> float:
    """Return a stiffness of a coupling, at most the rigid one; that where the file gives none."""
    value = part.number(item, "stiffness of the coupling")
    if value is None:
        part.say(item, "defaulted", f"rigid: {rigid:g} (N, m, rad)")
        return rigid
    if value > rigid:
        part.say(item, "derived", f"{value:.3g} (N, m, rad) means rigid: {rigid:g} here")
    return min(max(value, 0.0), rigid)


def _say_clearances(part: Part) -> None:
    """State that a linear bushing has no clearance."""
    for item in _CLEARANCES:
        attribute = part.attribute(item)
        if attribute is not None and isinstance(attribute.value, (int, float)) and attribute.value != 0:
            part.say(item, "refused", "a linear bushing has neither clearance nor preload")


def stub_couplings(shafts: SceneShafts, names: Names) -> Iterator[dict[str, Any]]:
    """Yield the couplings that fix the stubs of planetary sets on their shafts."""
    for number, stub in enumerate(shafts.stubs.values(), 1):
        main = shafts.by_rotor[stub.rotor]
        yield {
            "name": f"stub {number}",
            "first": main.name,
            "second": stub.name,
            "position_mm": main.position_mm(stub.begin),
            "torsional_stiffness_n_m_per_rad": RIGID_TORSION,
            "stiffness_matrix": np.diag([*[RIGID_COUPLING] * 3, *[RIGID_TORSION] * 2, 0.0]).tolist(),
        }
