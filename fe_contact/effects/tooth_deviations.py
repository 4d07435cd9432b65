"""Tooth deviations: run-out, wobble and waves, which turn with either gear."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from fe_contact.contact.model import ContactModel, MeetingTeeth
from fe_contact.effects.effect import ContactScene, Effect, Verdict
from fe_contact.geometry import NO_RUN_OUT, ParallelAxes, RunOut, Toothing, Wave, deviations_period
from fe_contact.types import FloatArray


@dataclass(frozen=True)
class _TurningGap:
    """Gap along the line of action by what turns with one gear, m.

    Attributes
    ----------
    gear : int
        0 is the pinion, 1 the wheel.
    period : int
        Base pitches after which it is taken to repeat.
    """

    gear: int
    run_out: RunOut
    waves: tuple[Wave, ...]
    period: int

    @property
    def largest(self) -> float:
        """Bound of the gap, m."""
        waves = sum(wave.amplitude for wave in self.waves)
        return self.run_out.eccentricity + 0.5 * self.run_out.wobble + waves

    def __call__(self, teeth: MeetingTeeth) -> FloatArray:
        """Return the gap of pairs of teeth at touching points: that of the gear turned until they touch."""
        pair = teeth.pair
        own = (pair.pinion, pair.wheel)[self.gear]
        lead = math.tan(pair.base_helix_angle) / own.base_radius  # the gear turns so far per m of face
        at_pitch_point = pair.path_of_contact.pitch_point
        if self.gear == 0:
            rolled, along = teeth.roll_1 - at_pitch_point, teeth.face
        else:
            way = teeth.roll_2 - pair.mating_roll_length(at_pitch_point)
            rolled, along = -own.sign * way, teeth.face - pair.axial_offset
        tooth = 2.0 * math.pi / own.teeth * (teeth.meeting % self.period)
        turn = tooth + rolled / own.base_radius + teeth.face * lead
        along = along / own.face_width
        excess = self.run_out.excess(turn, along)
        for wave in self.waves:
            excess = excess + wave.excess(turn, along, lead * own.face_width)
        return np.asarray(-excess)


@dataclass(frozen=True)
class ToothDeviations(Effect):
    """Run-out, wobble and waves of both gears; the table then covers more than one base pitch."""

    name: ClassVar[str] = "tooth_deviations"
    needs: ClassVar[tuple[str, ...]] = ("position", "tooth numbers")
    adds: ClassVar[tuple[str, ...]] = ("gap", "period")
    cost: ClassVar[str] = "a contact sweep for every base pitch of the period; no finite-element work"
    sources: ClassVar[tuple[str, ...]] = ("docs/effects.md#tooth_deviations", "ISO 1328-1", "ISO 1328-2")
    valid_for: ClassVar[str] = "waves longer than the contact strip is wide"

    def called_for(self, scene: ContactScene) -> Verdict:
        """On where either gear has any."""
        figures = [f"{name} {_figures(gear)}" for name, gear in scene.gears.items() if _deviates(gear)]
        if not figures:
            return Verdict(False, "no gear has run-out, wobble or waves", neutral=True)
        return Verdict(True, f"{'; '.join(figures)}, over {_period(scene)} base pitches")

    def contribute(self, scene: ContactScene, model: ContactModel) -> ContactModel:
        """Add the gap of each gear that has any."""
        gaps = tuple(
            _TurningGap(index, gear.run_out, gear.waves, _period(scene))
            for index, gear in enumerate(scene.gears.values())
            if _deviates(gear)
        )
        return replace(model, tooth_gaps=(*model.tooth_gaps, *gaps))

    def across_face(self, scene: ContactScene) -> str | None:
        """Wobble, and waves whose crests are inclined to the contact lines."""
        gears = scene.gears.values()
        tilted = any(gear.run_out.wobble for gear in gears)
        inclined = any(wave.amplitude and wave.face_waves for gear in gears for wave in gear.waves)
        found = [words for words, there in (("wobble", tilted), ("waves across the face", inclined)) if there]
        return " and ".join(found) or None

    def without(self, scene: ContactScene) -> ContactScene:
        """Return the scene of gears without them."""
        return scene.with_gears(lambda _: {"run_out": NO_RUN_OUT, "waves": ()})


def sharpest_crest(pair: ParallelAxes) -> float:
    """Return the curvature of the waves of both gears over that of the plain flanks, where that is largest.

    At the ends of the path of contact, the crests of all waves together. At 1 a trough fits the mate.
    """
    path = pair.path_of_contact
    roll_1 = np.array([path.start, path.end])
    rolls = roll_1, pair.mating_roll_length(roll_1)
    waves = (
        sum(wave.amplitude * wave.order**2 for wave in gear.waves) / np.square(roll)
        for gear, roll in zip((pair.pinion, pair.wheel), rolls, strict=True)
    )
    return float(np.max(sum(waves) / pair.relative_curvature(roll_1)))


def _deviates(gear: Toothing) -> bool:
    return not gear.run_out.neutral or any(wave.amplitude for wave in gear.waves)


def _figures(gear: Toothing) -> str:
    """Return the amounts of a gear in words."""
    amounts = (("eccentricity", gear.run_out.eccentricity), ("wobble", gear.run_out.wobble))
    waves = (f"{wave.order} waves {1e6 * wave.amplitude:.3g} um" for wave in gear.waves if wave.amplitude)
    return ", ".join([*(f"{name} {1e6 * amount:.3g} um" for name, amount in amounts if amount), *waves])


def _period(scene: ContactScene) -> int:
    """Return the pitches requested, or those after which both gears repeat together."""
    periods = (deviations_period(gear.run_out, gear.waves, gear.teeth) for gear in scene.gears.values())
    return scene.pitches or math.lcm(*periods)
