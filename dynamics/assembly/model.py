"""What a scene is modeled with: freedoms, connections, flanks, and the effects decided on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from bounds import above
from dynamics.assembly.connections import Connections, gather_connections
from dynamics.assembly.flanks import Flanks, flank_laws, with_coast_flanks
from dynamics.assembly.loaded_meshes import loaded_meshes
from dynamics.assembly.mesh_axes import mesh_axes
from dynamics.assembly.rotor_rotations import rotor_rotations
from dynamics.assembly.shaft_bending import bending_shafts, with_elastic
from dynamics.assembly.supported_rotors import supported_rotors
from dynamics.effects import BendingShaft
from dynamics.effects.flexible_shafts import FlexibleShafts
from dynamics.effects.ledger import EffectLedger, keep_ledger, with_mesh_effects
from dynamics.errors import InputError
from dynamics.mechanism.columns import mass_terms
from dynamics.mechanism.freedoms import Freedoms, find_freedoms
from dynamics.mechanism.mechanism import GIVE_INERTIA, Mechanism
from dynamics.mechanism.rotor import Rotor


@dataclass(frozen=True)
class Model:
    """A mechanism with its effects decided.

    Attributes
    ----------
    mechanism : Mechanism
    freedoms : Freedoms
    connections : Connections
    flanks : Flanks
        Force laws as resolved: nominal forces, damping, tables.
    ledger : EffectLedger
    """

    mechanism: Mechanism
    freedoms: Freedoms
    connections: Connections
    flanks: Flanks
    ledger: EffectLedger


def decide_model(mechanism: Mechanism) -> Model:
    """Decide the effects of rotors, which give the freedoms, and then those of meshes, which look at them.

    Raises
    ------
    InputError
        If a choice is unknown, a free direction has no inertia, or a table does not fit its mesh.
    """
    flanks = _flanks(mechanism)
    bending = bending_shafts(mechanism, flanks)
    ledger = _on_rotors(mechanism, bending)
    mechanism = _with_flexible_shafts(mechanism, bending, ledger)
    freedoms = find_freedoms(mechanism.rotors, mechanism.kinematics, ledger)
    _check_mass(freedoms, mechanism.rotors)
    connections = gather_connections(mechanism.scene, mechanism.rotors)
    ledger = _on_meshes(mechanism, freedoms, connections, flanks, ledger)
    meshes = mechanism.scene.meshes
    coast = [index for index, mesh in enumerate(meshes) if ledger.on("backlash", mesh.name)]
    return Model(mechanism, freedoms, connections, with_coast_flanks(flanks, meshes, coast), ledger)


def _flanks(mechanism: Mechanism) -> Flanks:
    """Resolve the driving flanks."""
    scene, kinematics = mechanism.scene, mechanism.kinematics
    return flank_laws(scene, kinematics, mechanism.nominal_force, mechanism.polar_inertia)


def _on_rotors(mechanism: Mechanism, bending: Sequence[BendingShaft]) -> EffectLedger:
    """Decide the effects of rotors."""
    scene, rotors = mechanism.scene, mechanism.rotors
    turns = rotor_rotations(scene, mechanism.kinematics, rotors)
    forces, loads = mechanism.nominal_force, mechanism.bearing_load
    found = supported_rotors(scene, rotors, mechanism.lines, forces, loads, turns, bending)
    return keep_ledger(scene.effects, found)


def _with_flexible_shafts(
    mechanism: Mechanism, bending: Sequence[BendingShaft], ledger: EffectLedger
) -> Mechanism:
    """Give the shafts on which it is on their elastic coordinates."""
    names = [shaft.name for shaft in mechanism.scene.shafts]
    on = [ledger.on(FlexibleShafts().name, name) for name in names]
    if not any(on):
        return mechanism
    pairs = zip(on, bending, strict=True)
    return with_elastic(mechanism, [shaft.elastic if flexible else None for flexible, shaft in pairs])


def _on_meshes(
    mechanism: Mechanism, freedoms: Freedoms, connections: Connections, flanks: Flanks, ledger: EffectLedger
) -> EffectLedger:
    """Decide the effects of meshes too."""
    scene, kinematics, rotors = mechanism.scene, mechanism.kinematics, mechanism.rotors
    senses, supports = kinematics.mesh_sense, connections.supports
    axes = mesh_axes(scene, rotors, senses, mechanism.lines, freedoms, supports, flanks)
    inertia = mechanism.rotational_inertia
    meshes = loaded_meshes(scene, kinematics, flanks, mechanism.polar_inertia, inertia, axes)
    return with_mesh_effects(ledger, scene.effects, meshes)


def _check_mass(freedoms: Freedoms, rotors: Sequence[Rotor]) -> None:
    """Every free direction needs inertia."""
    for name, value in zip(freedoms.name, mass_terms(rotors)[0][freedoms.column], strict=True):
        if value <= 0.0:
            raise InputError(f"inertia of {name}", float(value), above(0.0), GIVE_INERTIA)
