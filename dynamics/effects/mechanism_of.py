"""The mechanism of a scene with what its effects may add, checked by them."""

from __future__ import annotations

from collections.abc import Sequence

from dynamics.effects.effect import Effect
from dynamics.effects.ledger import check_choices
from dynamics.effects.registry import EFFECTS
from dynamics.identity_cache import identity_cached
from dynamics.mechanism.additions import Additions
from dynamics.mechanism.mechanism import Mechanism, gather_mechanism
from dynamics.scene.scene import Scene


@identity_cached
def mechanism_of(scene: Scene, registry: tuple[Effect, ...] = EFFECTS) -> Mechanism:
    """Gather the mechanism of `scene`; every effect that is not switched off checks it.

    Raises
    ------
    InputError
        If a choice is unknown, parts do not fit each other, or an effect cannot do without a part.
    """
    check_choices(scene.effects, registry)
    allowed = [effect for effect in registry if scene.effects.get(effect.name) != "off"]
    requested = [effect for effect in registry if scene.effects.get(effect.name) == "on"]
    mechanism = gather_mechanism(scene, Additions(_added(allowed), _added(requested)))
    for effect in allowed:
        effect.check(mechanism)
    return mechanism


def _added(effects: Sequence[Effect]) -> frozenset[str]:
    return frozenset(part for effect in effects for part in effect.adds)
