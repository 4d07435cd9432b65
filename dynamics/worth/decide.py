"""What "auto" makes of a tolerance: effects too small to be seen are left off, larger ones are on."""

from __future__ import annotations

import time as clock
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from dynamics.effects.backlash import Backlash
from dynamics.effects.bearing_clearance import BearingClearance
from dynamics.scene import Scene
from dynamics.worth.estimate import Worth, estimate_worths

SHARE = 0.1
"""Of the tolerance, for everything that is left off together: estimates may be wrong by a factor of two and
more, and what is left off must stay invisible."""
KEPT = (Backlash().name, BearingClearance().name)
"""Effects of impacts, of which linear theory says nothing."""


@dataclass(frozen=True)
class Decided:
    """A scene with what its tolerance decided.

    Attributes
    ----------
    scene : Scene
        Its `effects` say what to do.
    automatic : mapping of str to str
        Effects that the tolerance decided against what the scene calls for, and why.
    worths : mapping of str to Worth
        Estimates; empty where there was no tolerance to decide by.
    seconds : float
        CPU time that deciding took, s.
    """

    scene: Scene
    automatic: Mapping[str, str] = field(default_factory=dict)
    worths: Mapping[str, Worth] = field(default_factory=dict)
    seconds: float = 0.0

    @property
    def left_off(self) -> dict[str, Worth]:
        """What the scene calls for and is off, with its worth."""
        off = [name for name in self.automatic if self.scene.effects[name] == "off"]
        return {name: self.worths[name] for name in off}


def decide_effects(scene: Scene) -> Decided:
    """Decide the effects that are left to "auto" by the scene's tolerance; without one, as the scene calls.

    Estimated worths, relative to mean and peak-to-peak transmission error and to the largest bearing force,
    may sum up to a tenth of the tolerance in what is left off, the smallest first. An effect that the scene
    does not call for is on if it is worth more than that by itself.
    """
    if scene.tolerance is None:
        return Decided(scene)
    began = clock.process_time()
    worths = estimate_worths(scene)
    allowed = SHARE * scene.tolerance
    free = {name: worth for name, worth in worths.items() if scene.effects.get(name, "auto") == "auto"}
    automatic = {
        name: f"on for the tolerance of {scene.tolerance:g}: worth {worth.words}"
        for name, worth in free.items()
        if not worth.on and worth.largest > allowed
    }
    choices, spent = dict.fromkeys(automatic, "on"), 0.0
    spare = {name: worth for name, worth in free.items() if worth.on and name not in KEPT}
    for name, worth in sorted(spare.items(), key=lambda item: item[1].largest):
        spent += worth.largest
        if spent <= allowed:
            choices[name] = "off"
            automatic[name] = f"left off for the tolerance of {scene.tolerance:g}: worth {worth.words}"
    chosen = replace(scene, effects={**scene.effects, **choices})
    return Decided(chosen, automatic, worths, clock.process_time() - began)
