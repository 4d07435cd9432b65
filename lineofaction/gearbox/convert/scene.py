"""From a scene file and its STE databases to the scene of dynamics."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from bounds import inside
from dynamics.bearings import BallBearing, Bushing, CatalogLine, PlanetBearing, RollerBearing, RollingBearing
from dynamics.bearings.catalog import from_catalog
from dynamics.effects.ledger import mechanism_of
from dynamics.forces import RollingContact, SpringCurve
from dynamics.joints import Coupling, FreeRotation, Housing, ImposedRotation
from dynamics.loads import AngleLaw, TimeLaw
from dynamics.mechanism import with_planets
from dynamics.mechanism.motion_check import check_motion
from dynamics.meshes import CoastFlank, GearMesh, MeshTable, straight_table
from dynamics.scene import Integration, Outputs, Scene
from dynamics.shafts import BeamSection, DiscBody, GearBody, Inertia, Shaft, hollow_cylinder
from fe_contact.ste import PairFacts, SteDatabase
from lineofaction.gearbox.convert.case import boundary_errors
from lineofaction.gearbox.convert.closed_form import closed_forms
from lineofaction.gearbox.convert.declared import declared_part, in_si
from lineofaction.gearbox.convert.errors import named
from lineofaction.gearbox.convert.housings import housing_of, stand_in
from lineofaction.gearbox.convert.loads import force_of, load_torque_of, speed_torque_of, unbalance_of
from lineofaction.gearbox.convert.topology import Teeth, check_center_distances, teeth_of
from lineofaction.gearbox.schemas.scene import DiscInput, SceneInput, ShaftInput
from lineofaction.gearbox.schemas.scene_bearings import RollingBearingInput
from lineofaction.gearbox.schemas.scene_bodies import (
    BearingInput,
    BushingInput,
    CouplingInput,
    GearBodyInput,
    PlanetBearingInput,
)
from lineofaction.gearbox.schemas.scene_meshes import CoastFlankInput, MeshInput
from lineofaction.gearbox.schemas.scene_motion import DriveInput, FreeRotationInput
from lineofaction.gearbox.units import DEGREE, MM, MRAD, RPM, UM

if TYPE_CHECKING:
    from dynamics.housings import ReducedHousing

# Bearings of a scene file in SI: bushings, planet bearings, and what they do that is not linear.


def _bushing_of(index: int, bushing: BushingInput) -> Bushing:
    """Return a bushing."""
    with named(f"bushings[{index}]"):
        return Bushing(
            name=bushing.name,
            shaft=bushing.shaft,
            stiffness=bushing.stiffness_matrix,
            damping=bushing.damping_matrix,
            preload=_preload(bushing),
            **in_si(Bushing, bushing),
        )


def _preload(bushing: BushingInput) -> tuple[float, ...] | None:
    """Force and moment on the shaft; None where neither is given."""
    if bushing.preload_force_n is None and bushing.preload_moment_n_m is None:
        return None
    return (*(bushing.preload_force_n or (0.0,) * 3), *(bushing.preload_moment_n_m or (0.0,) * 2))


def rolling_bearing_of(index: int, bearing: RollingBearingInput) -> RollingBearing:
    """Return a rolling bearing, its row as written or by its catalog line."""
    with named(f"rolling_bearings[{index}]"):
        own = in_si(RollingBearing, bearing)
        return RollingBearing(bearing.name, bearing.shaft, _row(bearing), **own)


def _row(bearing: RollingBearingInput) -> BallBearing | RollerBearing:
    if bearing.ball is not None:
        with inside("ball"):
            return BallBearing(**in_si(BallBearing, bearing.ball))
    if bearing.roller is not None:
        with inside("roller"):
            return RollerBearing(**in_si(RollerBearing, bearing.roller))
    assert bearing.catalog is not None  # the schema comes first
    with inside("catalog"):
        return from_catalog(**in_si(CatalogLine, bearing.catalog))


def rolling_contacts_of(scene: SceneInput) -> Iterator[RollingContact]:
    """Yield the rolling contacts of all bearings."""
    for path, bearing in _bearings(scene):
        law = bearing.rolling_contact
        if law is not None:
            with named(f"{path}.rolling_contact"):
                yield RollingContact(
                    bearing.name,
                    law.stiffness_n_per_m_n,
                    law.exponent,
                    law.radial_clearance_um * UM,
                    law.damping_n_s_per_m,
                    law.damping_ratio,
                )


def spring_curves_of(scene: SceneInput) -> Iterator[SpringCurve]:
    """Yield the curves of all bearings."""
    for path, bearing in _bearings(scene):
        for number, curve in enumerate(bearing.spring_curves):
            ways = tuple(value * UM for value in curve.displacement_um or ())
            ways = ways or tuple(value * MRAD for value in curve.tilt_mrad or ())
            with named(f"{path}.spring_curves[{number}]"):
                yield SpringCurve(
                    bearing.name, curve.direction, ways, tuple(curve.force_n or curve.moment_n_m or ())
                )


def planet_bearing_of(index: int, bearing: PlanetBearingInput) -> PlanetBearing:
    """Return a planet's bearing."""
    with named(f"planet_bearings[{index}]"):
        return PlanetBearing(
            name=bearing.name,
            shaft=bearing.shaft,
            carrier=bearing.carrier,
            stiffness=bearing.stiffness_matrix,
            damping=bearing.damping_matrix,
            **in_si(PlanetBearing, bearing),
        )


