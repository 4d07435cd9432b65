"""What holds the shafts of the scene: bearings, couplings between shafts, and the elastic housing."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from bounds.types import FloatArray
from dynamics.bearings import BallBearing, CatalogLine, RollerBearing
from dynamics.bearings.matrix import least_share
from dynamics.bearings.rolling_bearing import AXIAL_PRELOAD, BOTH, DYNAMIC_CAPACITY, NEGATIVE, NONE, POSITIVE
from dynamics.joints.housing import DEFINITE
from lineofaction.gearbox.from_rexs.bearings import (
    BearingGeometry,
    BearingStiffness,
    operating_point,
    stated_stiffness,
)
from lineofaction.gearbox.from_rexs.gear_unit import Connection, Part, rounded
from lineofaction.gearbox.from_rexs.layout import Layout
from lineofaction.gearbox.from_rexs.placement import FIXED, Placement
from lineofaction.gearbox.from_rexs.scene_shafts import Names, SceneShafts
from lineofaction.gearbox.schemas.declared import figures

Table = dict[str, Any]

RIGID_COUPLING, RIGID_TORSION = 1e9, 1e7
"""N/m, and N m/rad, of a coupling that does not yield."""
_CLEARANCES = ("radial_clearance", "axial_clearance", "operating_axial_bearing_clearance", "preload_distance")
_STIFFNESSES = ("radial_stiffness", "axial_stiffness", "bending_stiffness")

_ABSORPTION = "axial_force_absorption"
_LOCATING = {"both_directions": BOTH, "positive": POSITIVE, "negative": NEGATIVE, "no_direction": NONE}
_OPPOSITE = {POSITIVE: NEGATIVE, NEGATIVE: POSITIVE}
_SIGN = {POSITIVE: 1, NEGATIVE: -1}


class SceneBearings:
    """Tables of what holds the shafts, as a scene file has them; the account says what is left out and why.

    `seats`: the bushing or rolling bearing of each bearing on the ground, by its component.
    """

    def __init__(self, layout: Layout, shafts: SceneShafts) -> None:
        self._layout, self._shafts, self._names = layout, shafts, Names()
        self._loose = _loosely_housed(layout)
        self.bushings: list[Table] = []
        self.rolling_bearings: list[Table] = []
        self.planet_bearings: list[Table] = []
        self.couplings: list[Table] = []
        self.seats: dict[int, str] = {}
        for entry in layout.unit.bearings:
            self._enter(entry)
        for entry in layout.unit.couplings:
            if entry.on_ground is not None and self._rotor(entry.held) is not None:
                self._enter(entry)
        for entry in layout.rotors.couplings:
            self._enter_coupling(entry)
        self.couplings += _stub_couplings(shafts)
        self.housings = list(_housings(layout, self.seats))

    def _enter(self, entry: Connection) -> None:
        """Enter a bearing, or a coupling on the ground, by what it joins."""
        ends = [self._rotor(side) for side in (entry.inner, entry.outer)]
        planets = {planets.planets[0].id: planets for planets in self._layout.rotors.sets}
        planet = next((side for side in (entry.inner, entry.outer) if side.id in planets), None)
        if entry.on_ground is not None and self._rotor(entry.held) is not None:
            self._enter_on_ground(entry)
        elif planet is not None and ends[0] is not None and ends[1] is not None:
            carrier = self._layout.rotor(planets[planet.id].carrier[0].id)
            if self._layout.rotor(entry.other(planet).id) == carrier:
                table = self._seat(entry, planet) | self._bushing(entry, planet)
                self.planet_bearings.append(table | {"carrier": self._shafts.by_rotor[carrier].name})
                _say_clearances(entry.part)
                entry.part.say("", "taken", f"bearing of shaft {table['shaft']}")
        elif ends[0] is not None and ends[1] is not None and ends[0] != ends[1]:
            _say_clearances(entry.part)
            self.couplings.append(self._between(entry))
        else:
            copies = {copy.id for planets in self._layout.rotors.sets for copy in planets.planets[1:]}
            is_copy = bool(copies & {entry.inner.id, entry.outer.id})
            words = "that of an equal planet" if is_copy else "what it holds is not in the scene"
            entry.part.say("", "derived" if is_copy else "refused", words)

    def _enter_on_ground(self, entry: Connection) -> None:
        """Enter a bearing by its geometry, or as a bushing for the reason that the account has."""
        rolling = self._rolling_bearing(entry)
        seat = self._seat(entry, entry.held)
        if isinstance(rolling, str):
            _say_clearances(entry.part)
            self.bushings.append(seat | self._bushing(entry, entry.held))
            entry.part.say("", "taken", f"bushing on shaft {seat['shaft']}: {rolling}")
        else:
            self.rolling_bearings.append(seat | rolling)
            entry.part.say("", "taken", f"rolling bearing on shaft {seat['shaft']}, by its geometry")
        self.seats[entry.part.id] = seat["name"]

    def _rotor(self, side: Part) -> int | None:
        """Return the rotor of a side if the scene has it."""
        rotor = self._layout.rotors.of.get(side.id)
        return rotor if rotor in self._shafts.by_rotor else None

    def _rolling_bearing(self, entry: Connection) -> Table | str:
        """Return what a scene file states of a bearing by its geometry, or why it is a bushing."""
        part = entry.part
        if part.id in self._loose:
            return "the matrix of the casing is singular, and only linear bearings sit in it"
        if entry.held.id != entry.inner.id:
            return "the shaft is on its outer side"
        if operating_point(part) is not None or any(stated_stiffness(part, item) for item in _STIFFNESSES):
            return "its stiffness is stated"
        if part.value("radial_force_absorption") is False:
            return "it carries no radial force"
        geometry = BearingGeometry.of(part)
        if isinstance(geometry, str):
            return geometry
        sense = 1 if float(self._layout.turn(part, entry.held)[2, 0]) > 0.0 else -1
        located = _located(part, geometry, sense)
        return located if isinstance(located, str) else located | _further(part)

    def _seat(self, entry: Connection, held: Part) -> Table:
        shaft = self._shafts.by_rotor[self._layout.rotor(held.id)]
        side = "inner" if held.id == entry.inner.id else "outer"
        return shaft.seat(self._names.of(entry.part), self._z(entry.part, held, side))

    def _bushing(self, entry: Connection, held: Part) -> Table:
        stiffness = BearingStiffness.of(entry.part)
        if stiffness.matrix is not None:
            return {"stiffness_matrix": self._turned(entry.part, held, stiffness.matrix).tolist()}
        linear = {"radial_stiffness_n_per_m": stiffness.radial, "axial_stiffness_n_per_m": stiffness.axial}
        tilt = np.diag([0.0, 0.0, 0.0, stiffness.tilt, stiffness.tilt])
        return linear | ({"stiffness_matrix": tilt.tolist()} if stiffness.tilt > 0.0 else {})

    def _turned(self, part: Part, held: Part, matrix: FloatArray) -> FloatArray:
        """Return the stiffness (5, 5) in x, y, z, tilt_x, tilt_y of a matrix along u, v, w of a bearing."""
        full = np.zeros((6, 6))
        kept = np.array([0, 1, 2, 4, 5])
        full[np.ix_(kept, kept)] = matrix
        both = np.kron(np.eye(2), self._layout.turn(part, held))
        return np.asarray((both @ full @ both.T)[:5, :5])

    def _z(self, part: Part, held: Part, side: str) -> float:
        if held.id not in self._layout.shafts:
            place = Placement.of(part)
            return 0.0 if place is None else float(self._layout.axes.point(place.origin)[2])
        return self._layout.z_on(self._layout.shafts[held.id], part, f"u_coordinate_on_shaft_{side}_side")

    def _between(self, entry: Connection) -> Table:
        """Return a bearing between two shafts: a coupling that leaves their rotations free."""
        stiffness = BearingStiffness.of(entry.part)
        if stiffness.matrix is None:
            rows = [stiffness.radial, stiffness.radial, stiffness.axial, stiffness.tilt, stiffness.tilt, 0.0]
            full = np.diag(np.minimum(rows, RIGID_COUPLING))
        else:
            full = np.zeros((6, 6))
            full[:5, :5] = self._turned(entry.part, entry.inner, stiffness.matrix)
        entry.part.say("", "taken", "bearing between two shafts")
        return self._joint(entry) | _coupled(0.0, full)

    def _joint(self, entry: Connection) -> Table:
        sides = (entry.inner, entry.outer)
        first, second = (self._shafts.by_rotor[self._layout.rotor(side.id)] for side in sides)
        z = self._z(entry.part, entry.inner, "inner")
        return {
            "name": self._names.of(entry.part),
            "first": first.name,
            "second": second.name,
            "position_mm": first.position_mm(z),
        }

    def _enter_coupling(self, entry: Connection) -> None:
        if any(self._rotor(side) is None for side in (entry.inner, entry.outer)):
            return
        radial, axial = (_limited(entry.part, item, RIGID_COUPLING) for item in _STIFFNESSES[:2])
        tilt = _limited(entry.part, "bending_stiffness", RIGID_TORSION)
        torsion = _limited(entry.part, "rotational_stiffness", RIGID_TORSION)
        entry.part.say("", "taken", "coupling")
        matrix = np.diag([radial, radial, axial, tilt, tilt, 0.0])
        self.couplings.append(self._joint(entry) | _coupled(torsion or RIGID_TORSION, matrix))


def _coupled(torsion: float, matrix: FloatArray) -> Table:
    return {"torsional_stiffness_n_m_per_rad": torsion, "stiffness_matrix": matrix.tolist()}


def _limited(part: Part, item: str, rigid: float) -> float:
    """Return a stiffness of a coupling, at most the rigid one; that where the file gives none."""
    value = part.number(item, "stiffness of the coupling", rigid, f"rigid: {rigid:g} (N, m, rad)")
    if value > rigid:
        part.say(item, "derived", f"{value:.3g} (N, m, rad) means rigid: {rigid:g} here")
    return min(max(value, 0.0), rigid)


def _say_clearances(part: Part) -> None:
    for item in _CLEARANCES:
        value = part.value(item)
        if isinstance(value, (int, float)) and value != 0:
            part.say(item, "refused", "a linear bushing has neither clearance nor preload")


def _stub_couplings(shafts: SceneShafts) -> Iterator[Table]:
    """Yield the couplings that fix the stubs of planetary sets on their shafts."""
    matrix = np.diag([*[RIGID_COUPLING] * 3, *[RIGID_TORSION] * 2, 0.0])
    for number, stub in enumerate(shafts.stubs.values(), 1):
        main = shafts.by_rotor[stub.rotor]
        joint = {"first": main.name, "second": stub.name, "position_mm": main.position_mm(stub.begin)}
        yield {"name": f"stub {number}", **joint, **_coupled(RIGID_TORSION, matrix)}


# A bearing by its geometry, and in which directions it holds its shaft along the axis of the scene.


def _axial_location(part: Part, sense: int, item: str = _ABSORPTION) -> str | None:
    """Return the directions along z in which a bearing, or its row, holds its shaft.

    Both, positive, negative, none; None where the file does not say. `sense` is +1 where u of the bearing is
    along z, -1 where it is against it.
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
    own = _SIGN.get(_axial_location(part, sense) or "")
    stated = None if row is None else _axial_location(row, sense, f"{_ABSORPTION}_of_row")
    of_row = _SIGN.get(stated or "")
    if own is not None and of_row is not None and own != of_row:
        return f"{_ABSORPTION} of the bearing and of its row are opposite"
    side = of_row or own
    return side or f"{_ABSORPTION} does not say which direction its contact angle holds: positive or negative"


