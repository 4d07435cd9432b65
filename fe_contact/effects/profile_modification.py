"""Profile modification: tip and root relief, profile crowning and slope as gaps on the line of action."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar

from fe_contact.contact.model import ContactModel
from fe_contact.effects.effect import ContactScene, Verdict
from fe_contact.geometry import FlankModification, GearPair
from fe_contact.types import FloatArray


@dataclass(frozen=True)
class ModificationGap:
    """Material removed from both flanks in m at the touching points."""

    along_profile: bool

    def __call__(
        self, pair: GearPair, roll_1: FloatArray, roll_2: FloatArray, face: FloatArray
    ) -> FloatArray:
        """Sum over both flanks."""
        pinion, wheel = pair.pinion, pair.wheel
        return pinion.modification.material_removed(
            pinion, roll_1, face
        ) + wheel.modification.material_removed(wheel, roll_2, face - pair.axial_offset)


@dataclass(frozen=True)
class ProfileModification:
    """Designed deviations of either flank from the involute."""

    name: ClassVar[str] = "profile_modification"
    needs: ClassVar[tuple[str, ...]] = ("position",)
    adds: ClassVar[tuple[str, ...]] = ("gap",)
    cost: ClassVar[str] = "none"
    sources: ClassVar[tuple[str, ...]] = ("docs/effects/profile_modification.md", "ISO 21771-1")
    valid_for: ClassVar[str] = "slopes below about 0.02 (the touching point stays on the line of action)"

    def called_for(self, scene: ContactScene) -> Verdict:
        """On where either gear has a modification."""
        neutral = FlankModification()
        modified = [
            n
            for n, g in (("pinion", scene.pair.pinion), ("wheel", scene.pair.wheel))
            if g.modification != neutral
        ]
        if not modified:
            return Verdict(False, "both flanks are plain involutes", "nothing")
        return Verdict(True, f"modified flank on {' and '.join(modified)}", "up to the modification itself")

    def contribute(self, scene: ContactScene, model: ContactModel) -> ContactModel:
        """Add the gap of both flanks."""
        gears = (scene.pair.pinion, scene.pair.wheel)
        term = ModificationGap(any(gear.modification.varies_along_profile for gear in gears))
        return replace(model, gaps=(*model.gaps, term))
