"""From a scene file and its STE databases to the scene of dynamics."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence, Set
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, TypeVar

from pydantic import BaseModel

from bounds import inside
from dynamics.bearings import BallBearing, Bushing, CatalogLine, PlanetBearing, RollerBearing, RollingBearing
from dynamics.bearings.catalog import from_catalog
from dynamics.effects.ledger import mechanism_of
from dynamics.forces import SpeedTorque
from dynamics.forces.laws import STATED
from dynamics.identity_cache import cached_by, identity_cached
from dynamics.joints import Coupling, FreeRotation, Housing, ImposedRotation
from dynamics.loads import AngleLaw, AppliedForce, BySpeed, LoadTorque, Orders, SpeedCurve, TimeLaw, Unbalance
from dynamics.loads.load_course import CONSTANT, Course
from dynamics.mechanism import with_planets
from dynamics.mechanism.base_pitches import PRINTED
from dynamics.mechanism.kinematics import check_motion
from dynamics.meshes import CoastFlank, GearMesh, MeshTable
from dynamics.meshes.stiffness_table import PeriodicCurve, stiffness_table, straight_table
from dynamics.scene import Integration, Outputs, Scene
from dynamics.shafts import BeamSection, DiscBody, GearBody, Inertia, Shaft, hollow_cylinder
from dynamics.solid_housing import Material
from dynamics.temperatures import Temperatures
from fe_contact.ste import PairFacts, SteDatabase
from lineofaction.gearbox.convert.case import boundary_errors
from lineofaction.gearbox.convert.complaint import complaint_of
from lineofaction.gearbox.convert.declared import in_si, part_of
from lineofaction.gearbox.convert.errors import named
from lineofaction.gearbox.convert.housings import ANY_STIFFNESS, housing_of, placeholder
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas.bearings import BearingInput, BushingInput, RollingBearingInput
from lineofaction.gearbox.schemas.bodies import DiscInput, GearBodyInput, ShaftInput
from lineofaction.gearbox.schemas.housings import TemperaturesInput
from lineofaction.gearbox.schemas.loads import DriveInput, ForceInput, LoadTorqueInput, SpeedTorqueInput
from lineofaction.gearbox.schemas.meshes import CoastFlankInput, MeshInput, PeriodicInput, StiffnessMeshInput
from lineofaction.gearbox.schemas.scene import IntegrationInput, OutputsInput, SceneInput
from lineofaction.gearbox.units import DEGREE, MM, RPM, UM

if TYPE_CHECKING:
    from dynamics.housings import ReducedHousing

T = TypeVar("T")

# The gears that the meshes describe, and their axes.

_SAME = 1e-6  # relative; lengths that are typed with a few digits agree to this


@dataclass(frozen=True)
class _Teeth:
    """One gear as its mesh describes it; SI units, the helix angle with the hand's sign."""

    teeth: int
    base_radius: float
    base_helix_angle: float
    pitch_diameter: float
    face_width: float
    internal: bool = False


def _teeth_of(scene: SceneInput, facts: Mapping[str, PairFacts]) -> dict[str, _Teeth]:
    """Teeth of every gear, by name; a gear in two meshes must be the same in both."""
    by_name: dict[str, _Teeth] = {}
    for index, mesh in enumerate(scene.meshes):
        if mesh.wheel_drives and not facts[mesh.name].internal:
            bound = "left out: the wheel of this case is no ring gear"
            advice = "Give a case whose pinion is the gear that drives."
            raise BadInput.of(f"meshes[{index}].wheel_drives", True, bound, advice)
        for side, role in enumerate(("driven", "driver") if mesh.wheel_drives else ("driver", "driven")):
            name, teeth = getattr(mesh, role), _side(facts[mesh.name], side)
            known = by_name.setdefault(name, teeth)
            if known.teeth != teeth.teeth or not math.isclose(
                known.base_radius, teeth.base_radius, rel_tol=PRINTED
            ):
                bound = f"the gear of {known.teeth} teeth that its other mesh has ({teeth.teeth} teeth here)"
                raise BadInput.of(f"meshes[{index}].{role}", name, bound, "Check the cases of both meshes.")
    for index, gear in enumerate(scene.gears):
        if gear.name not in by_name:
            raise BadInput.of(
                f"gears[{index}].name", gear.name, "part of a mesh", "Add it to a mesh or remove it."
            )
    return by_name


