"""Supports of the scene's shafts: bearings, and couplings between shafts.

A *table* is a record of a scene file. The *account* of a conversion states the fate of each component of the
REXS file: taken, derived from other values, or refused. A *rotor* is a set of shafts of the file that turn
together: a shaft of the scene. A bearing has its axes u, v, w in the file, and x, y, z in the scene.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from bounds.types import FloatArray
from lineofaction.gearbox.from_rexs.bearing_location import STIFFNESSES, Table, further_fields, located_row
from lineofaction.gearbox.from_rexs.bearing_stiffness import (
    BearingStiffness,
    finite_stiffness,
    operating_point,
)
from lineofaction.gearbox.from_rexs.bearings import BearingGeometry
from lineofaction.gearbox.from_rexs.elastic_housing import elastic_housings, loosely_housed
from lineofaction.gearbox.from_rexs.gear_unit import Connection, Part
from lineofaction.gearbox.from_rexs.layout import Layout
from lineofaction.gearbox.from_rexs.part_names import Names
from lineofaction.gearbox.from_rexs.placement import Placement
from lineofaction.gearbox.from_rexs.scene_shafts import SceneShafts

RIGID_COUPLING, RIGID_TORSION = 1e9, 1e7
"""Stiffness, N/m and N m/rad, of a coupling that counts as rigid."""
_STIFFNESS_ROWS = np.array([0, 1, 2, 4, 5])
"""Rows of a bearing's matrix among the displacements along u, v, w and the rotations about u, v, w: all but
the rotation about u, its axis."""
_CLEARANCES = ("radial_clearance", "axial_clearance", "operating_axial_bearing_clearance", "preload_distance")
"""Attributes of a bearing that a linear bushing does not have."""


class SceneBearings:
    """Tables of bearings and couplings as a scene file has them; the account states omissions and reasons.

    `seats` has the name of the bushing or rolling bearing by the id of the file's bearing on the ground.
    """

    def __init__(self, layout: Layout, shafts: SceneShafts) -> None:
        self._layout, self._shafts, self._names = layout, shafts, Names()
        self._loose = loosely_housed(layout)
        self.bushings: list[Table] = []
        self.rolling_bearings: list[Table] = []
        self.planet_bearings: list[Table] = []
        self.couplings: list[Table] = []
        self.seats: dict[int, str] = {}
        for entry in layout.unit.bearings:
            self._enter(entry)
        for entry in layout.unit.couplings:
            if entry.on_ground is not None and self._rotor(entry.rotor_side) is not None:
                self._enter(entry)
        for entry in layout.rotors.couplings:
            self._enter_coupling(entry)
        self.couplings += _stub_couplings(shafts)
        self.housings = list(elastic_housings(layout, self.seats))

    def _enter(self, entry: Connection) -> None:
        """Enter a bearing, or a coupling on the ground, by the parts that it joins."""
        ends = [self._rotor(side) for side in (entry.inner, entry.outer)]
        planets = {planets.planets[0].id: planets for planets in self._layout.rotors.sets}
        planet = next((side for side in (entry.inner, entry.outer) if side.id in planets), None)
        if entry.on_ground is not None and self._rotor(entry.rotor_side) is not None:
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
            text = "that of an equal planet" if is_copy else "what it holds is not in the scene"
            entry.part.say("", "derived" if is_copy else "refused", text)

    def _enter_on_ground(self, entry: Connection) -> None:
        """Enter a bearing on the ground by its geometry, or as a bushing, with the reason in the account."""
        rolling = self._rolling_bearing(entry)
        seat = self._seat(entry, entry.rotor_side)
        if isinstance(rolling, str):
            _say_clearances(entry.part)
            self.bushings.append(seat | self._bushing(entry, entry.rotor_side))
            entry.part.say("", "taken", f"bushing on shaft {seat['shaft']}: {rolling}")
        else:
            self.rolling_bearings.append(seat | rolling)
            entry.part.say("", "taken", f"rolling bearing on shaft {seat['shaft']}, by its geometry")
        self.seats[entry.part.id] = seat["name"]

    def _rotor(self, side: Part) -> int | None:
        """Return the rotor of one side of a bearing or coupling; None if the scene does not have it."""
        rotor = self._layout.rotors.of.get(side.id)
        return rotor if rotor in self._shafts.by_rotor else None

    def _rolling_bearing(self, entry: Connection) -> Table | str:
        """Return the table of a bearing by its geometry, or the reason why the bearing is a bushing."""
        part = entry.part
        if part.id in self._loose:
            return "the matrix of the casing is singular, and only linear bearings sit in it"
        if entry.rotor_side.id != entry.inner.id:
            return "the shaft is on its outer side"
        if operating_point(part) is not None or any(finite_stiffness(part, item) for item in STIFFNESSES):
            return "its stiffness is stated"
        if part.value("radial_force_absorption") is False:
            return "it carries no radial force"
        geometry = BearingGeometry.of(part)
        if isinstance(geometry, str):
            return geometry
        # 1 if the bearing's axis u points along z of the scene, else -1
        sense = 1 if float(self._layout.rotation(part, entry.rotor_side)[2, 0]) > 0.0 else -1
        located = located_row(part, geometry, sense)
        return located if isinstance(located, str) else located | further_fields(part)

    def _seat(self, entry: Connection, rotor_side: Part) -> Table:
        shaft = self._shafts.by_rotor[self._layout.rotor(rotor_side.id)]
        side = "inner" if rotor_side.id == entry.inner.id else "outer"
        return shaft.seat(self._names.of(entry.part), self._z(entry.part, rotor_side, side))

    def _bushing(self, entry: Connection, rotor_side: Part) -> Table:
        stiffness = BearingStiffness.of(entry.part)
        if stiffness.matrix is not None:
            return {"stiffness_matrix": self._turned(entry.part, rotor_side, stiffness.matrix).tolist()}
        linear = {"radial_stiffness_n_per_m": stiffness.radial, "axial_stiffness_n_per_m": stiffness.axial}
        tilt = np.diag([0.0, 0.0, 0.0, stiffness.tilt, stiffness.tilt])
        return linear | ({"stiffness_matrix": tilt.tolist()} if stiffness.tilt > 0.0 else {})

    def _turned(self, part: Part, rotor_side: Part, matrix: FloatArray) -> FloatArray:
        """Return a bearing's stiffness (5, 5) along u, v, w as one in x, y, z, tilt_x, tilt_y."""
        full = np.zeros((6, 6))
        full[np.ix_(_STIFFNESS_ROWS, _STIFFNESS_ROWS)] = matrix
        # displacements and rotations turn alike: two equal blocks
        rotation = np.kron(np.eye(2), self._layout.rotation(part, rotor_side))
        return np.asarray((rotation @ full @ rotation.T)[:5, :5])

    def _z(self, part: Part, rotor_side: Part, side: str) -> float:
        """Return the position of a part along z, m; `side` of it ("inner" or "outer") is on the shaft."""
        if rotor_side.id not in self._layout.shafts:
            placement = Placement.of(part)
            return 0.0 if placement is None else float(self._layout.axes.point(placement.origin)[2])
        return self._layout.z_on(
            self._layout.shafts[rotor_side.id], part, f"u_coordinate_on_shaft_{side}_side"
        )

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
        return self._joint(entry) | _coupled_table(0.0, full)

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
        radial, axial = (_limited(entry.part, item, RIGID_COUPLING) for item in STIFFNESSES[:2])
        tilt = _limited(entry.part, "bending_stiffness", RIGID_TORSION)
        torsion = _limited(entry.part, "rotational_stiffness", RIGID_TORSION)
        entry.part.say("", "taken", "coupling")
        matrix = np.diag([radial, radial, axial, tilt, tilt, 0.0])
        self.couplings.append(self._joint(entry) | _coupled_table(torsion or RIGID_TORSION, matrix))


def _coupled_table(torsion: float, matrix: FloatArray) -> Table:
    return {"torsional_stiffness_n_m_per_rad": torsion, "stiffness_matrix": matrix.tolist()}


def _limited(part: Part, item: str, rigid: float) -> float:
    """Return a stiffness of a coupling, at most `rigid`, which also stands where the file gives none."""
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
        yield {"name": f"stub {number}", **joint, **_coupled_table(RIGID_TORSION, matrix)}
