"""The scene of a gear unit at an operating point, and which of its parts is which of the file."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from bounds.types import FloatArray
from lineofaction.gearbox.from_rexs.gear_unit import NO_STAGE, GearStage, Part, rounded
from lineofaction.gearbox.from_rexs.gears import StageCase, scene_discs, scene_gears
from lineofaction.gearbox.from_rexs.layout import Layout
from lineofaction.gearbox.from_rexs.loads import AppliedTorque, SceneMotion
from lineofaction.gearbox.from_rexs.placement import FIXED, SAME_PLACE, PlacedShaft, Placement
from lineofaction.gearbox.from_rexs.power_flow import FORCES, OperatingPoint, PowerFlow
from lineofaction.gearbox.from_rexs.scene_bearings import SceneBearings
from lineofaction.gearbox.from_rexs.scene_shafts import Names, SceneShafts
from lineofaction.gearbox.units import MM

# Which component each part of a scene is, and how its axes u, v, w lie in the scene.


@dataclass(frozen=True)
class ShaftPart:
    """A shaft."""

    component: int
    turn: FloatArray
    """Takes components along u, v, w to x, y, z. Shape (3, 3)."""
    sense: int
    """+1 where u is along z, -1 where it is against it."""
    zero: float
    """Position of u = 0 from the left end of the scene's shaft, m."""


@dataclass(frozen=True)
class BearingPart:
    """A bearing, or a coupling, on the ground."""

    component: int
    turn: FloatArray
    """Takes components along its u, v, w to x, y, z. Shape (3, 3)."""
    shaft_inside: bool
    """Whether the shaft is on the inner side."""


@dataclass(frozen=True)
class _MeshPart:
    """A stage."""

    component: int
    case: str
    """Name of its case."""
    sense: int
    """+1 where the face positions of the case count along u of the shaft of the stage's gear 1, -1 against
    it; the opposite where a load case turns the train the other way.
    """


@dataclass(frozen=True)
class SceneParts:
    """The components of shafts, bearings on the ground and meshes by their names in the scene.

    Copies of planets, planet bearings and stubs are not among them.
    """

    shafts: Mapping[str, ShaftPart] = field(default_factory=dict)
    bearings: Mapping[str, BearingPart] = field(default_factory=dict)
    meshes: Mapping[str, _MeshPart] = field(default_factory=dict)


def _scene_parts(
    layout: Layout,
    flow: PowerFlow,
    shafts: SceneShafts,
    seats: Mapping[int, str],
    meshes: Sequence[tuple[str, StageCase]],
) -> SceneParts:
    """Return the components of a scene's parts, its meshes in the order of `shafts.stages`.

    A carrier is a shaft of them only if the component of its rotor is a shaft of its own.
    """
    of_meshes = {
        name: _MeshPart(stage.stage.id, case.name, _face_sense(layout, flow, stage, case))
        for stage, (name, case) in zip(shafts.stages, meshes, strict=True)
    }
    of_shafts = {}
    for rotor, shaft in shafts.by_rotor.items():
        if (placed := layout.shafts.get(rotor)) is not None:
            turn, zero = layout.axes.turn(placed.place), float(placed.start[2]) - shaft.begin
            of_shafts[shaft.name] = ShaftPart(rotor, turn, placed.sense, zero)
    of_bearings = {}
    for entry in (*layout.unit.bearings, *layout.unit.couplings):
        if entry.part.id in seats and entry.held.id in layout.shafts:
            turn, inside = layout.turn(entry.part, entry.held), entry.held.id == entry.inner.id
            of_bearings[seats[entry.part.id]] = BearingPart(entry.part.id, turn, inside)
    return SceneParts(of_shafts, of_bearings, of_meshes)


def _face_sense(layout: Layout, flow: PowerFlow, stage: GearStage, case: StageCase) -> int:
    """Return how the face positions of the case count along u of gear 1's shaft.

    They count against the scene's z if the case's driving gear turns about +z; a ring gear that drives is
    pushed back by it.
    """
    driver, _ = case.driving(stage)
    relative = flow.relative_speed(stage, 0 if driver.id == stage.gears[0].id else 1)
    pushed = -relative if case.wheel_drives else relative
    return -int(np.sign(pushed)) * layout.sense(stage.shafts[0].id)


# Forces of the scene: what acts on shafts from outside across and along their axes, by load case.


ROUNDING = 1e-12
"""Of the largest component of a vector: less is that of the turn of its axes."""