def _side(facts: PairFacts, side: int) -> _Teeth:
    """Return one gear of a pair; the hands of external gears are opposite, those in a ring gear the same."""
    radius = facts.base_radius[side]
    hand = facts.helix_hand if side == 0 or facts.internal else -facts.helix_hand
    diameter = 2.0 * radius / math.cos(facts.working_pressure_angle)
    helix, ring = hand * facts.base_helix_angle, facts.internal and side == 1
    return _Teeth(facts.teeth[side], radius, helix, diameter, facts.face_width, ring)


def _check_center_distances(scene: SceneInput, facts: Mapping[str, PairFacts]) -> None:
    """Refuse axes of meshing gears that are not as far apart as their database says."""
    origin = {shaft.name: shaft.origin_mm for shaft in scene.shafts}
    carrier = {gear.name: gear.shaft for gear in scene.gears}
    number = {shaft.name: index for index, shaft in enumerate(scene.shafts)}
    for mesh in scene.meshes:
        first, second = origin[carrier[mesh.driver]], origin[carrier[mesh.driven]]
        distance = math.hypot(second[0] - first[0], second[1] - first[1])
        expected = facts[mesh.name].center_distance / MM
        if not math.isclose(distance, expected, rel_tol=_SAME):
            field = f"shafts[{number[carrier[mesh.driven]]}].origin_mm"
            bound = (
                f"{expected:.7g} mm across the axis from shaft {carrier[mesh.driver]}, not {distance:.7g} mm"
            )
            raise BadInput.of(field, list(second), bound, f"That is the center distance of mesh {mesh.name}.")


# Parts of a scene file in SI, each by its table; what a table shares with its part is not said here again.
# Scenes that have the same tables of a kind share its parts.


def _each(kind: str, made: Callable[[Any], T]) -> Callable[[tuple[BaseModel, ...]], tuple[T, ...]]:
    """Return what makes the parts of a kind; errors are named by the place in the list."""

    @identity_cached
    def of(tables: tuple[BaseModel, ...]) -> tuple[T, ...]:
        parts = []
        for index, table in enumerate(tables):
            with named(f"{kind}[{index}]"):
                parts.append(made(table))
        return tuple(parts)

    return of


def _plain(kind: type[T]) -> Callable[[BaseModel], T]:
    """Return what makes parts that share all their fields with their tables."""
    return lambda table: kind(**in_si(kind, table))


def _bushing(table: BushingInput) -> Bushing:
    """Return a bushing; force and moment of its preload where one of them is given."""
    force, moment = table.preload_force_n, table.preload_moment_n_m
    preload = None if force is None and moment is None else (*(force or (0.0,) * 3), *(moment or (0.0,) * 2))
    return Bushing(**in_si(Bushing, table), preload=preload)


def _rolling_bearing_of(table: RollingBearingInput) -> RollingBearing:
    """Return a rolling bearing, its row as written or by its catalog line."""
    row = part_of(BallBearing, table.ball, "ball") or part_of(RollerBearing, table.roller, "roller")
    if row is None:
        assert table.catalog is not None  # the schema comes first
        with inside("catalog"):
            row = from_catalog(**in_si(CatalogLine, table.catalog))
    return RollingBearing(**in_si(RollingBearing, table), row=row)


@cached_by(lambda scene: (*scene.bushings, "", *scene.planet_bearings))
def _laws(scene: SceneInput) -> dict[str, Any]:
    """Return what all bearings do that is not linear, by the kinds of `StatedLaws`."""
    return {kind: tuple(_laws_of(kind, scene)) for kind in STATED}


def _laws_of(kind: str, scene: SceneInput) -> Iterator[Any]:
    for path, bearing in _bearings(scene):
        for name, table in bearing.laws[kind].items():
            with named(f"{path}.{name}"):
                yield STATED[kind](bushing=bearing.name, **in_si(STATED[kind], table) | table.renamed)


def _bearings(scene: SceneInput) -> Iterator[tuple[str, BearingInput]]:
    yield from ((f"bushings[{index}]", part) for index, part in enumerate(scene.bushings))
    yield from ((f"planet_bearings[{index}]", part) for index, part in enumerate(scene.planet_bearings))


@identity_cached
def _shafts(tables: tuple[ShaftInput, ...]) -> tuple[Shaft, ...]:
    """Return the shafts; a diameter is one section of steel, an inertia alone is rigid."""
    shafts = []
    for index, table in enumerate(tables):
        sections = _sections(index, table)
        with named(f"shafts[{index}]"):
            inertia = part_of(Inertia, table.inertia, "inertia") or Inertia()
            shafts.append(Shaft(**in_si(Shaft, table), inertia=inertia, sections=sections))
    return tuple(shafts)