def _located(part: Part, geometry: BearingGeometry, sense: int) -> Table | str:
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


def _further(part: Part) -> Table:
    """Return the rating of a bearing; state that its stiffness follows from the geometry."""
    for item in _STIFFNESSES:
        if part.number(item, "stiffness of the bearing") is not None:
            part.say(item, "ignored", "the stiffness follows from the geometry")
    words = "dynamic load rating, kN: the rating life"
    rating = part.bounded("radial_dynamic_load_rating", words, DYNAMIC_CAPACITY)
    return {"dynamic_capacity_n": rounded(rating)} if rating else {}


def _table(row: BallBearing | RollerBearing | CatalogLine) -> Table:
    """Return a row as a scene file states it; defaults are not written out."""
    names = {BallBearing: "ball", RollerBearing: "roller", CatalogLine: "catalog"}
    values = {
        figure.field: figure.own(value)
        for figure in figures(type(row))
        if (value := getattr(row, figure.name)) != figure.default
    }
    return {names[type(row)]: values}


# The elastic housing: the reduced stiffness matrix of the casing's assembly group.


_MATRIX = "reduced_static_stiffness_matrix"
_PER_POINT = 6
_SYMMETRIC = 1e-6
"""Relative; a finite-element program writes its matrices with that many digits."""


