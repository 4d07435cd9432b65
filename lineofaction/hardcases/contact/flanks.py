"""Hard contact on flanks: loads, handover, edges, gaps."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np
from scipy.optimize import brentq

from fe_contact.analysis.analyze import analyze
from fe_contact.contact import ContactProblem, ContactSolution, solve_contact
from fe_contact.errors import InputError
from fe_contact.geometry import FlankGrid, FlankModification, Gear, GearPair, PitchDeviation
from fe_contact.types import FloatArray
from lineofaction.hardcases.contact.laws import (
    NOMINAL_TORQUE,
    Posed,
    even_positions,
    mean_off,
    nominal_gear,
    nominal_pair,
    posed,
    range_off,
    soundness,
)
from lineofaction.hardcases.scene import Measured, Scenes

SCENES = Scenes("contact")

_DECADES = np.geomspace(1e-4, 1e3, 29)


@SCENES.add(
    "load_seven_decades",
    "One table holds 1e-4 and 1e3 times the nominal load: patches fit for the highest load are wider than "
    "the tooth, and forces differ by 1e7.",
    "STE grows with load, the tangent compliance never does, two solvers agree, and the curve at nominal "
    "load is that of a table which holds nothing else.",
)
def _seven_decades() -> Sequence[Measured]:
    """Solve one table over seven decades of load, and its nominal curve alone."""
    wide = posed(nominal_pair(), NOMINAL_TORQUE * _DECADES)
    problem, solution = wide.solve(even_positions(48))
    alone = posed(nominal_pair())
    nominal = alone.ste(even_positions(48))[:, 0]
    here = solution.deflection[:, int(np.argmin(np.abs(_DECADES - 1.0)))]
    elastic = solution.deflection - solution.no_load[:, None]
    stiffening = np.diff(solution.tangent, axis=1) / solution.tangent[:, :-1]
    return (
        *soundness(problem, solution),
        Measured(
            "least growth of STE from load to load",
            float(np.min(elastic[:, 1:] / elastic[:, :-1])),
            least=1.0 + 1e-9,
        ),
        Measured("largest growth of the tangent compliance", float(stiffening.max()), most=1e-9),
        Measured(
            "mean STE at nominal load, against a table of that load alone", mean_off(here, nominal), 5e-3
        ),
        Measured("peak-to-peak likewise", range_off(here, nominal), most=2e-2),
        Measured("points whose contact outgrew its patch", float(solution.beyond.sum())),
    )


@SCENES.add(
    "zero_load",
    "At zero load no tangent stiffness exists and every figure is 0/0.",
    "STE tends to the rigid gap, where the table's force is exactly zero; a load of zero is refused by name.",
)
def _zero_load() -> Sequence[Measured]:
    """Go to zero load in the solver, in the table and at the entry point."""
    relief = FlankModification(tip_relief=20e-6, tip_relief_length=2e-3, profile_crowning=5e-6)
    pair = nominal_pair(modification=relief)
    case = posed(pair, NOMINAL_TORQUE * np.geomspace(1e-15, 1.0, 6))
    problem, solution = case.solve(even_positions(48))
    left = (solution.deflection[:, 0] - solution.no_load) / solution.deflection[:, -1]
    table = analyze(pair, torques=[NOMINAL_TORQUE], level="draft", positions=48, receipt="minimal")
    at_rest = table.ste(table.position, 0.0)
    lift_off = table.no_load_transmission_error[:, 0, 0]
    try:
        analyze(pair, torques=[0.0, NOMINAL_TORQUE])
        refused = ""
    except InputError as error:
        refused = error.field
    return (
        *soundness(problem, solution),
        Measured("STE left at 1e-15 of the load, over its nominal value", float(left.max()), 1e-12, 0.0),
        Measured("table at zero force against the rigid gap, m", float(np.ptp(at_rest - lift_off)), 1e-16),
        Measured("force at lift-off, N", float(table.force_at(table.position, lift_off).force.max()), 0.0),
        Measured("zero in a list of torques refused by its name", float(refused == "torques[0]"), least=1.0),
    )


# A tooth pair that just touches under load: on the border of the active set.


_POSITION = np.array([0.3])
_LOADS = np.array([0.5, 1.0 - 1e-6, 1.0 + 1e-6, 1.0 + 1e-3])
_LENGTH = 2.5e-3
"""Of the relief in m, along the radius."""
_NUDGES = np.array([-1e-3, -1e-6, -1e-9, -1e-12, -1e-15, 0.0, 1e-15, 1e-12, 1e-9, 1e-6, 1e-3])


@SCENES.add(
    "handover_touching",
    "Tip relief equal to the deflection to the last digit: the entering pair touches without force, so that"
    " rounding decides whether it belongs to the active set.",
    "The gap is that of a straight ramp; STE rises with relief and never faster than it (the deflection is "
    "non-expansive in the gaps), and the pair carries a millionth above the load that brings it into touch; "
    "through nudges of 1e-15 to 1e-3; two solvers agree.",
)
def _relief_that_touches() -> Sequence[Measured]:
    """Find the tip relief with which the second pair carries nothing and gapes nowhere; nudge it."""
    case = posed(nominal_pair())
    exact = brentq(lambda relief: _reach(case, relief), 1e-6, 100e-6, xtol=1e-18, rtol=1e-15)
    reliefs = exact * (1.0 + _NUDGES)
    solved = [_solve(case, relief) for relief in reliefs]
    ste = np.array([solution.deflection[0, 0] for _, solution in solved])
    rise, widening = np.diff(ste), np.diff(reliefs)
    rounding = 1e-14 * ste.max()
    raised = _raised(*solved[_NUDGES.size // 2])
    checks = [soundness(*each) for each in (*solved, raised)]
    entering = np.sort(raised[1].force[0], axis=1)[:, -2] / raised[1].load
    return (
        *(max(column, key=lambda m: m.value) for column in zip(*checks, strict=True)),
        Measured("relief found, µm", 1e6 * exact),
        Measured("its gap off the closed form of a straight ramp", _off_the_ramp(case, exact), most=1e-3),
        Measured("share of the touching pair", float(_share(*solved[_NUDGES.size // 2])), most=1e-9),
        Measured("its share a millionth below the load at which it touches", float(entering[1]), most=0.0),
        Measured("a millionth above it, raised to it", float(entering[2]), most=1e-6, least=1e-9),
        Measured("least rise of STE with relief, m", float((rise + rounding).min()), least=0.0),
        Measured("largest rise over the relief's", float(((rise - rounding) / widening).max()), most=1.0),
    )


def _solve(case: Posed, relief: float) -> tuple[ContactProblem, ContactSolution]:
    """Solve with a linear relief of the driven tip, which enters the mesh."""
    modification = FlankModification(tip_relief=float(relief), tip_relief_length=_LENGTH)
    pair = GearPair(nominal_gear(), nominal_gear(modification=modification), case.pair.center_distance)
    relieved = posed(pair, case.pair.torque(case.plan.load), bodies=case.contact)
    return relieved.solve(_POSITION, case.plan.load)


def _raised(problem: ContactProblem, touching: ContactSolution) -> tuple[ContactProblem, ContactSolution]:
    """Raise the load through that at which the pair touches: it was out of contact at the load before."""
    return problem, solve_contact(problem, touching.load[-1] * _LOADS)


def _reach(case: Posed, relief: float) -> float:
    """Return how far the weaker pair is from touching: < 0 it carries (share), > 0 it gapes (um)."""
    problem, solution = _solve(case, relief)
    force = solution.force[0, 0]
    weaker = int(np.argsort(force)[-2])
    if force[weaker] > 0.0:
        return -float(force[weaker] / force.sum())
    c = problem.candidates
    gap = c.gap[0] * c.motion_arm[0] + problem.moved(solution.force)[0, 0]
    slack = gap - c.motion_arm[0] * solution.deflection[0, 0]
    return 1e6 * float(np.min(slack[force == 0.0]))


def _off_the_ramp(case: Posed, relief: float) -> float:
    """Return how far the entering pair's gap is off that of a ramp of height c and slope m along the flank.

    It is c - R m^2/2 along the normal, which gear 2 closes by a lag of 1/(1 - s) times that, s the slope over
    its roll length.
    """
    problem, _ = _solve(case, relief)
    pair, gear = case.pair, case.pair.wheel
    start, tip = gear.roll_length(gear.tip_radius - _LENGTH), gear.tip_roll_length
    roll_1, roll_2 = pair.roll_lengths(_POSITION[:, None], problem.candidates.pair)
    entering = int(np.flatnonzero((roll_2[0] > start) & (roll_2[0] < tip))[0])
    first, second = float(roll_1[0, entering]), float(roll_2[0, entering])
    height = relief * (second - start) / (tip - start)
    by_roll = relief / (tip - start)
    slope = by_roll * gear.base_radius / second
    radius = 1.0 / (1.0 / first + 1.0 / second)
    lag = (height - 0.5 * radius * slope**2) / (1.0 - by_roll)
    return abs(float(problem.candidates.gap[0, entering]) / lag - 1.0)


def _share(problem: ContactProblem, solution: ContactSolution) -> float:
    """Return the load share of the weakest pair but those that carry nothing."""
    force = np.sort(solution.force[0, 0])
    return float(force[-2] / force.sum())


# Contact at the tip edges, with teeth whose tips are sharp, pointed or rounded.


_POINTED = 0.02
"""Tip thickness of the sharp teeth in modules."""
_ROUNDING = 0.15e-3
"""Radial height of the rounded tip edge in m."""


@SCENES.add(
    "tip_edge_high_load",
    "At ten times the nominal load whole pairs hang on a tip edge, off the line of action, with arms that "
    "differ between the gears.",
    "More places to touch never raise STE; the curve is continuous; two solvers agree.",
)
def _tip_edge_at_high_load() -> Sequence[Measured]:
    """Load the nominal pair tenfold and look at how its tip edges enter and leave."""
    case = posed(nominal_pair(), [10.0 * NOMINAL_TORQUE])
    problem, solution = case.solve(even_positions(400))
    without = case.with_model(corner_contact=False).solve(even_positions(400), case.plan.load)[1]
    saved = (without.deflection - solution.deflection) / solution.deflection
    return (
        *soundness(problem, solution),
        Measured("least relief by the tip edges", float(saved.min()), least=-1e-12),
        Measured("largest relief by the tip edges", float(saved.max()), least=0.02),
        _smoothness(case),
    )


@SCENES.add(
    "sharp_tips",
    "Teeth of 0.02 modules thickness at the tip: a wedge of elements, and no room for a load patch.",
    "Two meshes agree, the curve is continuous, two solvers agree.",
)
def _sharp_tips() -> Sequence[Measured]:
    """Raise the tips until next to nothing is left of them."""
    highest = brentq(lambda h: _tall(h).tip_tooth_thickness - _POINTED * 4e-3, 1.0, 1.7, xtol=1e-10)
    gear = _tall(highest)
    coarse, fine = (posed(GearPair(gear, gear), level=level) for level in ("standard", "fine"))
    problem, solution = fine.solve(even_positions(200))
    rougher = coarse.solve(even_positions(200), fine.plan.load)[1]
    return (
        *soundness(problem, solution),
        Measured("tip thickness, modules", gear.tip_tooth_thickness / gear.normal_module),
        Measured(
            "mean STE of two meshes apart", mean_off(rougher.deflection, solution.deflection), most=3e-3
        ),
        Measured("peak-to-peak likewise", range_off(rougher.deflection, solution.deflection), most=2e-2),
        _smoothness(coarse),
    )


@SCENES.add(
    "rounded_tips",
    "A tip edge rounded over 0.15 mm: the relief is so steep that the touching point leaves the line of "
    "action.",
    "STE changes by less than 1 nm with 1 nm of rounding, rises with its depth, and is continuous; a "
    "rounding of 0.2 mm turns the normal, so that lever arms may lower STE by 2 %.",
)
def _rounded_tips() -> Sequence[Measured]:
    """Round the tip edges off, by a relief steep enough to take them out of contact."""
    sharp = posed(nominal_pair(), [2.0 * NOMINAL_TORQUE])
    position = even_positions(200)
    plain = sharp.ste(position)
    curves = []
    for depth in (0.0, 1e-9, 2e-6, 20e-6, 200e-6):
        pair = nominal_pair(
            modification=(
                FlankModification(
                    tip_relief=depth,
                    tip_relief_length=_ROUNDING if depth else 0.0,
                    tip_relief_shape="parabolic",
                )
            )
        )
        case = posed(pair, [2.0 * NOMINAL_TORQUE], bodies=sharp.contact)
        problem, solution = case.solve(position)
        curves.append(solution.deflection)
    *rises, turned = (float(np.min(deep - shallow)) for shallow, deep in pairwise(curves))
    return (
        *soundness(problem, solution),
        Measured("no rounding against none given, m", float(np.ptp(curves[0] - plain)), most=0.0),
        Measured("1 nm of rounding, largest change of STE, m", _largest(curves[1] - plain), most=1e-9),
        Measured("least rise of STE with the depth, m", min(rises), least=-1e-14),
        Measured("least rise with a normal that turns, over STE", turned / float(plain.max()), least=-0.02),
        _smoothness(case),
    )


def _tall(addendum: float) -> Gear:
    """Return the nominal gear with another addendum and room for its mate's."""
    return nominal_gear(
        addendum_coefficient=addendum, dedendum_coefficient=addendum + 0.15, root_radius_coefficient=0.1,
        teeth=40, bore_diameter=80e-3,
    )  # fmt: skip


