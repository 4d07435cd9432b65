"""Conversion of the tables of a scene file to parts in SI, by the fields that both declare.

Scenes that have the same tables of a kind share its parts: they are made once, and the same objects.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any, TypeVar

from pydantic import BaseModel

from bounds import inside
from dynamics.bearings import BallBearing, Bushing, CatalogLine, PlanetBearing, RollerBearing, RollingBearing
from dynamics.bearings.catalog import from_catalog
from dynamics.forces import SpeedTorque
from dynamics.forces.laws import BEARING_PARTS
from dynamics.identity_cache import cached_by, identity_cached
from dynamics.joints import Coupling, FreeRotation, ImposedRotation
from dynamics.loads import AngleLaw, AppliedForce, BySpeed, LoadTorque, Orders, SpeedCurve, TimeLaw, Unbalance
from dynamics.loads.load_course import CONSTANT, Course
from dynamics.meshes import CoastFlank, GearMesh, MeshTable
from dynamics.scene import Integration, Outputs
from dynamics.shafts import BeamSection, DiscBody, GearBody, Inertia, Shaft, hollow_cylinder
from dynamics.solid_housing import Material
from dynamics.temperatures import Temperatures
from lineofaction.gearbox.convert.boundary_errors import named
from lineofaction.gearbox.convert.declared import in_si, part_of
from lineofaction.gearbox.schemas.bearings import BearingInput, BushingInput, RollingBearingInput
from lineofaction.gearbox.schemas.bodies import DiscInput, GearBodyInput
from lineofaction.gearbox.schemas.closed_form_meshes import CoastFlankInput
from lineofaction.gearbox.schemas.forces import ForceInput
from lineofaction.gearbox.schemas.housing_solid import TemperaturesInput
from lineofaction.gearbox.schemas.loads import DriveInput, LoadTorqueInput, SpeedTorqueInput
from lineofaction.gearbox.schemas.meshes import MeshInput
from lineofaction.gearbox.schemas.scene import IntegrationInput, OutputsInput, SceneInput
from lineofaction.gearbox.schemas.shafts import ShaftInput
from lineofaction.gearbox.units import DEGREE, MM, RPM, UM

T = TypeVar("T")


@dataclass(frozen=True)
class GearTeeth:
    """One gear as its mesh describes it; SI units, the helix angle with the hand's sign."""

    teeth: int
    base_radius: float
    base_helix_angle: float
    pitch_diameter: float
    face_width: float
    internal: bool = False
    base_tooth_thickness: float | None = None


def _parts_of_kind(kind: str, made: Callable[[Any], T]) -> Callable[[tuple[BaseModel, ...]], tuple[T, ...]]:
    """Return a function that makes the parts of a kind; errors name the place in the list."""

    @identity_cached
    def of(tables: tuple[BaseModel, ...]) -> tuple[T, ...]:
        parts = []
        for index, table in enumerate(tables):
            with named(f"{kind}[{index}]"):
                parts.append(made(table))
        return tuple(parts)

    return of


def _plain(kind: type[T]) -> Callable[[BaseModel], T]:
    """Return a function that makes parts which share all their fields with their tables."""
    return lambda table: kind(**in_si(kind, table))


def _bushing(table: BushingInput) -> Bushing:
    """Return a bushing; force and moment of its preload where one of them is given."""
    force, moment = table.preload_force_n, table.preload_moment_n_m
    preload = None if force is None and moment is None else (*(force or (0.0,) * 3), *(moment or (0.0,) * 2))
    return Bushing(**in_si(Bushing, table), preload=preload)


def rolling_bearing_of(table: RollingBearingInput) -> RollingBearing:
    """Return a rolling bearing, its row as written or by its catalog line."""
    row = part_of(BallBearing, table.ball, "ball") or part_of(RollerBearing, table.roller, "roller")
    if row is None:
        assert table.catalog is not None  # the schema comes first
        with inside("catalog"):
            row = from_catalog(**in_si(CatalogLine, table.catalog))
    return RollingBearing(**in_si(RollingBearing, table), row=row)


