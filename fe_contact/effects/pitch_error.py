"""Pitch error: teeth of either gear displaced from their nominal places, tooth by tooth."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from fe_contact.contact.model import ContactModel, MeetingTeeth
from fe_contact.effects.effect import ContactScene, Effect, Verdict
from fe_contact.flank.extent import Extent
from fe_contact.geometry import ParallelAxes, PitchDeviation
from fe_contact.types import FloatArray, IntArray


@dataclass(frozen=True)
class PitchGap:
    """Gap of every tooth of a gear along the line of action, m, in the order of meshing.

    A positive gap is a flank that stands back from its nominal place. The table repeats after `period` base
    pitches, also where the teeth would not.
    """

    gear: int
    """Index of the gear in the pair: 0 or 1."""
    teeth: tuple[float, ...]
    """Gaps of the teeth, m; one entry: the gap of all teeth."""
    period: int
    """Base pitches after which the same teeth meet again, in the table."""

    @property
    def largest(self) -> float:
        """Bound of the gap, m."""
        return max(self.teeth)

    @property
    def extents(self) -> Extent:
        """Bounds of the gap: itself, as it is the same all over a flank."""
        gap = np.array(self.teeth)
        return Extent(gap, gap)

    def __call__(self, teeth: MeetingTeeth) -> FloatArray:
        """Return the gap of the tooth that meets, m: the same all over a flank."""
        return np.array(self.teeth)[self.tooth(teeth.meeting)]

    def tooth(self, meeting: IntArray) -> IntArray:
        """Return which teeth meet, the first is 0."""
        return meeting % self.period % len(self.teeth)

    def nodes(self, _pair: ParallelAxes, _tooth: int) -> FloatArray:
        """Return an empty array: a gap that is the same all over a flank needs no nodes."""
        return np.zeros(0)


@dataclass(frozen=True)
class PitchError(Effect):
    """Cumulative pitch deviations of both gears; the table then covers more than one base pitch."""

    name: ClassVar[str] = "pitch_error"
    needs: ClassVar[tuple[str, ...]] = ("position", "tooth numbers")
    adds: ClassVar[tuple[str, ...]] = ("gap", "period")
    cost: ClassVar[str] = "a contact sweep for every base pitch of the period; no finite-element work"
    sources: ClassVar[tuple[str, ...]] = ("docs/effects.md#pitch_error", "ISO 1328-1")
    valid_for: ClassVar[str] = "flanks displaced as a whole"

    def called_for(self, scene: ContactScene) -> Verdict:
        """Call for the effect where a tooth of either gear has a pitch deviation."""
        deviations = {name: gear.pitch_deviation for name, gear in scene.gears.items()}
        figures = [
            f"{name} f_p {1e6 * deviation.single:.3g} µm, F_p {1e6 * deviation.total:.3g} µm"
            for name, deviation in deviations.items()
            if not deviation.neutral
        ]
        if not figures:
            return Verdict(False, "no tooth has a pitch deviation", neutral=True)
        return Verdict(True, f"{', '.join(figures)}, over {_period(scene)} base pitches")

    def contribute(self, scene: ContactScene, model: ContactModel) -> ContactModel:
        """Add the gap of both gears' teeth."""
        if all(gear.pitch_deviation.neutral for gear in scene.gears.values()):
            return model
        gaps = []
        for index, gear in enumerate(scene.gears.values()):
            # a tooth that is ahead by its deviation touches earlier: its gap is negative
            gap = -gear.pitch_deviation.on_line_of_action(gear.transverse_pressure_angle)
            gaps.append(PitchGap(index, tuple(gap.tolist()), _period(scene)))
        return replace(model, tooth_gaps=(*model.tooth_gaps, *gaps))

    def without(self, scene: ContactScene) -> ContactScene:
        """Return the scene with all teeth in their places."""
        return scene.with_gears(lambda _: {"pitch_deviation": PitchDeviation()})


def _period(scene: ContactScene) -> int:
    """Return the requested period, or the period after which the deviations of both gears repeat together."""
    return scene.pitches or math.lcm(*(gear.pitch_deviation.period for gear in scene.gears.values()))