def _housings(layout: Layout, seats: dict[int, str]) -> Iterator[Table]:
    """Yield the housings whose points carry bearings.

    The matrix of the file has six rows a point, motions along and rotations about u, v, w of its assembly
    group, in N, mm, rad, and the order of the points. Points that carry no bearing of the scene follow free
    of force (static condensation). `seats` has the names of the bushings by component.
    """
    names = Names()
    for group in _groups(layout):
        points = group.children("reduction_point")
        bearings = [_seat_of(point, seats) for point in points]
        matrix = _stiffness(group, len(points))
        if matrix is None:
            continue
        if not any(bearings):
            group.say("", "refused", "no reduction point refers to a bearing of the scene")
            continue
        turn = np.kron(np.eye(2 * len(points)), layout.axes.turn(Placement.of(group) or FIXED))
        turned = turn @ matrix @ turn.T
        kept = [index for index, name in enumerate(bearings) if name]
        group.say("", "taken", "elastic housing")
        words = f"stiffness under {len(kept)} bearings; u, v, w turned to x, y, z, mm to m"
        group.say(_MATRIX, "taken", words)
        yield {
            "name": names.of(group),
            "bushings": [name for name in bearings if name],
            "stiffness_matrix": _condensed(turned, kept).tolist(),
        }


