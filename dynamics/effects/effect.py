"""An effect of the multibody model: its properties, its decision and its contribution where it is on.

An effect is a class in a file of its own, derived from `RotorEffect` or `MeshEffect`, and a line in the
registry. The rest of the model knows no effect by name. The methods of the base classes contribute nothing.
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
    """The decision on an effect in one rotor or mesh."""

    on: bool
    """Whether the rotor or mesh calls for the effect."""
    possible: bool
    """False: the scene lacks the freedoms or data, and a request for the effect changes nothing."""
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
    """Additions of the effect to the model: names of `FREEDOMS` of a rotor, or of the module `additions`."""
    linear: ClassVar[bool] = True
    """Whether linear theory estimates the influence of the effect; False for effects on impacts, which it
    does not have.
    """
    in_statics: ClassVar[bool | None] = None
    """Whether static deflections include the effect. True: in every scene that has the data; False: never,
    because it acts in motion only; None: where it is on, as in a run.
    """
    compulsory: ClassVar[bool] = False
    """Whether some scenes need the effect even if they switch it off."""

    def prepared(self, scene: Scene) -> Scene:
        """Return `scene` with the changes of its parts by the effect, which is not switched off.

        Raises `InputError`: the scene does not fit the effect.
        """
        return scene

    def neglected(self, scene: Scene) -> Scene:
        """Return `scene` without the cause of the effect, which is switched off."""
        return scene

    def check(self, mechanism: Mechanism) -> None:
        """Raise `InputError` for a mechanism that the effect, if not switched off, cannot be applied to."""


class RotorEffect(Effect):
    """An effect of rotors."""

    def called_for(self, rotor: LoadedRotor) -> Verdict:
        """Decide for one rotor."""
        raise NotImplementedError

    def verdicts(self, rotors: Sequence[LoadedRotor]) -> Sequence[Verdict]:
        """Decide for all rotors of a scene."""
        return [self.called_for(rotor) for rotor in rotors]

    def extend(self, mechanism: Mechanism, decision: Sequence[Verdict | None]) -> Mechanism:
        """Return `mechanism` with the additions to its rotors; `decision` is None where the effect is off."""
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
        """Return `flanks` with further flanks of the meshes `on`, by index."""
        return flanks

    def contribute(self, terms: FlankTerms, flank: FlankInSpace) -> FlankTerms:
        """Return `terms` with the terms that the effect adds to the force of one flank."""
        return terms
