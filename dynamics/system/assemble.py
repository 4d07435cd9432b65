"""From a scene to arrays: the main flow of this room."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from dynamics.errors import InputError
from dynamics.joints import Bushing
from dynamics.system.arrays import Loads, Reference, SystemArrays
from dynamics.system.effects import FREEDOMS, MeshOnRotor, SupportedRotor
from dynamics.system.effects.ledger import EffectLedger, keep_ledger
from dynamics.system.flanks import Flanks, flank_laws
from dynamics.system.freedoms import (
    Freedoms,
    bushing_coefficients,
    bushing_kinematics,
    find_freedoms,
    mass_diagonal,
    shared_blocks,
)
from dynamics.system.kinematics import Kinematics, solve_kinematics
from dynamics.system.law_arrays import pack_laws, revolutions
from dynamics.system.line_of_action import LineOfAction, line_of_action
from dynamics.system.nominal_forces import nominal_forces
from dynamics.system.rotor import Rotor, build_rotor
from dynamics.system.scene import Scene
from dynamics.types import FloatArray


@dataclass(frozen=True)
class System:
    """An assembled scene.

    Attributes
    ----------
    scene : Scene
    arrays : SystemArrays
        For the compiled loops.
    freedoms : Freedoms
    kinematics : Kinematics
    lines : tuple of LineOfAction
        One per mesh.
    flanks : Flanks
        Force laws as resolved: nominal forces, damping, tables.
    bushings : tuple of Bushing
        All, rotor by rotor, with damping filled in.
    bearing_stiffness, bearing_damping : (b, 3, n) arrays
        Force on the ground at each bushing per freedom and its rate.
    ledger : EffectLedger
    """

    scene: Scene
    arrays: SystemArrays
    freedoms: Freedoms
    kinematics: Kinematics
    lines: tuple[LineOfAction, ...]
    flanks: Flanks
    bushings: tuple[Bushing, ...]
    bearing_stiffness: FloatArray
    bearing_damping: FloatArray
    ledger: EffectLedger


def assemble(scene: Scene) -> System:
    """Assemble `scene`.

    Raises
    ------
    InputError
        If parts do not fit each other, or a free direction has no inertia.
    """
    kinematics = solve_kinematics(scene)
    rotors = [build_rotor(scene, shaft) for shaft in scene.shafts]
    senses = [kinematics.sense[scene.shaft_index(scene.gear(mesh.driver).shaft)] for mesh in scene.meshes]
    lines = tuple(line_of_action(scene, index, sense) for index, sense in enumerate(senses))
    forces = nominal_forces(scene, kinematics)
    ledger = keep_ledger(scene.effects, _supported(scene, rotors, lines, forces))
    freedoms = find_freedoms(rotors, kinematics, ledger)
    _check_mass(freedoms, rotors)
    flanks = flank_laws(scene, kinematics, forces, [rotor.inertia.polar for rotor in rotors])
    bushings = tuple(bushing for rotor in rotors for bushing in rotor.bushings)
    stiffness, damping = bushing_coefficients(bushings)
    moves = freedoms.keep(bushing_kinematics(rotors))
    arrays = _arrays(scene, rotors, kinematics, freedoms, lines, flanks, (moves, stiffness, damping))
    return System(
        scene,
        arrays,
        freedoms,
        kinematics,
        lines,
        flanks,
        bushings,
        stiffness[:, :, None] * moves,
        damping[:, :, None] * moves,
        ledger,
    )


def _supported(
    scene: Scene, rotors: Sequence[Rotor], lines: Sequence[LineOfAction], forces: FloatArray
) -> list[SupportedRotor]:
    """Gather what the effects decide on."""
    meshes: list[list[MeshOnRotor]] = [[] for _ in rotors]
    for mesh, line, force in zip(scene.meshes, lines, forces, strict=True):
        for name in (mesh.driver, mesh.driven):
            gear = scene.gear(name)
            index = scene.shaft_index(gear.shaft)
            lever = float(line.point[2] - rotors[index].center[2])
            radius = gear.base_radius / math.cos(line.working_pressure_angle)
            meshes[index].append(MeshOnRotor(float(force), lever, abs(float(line.force[2])), radius))
    return [
        SupportedRotor(
            rotor.shaft.name,
            rotor.shaft.length,
            rotor.radial_stiffness,
            rotor.axial_stiffness,
            rotor.tilt_stiffness,
            rotor.elastic_lever,
            tuple(on_rotor),
        )
        for rotor, on_rotor in zip(rotors, meshes, strict=True)
    ]


def _arrays(
    scene: Scene,
    rotors: Sequence[Rotor],
    kinematics: Kinematics,
    freedoms: Freedoms,
    lines: Sequence[LineOfAction],
    flanks: Flanks,
    supports: tuple[FloatArray, FloatArray, FloatArray],
) -> SystemArrays:
    """Reduce every six-freedom array to the free directions."""
    moves, coefficient, viscous = supports
    stiffness = np.einsum("bki,bk,bkj->ij", moves, coefficient, moves)
    damping = np.einsum("bki,bk,bkj->ij", moves, viscous, moves)
    mass = np.diag(freedoms.keep(mass_diagonal(rotors)))
    gradient = _gradients(scene, rotors, lines)
    polar = np.array([rotor.inertia.polar for rotor in rotors])
    ratio = np.array([float(value) for value in kinematics.ratio])
    inertial = np.zeros((len(rotors), 6))
    inertial[:, 5] = -polar * ratio
    scale, direction = freedoms.keep(_scales(scene).ravel()), freedoms.keep(gradient)
    held = np.diag(stiffness) + flanks.mean_stiffness @ direction**2
    return SystemArrays(
        np.ascontiguousarray(mass),
        damping,
        stiffness,
        shared_blocks([mass, damping, stiffness]),
        direction,
        freedoms.keep(_turns(scene, rotors, kinematics)),
        np.ascontiguousarray(gradient[:, 6 * kinematics.drive + 5]),
        freedoms.keep(inertial.ravel()),
        float(polar[kinematics.drive]),
        float(np.sum(polar * ratio**2)),
        scale,
        scale * np.sqrt(np.diag(mass) / np.maximum(held, 1e-300)),
        flanks.law,
        _reference(scene, kinematics),
        _loads(scene, kinematics, freedoms, ratio),
    )


def _check_mass(freedoms: Freedoms, rotors: Sequence[Rotor]) -> None:
    """Every free direction needs inertia."""
    for name, value in zip(freedoms.name, freedoms.keep(mass_diagonal(rotors)), strict=True):
        if value <= 0.0:
            suggestion = "Give the shaft or its gears mass and inertia (see hollow_cylinder)."
            raise InputError(f"inertia of {name}", float(value), "above 0", suggestion)


def _gradients(scene: Scene, rotors: Sequence[Rotor], lines: Sequence[LineOfAction]) -> FloatArray:
    """Return the derivatives of each transmission error in six freedoms of all rotors, (m, 6 r)."""
    gradient = np.zeros((len(lines), len(rotors), 6))
    for row, (mesh, line) in enumerate(zip(scene.meshes, lines, strict=True)):
        for name, sign in ((mesh.driver, 1.0), (mesh.driven, -1.0)):
            index = scene.shaft_index(scene.gear(name).shaft)
            gradient[row, index] += sign * line.gradient(rotors[index].center)
    return gradient.reshape(len(lines), 6 * len(rotors))


def _turns(scene: Scene, rotors: Sequence[Rotor], kinematics: Kinematics) -> FloatArray:
    """Return the derivatives of each position in all freedoms, (m, 6 r): the driver's rotation."""
    turn = np.zeros((len(scene.meshes), len(rotors), 6))
    for row, mesh in enumerate(scene.meshes):
        driver = scene.gear(mesh.driver)
        index = scene.shaft_index(driver.shaft)
        turn[row, index, 5] = kinematics.sense[index] * driver.teeth / (2.0 * math.pi)
    return turn.reshape(len(scene.meshes), 6 * len(rotors))


