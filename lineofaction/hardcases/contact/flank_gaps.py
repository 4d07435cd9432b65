"""Gaps larger than any deflection: deep relief, teeth out of their places, noise on the flanks.

A scene returns figures, each with its least and largest allowed value. The nominal pair has two equal gears.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from fe_contact.contact import ContactProblem, solve_contact
from fe_contact.geometry import FlankGrid, FlankModification, Gear, GearPair, PitchDeviation
from fe_contact.types import FloatArray
from lineofaction.hardcases.contact.contact_case import (
    NOMINAL_TORQUE,
    contact_case,
    even_positions,
    nominal_gear,
    nominal_pair,
)
from lineofaction.hardcases.contact.laws import soundness
from lineofaction.hardcases.scene import Measured, Scenes, largest

SCENES = Scenes("contact")

_STEP = 50e-6
"""Pitch deviation of one tooth in m: six times the deflection at nominal load."""

_NOISE = 2e-6
"""Standard deviation of the noise on a flank in m."""

_SEED = 20260101

_RELIEF = 300e-6
"""Tip relief in m that no plausible load closes."""

_CENTER_DISTANCE = 80e-3
"""Center distance of the nominal pair in m."""

_TEETH = 20
"""Teeth of a nominal gear."""

_TOOTH = 5
"""The tooth with the pitch deviation."""

_POSITIONS = 48
"""Positions of the pitch error in one base pitch."""


@SCENES.add(
    "gap_beyond_deflection",
    "Relief of 0.3 mm where teeth bend by 8 µm: gaps and deflections differ by orders of magnitude, and "
    "most candidates never touch.",
    "Out of reach means without effect: taking those candidates away, or a meter further, changes no bit.",
)
def _gap_beyond_deflection() -> Sequence[Measured]:
    """Relieve both tips by 0.3 mm, so that most pairs cannot touch at any load."""
    relief = FlankModification(tip_relief=_RELIEF, tip_relief_length=3e-3)
    case = contact_case(nominal_pair(modification=relief), NOMINAL_TORQUE * np.array([0.01, 1.0, 4.0]))
    problem, solution = case.solve(even_positions(200))
    c = problem.candidates
    elastic = float((solution.deflection - solution.no_load[:, None]).max())
    # an infinite gap is no candidate at all; twice the deflection is out of reach for certain
    far = np.isfinite(c.gap) & (c.gap - solution.no_load[:, None] > 2.0 * elastic)
    at_each_load = far[:, None, :].repeat(case.plan.load.size, axis=1)  # (positions, loads, candidates)
    without = solve_contact(_with_gap(problem, np.where(far, np.inf, c.gap)), case.plan.load)
    wider = solve_contact(_with_gap(problem, np.where(far, c.gap + 1.0, c.gap)), case.plan.load)
    return (
        *soundness(problem, solution),
        Measured("candidates out of reach", far.sum(), minimum=50.0),
        Measured("largest gap over the elastic deflection", float(c.gap[far].max()) / elastic),
        Measured("force on them, N", solution.force[at_each_load].max(), maximum=0.0),
        Measured("STE without them, change in m", largest(without.deflection - solution.deflection), 0.0),
        Measured("STE with 1 m more gap, change in m", largest(wider.deflection - solution.deflection), 0.0),
    )


@SCENES.add(
    "pitch_error_beyond_deflection",
    "One tooth stands 50 µm ahead where teeth bend by 8 µm: its neighbors lose contact and STE jumps.",
    "The tooth ahead carries alone, on the curve shifted by its deviation on the line of action; all teeth "
    "ahead shift the whole curve (superposition of rigid offsets).",
)
def _pitch_error_beyond_deflection() -> Sequence[Measured]:
    """Put one tooth 50 um ahead of its place, then all of them."""
    position = even_positions(_POSITIONS)
    plain = contact_case(nominal_pair())
    _, equal = plain.solve(position)  # all teeth alike
    teeth = np.zeros(_TEETH)
    teeth[_TOOTH] = _STEP
    case = contact_case(_with_pitch(tuple(teeth)), pitches=_TEETH, bodies=plain.contact)
    pitch = np.repeat(np.arange(_TEETH), _POSITIONS)
    problem, solution = case.solve(position, case.plan.load, pitch)
    shift = _STEP * np.cos(plain.pair.pinion.transverse_pressure_angle)
    all_shifted = contact_case(_with_pitch((_STEP,) * _TEETH), bodies=plain.contact)
    shifted = all_shifted.ste(position) - equal.deflection + shift
    # the tooth of each candidate (positions, candidates): pairs count back from the pitch
    tooth = pitch[:, None] - problem.candidates.pair
    carried = np.tile(equal.force[:, 0] > 0.0, (_TEETH, 1))
    single = carried.sum(axis=1) == 1
    ahead = single & np.any(carried & (tooth == _TOOTH), axis=1)
    beside = np.abs(tooth % _TEETH - _TOOTH) <= 1
    separate = single & ~np.any(np.isfinite(problem.candidates.gap) & beside, axis=1)
    change = solution.deflection[:, 0] - np.tile(equal.deflection[:, 0], _TEETH)
    share = solution.force[:, 0].max(axis=1) / solution.force[:, 0].sum(axis=1)
    return (
        *soundness(problem, solution),
        Measured("share of the tooth that is ahead, least", share[ahead].min(), minimum=1.0),
        Measured("its STE off the shifted curve, m", largest(change[ahead] + shift), maximum=1e-15),
        Measured("STE far from it, change in m", largest(change[separate]), maximum=1e-15),
        Measured("all teeth ahead: STE off the shifted curve, m", largest(shifted), maximum=1e-15),
        Measured("positions with the one tooth alone", ahead.sum(), minimum=5.0),
    )


@SCENES.add(
    "noisy_flanks",
    "Flanks from a measurement with 2 µm of noise: bumps as high as the deflection, touching points that "
    "wander.",
    "STE grows by no less than the least and no more than the most removed, and with load; two solvers "
    "agree.",
)
def _noisy_flanks() -> Sequence[Measured]:
    """Put noise on both flanks, as a measurement would."""
    rng = np.random.default_rng(_SEED)
    plain = contact_case(nominal_pair())
    position = even_positions(200)
    smooth = plain.ste(position)
    # 25 heights; five deviations above 0, because material can only be removed
    first, second = (_with_grid(np.maximum(rng.normal(5.0 * _NOISE, _NOISE, 25), 0.0)) for _ in range(2))
    noisy = contact_case(
        GearPair(first, second, _CENTER_DISTANCE),
        NOMINAL_TORQUE * np.geomspace(1e-3, 4.0, 7),
        bodies=plain.contact,
    )
    problem, solution = noisy.solve(position)
    low, high = (sum(extreme(_heights(gear)) for gear in (first, second)) for extreme in (np.min, np.max))
    at_nominal_load = contact_case(GearPair(first, second, _CENTER_DISTANCE), bodies=plain.contact)
    _, nominal = at_nominal_load.solve(position, plain.plan.load)
    added = nominal.deflection - smooth
    return (
        *soundness(problem, solution),
        Measured("added STE over the least removed", float(added.min()) / low, minimum=1.0),
        Measured("added STE over the most removed", float(added.max()) / high, maximum=1.0),
        Measured(
            "least growth of STE with load, m",
            np.diff(solution.deflection, axis=1).min(),
            minimum=1e-12,
        ),
    )


def _with_gap(problem: ContactProblem, gap: FloatArray) -> ContactProblem:
    return problem.touching(problem.candidates.touching(replace(problem.candidates.touch, gap=gap)))


def _with_pitch(cumulative: tuple[float, ...]) -> GearPair:
    pinion = nominal_gear(pitch_deviation=PitchDeviation(cumulative))
    return GearPair(pinion, nominal_gear(), _CENTER_DISTANCE)


def _with_grid(heights: FloatArray) -> Gear:
    """Return the nominal gear with these heights removed along its profile, the same all over the face."""
    gear = nominal_gear()
    roll = np.linspace(gear.form_roll_length, gear.tip_roll_length, heights.size)
    half = 0.5 * gear.face_width
    grid = FlankGrid(tuple(roll), (-half, half), tuple((h, h) for h in heights))
    return nominal_gear(modification=FlankModification(flank_grid=grid))


def _heights(gear: Gear) -> FloatArray:
    """Return the material removed at dense points along the profile, m."""
    roll = np.linspace(gear.form_roll_length, gear.tip_roll_length, 20_001)
    return gear.modification.material_removed(gear, roll)
