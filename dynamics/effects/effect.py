"""An effect of the multibody model: its facts, its decision and its contribution where it is on.

An effect is one file: a class of a rotor or of a mesh and a line in the registry. The rest of the model knows
none by name; what an effect does not contribute, the class it derives from leaves as it is.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

from dynamics.effects.force_terms import FlankInSpace, FlankTerms
from dynamics.effects.loaded_parts import LoadedMesh, LoadedRotor
from dynamics.forces.frames import FrameTerm
from dynamics.mechanism.connections import Connections
from dynamics.mechanism.flanks import Flanks
from dynamics.mechanism.mechanism import Mechanism
from dynamics.meshes.gear_mesh import GearMesh
from dynamics.scene.scene import Scene


@dataclass(frozen=True)
class Verdict:
    """Whether a rotor or a mesh calls for an effect."""

    on: bool
    possible: bool
    """False: the scene has no such freedom or data, and requesting it changes nothing."""
    reason: str
    """Reason for the verdict, in words."""
    influence: float
    """Static displacement along the line of action that the effect adds at the nominal force, m."""


class Effect:
    """One optional piece of physics."""

    name: ClassVar[str]
    """Name of the effect in a scene."""
    cost: ClassVar[str]
    """Cost of the effect, in words."""
    adds: ClassVar[tuple[str, ...]] = ()
    """Additions of the effect to the model: names of `FREEDOMS` that a rotor gets, names of `additions`."""
    linear: ClassVar[bool] = True
    """Whether linear theory estimates the influence of the effect; False for effects on impacts, of which it
    knows nothing.
    """
    at_rest: ClassVar[bool | None] = None
    """Whether static deflections follow it. True: wherever the scene has what it needs; False: never, it is
    one of motion; None: where the scene calls for it, as in a run.
    """
    compulsory: ClassVar[bool] = False
    """Whether there are scenes that need the effect, whatever they choose."""

    def prepared(self, scene: Scene) -> Scene:
        """Return `scene` with the changes that the effect, unless it is switched off, makes to its parts.

        Raises `InputError`.
        """
        return scene

    def neglected(self, scene: Scene) -> Scene:
        """Return `scene` without the cause of the effect, which is switched off."""
        return scene

    def check(self, mechanism: Mechanism) -> None:
        """Refuse a mechanism that the effect, if it is not switched off, cannot do with.

        Raises `InputError`.
        """


class RotorEffect(Effect):
    """An effect of rotors."""

    def called_for(self, rotor: LoadedRotor) -> Verdict:
        """Decide for one rotor."""
        raise NotImplementedError

    def verdicts(self, rotors: Sequence[LoadedRotor]) -> Sequence[Verdict]:
        """Decide for all rotors of a scene."""
        return [self.called_for(rotor) for rotor in rotors]

    def extend(self, mechanism: Mechanism, decision: Sequence[Verdict | None]) -> Mechanism:
        """Return `mechanism` with what the effect adds to its rotors; verdicts of those where it is on."""
        return mechanism

    def frame_terms(self, mechanism: Mechanism, connections: Connections, index: int) -> Sequence[FrameTerm]:
        """Return the rotating-frame forces on the rotor `index`."""
        return ()


class MeshEffect(Effect):
    """An effect of meshes."""

    def called_for(self, mesh: LoadedMesh) -> Verdict:
        """Decide for one mesh."""
        raise NotImplementedError

    def verdicts(self, meshes: Sequence[LoadedMesh]) -> Sequence[Verdict]:
        """Decide for all meshes of a scene."""
        return [self.called_for(mesh) for mesh in meshes]

    def extend(self, flanks: Flanks, meshes: Sequence[GearMesh], on: Sequence[int]) -> Flanks:
        """Return `flanks` with those that the effect adds to the meshes `on`."""
        return flanks

    def contribute(self, terms: FlankTerms, flank: FlankInSpace) -> FlankTerms:
        """Return `terms` with the terms that the effect adds to the force of one flank."""
        return terms