def _smoothness(case: Posed) -> Measured:
    """Return how the largest step of STE shrinks on positions four times as close: 1/4 if smooth."""
    steps = []
    for count in (256, 1024):
        curve = case.ste(even_positions(count))[:, -1]
        steps.append(_largest(np.diff(curve, append=curve[0])))
    return Measured("largest step of STE, at a quarter of the spacing", steps[1] / steps[0], most=0.4)


def _largest(values: FloatArray) -> float:
    return float(np.abs(values).max())


# Gaps larger than any deflection: deep relief, teeth out of their places, noise on the flanks.


_STEP = 50e-6
"""Pitch deviation of one tooth in m: six times the deflection at nominal load."""
_NOISE = 2e-6
"""Standard deviation of the noise on a flank in m."""
_SEED = 20260101


@SCENES.add(
    "gap_beyond_deflection",
    "Relief of 0.3 mm where teeth bend by 8 µm: gaps and deflections differ by orders of magnitude, and "
    "most candidates never touch.",
    "Out of reach means without effect: taking those candidates away, or a meter further, changes no bit.",
)
def _gap_beyond_deflection() -> Sequence[Measured]:
    """Relieve both tips by 0.3 mm, so that most pairs cannot touch whatever the load."""
    relief = FlankModification(tip_relief=300e-6, tip_relief_length=3e-3)
    case = posed(nominal_pair(modification=relief), NOMINAL_TORQUE * np.array([0.01, 1.0, 4.0]))
    problem, solution = case.solve(even_positions(200))
    c = problem.candidates
    elastic = float((solution.deflection - solution.no_load[:, None]).max())
    far = np.isfinite(c.gap) & (c.gap - solution.no_load[:, None] > 2.0 * elastic)
    without = solve_contact(_with_gap(problem, np.where(far, np.inf, c.gap)), case.plan.load)
    wider = solve_contact(_with_gap(problem, np.where(far, c.gap + 1.0, c.gap)), case.plan.load)
    return (
        *soundness(problem, solution),
        Measured("candidates out of reach", float(far.sum()), least=50.0),
        Measured("largest gap over the elastic deflection", float(c.gap[far].max()) / elastic),
        Measured("force on them, N", float(solution.force[far[:, None, :].repeat(3, 1)].max()), most=0.0),
        Measured("STE without them, change in m", _largest(without.deflection - solution.deflection), 0.0),
        Measured("STE with 1 m more gap, change in m", _largest(wider.deflection - solution.deflection), 0.0),
    )


