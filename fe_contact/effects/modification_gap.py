"""Gap of modified flanks, for the effects that modify along the profile and along the face."""

from __future__ import annotations

from dataclasses import dataclass

from fe_contact.contact import Break, flank_coordinate
from fe_contact.geometry import FlankModification, ParallelAxes
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
