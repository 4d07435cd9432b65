"""Gap of modified flanks, for the effects that modify along the profile and along the face."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar

from fe_contact.contact import Break, flank_coordinate
from fe_contact.contact.model import ContactModel
from fe_contact.effects.effect import ContactScene, Effect, Verdict
from fe_contact.flank.extent import Extent, modification_extent
from fe_contact.geometry import FlankGrid, FlankModification, ParallelAxes
from fe_contact.types import FloatArray


@dataclass(frozen=True)
class ModificationGap:
    """Material removed from both flanks.

    Attributes
    ----------
    pinion, wheel : FlankModification
        The part of each gear's modification that this gap stands for.
    """

    pinion: FlankModification
    wheel: FlankModification

    @property
    def along_profile(self) -> bool:
        """Whether the gap depends on the roll lengths."""
        return self.pinion.varies_along_profile or self.wheel.varies_along_profile

    @property
    def only_removes(self) -> bool:
        """Whether neither flank has material added anywhere."""
        return self.pinion.only_removes and self.wheel.only_removes

    @property
    def grids(self) -> tuple[FlankGrid | None, FlankGrid | None]:
        """The free-form surfaces of both flanks."""
        return self.pinion.flank_grid, self.wheel.flank_grid

    def extent(self, pair: ParallelAxes) -> Extent:
        """Sum of the bounds of both flanks."""
        return modification_extent(
            self.pinion, pair.pinion, pair.pinion.tip_form_roll_length
        ) + modification_extent(self.wheel, pair.wheel, pair.wheel.tip_form_roll_length)

    def breaks(self, pair: ParallelAxes, face: FloatArray) -> tuple[Break, ...]:
        """Roll lengths at which reliefs and the edges of rounded or chamfered tips begin on either flank."""
        sides = ((pair.pinion, self.pinion, face), (pair.wheel, self.wheel, face - pair.axial_offset))
        return tuple(
            Break(
                index,
                flank_coordinate(gear, start.roll_length),
                1 if start.towards_tip == (index == 0) else -1,
                start.jump,
                start.bend,
                start.ends_flank,
            )
            for index, (gear, modification, position) in enumerate(sides)
            for start in modification.relief_starts(gear, position)
        )

    def __call__(
        self, pair: ParallelAxes, roll_1: FloatArray, roll_2: FloatArray, face: FloatArray
    ) -> FloatArray:
        """Sum over both flanks in m; each gear's face position counts from its own mid-face."""
        return self.pinion.material_removed(pair.pinion, roll_1, face) + self.wheel.material_removed(
            pair.wheel, roll_2, face - pair.axial_offset
        )


# Profile modification: reliefs, profile crowning and slope, cut tip edges as gaps on the line of action.


@dataclass(frozen=True)
class ProfileModification(Effect):
    """Designed deviations of either flank from the involute."""

    name: ClassVar[str] = "profile_modification"
    brings: ClassVar[str] = "profile"
    needs: ClassVar[tuple[str, ...]] = ("position",)
    adds: ClassVar[tuple[str, ...]] = ("gap",)
    cost: ClassVar[str] = "a search for the touching point of every candidate; no finite-element work"
    sources: ClassVar[tuple[str, ...]] = ("docs/effects.md#profile_modification", "ISO 21771-1")
    valid_for: ClassVar[str] = "slopes below about 0.05; tip edges that open further"

    def called_for(self, scene: ContactScene) -> Verdict:
        """On where either gear has a modification along its profile."""
        modified = [name for name, gear in scene.gears.items() if not gear.modification.along_profile.neutral]
        if not modified:
            return Verdict(False, "both profiles are plain involutes", neutral=True)
        return Verdict(True, f"modified profile on {' and '.join(modified)}")

    def contribute(self, scene: ContactScene, model: ContactModel) -> ContactModel:
        """Add the gap of both flanks."""
        term = ModificationGap(*(gear.modification.along_profile for gear in scene.gears.values()))
        return replace(model, gaps=(*model.gaps, term))

    def without(self, scene: ContactScene) -> ContactScene:
        """Return the scene with plain profiles."""
        return scene.with_gears(lambda gear: {"modification": gear.modification.along_face})


# Lead modification: helix crowning and slope, end relief, twist as gaps over the face width.


@dataclass(frozen=True)
class LeadModification(Effect):
    """Designed deviations of either flank that differ over its face."""

    name: ClassVar[str] = "lead_modification"
    brings: ClassVar[str] = "face"
    needs: ClassVar[tuple[str, ...]] = ("face position",)
    adds: ClassVar[tuple[str, ...]] = ("gap",)
    cost: ClassVar[str] = "none beside the three-dimensional model; twist: a search for touching points"
    sources: ClassVar[tuple[str, ...]] = ("docs/effects.md#lead_modification", "ISO 21771-1")
    valid_for: ClassVar[str] = "every pair in three dimensions"

    def called_for(self, scene: ContactScene) -> Verdict:
        """On where either gear has a modification that differs over its face."""
        modified = [name for name, gear in scene.gears.items() if gear.modification.varies_along_face]
        if not modified:
            return Verdict(False, "both leads are plain", neutral=True)
        return Verdict(True, f"modified lead on {' and '.join(modified)}")

    def contribute(self, scene: ContactScene, model: ContactModel) -> ContactModel:
        """Add the gap of both flanks."""
        term = ModificationGap(*(gear.modification.along_face for gear in scene.gears.values()))
        return replace(model, gaps=(*model.gaps, term))

    def across_face(self, scene: ContactScene) -> str | None:
        """Say so where there is one."""
        return (
            "lead modification"
            if any(gear.modification.varies_along_face for gear in scene.gears.values())
            else None
        )

    def without(self, scene: ContactScene) -> ContactScene:
        """Return the scene with plain leads."""
        return scene.with_gears(lambda gear: {"modification": gear.modification.along_profile})
