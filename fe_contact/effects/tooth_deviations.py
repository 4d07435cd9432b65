"""Tooth deviations: run-out, wobble, waves and flanks of single teeth, which turn with either gear."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from fe_contact.contact.model import ContactModel
from fe_contact.contact.touch import STEP
from fe_contact.effects.effect import ContactScene, Effect, Verdict
from fe_contact.effects.turning_gap import TurningGap
from fe_contact.errors import InputError
from fe_contact.geometry import NO_RUN_OUT, ParallelAxes, Toothing, deviations_period

_POINTS = 513
"""Number of points of the path of contact at which surfaces are sampled."""


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
        """Call for the effect where either gear has run-out, wobble, waves or teeth that differ."""
        figures = [f"{name} {_figures(gear)}" for name, gear in scene.gears.items() if gear.deviates]
        if not figures:
            return Verdict(False, "no gear has run-out, wobble, waves or teeth that differ", neutral=True)
        return Verdict(True, f"{'; '.join(figures)}, over {_period(scene)} base pitches")

    def contribute(self, scene: ContactScene, model: ContactModel) -> ContactModel:
        """Add the gap of each gear that has any."""
        gaps = tuple(
            TurningGap.of(index, gear, _period(scene))
            for index, gear in enumerate(scene.gears.values())
            if gear.deviates
        )
        return replace(model, tooth_gaps=(*model.tooth_gaps, *gaps))

    def across_face(self, scene: ContactScene) -> str | None:
        """Name wobble, waves inclined to the contact lines, and flanks of teeth that vary along the face."""
        causes = dict.fromkeys(text for gear in scene.gears.values() for text in _across_face(gear).values())
        return " and ".join(causes) or None

    def refuse_plane(self, scene: ContactScene) -> None:
        """Refuse deviations that vary along the face."""
        for name, gear in scene.gears.items():
            for field, text in _across_face(gear).items():
                raise InputError(f"{name}.{field}", text, "none for a plane model", "Use the 3-D model.")

    def without(self, scene: ContactScene) -> ContactScene:
        """Return the scene of gears without these deviations."""
        return scene.with_gears(lambda _: {"run_out": NO_RUN_OUT, "waves": (), "tooth_flanks": ()})


def sharpest_crest(pair: ParallelAxes) -> float:
    """Return the largest curvature of waves and forms of both gears over that of the plain flanks.

    Waves and forms count at the ends of the path of contact, where the curvatures of all of them add up.
    Measured surfaces count anywhere on it, as the curvature over the width of a contact strip. At a ratio of
    1 a trough of one gear has the curvature of the other gear's flank.
    """
    path = pair.path_of_contact
    roll_1 = np.array([path.start, path.end])
    rolls = roll_1, pair.mating_roll_length(roll_1)
    waves = (
        (sum(wave.amplitude * wave.order**2 for wave in gear.waves) + _hollow(gear)) / np.square(roll)
        for gear, roll in zip((pair.pinion, pair.wheel), rolls, strict=True)
    )
    surfaces = sum(_hollow_surface(pair, index) for index in (0, 1))
    return float(np.max(sum(waves) / pair.relative_curvature(roll_1))) + surfaces


def _hollow_surface(pair: ParallelAxes, index: int) -> float:
    """Return the largest hollow curvature of measured surfaces of a gear over that of the plain flanks.

    The curvature is a second difference over both ends and the middle of a strip, `STEP` from each other.
    """
    gear = (pair.pinion, pair.wheel)[index]
    roll_1 = np.linspace(pair.path_of_contact.start, pair.path_of_contact.end, _POINTS)
    roll = roll_1 if index == 0 else pair.mating_roll_length(roll_1)
    curvature = pair.relative_curvature(roll_1)
    strip = STEP / curvature
    # along the flank, the square of the roll length grows by twice the base radius times the distance
    squares = (roll**2 + 2.0 * gear.base_radius * distance for distance in (-strip, 0.0 * strip, strip))
    inner, outer = sorted((gear.form_roll_length, gear.tip_roll_length))
    rolls = np.clip(np.sqrt(np.maximum(list(squares), 0.0)), inner, outer)
    mid_face, deepest = np.zeros(rolls.shape), 0.0
    for flank in gear.tooth_flanks:
        if flank.flank_grid is not None:
            before, center, after = flank.flank_grid.material_removed(rolls, mid_face)
            deepest = max(deepest, float(np.max((2.0 * center - before - after) / (strip**2 * curvature))))
    return deepest


def _hollow(gear: Toothing) -> float:
    """Return the largest hollow curvature of a tooth's form, as that of a wave: amplitude times order^2."""
    u_per_turn = 2.0 * gear.base_radius / (gear.tip_roll_length - gear.form_roll_length)
    return max((flank.hollow for flank in gear.tooth_flanks), default=0.0) * u_per_turn**2


def _across_face(gear: Toothing) -> dict[str, str]:
    """Return the fields of the deviations that vary along the face of a gear, in words."""
    inclined = any(wave.amplitude and wave.face_waves for wave in gear.waves)
    flanks = any(flank.varies_along_face for flank in gear.tooth_flanks)
    causes = {
        "run_out.wobble": ("wobble", bool(gear.run_out.wobble)),
        "waves": ("waves across the face", inclined),
        "tooth_flanks": ("helix deviations of teeth", flanks),
    }
    return {field: text for field, (text, is_present) in causes.items() if is_present}


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
    """Return the requested period, or the period after which both gears repeat together."""
    periods = (
        deviations_period(gear.run_out, gear.waves, gear.tooth_flanks, gear.teeth)
        for gear in scene.gears.values()
    )
    return scene.pitches or math.lcm(*periods)