@SCENES.add(
    "pitch_error_beyond_deflection",
    "One tooth stands 50 µm ahead where teeth bend by 8 µm: its neighbors lose contact and STE jumps.",
    "The tooth ahead carries alone, on the curve shifted by its deviation on the line of action; all teeth "
    "ahead shift the whole curve (superposition of rigid offsets).",
)
def _pitch_error_beyond_deflection() -> Sequence[Measured]:
    """Put one tooth 50 um ahead of its place, then all of them."""
    position = even_positions(48)
    plain = posed(nominal_pair())
    _, alone = plain.solve(position)
    teeth = np.zeros(20)
    teeth[5] = _STEP
    case = posed(_with_pitch(tuple(teeth)), pitches=20, bodies=plain.contact)
    problem, solution = case.solve(position, case.plan.load, np.repeat(np.arange(20), 48))
    shift = _STEP * np.cos(plain.pair.pinion.transverse_pressure_angle)
    every = posed(_with_pitch((_STEP,) * 20), bodies=plain.contact)
    shifted = every.ste(position) - alone.deflection + shift
    meeting = np.repeat(np.arange(20), 48)[:, None] - problem.candidates.pair
    carried = np.tile(alone.force[:, 0] > 0.0, (20, 1))
    single = carried.sum(axis=1) == 1
    ahead = single & np.any(carried & (meeting == 5), axis=1)
    apart = single & ~np.any(np.isfinite(problem.candidates.gap) & (np.abs(meeting % 20 - 5) <= 1), axis=1)
    change = solution.deflection[:, 0] - np.tile(alone.deflection[:, 0], 20)
    share = solution.force[:, 0].max(axis=1) / solution.force[:, 0].sum(axis=1)
    return (
        *soundness(problem, solution),
        Measured("share of the tooth that is ahead, least", float(share[ahead].min()), least=1.0),
        Measured("its STE off the shifted curve, m", _largest(change[ahead] + shift), most=1e-15),
        Measured("STE far from it, change in m", _largest(change[apart]), most=1e-15),
        Measured("all teeth ahead: STE off the shifted curve, m", _largest(shifted), most=1e-15),
        Measured("positions with the one tooth alone", float(ahead.sum()), least=5.0),
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
    plain = posed(nominal_pair())
    position = even_positions(200)
    smooth = plain.ste(position)
    first, second = (_with_grid(np.maximum(rng.normal(5.0 * _NOISE, _NOISE, 25), 0.0)) for _ in range(2))
    noisy = posed(
        GearPair(first, second, 80e-3), NOMINAL_TORQUE * np.geomspace(1e-3, 4.0, 7), bodies=plain.contact
    )
    problem, solution = noisy.solve(position)
    low, high = (sum(side(_heights(gear)) for gear in (first, second)) for side in (np.min, np.max))
    nominal = posed(GearPair(first, second, 80e-3), bodies=plain.contact).solve(position, plain.plan.load)[1]
    added = nominal.deflection - smooth
    return (
        *soundness(problem, solution),
        Measured("added STE over the least removed", float(added.min()) / low, least=1.0),
        Measured("added STE over the most removed", float(added.max()) / high, most=1.0),
        Measured(
            "least growth of STE with load, m", float(np.diff(solution.deflection, axis=1).min()), least=1e-12
        ),
    )


def _with_gap(problem: ContactProblem, gap: FloatArray) -> ContactProblem:
    return problem.touching(problem.candidates.touching(replace(problem.candidates.touch, gap=gap)))


def _with_pitch(cumulative: tuple[float, ...]) -> GearPair:
    pinion = nominal_gear(pitch_deviation=PitchDeviation(cumulative))
    return GearPair(pinion, nominal_gear(), 80e-3)


def _with_grid(heights: FloatArray) -> Gear:
    """Return the nominal gear with these heights removed along its profile, the same all over the face."""
    gear = nominal_gear()
    roll = np.linspace(gear.form_roll_length, gear.tip_roll_length, heights.size)
    half = 0.5 * gear.face_width
    grid = FlankGrid(tuple(roll), (-half, half), tuple((h, h) for h in heights))
    return nominal_gear(modification=FlankModification(flank_grid=grid))


def _heights(gear: Gear) -> FloatArray:
    """Material removed all along the profile."""
    roll = np.linspace(gear.form_roll_length, gear.tip_roll_length, 20_001)
    return gear.modification.material_removed(gear, roll)