def _sections(index: int, shaft: ShaftInput) -> tuple[BeamSection, ...]:
    """Return the pieces; their lengths, which agree with the shaft's, to the last digit."""
    if shaft.diameter_mm is not None:
        return (BeamSection(shaft.length_mm * MM, shaft.diameter_mm * MM),)
    parts = shaft.sections or ()
    together = sum(part.length_mm for part in parts)
    sections = []
    for number, part in enumerate(parts):
        with named(f"shafts[{index}].sections[{number}]"):
            length = part.length_mm * (shaft.length_mm / together) * MM
            sections.append(BeamSection(**in_si(BeamSection, part) | {"length": length}))
    return tuple(sections)


def _disc(table: DiscInput) -> DiscBody:
    inertia = part_of(Inertia, table.inertia, "inertia") or Inertia()
    placed = DiscBody(**in_si(DiscBody, table), inertia=inertia)
    if table.cylinder is None:
        return placed
    size = table.cylinder
    with inside("cylinder"):
        steel = hollow_cylinder(size.outer_diameter_mm * MM, size.width_mm * MM, size.bore_diameter_mm * MM)
        return replace(placed, inertia=steel)


@identity_cached
def _gears(tables: tuple[GearBodyInput, ...], teeth: tuple[_Teeth, ...]) -> tuple[GearBody, ...]:
    gears = []
    for index, (table, own) in enumerate(zip(tables, teeth, strict=True)):
        with named(f"gears[{index}]"):
            gears.append(_gear(table, own))
    return tuple(gears)


def _gear(table: GearBodyInput, teeth: _Teeth) -> GearBody:
    inertia = part_of(Inertia, table.inertia, "inertia")
    if inertia is None:
        inertia = hollow_cylinder(teeth.pitch_diameter, teeth.face_width, table.bore_diameter_mm * MM)
    own = {name: value for name, value in vars(teeth).items() if name != "pitch_diameter"}
    return GearBody(**in_si(GearBody, table), **own, inertia=inertia)


def _mesh(index: int, mesh: MeshInput, table: MeshTable, base_pitch: float) -> GearMesh:
    with named(f"meshes[{index}]"):
        return GearMesh(
            **in_si(GearMesh, mesh), table=table, coast=_coast_flank(mesh.coast_flank, base_pitch)
        )


def _coast_flank(flank: CoastFlankInput | None, base_pitch: float) -> CoastFlank | None:
    """Return the coast flank; teeth that are equally thick share the pitch less the backlash."""
    if flank is None:
        return None
    backlash = flank.backlash_um * UM
    thickness = flank.tooth_thickness
    with named("coast_flank"):
        return CoastFlank(backlash, 0.5 * (1.0 - backlash / base_pitch) if thickness is None else thickness)


def _drive(table: DriveInput) -> ImposedRotation:
    law: TimeLaw | AngleLaw
    if table.angle_deg is not None:
        law = AngleLaw(table.time_s, tuple(value * DEGREE for value in table.angle_deg))
    else:
        law = TimeLaw(table.time_s, tuple(v * RPM for v in table.speed_rpm or ()), table.course)
    return ImposedRotation(**in_si(ImposedRotation, table) | {"speed": law})


def _load_torque(table: LoadTorqueInput) -> LoadTorque:
    law = TimeLaw(table.time_s, table.torque_n_m, table.course)
    return LoadTorque(**in_si(LoadTorque, table) | {"torque": law})


def _speed_torque(table: SpeedTorqueInput) -> SpeedTorque:
    speed = [value * RPM for value in table.speed_rpm]
    if table.kind == "table":
        curve = SpeedCurve.table(speed, table.torque_n_m)
    elif table.kind == "quadratic":
        curve = SpeedCurve.quadratic(table.torque_n_m[0], speed[0])
    else:
        curve = SpeedCurve.constant(table.torque_n_m[0], speed[0])
    return SpeedTorque(**in_si(SpeedTorque, table), curve=curve)


def _force(table: ForceInput) -> AppliedForce:
    return AppliedForce(**in_si(AppliedForce, table) | {"course": _course(table)})


def _course(force: ForceInput) -> Course:
    shaft, factor = force.of_shaft or force.shaft, force.factor or ()
    if force.time_s is not None:
        return TimeLaw(force.time_s, factor, force.course)
    if force.speed_rpm is not None:
        return BySpeed(SpeedCurve.table([value * RPM for value in force.speed_rpm], factor), shaft)
    if force.orders is not None:
        phases = force.phase_deg or (0.0,) * len(force.orders)
        angles = tuple(phase * DEGREE for phase in phases)
        return Orders(shaft, force.orders, force.amplitude or (), angles, force.mean)
    return CONSTANT if force.turn_factor is None else Orders.table(shaft, force.turn_factor)


