"""Phases behind the positions of the meshes: frames that couplings cross, angles of loads, cages."""

from __future__ import annotations

from dynamics.assembly.frame_couplings import frame_turns
from dynamics.mechanism.kinematics import Kinematics
from dynamics.mechanism.load_phases import LoadPhase, load_phases
from dynamics.mechanism.mechanism import Mechanism
from dynamics.mechanism.sampling import cage_turns
from dynamics.scene.scene import Scene


def repeating_phases(scene: Scene, kinematics: Kinematics) -> tuple[LoadPhase, ...]:
    """Return the phases of exact ratio, of frames and loads, in their order behind the last mesh."""
    frames = tuple(LoadPhase(rate, 1, None) for rate in frame_turns(scene, kinematics))
    return (*frames, *load_phases(scene, kinematics))


def phases(mechanism: Mechanism) -> tuple[LoadPhase, ...]:
    """Return all phases: those of exact ratio, then cages whose elements pass."""
    scene, kinematics = mechanism.scene, mechanism.kinematics
    cages = cage_turns(scene, kinematics, mechanism.passing)
    return (*repeating_phases(scene, kinematics), *(LoadPhase(rate, 1, None) for rate in cages))
