"""Gap of modified flanks, for the effects that modify along the profile and along the face.

A modification is a sum of parts (tip relief, crowning, a free-form grid and others), each of which removes
material over the flank. Positive gaps are removed material, m.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from fe_contact.contact import Break
from fe_contact.contact.model import ContactModel
from fe_contact.effects.effect import ContactScene, Effect, Verdict
from fe_contact.flank.extent import Extent
from fe_contact.flank.part import FlankPart
from fe_contact.flank.tooth import Tooth
from fe_contact.geometry import FlankGrid, FlankModification, ParallelAxes
from fe_contact.types import FloatArray

_ALONG_PROFILE, _ALONG_FACE = 65, 33
"""Points of the lattice that bounds parts, along roll length and face; odd, so that middles are points."""
_BETWEEN = 0.25
"""Largest departure of a part from its lattice over the second difference. A smooth part departs from the
linear interpolant by an eighth, a part with a kink by up to a quarter.
"""


@dataclass(frozen=True)
class ModificationGap:
    """Material removed from both flanks."""

    pinion: FlankModification
    wheel: FlankModification
    """`pinion`, `wheel`: The part of each gear's modification that this gap stands for."""

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
        """Return the bounds of the gap, the sum of those of both flanks."""
        on_pinion = _modification_extent(self.pinion, pair.pinion, pair.pinion.tip_form_roll_length)
        return on_pinion + _modification_extent(self.wheel, pair.wheel, pair.wheel.tip_form_roll_length)

    def breaks(self, pair: ParallelAxes, face: FloatArray) -> tuple[Break, ...]:
        """Return the breaks of the gap: the beginnings of reliefs and of rounded or chamfered tips.

        `face` are positions from mid-face of the pinion, m.
        """
        sides = ((pair.pinion, self.pinion, face), (pair.wheel, self.wheel, face - pair.axial_offset))
        return tuple(
            Break(
                gear=index,
                position=gear.flank_coordinate(start.roll_length),
                # the tip of the pinion and the root of the wheel lie on the same side of the contact
                side=1 if start.towards_tip == (index == 0) else -1,
                jump=start.jump,
                bend=start.bend,
                ends_flank=start.ends_flank,
            )
            for index, (gear, modification, position) in enumerate(sides)
            for start in modification.relief_starts(gear, position)
        )

    def __call__(
        self, pair: ParallelAxes, roll_1: FloatArray, roll_2: FloatArray, face: FloatArray
    ) -> FloatArray:
        """Return the material removed from both flanks, m, at roll lengths and positions from mid-face, m.

        `face` counts from mid-face of the pinion.
        """
        on_pinion = self.pinion.material_removed(pair.pinion, roll_1, face)
        return on_pinion + self.wheel.material_removed(pair.wheel, roll_2, face - pair.axial_offset)


def _modification_extent(modification: FlankModification, gear: Tooth, tip_form: float) -> Extent:
    """Return the extent of the material that a modification removes from the usable flank of a gear.

    It is the sum of the extents of the parts, as if all of them were deepest at one point. The usable flank
    ends at the roll length `tip_form`, m.
    """
    extents = (
        _part_extent(part, gear, tip_form)
        for part in modification.parts
        if part.varies and not any(start.ends_flank for start in part.relief_starts(gear))
    )
    extent = sum(extents, Extent())
    return replace(extent, low=max(extent.low, 0.0)) if modification.only_removes else extent


def _part_extent(part: FlankPart, gear: Tooth, tip_form: float) -> Extent:
    """Bound a part by its values on a lattice, and by its slopes between the points."""
    grid: FlankGrid | None = getattr(part, "flank_grid", None)  # only a free-form part has one
    if grid is not None:
        return grid.extent((gear.form_roll_length, gear.tip_roll_length))
    roll = np.linspace(gear.form_roll_length, tip_form, _ALONG_PROFILE)
    face = np.linspace(-0.5, 0.5, _ALONG_FACE) * gear.face_width
    removed = part.removed(gear, *np.meshgrid(roll, face, indexing="ij"))
    bends = (np.abs(np.diff(removed, 2, axis=axis)).max() for axis in (0, 1))
    between = _BETWEEN * float(sum(bends))
    secant = np.abs(np.diff(removed, axis=0)).max() / abs(roll[1] - roll[0])
    bend = np.abs(np.diff(removed, 2, axis=0)).max() / abs(roll[1] - roll[0])
    slope = float(secant + bend)
    for start in part.relief_starts(gear, 0.0):  # the slope over the roll length with which a relief begins
        jump = np.max(np.abs(start.jump)) * np.max(start.roll_length) / gear.base_radius
        slope = max(slope, float(jump))
    low, high = float(removed.min()) - between, float(removed.max()) + between
    return Extent(low, high, slope)


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
        """Call for the effect where either gear has a modification along its profile."""
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
        """Call for the effect where either gear has a modification that varies over its face."""
        modified = [name for name, gear in scene.gears.items() if gear.modification.varies_along_face]
        if not modified:
            return Verdict(False, "both leads are plain", neutral=True)
        return Verdict(True, f"modified lead on {' and '.join(modified)}")

    def contribute(self, scene: ContactScene, model: ContactModel) -> ContactModel:
        """Add the gap of both flanks."""
        term = ModificationGap(*(gear.modification.along_face for gear in scene.gears.values()))
        return replace(model, gaps=(*model.gaps, term))

    def across_face(self, scene: ContactScene) -> str | None:
        """Return the reason for a model over the face, a lead modification; None: there is none."""
        varies = any(gear.modification.varies_along_face for gear in scene.gears.values())
        return "lead modification" if varies else None

    def without(self, scene: ContactScene) -> ContactScene:
        """Return the scene with plain leads."""
        return scene.with_gears(lambda gear: {"modification": gear.modification.along_profile})