_ALONE: Mapping[str, Callable[[Any], tuple[Any, ...]]] = {
    kind: _each(kind, made)
    for kind, made in {
        "discs": _disc,
        "bushings": _bushing,
        "drives": _drive,
        "planet_bearings": _plain(PlanetBearing),
        "couplings": _plain(Coupling),
        "speed_torques": _speed_torque,
        "free_rotations": _plain(FreeRotation),
        "rolling_bearings": _rolling_bearing_of,
        "loads": _load_torque,
        "forces": _force,
        "unbalances": _plain(Unbalance),
    }.items()
}
"""What makes the parts of each kind that follow from their tables alone."""


def _has_bent_shafts(database: SteDatabase) -> bool:
    ledger = database.metadata.effect_ledger
    entries = ledger if isinstance(ledger, list) else ledger.get("entries", [])
    return any(
        isinstance(e, Mapping) and e.get("name") == "shaft_deflection" and e.get("on") for e in entries
    )


# Meshes in closed form: the facts of their gears and their tables.


def _closed_forms(scene: SceneInput) -> dict[str, tuple[PairFacts, MeshTable]]:
    """Return facts and table of every mesh that states its stiffness, by name."""
    return {
        mesh.name: (_facts(f"meshes[{index}].stiffness", mesh.stiffness), _table(index, mesh.stiffness))
        for index, mesh in enumerate(scene.meshes)
        if mesh.stiffness is not None
    }


def _facts(field: str, mesh: StiffnessMeshInput) -> PairFacts:
    """Return the facts of the pair: base radii in the ratio of the teeth, the center distance from them."""
    pinion, wheel = mesh.teeth
    if mesh.internal and wheel <= pinion:
        raise BadInput.of(
            f"{field}.teeth", list(mesh.teeth), "more teeth of the ring gear than of its pinion"
        )
    radius = mesh.base_radius_mm * MM
    radii = (radius, radius * wheel / pinion)
    angle, helix = mesh.working_pressure_angle_deg * DEGREE, mesh.base_helix_angle_deg * DEGREE
    return PairFacts(
        teeth=(pinion, wheel),
        base_radius=radii,
        base_pitch=2.0 * math.pi * radius / pinion,
        base_helix_angle=abs(helix),
        center_distance=(radii[1] + (-radius if mesh.internal else radius)) / math.cos(angle),
        working_pressure_angle=angle,
        face_width=mesh.face_width_mm * MM,
        helix_hand=(helix > 0.0) - (helix < 0.0),
        internal=mesh.internal,
    )


def _table(index: int, mesh: StiffnessMeshInput) -> MeshTable:
    stiffness, error = mesh.stiffness_n_per_m, mesh.transmission_error_um
    where = f"meshes[{index}].stiffness"
    with named(f"{where}.stiffness_n_per_m"):
        of_stiffness = _curve(stiffness, 1.0)
    with named(f"{where}.transmission_error_um"):
        of_error = None if error is None else _curve(error, UM)
    with named(f"{where}.stiffness_n_per_m"):
        return stiffness_table(of_stiffness, of_error)


def _curve(law: PeriodicInput, unit: float) -> PeriodicCurve:
    value = [number * unit for number in law.value]
    if law.position is not None:
        return PeriodicCurve.tabulated(law.position, value)
    if law.amplitude is None:
        return PeriodicCurve.constant(value[0])
    phases = law.phase_deg or (0.0,) * len(law.amplitude)
    sizes = [number * unit for number in law.amplitude]
    return PeriodicCurve.harmonic(value[0], sizes, [phase * DEGREE for phase in phases])


NO_SOLIDS: Mapping[str, ReducedHousing] = {}


@dataclass(frozen=True)
class TabledScene:
    """A scene with its tables.

    Attributes
    ----------
    inputs : SceneInput
        As it was written, the cases of its meshes written out.
    databases : mapping of str to SteDatabase
        By name of the mesh.
    scene : Scene
        What they make, in SI.
    housings : mapping of str to ReducedHousing
        By name of the housing: of those that have a solid, or a file of modes on the caller's disk.
    seconds : float
        CPU seconds of tables and housings that were made for it.
    """

    inputs: SceneInput
    databases: Mapping[str, SteDatabase]
    scene: Scene
    housings: Mapping[str, ReducedHousing] = field(default_factory=dict)
    seconds: float = 0.0