def _bearings(scene: SceneInput) -> Iterator[tuple[str, BearingInput]]:
    yield from ((f"bushings[{index}]", part) for index, part in enumerate(scene.bushings))
    yield from ((f"planet_bearings[{index}]", part) for index, part in enumerate(scene.planet_bearings))


# Shafts of a scene file, and the discs on them, in the terms of dynamics.


def _shaft_of(index: int, shaft: ShaftInput) -> Shaft:
    """Return a shaft; a diameter is one section of steel, an inertia alone is rigid."""
    x, y, z = shaft.origin_mm
    sections = _sections(index, shaft)
    with named(f"shafts[{index}]"):
        return Shaft(
            name=shaft.name,
            origin=(x * MM, y * MM, z * MM),
            inertia=declared_part(Inertia, shaft.inertia, "inertia") or Inertia(),
            frame=shaft.frame,
            sections=sections,
            **in_si(Shaft, shaft),
        )


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


def _disc_of(index: int, disc: DiscInput) -> DiscBody:
    field = f"discs[{index}]"
    with named(field):
        inertia = declared_part(Inertia, disc.inertia, "inertia") or Inertia()
        placed = DiscBody(disc.name, disc.shaft, inertia=inertia, **in_si(DiscBody, disc))
    if disc.cylinder is None:
        return placed
    size = disc.cylinder
    with named(f"{field}.cylinder"):
        steel = hollow_cylinder(size.outer_diameter_mm * MM, size.width_mm * MM, size.bore_diameter_mm * MM)
        return replace(placed, inertia=steel)


def _has_bent_shafts(database: SteDatabase) -> bool:
    """Return whether a table has the bending of its gears' shafts in it."""
    ledger = database.metadata.effect_ledger
    entries = ledger if isinstance(ledger, list) else ledger.get("entries", [])
    return any(
        isinstance(e, Mapping) and e.get("name") == "shaft_deflection" and e.get("on") for e in entries
    )


ANY_STIFFNESS = 1e8  # N/m; checks that need no table do not read it
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
    scene : SceneInput
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
    moving = _moving(scene, facts, tables, housings)
    bent = {name for name, database in databases.items() if _has_bent_shafts(database)}
    meshes = tuple(replace(mesh, bent_shafts=mesh.name in bent) for mesh in moving.meshes)
    return replace(moving, meshes=meshes)


def check_scene(scene: SceneInput, facts: Mapping[str, PairFacts]) -> Scene:
    """Return the scene on placeholders for its tables and for the matrices of solids.

    Parameters
    ----------
    scene : SceneInput
    facts : mapping of str to PairFacts
        By name of the mesh.

    Raises
    ------
    BadInput
        No such system exists or moves.
    """
    tables = dict.fromkeys(facts, straight_table(ANY_STIFFNESS))
    return _moving(scene, facts, tables, [stand_in(i, part) for i, part in enumerate(scene.housings)])


