"""Scenes on which the influence of dynamic effects is estimated and measured."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
from scipy.spatial import ConvexHull

from benchmarks.pair_cases import M, gear_of, spur_pair
from dynamics.forces import RollingContact
from dynamics.housings import (
    ModalDamping,
    ReducedMatrices,
    Ring,
    SeatFrame,
    housing_of_matrices,
    scene_housing,
)
from dynamics.housings.reduced_housing import SurfaceMotion
from dynamics.housings.supports import MOTIONS
from dynamics.loads import TimeLaw
from dynamics.meshes import CoastFlank, MeshTable
from dynamics.noise import EquivalentSoundPower, QuantityLevel, SoundModel
from dynamics.scene import Outputs, Scene, pair_scene
from dynamics.shafts import BeamSection, GearBody, Inertia, hollow_cylinder
from fe_contact import GearPair, analyze
from lineofaction.cli.scene_tables import tabled_scene
from lineofaction.gearbox.subjects import scene_of

EXAMPLES = Path(__file__).parents[1] / "examples"
RPM = math.pi / 30.0
TORQUES = (10.0, 30.0, 60.0, 100.0, 160.0, 240.0)
LENGTH = 0.2
PLAY = {"thickness_allowance": 40e-6}
HELIX = math.radians(20.0)
SPUR = spur_pair(gear_of(18, **PLAY), gear_of(27, **PLAY))
HELICAL = spur_pair(gear_of(18, helix_angle=HELIX, **PLAY), gear_of(23, helix_angle=-HELIX, **PLAY))
AXES = {"misalignments": (-40e-6, 0.0, 40e-6), "center_distance_changes": (-40e-6, 0.0, 40e-6)}
CONSTANT = TimeLaw.constant
SHORT = {"flexible_shafts_scene": 1.0}
"""Seconds of the example that runs too long to be toggled seven times."""


@cache
def table(pair: GearPair, axes: bool, folder: Path) -> MeshTable:
    """Return the mesh force of a pair by draft finite elements, with both axes or none."""
    options = {"level": "draft", "positions": 64, "receipt": "minimal", "cache": folder}
    axes_request = AXES if axes else {}
    return analyze(pair, torques=list(TORQUES), **options, **axes_request).force_table()  # type: ignore[arg-type]


def example_scenes() -> dict[str, Scene]:
    """Return the scenes of the folder of examples whose meshes have tables, the long ones cut."""
    found = {}
    for file in sorted(EXAMPLES.glob("*_scene.toml")):
        given, folder = scene_of(file)
        if not given.meshes or any(mesh.stiffness is not None for mesh in given.meshes):
            continue
        scene = tabled_scene(given, folder, None, lambda _stage, _fraction: None).scene
        seconds = SHORT.get(file.stem, scene.duration)
        outputs = replace(scene.outputs, energy_audit=False, receipt="minimal")
        changes = {"duration": seconds, "outputs": outputs, "on_violation": "report"}
        found[f"example {file.stem}"] = replace(scene, **changes)  # type: ignore[arg-type]
    return found


def influence_scenes(folder: Path) -> dict[str, Scene]:
    """Return scenes by name; every effect has something to do in several of them."""
    slow, fast = CONSTANT(600.0 * RPM), CONSTANT(4000.0 * RPM)
    up = TimeLaw((0.0, 0.6), (1000.0 * RPM, 5000.0 * RPM))
    spur, helical = _scene(SPUR, table(SPUR, False, folder)), _scene(HELICAL, table(HELICAL, False, folder))
    spur_axes, helical_axes = (_scene(pair, table(pair, True, folder)) for pair in (SPUR, HELICAL))
    rubbing = _with_mesh(spur, friction=0.08)
    rolling = _on_rollers(_off_middle(spur, 0.06), 15e-6)
    return {
        "spur, 600 rpm": _turning(spur, slow),
        "spur, 4000 rpm": _turning(spur, fast),
        "spur, run-up": _turning(spur, up, 0.6),
        "spur off the middle, 4000 rpm": _turning(_off_middle(spur, 0.06), fast),
        "spur off the middle, soft bearings, 1500 rpm": _turning(
            _off_middle(_scene(SPUR, table(SPUR, False, folder), 2e7), 0.05), CONSTANT(1500.0 * RPM)
        ),
        "spur on shafts, 2500 rpm": _turning(
            _sections(_off_middle(spur, 0.06), 0.03), CONSTANT(2500.0 * RPM)
        ),
        "spur on stiff shafts, 2500 rpm": _turning(
            _sections(_off_middle(spur, 0.06), 0.08), CONSTANT(2500.0 * RPM)
        ),
        "spur, friction, 600 rpm": _turning(rubbing, slow),
        "spur, friction, 4000 rpm": _turning(rubbing, fast),
        "spur, axes, off the middle, 2000 rpm": _turning(
            _off_middle(spur_axes, 0.04), CONSTANT(2000.0 * RPM)
        ),
        "spur, axes, overhung, 1200 rpm": _turning(_overhung(spur_axes), CONSTANT(1200.0 * RPM)),
        "helical, 3000 rpm": _turning(helical, CONSTANT(3000.0 * RPM)),
        "helical, run-up": _turning(helical, up, 0.6),
        "helical on shafts, 3000 rpm": _turning(_sections(helical, 0.03), CONSTANT(3000.0 * RPM)),
        "helical, axes, friction, 1500 rpm": _turning(
            _with_mesh(helical_axes, friction=0.06), CONSTANT(1500.0 * RPM)
        ),
        "helical, axes, overhung, 3000 rpm": _turning(_overhung(helical_axes), CONSTANT(3000.0 * RPM)),
        "helical, overhung disc, 12000 rpm": _turning(_disc(helical), CONSTANT(12000.0 * RPM)),
        "spur on rollers with clearance, 2000 rpm": _turning(rolling, CONSTANT(2000.0 * RPM)),
        "spur on rollers, lightly loaded, 4000 rpm": _turning(rolling, fast, torque=8.0),
        "spur on rollers with clearance, falling load, 3000 rpm": _unloaded(
            _turning(rolling, CONSTANT(3000.0 * RPM), 0.4)
        ),
        "spur in a housing, 3000 rpm": _turning(_housed(spur), CONSTANT(3000.0 * RPM)),
        "helical in a housing, run-up": _turning(_housed(helical), up, 0.6),
        "spur off the middle in a housing, 4000 rpm": _turning(_housed(_off_middle(spur, 0.06)), fast),
        "helical on shafts in a housing, 2000 rpm": _turning(
            _housed(_sections(helical, 0.03)), CONSTANT(2000.0 * RPM)
        ),
        "spur, friction, in a housing, 1200 rpm": _turning(_housed(rubbing), CONSTANT(1200.0 * RPM)),
        "spur, light load, backlash, 4000 rpm": _turning(
            _with_mesh(spur, coast=CoastFlank(60e-6), damping_ratio=0.03), fast, torque=12.0
        ),
    }


def _scene(pair: GearPair, mesh_table: MeshTable, stiffness: float = 2e8) -> Scene:
    """Return the pair in the middle of two rigid shafts."""
    pinion, wheel = (
        GearBody(
            name,
            shaft,
            0.5 * LENGTH,
            gear.teeth,
            gear.base_radius,
            pair.pinion.face_width,
            gear.base_helix_angle,
            _body(gear.teeth, pair.pinion.face_width),
        )
        for name, shaft, gear in (("pinion", "input", pair.pinion), ("wheel", "output", pair.wheel))
    )
    scene = pair_scene(
        mesh_table,
        (pinion, wheel),
        center_distance=pair.center_distance,
        speed=CONSTANT(100.0),
        resisting_torque=CONSTANT(90.0),
        duration=0.2,
        shaft_inertia=hollow_cylinder(0.03, LENGTH),
        bushing_stiffness=stiffness,
    )
    return _with_mesh(scene, damping_ratio=0.06)


def _body(teeth: int, width: float) -> Inertia:
    """Return the inertia of a disc of so many teeth."""
    return hollow_cylinder(teeth * M, width, 0.5 * teeth * M)


def _turning(scene: Scene, speed: TimeLaw, duration: float = 0.2, torque: float = 90.0) -> Scene:
    """Return the scene at a speed, its results taken as they are."""
    drive, load = scene.drives[0], scene.loads[0]
    return replace(
        scene,
        drives=(replace(drive, speed=speed),),
        loads=(replace(load, torque=CONSTANT(torque)),),
        duration=duration,
        outputs=Outputs(sample_rate=50e3, energy_audit=False, receipt="minimal"),
        on_violation="report",
    )


def _unloaded(scene: Scene) -> Scene:
    """Let the load fall to a twelfth along the run."""
    falling = TimeLaw((0.0, scene.duration), (120.0, 10.0))
    return replace(scene, loads=(replace(scene.loads[0], torque=falling),))


def _with_mesh(scene: Scene, **changes: object) -> Scene:
    """Change the mesh."""
    return replace(scene, meshes=(replace(scene.meshes[0], **changes),))  # type: ignore[arg-type]


def _off_middle(scene: Scene, position: float) -> Scene:
    """Put both gears at `position` along their shafts, m."""
    return replace(scene, gears=tuple(replace(gear, position=position) for gear in scene.gears))


def _overhung(scene: Scene) -> Scene:
    """Put both gears outside their bearings."""
    bushings = tuple(
        replace(part, position=0.04 if part.name.endswith("left") else 0.14) for part in scene.bushings
    )
    return replace(_off_middle(scene, 0.19), bushings=bushings)


def _disc(scene: Scene) -> Scene:
    """Put a large disc on the end of the overhung driven shaft."""
    overhung = _overhung(scene)
    shaft = overhung.shafts[1]
    heavy = Inertia(4.0, 2.5e-2, 1.6e-2)
    return replace(overhung, shafts=(overhung.shafts[0], replace(shaft, inertia=heavy)))


def _sections(scene: Scene, diameter: float) -> Scene:
    """Make the shafts of one section each."""
    section = BeamSection(LENGTH, diameter)
    bare = [replace(shaft, sections=(section,), inertia=Inertia()) for shaft in scene.shafts]
    return replace(scene, shafts=tuple(bare))


def _housed(scene: Scene) -> Scene:
    """Put all bearings into a sounding housing of four seats of 6.75 kg, modes from 1061 to 1369 Hz."""
    tie = 4.0 * np.eye(4) - np.ones((4, 4))
    stiffness, mass = np.kron(3e8 * np.eye(4) + 5e7 * tie, np.eye(3)), 6.75 * np.eye(12)
    places = itertools.product((0.0, 0.09), (0.0, LENGTH))
    seats = tuple(
        SeatFrame(part.name, np.array([x, 0.0, z]), np.eye(3), Ring.RIGID, MOTIONS[:3])
        for part, (x, z) in zip(scene.bushings, places, strict=True)
    )
    housing = housing_of_matrices(ReducedMatrices(stiffness, mass), seats, ModalDamping((0.03,)))
    housing = replace(housing, surface=_box_on(seats))
    scene = replace(scene, housings=(replace(scene_housing(housing, "case"), seat_positions=None),))
    model = SoundModel(scene, {"case": housing}, {})
    return replace(scene, quantity=QuantityLevel(EquivalentSoundPower(), model, "sound power", "dB(A)"))


def _box_on(seats: Sequence[SeatFrame]) -> SurfaceMotion:
    """Return a box whose points move as the seats do, the nearest most."""
    corners = np.array(list(itertools.product((-0.1, 0.2), (-0.1, 0.1), (-0.02, LENGTH + 0.02))))
    hull = ConvexHull(corners)
    outward = np.linalg.det(corners[hull.simplices] - corners.mean(axis=0)) > 0.0
    faces = np.where(outward[:, None], hull.simplices, hull.simplices[:, ::-1])
    edges = np.stack([faces, np.roll(faces, -1, axis=1)], axis=2).reshape(-1, 2)
    pairs, number = np.unique(np.sort(edges, axis=1), axis=0, return_inverse=True)
    points = np.concatenate([corners, corners[pairs].mean(axis=1)])
    away = np.array([np.sum((points - seat.position) ** 2, axis=1) for seat in seats]).T
    weight = 1.0 / away / np.sum(1.0 / away, axis=1)[:, None]
    motion = np.kron(weight[:, None, :], np.eye(3)).reshape(len(points), 3, -1)
    return SurfaceMotion(
        points, np.concatenate([faces, len(corners) + number.reshape(-1, 3)], axis=1), motion
    )


def _on_rollers(scene: Scene, clearance: float) -> Scene:
    """Put the shafts on roller bearings."""
    bushings = tuple(replace(part, radial_stiffness=0.0) for part in scene.bushings)
    contacts = tuple(RollingContact(part.name, 6e8, clearance=clearance) for part in bushings)
    return replace(scene, bushings=bushings, rolling_contacts=contacts)