@dataclass(frozen=True)
class _SceneForce:
    """A force and moment on a shaft of the scene, fixed in space."""

    name: str
    shaft: str
    """`name`, `shaft`: Its own and its shaft's name in the scene."""
    position_mm: float
    """Where it acts, from the left end of that shaft."""
    load: int
    """The external load that it is."""
    turn: FloatArray
    """Takes components along u, v, w of the load's shaft to x, y, z. Shape (3, 3)."""
    lever: float
    """Along z from where it acts in the scene to the load's place, m; 0 but beyond the end of its shaft."""

    def stated(self, point: OperatingPoint) -> dict[str, Any]:
        """Return what an entry of a load case's forces says at an operating point.

        The moment about the axis is not in it: torques drive and load the train.
        """
        wrench = np.array(point.forces.get(self.load, (0.0,) * len(FORCES)))
        force, moment = self.turn @ wrench[:3], self.turn @ wrench[3:]
        moment[:2] += self.lever * np.array([-force[1], force[0]])
        moment[2] = 0.0
        return {"name": self.name, "force_n": _digits(force), "moment_n_m": _digits(moment)}

    def table(self, point: OperatingPoint) -> dict[str, Any]:
        """Return its table in a scene that runs at an operating point."""
        return {**self.stated(point), "shaft": self.shaft, "position_mm": self.position_mm}


def _forces(layout: Layout, points: Sequence[OperatingPoint], shafts: SceneShafts) -> Iterator[_SceneForce]:
    """Yield the external loads that push or tilt a shaft at any of some operating points.

    The account says which are left out, and why.
    """
    names = Names()
    acting = {load for point in points for load, wrench in point.forces.items() if any(wrench)}
    for part in layout.unit.of_type("external_load"):
        if part.id not in acting:
            continue
        placed, reason = _placed(layout, part, shafts)
        if placed is None:
            _refuse(layout, part, reason)
            continue
        shaft, z = shafts.by_rotor[layout.rotor(placed.part.id)], layout.z_on(placed, part)
        position = shaft.position_mm(z)
        lever = z - shaft.begin - position * MM
        turn = layout.axes.turn(placed.place)
        part.say("", "taken", f"acts on shaft {shaft.name}")
        if part.number("width_of_external_load", "width of a line load, mm"):
            words = "a line load is not spread: its force acts at u_coordinate_on_shaft"
            part.say("width_of_external_load", "ignored", words)
        if abs(lever) <= SAME_PLACE:
            lever = 0.0
        else:
            words = (
                f"{abs(lever) / MM:.6g} mm beyond the end of its shaft: the force is there, with its moment"
            )
            part.say("u_coordinate_on_shaft", "derived", words)
        yield _SceneForce(names.of(part), shaft.name, position, part.id, turn, lever)


def _placed(layout: Layout, load: Part, shafts: SceneShafts) -> tuple[PlacedShaft | None, str]:
    """Return the shaft that a load acts on, or why its force cannot be one of the scene."""
    shaft = load.shaft
    if shaft is None:
        return None, "acts on no shaft"
    if shaft.id not in layout.shafts or layout.rotor(shaft.id) not in shafts.by_rotor:
        return None, "acts on a shaft that the scene has not"
    if shaft.id in {planet.id for planets in layout.rotors.sets for planet in planets.planets}:
        return None, "acts on a planet, and a scene has one for all of its set"
    placed = layout.shafts[shaft.id]
    axis = MM * np.array(shafts.by_rotor[layout.rotor(shaft.id)].table["origin_mm"][:2])
    if not np.hypot(*(np.array(placed.origin[:2]) - axis)) <= 1e2 * SAME_PLACE:
        return None, "acts off the axis of the planet carrier that its shaft is part of"
    return placed, ""


def _refuse(layout: Layout, load: Part, reason: str) -> None:
    """State of a load's forces and moments, its own and those of load cases, that they are left out."""
    cases = (part for case in layout.unit.load_cases() for part in case if part.id == load.id)
    for part in (load, *cases):
        for item in FORCES:
            if part.value(item):
                part.say(item, "refused", reason)


def _digits(vector: FloatArray) -> list[float]:
    least = ROUNDING * float(np.max(np.abs(vector)))
    return [0.0 if abs(value) <= least else rounded(value) for value in vector]


STANDARD_GRAVITY = 9.80665
"""m/s^2."""
PERIODS = 10
"""Of the slowest mesh in the run of the scene."""