def _moving(
    scene: SceneInput,
    facts: Mapping[str, PairFacts],
    tables: Mapping[str, MeshTable],
    housings: Sequence[Housing],
) -> Scene:
    """Return the scene with all its planets, its parts checked one by one, together, and in motion.

    Facts and tables are those of the meshes with a database.
    """
    closed = closed_forms(scene)
    facts = {**facts, **{name: pair for name, (pair, _) in closed.items()}}
    tables = {**tables, **{name: table for name, (_, table) in closed.items()}}
    meshes = tuple(
        _mesh(i, mesh, tables[mesh.name], facts[mesh.name].base_pitch) for i, mesh in enumerate(scene.meshes)
    )
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
    """Return the scene with its parts checked one by one and together."""
    teeth = teeth_of(scene, facts)
    check_center_distances(scene, facts)
    x, y, z = scene.gravity_m_per_s2
    gears = tuple(_gear(i, gear, teeth[gear.name]) for i, gear in enumerate(scene.gears))
    with named("outputs"):
        outputs = Outputs(**in_si(Outputs, scene.outputs))
    with named("integration"):
        integration = Integration(**in_si(Integration, scene.integration))
    with named(""):
        return Scene(
            shafts=tuple(_shaft_of(i, shaft) for i, shaft in enumerate(scene.shafts)),
            gears=gears,
            discs=tuple(_disc_of(i, disc) for i, disc in enumerate(scene.discs)),
            bushings=tuple(_bushing_of(i, bushing) for i, bushing in enumerate(scene.bushings)),
            meshes=meshes,
            drives=tuple(_drive(i, drive) for i, drive in enumerate(scene.drives)),
            planet_bearings=tuple(planet_bearing_of(i, b) for i, b in enumerate(scene.planet_bearings)),
            couplings=tuple(_coupling(i, part) for i, part in enumerate(scene.couplings)),
            speed_torques=tuple(speed_torque_of(i, part) for i, part in enumerate(scene.speed_torques)),
            free_rotations=tuple(_free_rotation(i, part) for i, part in enumerate(scene.free_rotations)),
            housings=tuple(housings),
            rolling_bearings=tuple(rolling_bearing_of(i, b) for i, b in enumerate(scene.rolling_bearings)),
            rolling_contacts=tuple(rolling_contacts_of(scene)),
            spring_curves=tuple(spring_curves_of(scene)),
            loads=tuple(load_torque_of(i, load) for i, load in enumerate(scene.loads)),
            forces=tuple(force_of(i, force) for i, force in enumerate(scene.forces)),
            unbalances=tuple(unbalance_of(i, part) for i, part in enumerate(scene.unbalances)),
            duration=scene.run.duration_s,
            gravity=(x, y, z),
            effects=dict(scene.effects),
            outputs=outputs,
            integration=integration,
            on_violation=scene.run.on_violation,
            tolerance=scene.accuracy.tolerance,
        )


def _gear(index: int, gear: GearBodyInput, teeth: Teeth) -> GearBody:
    with named(f"gears[{index}]"):
        inertia = declared_part(Inertia, gear.inertia, "inertia")
        if inertia is None:
            inertia = hollow_cylinder(teeth.pitch_diameter, teeth.face_width, gear.bore_diameter_mm * MM)
        return GearBody(
            name=gear.name,
            shaft=gear.shaft,
            teeth=teeth.teeth,
            base_radius=teeth.base_radius,
            face_width=teeth.face_width,
            base_helix_angle=teeth.base_helix_angle,
            inertia=inertia,
            internal=teeth.internal,
            **in_si(GearBody, gear),
        )


def _coupling(index: int, coupling: CouplingInput) -> Coupling:
    with named(f"couplings[{index}]"):
        return Coupling(
            name=coupling.name,
            first=coupling.first,
            second=coupling.second,
            stiffness=coupling.stiffness_matrix,
            damping=coupling.damping_matrix,
            **in_si(Coupling, coupling),
        )


def _with_all_planets(inputs: SceneInput, scene: Scene) -> Scene:
    """Return the scene with every planet there as often as requested."""
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


def _mesh(index: int, mesh: MeshInput, table: MeshTable, base_pitch: float) -> GearMesh:
    with named(f"meshes[{index}]"):
        return GearMesh(
            name=mesh.name,
            driver=mesh.driver,
            driven=mesh.driven,
            table=table,
            technique=mesh.technique,
            damping=mesh.damping_n_s_per_m,
            damping_ratio=mesh.damping_ratio,
            nominal_force=mesh.nominal_force_n,
            position_offset=mesh.position_offset,
            misalignment=mesh.misalignment_um * UM,
            center_distance_change=mesh.center_distance_change_mm * MM,
            coast=_coast_flank(mesh.coast_flank, base_pitch),
            friction=mesh.friction,
        )


def _coast_flank(flank: CoastFlankInput | None, base_pitch: float) -> CoastFlank | None:
    """Return the coast flank; teeth that are equally thick share the pitch less the backlash."""
    if flank is None:
        return None
    backlash = flank.backlash_um * UM
    thickness = flank.tooth_thickness
    with named("coast_flank"):
        return CoastFlank(backlash, 0.5 * (1.0 - backlash / base_pitch) if thickness is None else thickness)


def _drive(index: int, drive: DriveInput) -> ImposedRotation:
    with named(f"drives[{index}]"):
        law: TimeLaw | AngleLaw
        if drive.angle_deg is not None:
            law = AngleLaw(drive.time_s, tuple(value * DEGREE for value in drive.angle_deg))
        else:
            law = TimeLaw(drive.time_s, tuple(v * RPM for v in drive.speed_rpm or ()), drive.course)
        return ImposedRotation(drive.name, drive.shaft, law, **in_si(ImposedRotation, drive))


def _free_rotation(index: int, rotation: FreeRotationInput) -> FreeRotation:
    with named(f"free_rotations[{index}]"):
        return FreeRotation(rotation.name, rotation.shaft, **in_si(FreeRotation, rotation))
