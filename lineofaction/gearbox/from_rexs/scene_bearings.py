"""The bearings of the scene: rolling bearings and bushings, planet bearings, couplings between shafts."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from bounds.types import FloatArray
from lineofaction.gearbox.from_rexs.bearing_stiffness import BearingStiffness, bearing_stiffness
from lineofaction.gearbox.from_rexs.connections import Connection, bearings, couplings
from lineofaction.gearbox.from_rexs.layout import Layout
from lineofaction.gearbox.from_rexs.names import Names
from lineofaction.gearbox.from_rexs.part import Part
from lineofaction.gearbox.from_rexs.placement import placement
from lineofaction.gearbox.from_rexs.rolling_bearing import rolling_bearing
from lineofaction.gearbox.from_rexs.scene_housing import loosely_housed
from lineofaction.gearbox.from_rexs.scene_shafts import SceneShafts

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
    """Enter a coupling between two shafts."""
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
