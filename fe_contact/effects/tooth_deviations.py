"""Tooth deviations: run-out, wobble, waves and flanks of single teeth, which turn with either gear."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from fe_contact.contact.model import ContactModel, MeetingTeeth
from fe_contact.effects.effect import ContactScene, Effect, Verdict
from fe_contact.errors import InputError
from fe_contact.flank.extent import Extent
from fe_contact.geometry import (
    NO_RUN_OUT,
    ParallelAxes,
    RunOut,
    ToothFlank,
    Toothing,
    Wave,
    deviations_period,
    flanks_excess,
)
from fe_contact.types import FloatArray, IntArray


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
    flanks: tuple[ToothFlank, ...]
    period: int

    @property
    def largest(self) -> float:
        """Bound of the gap, m."""
        waves = sum(wave.amplitude for wave in self.waves)
        flanks = max((flank.largest for flank in self.flanks), default=0.0)
        return self.run_out.eccentricity + 0.5 * self.run_out.wobble + waves + flanks

    def extent(self, pair: ParallelAxes, meeting: IntArray) -> Extent:
        """Return bounds of what turns with the gear, and of the flanks of the teeth that meet."""
        gear = (pair.pinion, pair.wheel)[self.gear]
        out = self.run_out.eccentricity + 0.5 * self.run_out.wobble
        waves = sum(wave.amplitude for wave in self.waves)
        steep = sum(wave.order * wave.amplitude for wave in self.waves) + out
        turning = Extent(-out - waves, out + waves, steep / gear.base_radius)
        low, high, slope = np.zeros((3, gear.teeth))
        for flank in self.flanks:
            extent, tooth = flank.extent(gear), flank.tooth - 1
            low[tooth], high[tooth], slope[tooth] = extent.low, extent.high, extent.slope
        return turning + Extent(low, high, slope).at(meeting % self.period % gear.teeth)

    def __call__(self, teeth: MeetingTeeth) -> FloatArray:
        """Return the gap of pairs of teeth at touching points: that of the gear turned until they touch."""
        pair = teeth.pair
        own = (pair.pinion, pair.wheel)[self.gear]
        lead = math.tan(pair.base_helix_angle) / own.base_radius  # the gear turns so far per m of face
        at_pitch_point = pair.path_of_contact.pitch_point
        if self.gear == 0:
            roll, rolled, face = teeth.roll_1, teeth.roll_1 - at_pitch_point, teeth.face
        else:
            way = teeth.roll_2 - pair.mating_roll_length(at_pitch_point)
            roll, rolled, face = teeth.roll_2, -own.sign * way, teeth.face - pair.axial_offset
        tooth = teeth.meeting % self.period
        turn = 2.0 * math.pi / own.teeth * tooth + rolled / own.base_radius + teeth.face * lead
        along = face / own.face_width
        excess = self.run_out.excess(turn, along)
        for wave in self.waves:
            excess = excess + wave.excess(turn, along, lead * own.face_width)
        if self.flanks:
            excess = excess + flanks_excess(own, self.flanks, tooth % own.teeth, roll, face)
        return np.asarray(-excess)


@dataclass(frozen=True)
class ToothDeviations(Effect):
    """Run-out, waves and flanks of single teeth of both gears; the table covers more than one base pitch."""

    name: ClassVar[str] = "tooth_deviations"
    needs: ClassVar[tuple[str, ...]] = ("position", "tooth numbers")
    adds: ClassVar[tuple[str, ...]] = ("gap", "period")
    cost: ClassVar[str] = "a contact sweep for every base pitch of the period; no finite-element work"
    sources: ClassVar[tuple[str, ...]] = ("docs/effects.md#tooth_deviations", "ISO 1328-1", "ISO 1328-2")
    valid_for: ClassVar[str] = "waves longer than the contact strip is wide"

    def called_for(self, scene: ContactScene) -> Verdict:
        """On where either gear has any."""
        figures = [f"{name} {_figures(gear)}" for name, gear in scene.gears.items() if gear.deviates]
        if not figures:
            return Verdict(False, "no gear has run-out, wobble, waves or teeth that differ", neutral=True)
        return Verdict(True, f"{'; '.join(figures)}, over {_period(scene)} base pitches")

    def contribute(self, scene: ContactScene, model: ContactModel) -> ContactModel:
        """Add the gap of each gear that has any."""
        gaps = tuple(
            _TurningGap(index, gear.run_out, gear.waves, gear.tooth_flanks, _period(scene))
            for index, gear in enumerate(scene.gears.values())
            if gear.deviates
        )
        return replace(model, tooth_gaps=(*model.tooth_gaps, *gaps))

    def across_face(self, scene: ContactScene) -> str | None:
        """Wobble, waves inclined to the contact lines, and flanks of teeth that vary along the face."""
        found = dict.fromkeys(words for gear in scene.gears.values() for words in _across_face(gear).values())
        return " and ".join(found) or None

    def refuse_plane(self, scene: ContactScene) -> None:
        """Refuse what varies along the face."""
        for name, gear in scene.gears.items():
            for field, words in _across_face(gear).items():
                raise InputError(f"{name}.{field}", words, "none for a plane model", "Use the 3-D model.")

    def without(self, scene: ContactScene) -> ContactScene:
        """Return the scene of gears without them."""
        return scene.with_gears(lambda _: {"run_out": NO_RUN_OUT, "waves": (), "tooth_flanks": ()})


def sharpest_crest(pair: ParallelAxes) -> float:
    """Return the largest curvature of waves and forms of both gears over that of the plain flanks.

    At the ends of the path of contact, the crests of all of them together. At 1 a trough fits the mate.
    """
    path = pair.path_of_contact
    roll_1 = np.array([path.start, path.end])
    rolls = roll_1, pair.mating_roll_length(roll_1)
    waves = (
        (sum(wave.amplitude * wave.order**2 for wave in gear.waves) + _hollow(gear)) / np.square(roll)
        for gear, roll in zip((pair.pinion, pair.wheel), rolls, strict=True)
    )
    return float(np.max(sum(waves) / pair.relative_curvature(roll_1)))


def _hollow(gear: Toothing) -> float:
    """Return how hollow the form of a tooth is at most, as an amplitude times the square of its order."""
    u_per_turn = 2.0 * gear.base_radius / (gear.tip_roll_length - gear.form_roll_length)
    return max((flank.hollow for flank in gear.tooth_flanks), default=0.0) * u_per_turn**2


def _across_face(gear: Toothing) -> dict[str, str]:
    """Return the fields of what varies along the face of a gear, in words."""
    inclined = any(wave.amplitude and wave.face_waves for wave in gear.waves)
    flanks = any(flank.varies_along_face for flank in gear.tooth_flanks)
    found = {
        "run_out.wobble": ("wobble", bool(gear.run_out.wobble)),
        "waves": ("waves across the face", inclined),
        "tooth_flanks": ("helix deviations of teeth", flanks),
    }
    return {field: words for field, (words, there) in found.items() if there}


def _figures(gear: Toothing) -> str:
    """Return the amounts of a gear in words."""
    amounts = (("eccentricity", gear.run_out.eccentricity), ("wobble", gear.run_out.wobble))
    waves = [f"{wave.order} waves {1e6 * wave.amplitude:.3g} µm" for wave in gear.waves if wave.amplitude]
    flanks = [flank.largest for flank in gear.tooth_flanks if not flank.neutral]
    largest = f"up to {1e6 * max(flanks, default=0.0):.3g} µm"
    teeth = [f"flanks of {len(flanks)} of {gear.teeth} teeth {largest}"] if flanks else []
    return ", ".join(
        [*(f"{name} {1e6 * amount:.3g} µm" for name, amount in amounts if amount), *waves, *teeth]
    )


def _period(scene: ContactScene) -> int:
    """Return the pitches requested, or those after which both gears repeat together."""
    periods = (
        deviations_period(gear.run_out, gear.waves, gear.tooth_flanks, gear.teeth)
        for gear in scene.gears.values()
    )
    return scene.pitches or math.lcm(*periods)