def _loosely_housed(layout: Layout) -> set[int]:
    """Return the components in an elastic housing that is not held in all directions: its matrix is singular.

    Only linear bearings sit in such a housing.
    """
    loose: set[int] = set()
    for group in _groups(layout):
        points = group.children("reduction_point")
        matrix = _stiffness(group, len(points))
        if matrix is not None and least_share(matrix) <= DEFINITE:
            seats = (point.referenced for point in points)
            loose |= {part.id for parts in seats for part in parts}
    return loose


def _groups(layout: Layout) -> list[Part]:
    return [
        group
        for casing in layout.unit.of_type("gear_casing")
        for group in casing.referenced
        if group.type == "assembly_group"
    ]


def _seat_of(point: Part, seats: dict[int, str]) -> str | None:
    for part in point.referenced:
        if part.id in seats:
            point.say("", "taken", f"seat of {seats[part.id]}")
            return seats[part.id]
    point.say("", "derived", "carries no bearing of the scene: it follows free of force")
    return None


def _stiffness(group: Part, points: int) -> FloatArray | None:
    """Return the matrix in N, m, rad, None if the account says why there is none."""
    rows = group.value(_MATRIX)
    if rows is None:
        group.say("", "refused", f"no {_MATRIX}: files of finite-element programs are not read")
        return None
    size = _PER_POINT * points
    sizes = [len(row) if isinstance(row, tuple) else 0 for row in (rows if isinstance(rows, tuple) else ())]
    if not isinstance(rows, tuple) or sizes != [size] * size:
        words = f"{size} rows of {size} numbers are needed: six for each reduction point"
        group.say(_MATRIX, "refused", words)
        return None
    try:
        matrix = np.array(rows, dtype=float)
    except (TypeError, ValueError):
        group.say(_MATRIX, "refused", "not all of its entries are numbers")
        return None
    scale = np.tile([1e3**0.5] * 3 + [1e-3**0.5] * 3, points)
    matrix *= scale[:, None] * scale
    most = float(np.max(np.abs(matrix)))
    if not np.isfinite(most) or np.any(np.abs(matrix - matrix.T) > _SYMMETRIC * most):
        group.say(_MATRIX, "refused", "not symmetric, or not finite")
        return None
    return np.asarray(0.5 * (matrix + matrix.T))


def _condensed(matrix: FloatArray, kept: list[int]) -> FloatArray:
    """Return the stiffness over some points, the others free of force."""
    rows = np.concatenate([np.arange(_PER_POINT * index, _PER_POINT * (index + 1)) for index in kept])
    free = np.setdiff1d(np.arange(len(matrix)), rows)
    if not free.size:
        return matrix
    follow = np.linalg.pinv(matrix[np.ix_(free, free)]) @ matrix[np.ix_(free, rows)]
    return np.asarray(matrix[np.ix_(rows, rows)] - matrix[np.ix_(rows, free)] @ follow)
