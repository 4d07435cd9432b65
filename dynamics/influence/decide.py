"""The decision of "auto" by a tolerance: effects too small to be seen are neglected, larger ones are on."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from dynamics.effects import EFFECTS
from dynamics.influence.estimate import Influence, estimate_influences
from dynamics.scene import Scene
from host import cpu_seconds

SHARE = 0.1
"""Of the tolerance, for all neglected effects together: estimates may be wrong by a factor of two and
more, and neglected effects must stay invisible."""


@dataclass(frozen=True)
class Decided:
    """A scene with what its tolerance decided.

    Attributes
    ----------
    scene : Scene
        Its `effects` say what to do.
    automatic : mapping of str to str
        Effects that the tolerance decided against what the scene calls for, and why.
    influences : mapping of str to Influence
        Estimates; empty where there was no tolerance to decide by.
    seconds : float
        CPU time that deciding took, s.
    """

    scene: Scene
    automatic: Mapping[str, str] = field(default_factory=dict)
    influences: Mapping[str, Influence] = field(default_factory=dict)
    seconds: float = 0.0

    @property
    def neglected(self) -> dict[str, Influence]:
        """Effects that the scene calls for and are off, with their influence."""
        off = [name for name in self.automatic if self.scene.effects[name] == "off"]
        return {name: self.influences[name] for name in off}


def decide_effects(scene: Scene) -> Decided:
    """Decide the effects that are left to "auto" by the scene's tolerance; without one, as the scene calls.

    Influences, relative to mean and peak-to-peak transmission error and to the largest bearing force,
    may sum up to a tenth of the tolerance in neglected effects, the smallest first. An effect that the scene
    does not call for is on if its influence exceeds that by itself.
    """
    if scene.tolerance is None:
        return Decided(scene)
    began = cpu_seconds()
    influences = estimate_influences(scene)
    allowed = SHARE * scene.tolerance
    free = {
        name: influence for name, influence in influences.items() if scene.effects.get(name, "auto") == "auto"
    }
    automatic = {
        name: f"on for the tolerance of {scene.tolerance:g}: influence {influence.words}"
        for name, influence in free.items()
        if not influence.on and influence.largest > allowed
    }
    choices, total = dict.fromkeys(automatic, "on"), 0.0
    linear = {effect.name for effect in EFFECTS if effect.linear}
    candidates = {name: influence for name, influence in free.items() if influence.on and name in linear}
    for name, influence in sorted(candidates.items(), key=lambda item: item[1].largest):
        total += influence.largest
        if total <= allowed:
            choices[name] = "off"
            automatic[name] = (
                f"neglected for the tolerance of {scene.tolerance:g}: influence {influence.words}"
            )
    chosen = replace(scene, effects={**scene.effects, **choices})
    return Decided(chosen, automatic, influences, cpu_seconds() - began)
