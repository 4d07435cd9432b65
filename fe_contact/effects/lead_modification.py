"""Lead modification: helix crowning and slope, end relief, twist as gaps over the face width."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar

from fe_contact.contact.model import ContactModel
from fe_contact.effects.effect import ContactScene, Effect, Verdict
from fe_contact.effects.modification_gap import ModificationGap


@dataclass(frozen=True)
class LeadModification(Effect):
    """Designed deviations of either flank that differ over its face."""

    name: ClassVar[str] = "lead_modification"
    brings: ClassVar[str] = "face"
    needs: ClassVar[tuple[str, ...]] = ("face position",)
    adds: ClassVar[tuple[str, ...]] = ("gap",)
    cost: ClassVar[str] = "none beside the three-dimensional model; twist: a search for touching points"
    sources: ClassVar[tuple[str, ...]] = ("docs/effects/lead_modification.md", "ISO 21771-1")
    valid_for: ClassVar[str] = "every pair in three dimensions"

    def called_for(self, scene: ContactScene) -> Verdict:
        """On where either gear has a modification that differs over its face."""
        gears = (("pinion", scene.pair.pinion), ("wheel", scene.pair.wheel))
        modified = [name for name, gear in gears if gear.modification.varies_along_face]
        if not modified:
            return Verdict(False, "both leads are plain", neutral=True)
        return Verdict(True, f"modified lead on {' and '.join(modified)}")

    def contribute(self, scene: ContactScene, model: ContactModel) -> ContactModel:
        """Add the gap of both flanks."""
        gears = (scene.pair.pinion, scene.pair.wheel)
        term = ModificationGap(*(gear.modification.along_face for gear in gears))
        return replace(model, gaps=(*model.gaps, term))

    def across_face(self, scene: ContactScene) -> str | None:
        """Say so where there is one."""
        gears = (scene.pair.pinion, scene.pair.wheel)
        return "lead modification" if any(gear.modification.varies_along_face for gear in gears) else None

    def without(self, scene: ContactScene) -> ContactScene:
        """Return the scene with plain leads."""
        return scene.with_gears(lambda gear: {"modification": gear.modification.along_profile})