def _scales(scene: Scene) -> FloatArray:
    """Metres per unit of each freedom, (r, 6): the largest base radius on the shaft for rotations."""
    scale = np.ones((len(scene.shafts), len(FREEDOMS)))
    for index, shaft in enumerate(scene.shafts):
        scale[index, 3:] = max(gear.base_radius for gear in scene.gears if gear.shaft == shaft.name)
    return scale


def _reference(scene: Scene, kinematics: Kinematics) -> Reference:
    """Lay out the kinematic motion."""
    whole, fraction = revolutions(scene.drives[0].speed)
    rates = []
    for mesh in scene.meshes:
        driver = scene.gear(mesh.driver)
        index = scene.shaft_index(driver.shaft)
        rates.append(kinematics.ratio[index] * kinematics.sense[index] * driver.teeth)
    return Reference(
        pack_laws([scene.drives[0].speed]),
        whole,
        fraction,
        np.array([rate.numerator for rate in rates], dtype=np.int64),
        np.array([rate.denominator for rate in rates], dtype=np.int64),
        np.array([mesh.position_offset for mesh in scene.meshes], dtype=float),
        np.array([mesh.table.period for mesh in scene.meshes], dtype=np.int64),
    )


def _loads(scene: Scene, kinematics: Kinematics, freedoms: Freedoms, ratio: FloatArray) -> Loads:
    """Lay out the load torques: each against the sense of its shaft."""
    direction = np.zeros((len(scene.loads), len(scene.shafts), 6))
    shafts = [scene.shaft_index(load.shaft) for load in scene.loads]
    for row, shaft in enumerate(shafts):
        direction[row, shaft, 5] = -kinematics.sense[shaft]
    return Loads(
        pack_laws([load.torque for load in scene.loads]),
        freedoms.keep(direction.reshape(len(scene.loads), 6 * len(scene.shafts))),
        np.ascontiguousarray(direction[:, :, 5] @ ratio),
        np.ascontiguousarray(direction[:, kinematics.drive, 5]),
    )
