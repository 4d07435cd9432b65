"""The model of a scene: freedoms, connections, flanks, and the effects decided on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

from bounds import above
from dynamics.effects import Effect, EffectLedger, MeshEffect, RotorEffect
from dynamics.effects.ledger import mechanism_of
from dynamics.effects.loaded_parts import LoadedTrain, loaded_rotors
from dynamics.errors import InputError
from dynamics.mechanism.columns import mass_terms
from dynamics.mechanism.connections import gather_connections
from dynamics.mechanism.flanks import Flanks, flank_laws
from dynamics.mechanism.freedoms import find_freedoms
from dynamics.mechanism.mechanism import GIVE_INERTIA, Mechanism
from dynamics.scene.scene import Scene


@dataclass(frozen=True)
class Model(LoadedTrain):
    """A mechanism with the decisions on its effects; its flanks include those that effects add."""

    ledger: EffectLedger


def decide_model(scene: Scene, registry: tuple[Effect, ...]) -> Model:
    """Decide the effects of rotors, which give the freedoms, and then the effects of meshes, which use them.

    Raises `InputError`: a choice is unknown, parts do not fit each other, or a free direction has no inertia.
    """
    mechanism = mechanism_of(scene, registry)
    flanks = flank_laws(mechanism)
    mechanism, ledger = _on_rotors(mechanism, flanks, [e for e in registry if isinstance(e, RotorEffect)])
    added = [ledger.on_rotor(rotor.shaft.name) for rotor in mechanism.rotors]
    kinds = [{kind for effect in effects for kind in effect.adds} for effects in added]
    freedoms = find_freedoms(mechanism.rotors, mechanism.kinematics, kinds)
    diagonal, _ = mass_terms(mechanism.rotors)
    for name, value in zip(freedoms.name, diagonal[freedoms.column], strict=True):
        if value <= 0.0:
            raise InputError(f"inertia of {name}", float(value), above(0.0), GIVE_INERTIA)
    train = LoadedTrain(mechanism, freedoms, gather_connections(mechanism.scene, mechanism.rotors), flanks)
    flanks, ledger = _on_meshes(train, ledger, [e for e in registry if isinstance(e, MeshEffect)])
    return Model(mechanism, freedoms, train.connections, flanks, ledger)


def _on_rotors(
    mechanism: Mechanism, flanks: Flanks, registry: Sequence[RotorEffect]
) -> tuple[Mechanism, EffectLedger]:
    """Decide the effects of rotors, and extend the mechanism by those that are on."""
    ledger, choices = EffectLedger(), mechanism.scene.effects
    rotors = loaded_rotors(mechanism, flanks)
    names = [rotor.shaft.name for rotor in mechanism.rotors]
    for effect in registry:
        choice = choices.get(effect.name, "auto")
        ledger = ledger.decide(effect, choice, names, partial(effect.verdicts, rotors))
    for effect in registry:
        on = [entry.verdict if entry.on else None for entry in ledger.of(effect.name)]
        mechanism = effect.extend(mechanism, on)
    return mechanism, ledger


def _on_meshes(
    train: LoadedTrain, ledger: EffectLedger, registry: Sequence[MeshEffect]
) -> tuple[Flanks, EffectLedger]:
    """Decide the effects of meshes, and extend the flanks by those that are on."""
    flanks, scene, meshes = train.flanks, train.mechanism.scene, train.meshes
    names = [mesh.mesh.name for mesh in meshes]
    for effect in registry:
        choice = scene.effects.get(effect.name, "auto")
        ledger = ledger.decide(effect, choice, names, partial(effect.verdicts, meshes))
        on = [index for index, mesh in enumerate(scene.meshes) if ledger.on(effect.name, mesh.name)]
        flanks = effect.extend(flanks, scene.meshes, on)
    return flanks, ledger
