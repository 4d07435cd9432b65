"""Checks of a scene without its tables: it moves, its teeth fit and loads press its flanks."""

from __future__ import annotations

from dynamics.errors import InputError
from dynamics.mechanism.base_pitches import with_common_base_pitches
from dynamics.mechanism.kinematics import Kinematics, solve_kinematics
from dynamics.mechanism.train_phases import train_phases
from dynamics.scene.scene import Scene


def check_motion(scene: Scene) -> Kinematics:
    """Return the kinematic motion of a scene that can move.

    Nothing here reads the tables of the meshes, so that it may be called before they exist. Raises
    `InputError`: gears cannot mesh, a train is locked or not driven, a load acts on a shaft at rest, or one
    pulls flanks apart that have no coast flank behind them.
    """
    scene, _ = with_common_base_pitches(scene)
    kinematics = solve_kinematics(scene)
    train_phases(scene, kinematics.mesh_sense)
    check_loads(scene, kinematics)
    return kinematics


def check_loads(scene: Scene, kinematics: Kinematics) -> None:
    """Refuse a load on a shaft at rest in the kinematic motion; raises `InputError`."""
    for index, load in enumerate(scene.loads):
        if kinematics.sense[scene.shaft_index(load.shaft)] == 0:
            bound, suggestion = "a shaft that turns", "A held shaft needs no load."
            raise InputError(f"loads[{index}].shaft", load.shaft, bound, suggestion)
