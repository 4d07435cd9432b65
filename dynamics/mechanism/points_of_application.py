"""Points of application on the shafts of a scene, and the shafts that can bend and twist."""

from __future__ import annotations

from collections.abc import Sequence

from dynamics.mechanism.connections import seated
from dynamics.mechanism.mechanism import Mechanism
from dynamics.mechanism.rotor import Rotor
from dynamics.mechanism.sampling import order_rate
from dynamics.scene.scene import Scene
from dynamics.shafts import Disc, ElasticShaft, PointOfApplication, elastic_shaft
from dynamics.shafts.shaft_position import OnShaft, on_length


def why_rigid(mechanism: Mechanism, index: int) -> str:
    """Return why the shaft `index` cannot be flexible; empty where it can."""
    scene, rotor = mechanism.scene, mechanism.rotors[index]
    shaft = rotor.shaft
    if not shaft.sections:
        return "the shaft has no sections: its elasticity is not known"
    if rotor.frame is not None:
        return "left out: members of a planetary set are rigid"
    bent = [
        mesh.name for mesh in scene.meshes if mesh.bent_shafts and shaft.name in _shafts(scene, mesh.name)
    ]
    if bent:
        return f'the table of "{bent[0]}" has the bending of its shafts in it'
    for name, position in _positions(scene, rotor):
        if not on_length(position, shaft.length):
            return f'"{name}" at {position:g} m is off the shaft, which is {shaft.length:g} m long'
    return ""


def elastic_of(mechanism: Mechanism, index: int) -> ElasticShaft:
    """Return the elastic coordinates of the shaft `index`, reduced to where forces act on it.

    It bends where bearings hold it across and in tilt, and neither is switched off; it stretches where it may
    move along its axis. It is resolved to the scene's highest frequency, else to half the rate of the output.
    """
    scene, rotor = mechanism.scene, mechanism.rotors[index]
    shaft = rotor.shaft
    drive = next((d for d in scene.drives if d.shaft == shaft.name and d.rigid), None)
    discs = tuple(Disc(rotor.on_shaft(body.position), body.inertia) for body in scene.mounted(shaft.name))
    return elastic_shaft(
        shaft.sections,
        discs,
        _points_of_application(mechanism, rotor, _bends(mechanism, rotor), _stretches(mechanism, rotor)),
        _highest(mechanism),
        shaft.damping_ratio,
        None if drive is None else rotor.on_shaft(drive.position),
    )


def _highest(mechanism: Mechanism) -> float:
    """Return the frequency to which shafts are resolved, Hz."""
    scene = mechanism.scene
    rate = scene.outputs.sample_rate or order_rate(scene, mechanism.kinematics)
    return scene.highest_frequency or 0.5 * rate


def _bends(mechanism: Mechanism, rotor: Rotor) -> bool:
    """Whether the shaft is held across and in tilt, and free to move."""
    held = rotor.radial_stiffness > 0.0 and rotor.tilt_stiffness > 0.0
    return held and {"x", "tilt_x"} <= mechanism.additions.possible


def _stretches(mechanism: Mechanism, rotor: Rotor) -> bool:
    """Whether the shaft has the freedom along its axis: requested, or possible and called for."""
    scene, additions = mechanism.scene, mechanism.additions
    gears = {gear.name: gear for gear in scene.gears if gear.shaft == rotor.shaft.name}
    meshing = [name for mesh in scene.meshes for name in (mesh.driver, mesh.driven) if name in gears]
    helical = any(gears[name].base_helix_angle != 0.0 for name in meshing)
    wanted = helical or "z" in additions.requested
    return rotor.axial_stiffness > 0.0 and "z" in additions.possible and wanted


def _points_of_application(
    mechanism: Mechanism, rotor: Rotor, bends: bool, stretches: bool
) -> tuple[PointOfApplication, ...]:
    """Return where gears, bearings, couplings and torques act."""
    scene, name = mechanism.scene, rotor.shaft.name
    laws = mechanism.bearings
    tilting = seated(scene, mechanism.rotors) | {at.name for at in laws if at.tilts}
    holding = {at.name for at in laws if at.holds_axis}
    points = [
        PointOfApplication(rotor.on_shaft(gear.position), bends, bends, stretches, True)
        for gear in scene.gears
        if gear.shaft == name
    ]
    for bushing in rotor.bushings:
        along = stretches and (bushing.axial_stiffness > 0.0 or bushing.full or bushing.name in holding)
        tilts = bends and bushing.name in tilting
        points.append(PointOfApplication(rotor.on_shaft(bushing.position), bends, tilts, along))
    for position, full in _couplings(scene, rotor):
        whole = bends and full
        points.append(PointOfApplication(rotor.on_shaft(position), whole, whole, stretches and full, True))
    torques: list[OnShaft] = [*scene.drives, *scene.loads, *scene.speed_torques]
    points += [
        PointOfApplication(rotor.on_shaft(part.position), turn=True) for part in torques if part.shaft == name
    ]
    applied: list[OnShaft] = [*scene.forces, *scene.unbalances]
    points += [
        PointOfApplication(rotor.on_shaft(part.position), bends, bends, stretches, True)
        for part in applied
        if part.shaft == name
    ]
    return tuple(points)


def _couplings(scene: Scene, rotor: Rotor) -> list[tuple[float, bool]]:
    """Positions of the couplings along the shaft, m, and whether they join more than rotations."""
    z = {shaft.name: shaft.origin[2] for shaft in scene.shafts}
    return [
        (z[coupling.first] + coupling.position - rotor.shaft.origin[2], coupling.stiffness is not None)
        for coupling in scene.couplings
        if rotor.shaft.name in (coupling.first, coupling.second)
    ]


def _positions(scene: Scene, rotor: Rotor) -> list[tuple[str, float]]:
    """Names and positions of what must lie on the shaft; torsional couplings act at its nearer end."""
    name = rotor.shaft.name
    torques: list[OnShaft] = [*scene.drives, *scene.loads, *scene.speed_torques]
    points: list[OnShaft] = [*scene.forces, *scene.unbalances]
    parts: list[OnShaft] = [*scene.gears, *scene.discs, *scene.ground_bearings, *torques, *points]
    return [(part.name, part.position) for part in parts if part.shaft == name]


def _shafts(scene: Scene, mesh: str) -> Sequence[str]:
    meshing = next(part for part in scene.meshes if part.name == mesh)
    return [scene.gear(name).shaft for name in (meshing.driver, meshing.driven)]