@cached_by(lambda scene: (scene.bushings, scene.planet_bearings))
def _laws(scene: SceneInput) -> dict[str, Any]:
    """Return the nonlinear laws of all bearings, by the kinds of `BearingLawParts`."""
    return {kind: tuple(_laws_of(kind, scene)) for kind in BEARING_PARTS}


def _laws_of(kind: str, scene: SceneInput) -> Iterator[Any]:
    for path, bearing in _bearings(scene):
        for name, table in bearing.laws[kind].items():
            with named(f"{path}.{name}"):
                yield BEARING_PARTS[kind](
                    bushing=bearing.name, **in_si(BEARING_PARTS[kind], table) | table.renamed
                )


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
def _gears(tables: tuple[GearBodyInput, ...], teeth: tuple[GearTeeth, ...]) -> tuple[GearBody, ...]:
    gears = []
    for index, (table, toothing) in enumerate(zip(tables, teeth, strict=True)):
        with named(f"gears[{index}]"):
            gears.append(_gear(table, toothing))
    return tuple(gears)


def _gear(table: GearBodyInput, teeth: GearTeeth) -> GearBody:
    inertia = part_of(Inertia, table.inertia, "inertia")
    if inertia is None:
        inertia = hollow_cylinder(teeth.pitch_diameter, teeth.face_width, table.bore_diameter_mm * MM)
    sizes = {name: value for name, value in vars(teeth).items() if name != "pitch_diameter"}
    return GearBody(**in_si(GearBody, table), **sizes, inertia=inertia)


@identity_cached
def meshes_of(
    pairs: tuple[tuple[MeshInput, MeshTable], ...], base_pitch: tuple[float, ...], bent: tuple[bool, ...]
) -> tuple[GearMesh, ...]:
    """Return the meshes of a scene file on their tables.

    Parameters
    ----------
    base_pitch : tuple of float
        Base pitch of each, m.
    bent : tuple of bool
        Whether the bending of its shafts is in the table.
    """
    meshes = []
    for index, ((mesh, table), pitch, shafts) in enumerate(zip(pairs, base_pitch, bent, strict=True)):
        with named(f"meshes[{index}]"):
            coast = _coast_flank(mesh.coast_flank, pitch)
            meshes.append(GearMesh(**in_si(GearMesh, mesh), table=table, coast=coast, bent_shafts=shafts))
    return tuple(meshes)


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
    with named("temperatures"):
        material = part_of(Material, table.housing_material, "housing_material")
        return Temperatures(**in_si(Temperatures, table) | {"housing_material": material})


_ALONE: Mapping[str, Callable[[Any], Any]] = {
    "discs": _disc,
    "bushings": _bushing,
    "drives": _drive,
    "planet_bearings": _plain(PlanetBearing),
    "couplings": _plain(Coupling),
    "speed_torques": _speed_torque,
    "free_rotations": _plain(FreeRotation),
    "rolling_bearings": rolling_bearing_of,
    "loads": _load_torque,
    "forces": _force,
    "unbalances": _plain(Unbalance),
}
"""Functions that make a part from its table alone, by kind of part."""
_LISTS = {kind: _parts_of_kind(kind, made) for kind, made in _ALONE.items()}


def parts_of(scene: SceneInput, teeth: tuple[GearTeeth, ...]) -> dict[str, Any]:
    """Return the fields of the dynamic scene that hold its parts and settings, but meshes and housings.

    `teeth` are those of its gears. Raises `BadInput`, named by the fields of the file.
    """
    return {
        "shafts": _shafts(scene.shafts),
        "gears": _gears(scene.gears, teeth),
        **{kind: parts(getattr(scene, kind)) for kind, parts in _LISTS.items()},
        **_laws(scene),
        "temperatures": _temperatures(scene.temperatures),
        "outputs": _outputs(scene.outputs),
        "integration": _integration(scene.integration),
    }