def dynamic_scene(
    scene: SceneInput,
    databases: Mapping[str, SteDatabase],
    reduced: Mapping[str, ReducedHousing] = NO_SOLIDS,
) -> Scene:
    """Return the scene in SI.

    Parameters
    ----------
    databases : mapping of str to SteDatabase
        By name of the mesh; of all meshes that do not state their stiffness.
    reduced : mapping of str to ReducedHousing
        By name of the housing; of all housings that are given by their solids.

    Raises
    ------
    BadInput
        No such system; named by the scene file's fields, in its units.
    JobFailed
        A database has failed points.
    """
    facts = {name: database.facts for name, database in databases.items()}
    with boundary_errors():
        tables: dict[str, MeshTable] = {name: table.force_table() for name, table in databases.items()}
    housings = [housing_of(i, part, reduced.get(part.name)) for i, part in enumerate(scene.housings)]
    bent = {name for name, database in databases.items() if _has_bent_shafts(database)}
    return _moving(scene, facts, tables, housings, bent)


def check_scene(scene: SceneInput, facts: Mapping[str, PairFacts]) -> Scene:
    """Return the scene on placeholders for its tables and for the matrices of solids.

    Parameters
    ----------
    facts : mapping of str to PairFacts
        By name of the mesh.

    Raises
    ------
    BadInput
        No such system exists or moves, or nothing of it passes where it is complained of.
    """
    tables = dict.fromkeys(facts, straight_table(ANY_STIFFNESS))
    housings = [placeholder(i, part) for i, part in enumerate(scene.housings)]
    moving = _moving(scene, facts, tables, housings)
    if scene.complaint is not None:
        complaint_of(scene, moving)
    return moving


def _moving(
    scene: SceneInput,
    facts: Mapping[str, PairFacts],
    tables: Mapping[str, MeshTable],
    housings: Sequence[Housing],
    bent: Set[str] = frozenset(),
) -> Scene:
    """Return the scene with all its planets, its parts checked one by one, together, and in motion.

    Facts and tables are those of the meshes with a database, `bent` the names of those whose tables have the
    bending of their shafts in them.
    """
    closed = _closed_forms(scene)
    facts = {**facts, **{name: pair for name, (pair, _) in closed.items()}}
    tables = {**tables, **{name: table for name, (_, table) in closed.items()}}
    stated = (
        _mesh(i, mesh, tables[mesh.name], facts[mesh.name].base_pitch) for i, mesh in enumerate(scene.meshes)
    )
    meshes = tuple(replace(mesh, bent_shafts=mesh.name in bent) for mesh in stated)
    one_of_each = _assembled(scene, facts, meshes, housings)
    with named(""):
        check_motion(one_of_each)
    whole = _with_all_planets(scene, one_of_each)
    with named(""):
        mechanism_of(whole)
    return whole


def _assembled(
    scene: SceneInput,
    facts: Mapping[str, PairFacts],
    meshes: tuple[GearMesh, ...],
    housings: Sequence[Housing],
) -> Scene:
    teeth = _teeth_of(scene, facts)
    _check_center_distances(scene, facts)
    with named("temperatures"):
        temperatures = _temperatures(scene.temperatures)
    with named(""):
        return Scene(
            **in_si(Scene, scene, scene.run, scene.accuracy),
            shafts=_shafts(scene.shafts),
            gears=_gears(scene.gears, tuple(teeth[gear.name] for gear in scene.gears)),
            meshes=meshes,
            housings=tuple(housings),
            **{kind: parts(getattr(scene, kind)) for kind, parts in _ALONE.items()},
            **_laws(scene),
            temperatures=temperatures,
            outputs=_outputs(scene.outputs),
            integration=_integration(scene.integration),
        )


@identity_cached
def _outputs(table: OutputsInput) -> Outputs:
    with named("outputs"):
        return Outputs(**in_si(Outputs, table))


@identity_cached
def _integration(table: IntegrationInput) -> Integration:
    with named("integration"):
        return Integration(**in_si(Integration, table))


@identity_cached
def _temperatures(table: TemperaturesInput | None) -> Temperatures | None:
    if table is None:
        return None
    material = part_of(Material, table.housing_material, "housing_material")
    return Temperatures(**in_si(Temperatures, table) | {"housing_material": material})


def _with_all_planets(inputs: SceneInput, scene: Scene) -> Scene:
    for index, planets in enumerate(inputs.planets):
        angles = None if planets.angles_deg is None else [angle * DEGREE for angle in planets.angles_deg]
        errors = None
        if planets.radial_errors_um is not None or planets.tangential_errors_um is not None:
            none = (0.0,) * planets.number
            away, across = planets.radial_errors_um or none, planets.tangential_errors_um or none
            errors = [(r * UM, t * UM) for r, t in zip(away, across, strict=True)]
        with named(f"planets[{index}]"):
            scene = with_planets(scene, planets.planet, planets.number, angles, errors)
    return scene