@dataclass(frozen=True)
class SceneTable:
    """A scene as its file says it."""

    table: dict[str, Any]
    """Tables of a scene file; meshes name their case files."""
    leader: AppliedTorque | None
    """What drives it first."""
    forces: tuple[_SceneForce, ...]
    """The external loads that its forces are."""
    parts: SceneParts
    """The components that its parts are."""

    @staticmethod
    def of(layout: Layout, flows: Sequence[PowerFlow], cases: Sequence[StageCase]) -> SceneTable:
        """Return the scene at the operating point of the first flow; stages without a case are cut off."""
        flow = flows[0]
        by_stage, names = _by_stage(cases), Names()
        known = [stage for stage in layout.stages if stage.stage.id in by_stage]
        computed = [stage for stage in known if layout.is_computed(stage) and flow.moves(stage)]
        cut = [stage for stage in layout.stages if stage not in computed]
        shafts = SceneShafts.of(layout, computed, names)
        _say_without_mesh(layout, cases, computed, shafts)
        bearings = SceneBearings(layout, shafts)
        gears, meshes = scene_gears(layout, shafts, by_stage)
        motion = SceneMotion(flow, shafts, cut)
        forces = tuple(_forces(layout, [each.point for each in flows], shafts))
        table: dict[str, Any] = {
            "run": {"duration_s": _duration(layout, motion.slowest_mesh())},
            "gravity_m_per_s2": _gravity(layout),
            "shafts": [shaft.table for shaft in shafts.all],
            "gears": gears,
            "discs": scene_discs(layout, shafts),
            "bushings": bearings.bushings,
            "rolling_bearings": bearings.rolling_bearings,
            "planet_bearings": bearings.planet_bearings,
            "couplings": bearings.couplings,
            "housings": bearings.housings,
            "planets": _planets(layout, {shaft.rotor: shaft.name for shaft in shafts.by_rotor.values()}),
            "meshes": meshes,
            **motion.tables(),
            "forces": [force.table(flow.point) for force in forces],
        }
        named = [
            (mesh["name"], by_stage[stage.stage.id])
            for stage, mesh in zip(shafts.stages, meshes, strict=True)
        ]
        return SceneTable(
            {key: value for key, value in table.items() if value != []},
            motion.drivers[0] if motion.drivers else None,
            forces,
            _scene_parts(layout, flow, shafts, bearings.seats, named),
        )


def _by_stage(cases: Sequence[StageCase]) -> dict[int, StageCase]:
    """Return the case of each stage, of equal ones too."""
    return {stage: case for case in cases for stage in (case.stage, *case.equal)}


def _say_without_mesh(
    layout: Layout, cases: Sequence[StageCase], computed: Sequence[GearStage], shafts: SceneShafts
) -> None:
    """State which stages have a case but no mesh in the scene, but for those of equal planets."""
    meshed = {stage.stage.id for stage in shafts.stages}
    meshed |= {s.stage.id for s in computed} & {equal for case in cases for equal in case.equal}
    on_shafts = {stage.stage.id for stage in layout.stages}
    for number in _by_stage(cases).keys() - meshed:
        words = "it has a case and no mesh: its shafts are not parallel to those of the first stage, nothing "
        words += "places them or joins them to a speed, or they carry a planet unlike the first"
        layout.unit.part(number).say("", "refused", words if number in on_shafts else NO_STAGE)


def _duration(layout: Layout, rate: float) -> float:
    duration = float(f"{PERIODS / rate:.2g}") if rate > 0.0 else 1.0
    for part in layout.unit.of_type("gear_unit"):
        words = f"{duration:g} s, {PERIODS} periods of the slowest mesh: a REXS file states no run"
        part.say("run.duration_s", "defaulted", words)
    return duration


def _gravity(layout: Layout) -> list[float]:
    """Return the acceleration of gravity in x, y, z, m/s^2; none where the file does not account for it."""
    for part in layout.unit.of_type("gear_unit"):
        if part.value("account_for_gravity") is not True:
            continue
        if layout.rotors.sets:
            part.say("account_for_gravity", "refused", "a scene with a planet carrier's frame has no gravity")
            break
        part.say("account_for_gravity", "taken", "gravity of the scene")
        items = [f"direction_vector_gravity_{axis}" for axis in "uvw"]
        vector = np.array([part.number(item, "direction of gravity") or 0.0 for item in items])
        size = part.number("gravitational_acceleration", "gravity, m/s^2")
        length = float(np.linalg.norm(vector))
        if length == 0.0 or not math.isfinite(length):
            part.say("account_for_gravity", "refused", "the file gives gravity no direction")
            break
        place = Placement.of(part) or FIXED
        turned = layout.axes.turn(place) @ vector / length * (size or STANDARD_GRAVITY)
        return [float(value) + 0.0 for value in np.round(turned, 12)]
    return [0.0, 0.0, 0.0]


def _planets(layout: Layout, names: dict[int, str]) -> list[dict[str, Any]]:
    """Return how often the first planet of each set is there, and at which angles."""
    tables = []
    for planets in layout.rotors.sets:
        first = planets.planets[0]
        if first.id not in names:
            planets.stage.say("", "refused", "no stage of the scene has its planets")
            continue
        places = [layout.shafts[p.id].origin[:2] for p in planets.planets if p.id in layout.shafts]
        central = next((layout.shafts[c.id] for c in planets.central if c.id in layout.shafts), None)
        middle = np.mean(places, axis=0) if central is None else central.origin[:2]
        offsets = [place - middle for place in places]
        angles = [math.degrees(math.atan2(y, x)) for x, y in offsets]
        turned = sorted((angle - angles[0]) % 360.0 for angle in angles)
        table: dict[str, Any] = {"planet": names[first.id], "number": len(places)}
        equal = [index * 360.0 / len(places) for index in range(len(places))]
        if not np.allclose(turned, equal, atol=1e-6):
            table["angles_deg"] = turned
        for planet in planets.planets[1:]:
            for part in (planet, *planet.children("cylindrical_gear")):
                part.say("", "derived", f"copy of planet {names[first.id]}")
        tables.append(table)
    return tables
