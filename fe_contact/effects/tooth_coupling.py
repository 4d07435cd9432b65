"""Tooth-to-tooth coupling: load on one tooth moves its neighbors through the rim and the body."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar

from fe_contact.contact.model import ContactModel
from fe_contact.effects.effect import ContactScene, Effect, Verdict


@dataclass(frozen=True)
class ToothCoupling(Effect):
    """Cross-tooth blocks of the compliance; two teeth apart it is still three quarters (body twist)."""

    name: ClassVar[str] = "tooth_coupling"
    needs: ClassVar[tuple[str, ...]] = ("position",)
    adds: ClassVar[tuple[str, ...]] = ("coupling",)
    cost: ClassVar[str] = "none: the blocks come with the condensed compliance"
    sources: ClassVar[tuple[str, ...]] = ("docs/effects.md#tooth_coupling",)
    valid_for: ClassVar[str] = "every pair"

    def called_for(self, scene: ContactScene) -> Verdict:
        """Call for the effect in every scene: two neighboring pairs can share load."""
        ratio = scene.pair.active_contact_ratio
        return Verdict(True, f"contact ratio {ratio:.3f}: neighboring pairs share the load")

    def contribute(self, scene: ContactScene, model: ContactModel) -> ContactModel:
        """Couple the teeth."""
        return replace(model, couple_teeth=True)
