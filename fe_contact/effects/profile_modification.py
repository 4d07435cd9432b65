"""Profile modification: reliefs, profile crowning and slope, cut tip edges as gaps on the line of action."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar

from fe_contact.contact.model import ContactModel
from fe_contact.effects.effect import ContactScene, Effect, Verdict
from fe_contact.effects.modification_gap import ModificationGap


@dataclass(frozen=True)
class ProfileModification(Effect):
    """Designed deviations of either flank from the involute."""

    name: ClassVar[str] = "profile_modification"
    brings: ClassVar[str] = "profile"
    needs: ClassVar[tuple[str, ...]] = ("position",)
    adds: ClassVar[tuple[str, ...]] = ("gap",)
    cost: ClassVar[str] = "a search for the touching point of every candidate; no finite-element work"
    sources: ClassVar[tuple[str, ...]] = ("docs/effects/profile_modification.md", "ISO 21771-1")
    valid_for: ClassVar[str] = "slopes below about 0.05; tip edges that open further"

    def called_for(self, scene: ContactScene) -> Verdict:
        """On where either gear has a modification along its profile."""
        gears = (("pinion", scene.pair.pinion), ("wheel", scene.pair.wheel))
        modified = [name for name, gear in gears if not gear.modification.along_profile.neutral]
        if not modified:
            return Verdict(False, "both profiles are plain involutes", neutral=True)
        return Verdict(True, f"modified profile on {' and '.join(modified)}")

    def contribute(self, scene: ContactScene, model: ContactModel) -> ContactModel:
        """Add the gap of both flanks."""
        gears = (scene.pair.pinion, scene.pair.wheel)
        term = ModificationGap(*(gear.modification.along_profile for gear in gears))
        return replace(model, gaps=(*model.gaps, term))

    def without(self, scene: ContactScene) -> ContactScene:
        """Return the scene with plain profiles."""
        return scene.with_gears(lambda gear: {"modification": gear.modification.along_face})
