"""Hard pairs: misaligned and short faces, contact ratios, numbers of teeth."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np
from scipy.optimize import brentq

from fe_contact.contact import ContactProblem, ContactSolution
from fe_contact.contact.slices import POINTS
from fe_contact.geometry import Gear, GearPair
from fe_contact.types import FloatArray
from lineofaction.hardcases.contact.laws import (
    CYCLIC,
    NOMINAL_TORQUE,
    Posed,
    even_positions,
    mean_off,
    nominal_pair,
    off,
    posed,
    range_off,
    soundness,
)
from lineofaction.hardcases.scene import Measured, Scenes

SCENES = Scenes("contact")

_MISALIGNMENT = 300e-6
_WIDE = 60e-3


@SCENES.add(
    "misaligned_to_5_percent",
    "0.3 mm of misalignment over the face: one slice of nineteen carries, and gaps are 40 times the "
    "deflection.",
    "The side that comes closer carries; both sides are mirror images, in STE and in the place of the load; "
    "the rigid gap is that of the wedge.",
)
def _five_per_cent() -> Sequence[Measured]:
    """Misalign a wide pair until one slice of nineteen carries all, to either side."""
    case, other = (
        posed(
            nominal_pair(face_width=_WIDE),
            [0.02 * NOMINAL_TORQUE],
            model="3d",
            misalignment=sign * _MISALIGNMENT,
        )
        for sign in (1.0, -1.0)
    )
    position = even_positions(24)
    problem, solution = case.solve(position)
    mirrored_problem, mirrored = other.solve(position)
    slices = case.plan.discretization.slices
    wedge = 0.5 * _MISALIGNMENT * (1.0 - 1.0 / (slices * POINTS))
    face = problem.candidates.face_position
    loaded = [np.unique(face[force > 0.0]).size for force in solution.force[:, 0]]
    return (
        *soundness(problem, solution, 8),
        Measured("part of the face that carries, %", 100.0 * (max(loaded) / np.unique(face).size), most=6.0),
        Measured(
            "centroid over half the face width, to the side that comes closer, least",
            # positive misalignment opens the gap towards larger face positions: the load is at the lower ones
            float(-_centroid(problem, solution).max() / (0.5 * _WIDE)),
            least=0.9,
        ),
        Measured(
            "misaligned to the other side: relative difference of STE",
            off(mirrored.deflection, solution.deflection),
            most=1e-9,
        ),
        Measured(
            "centroids off their mirror images, m",
            float(np.abs(_centroid(mirrored_problem, mirrored) + _centroid(problem, solution)).max()),
            most=1e-9,
        ),
        Measured("rigid gap off the wedge's, m", float(np.abs(solution.no_load + wedge).max()), most=1e-12),
    )


@SCENES.add(
    "single_slice",
    "One slice over the whole face: the load may not spread as it likes, and patches are as wide as the "
    "gear.",
    "Dividing slices frees the load: from three on STE falls everywhere (least complementary energy); one, "
    "which knows no free ends of the face, is within 5 % of nine.",
)
def _single_slice() -> Sequence[Measured]:
    """Spread the load evenly: one slice in three dimensions, then three, then nine."""
    full = posed(nominal_pair(), model="3d")
    position = even_positions(24)
    curves = []
    for slices in (1, 3, 9):
        fewer = Posed(full.contact.in_slices(slices), full.model)
        problem, solution = fewer.solve(position)
        curves.append(solution.deflection[:, 0])
        if slices == 1:
            figures = soundness(problem, solution, 8)
    freed = float(np.min(curves[1] - curves[2]))
    return (
        *figures,
        Measured("least drop of STE as three slices are divided, m", freed, least=0.0),
        Measured(
            "mean of one slice over nine", float(curves[0].mean() / curves[2].mean()), most=1.05, least=0.95
        ),
    )


@SCENES.add(
    "identical_positions",
    "Positions given twice make spacings of zero.",
    "Equal positions have equal STE to the last bit, whatever stands beside them.",
)
def _duplicates() -> Sequence[Measured]:
    """Ask for the same position several times, in any order, alone and among others."""
    case = posed(nominal_pair())
    positions = np.array([0.3, 0.3, 0.0, 0.97, 0.3, 0.0, 0.5, 0.5])
    problem, together = case.solve(positions)
    apart = [case.ste(np.array([x]))[0, 0] for x in positions]
    groups = [together.deflection[positions == x, 0] for x in np.unique(positions)]
    return (
        *soundness(problem, together),
        Measured("spread over equal positions, m", max(float(np.ptp(group)) for group in groups), most=0.0),
        Measured(
            "asked together or alone, difference in m",
            float(np.abs(together.deflection[:, 0] - apart).max()),
            most=1e-20,
        ),
    )


def _centroid(problem: ContactProblem, solution: ContactSolution) -> FloatArray:
    """Return where along the face the load acts, m."""
    force = solution.force[:, 0]
    return np.asarray(force @ problem.candidates.face_position / force.sum(axis=1))


# Contact ratios where pairs hand over in no time, or all at once.


_COUNTED = 2000
"""Positions at which the touching pairs are counted."""
_TIP_CLEARANCE = 0.25


def _handover_at_ratio(ratio: float) -> Sequence[Measured]:
    """Choose the addendum for the contact ratio, load the pair, and follow it past the end of the pitch."""
    low, high = (0.587, 1.0) if ratio < 1.5 else (1.0, 1.75)
    addendum = brentq(
        lambda height: _pair(height, ratio).transverse_contact_ratio - ratio, low, high, xtol=1e-13
    )
    pair = _pair(addendum, ratio)
    case = posed(pair, NOMINAL_TORQUE * pair.pinion.base_radius / 0.0376 * np.array([1e-3, 1.0]))
    position = even_positions(240)
    problem, solution = case.solve(position)
    ends = case.ste(np.array([0.0, 1.0]))
    loaded = solution.force * problem.candidates.torque_share[:, None, :]
    shares = loaded.sum(axis=2) / case.plan.load
    return (
        *soundness(problem, solution),
        Measured("contact ratio", pair.transverse_contact_ratio, ratio + 1e-9, ratio - 1e-9),
        Measured(
            "pairs that touch, mean over positions, off the contact ratio",
            abs(_mean_pairs(case) - ratio),
            most=2.0 / _COUNTED,
        ),
        Measured("STE one pitch further, relative change", off(ends[1], ends[0]), most=CYCLIC),
        Measured("load shares off one", float(np.abs(shares - 1.0).max()), most=1e-12),
        Measured("smallest share", float(loaded.min()), least=0.0),
    )


def _pair(addendum: float, ratio: float) -> GearPair:
    """Return two equal gears: short teeth of 20 degrees, or many tall ones of 17.5 degrees."""
    tall = ratio > 1.5
    gear = Gear(
        teeth=80 if tall else 24,
        normal_module=4e-3,
        face_width=25e-3,
        bore_diameter=0.15 if tall else 40e-3,
        normal_pressure_angle=math.radians(17.5 if tall else 20.0),
        addendum_coefficient=addendum,
        dedendum_coefficient=addendum + _TIP_CLEARANCE,
        root_radius_coefficient=0.15,
    )
    return GearPair(gear, gear)


def _mean_pairs(case: Posed) -> float:
    without = case.with_model(corner_contact=False)
    _, solution = without.solve(even_positions(_COUNTED), case.plan.load[:1])
    return float((solution.force[:, 0] > 0.0).sum(axis=1).mean())


for _name, _ratio, _because in (
    ("contact_ratio_1.01", 1.01, "Two pairs share the load over one per cent of the pitch only."),
    (
        "contact_ratio_2.0",
        2.0,
        "One pair enters at the very position at which another leaves: two ties at once.",
    ),
    (
        "contact_ratio_2.6",
        2.6,
        "Two and three pairs in turn: the coupling of teeth two apart decides the ripple.",
    ),
):
    SCENES.add(
        _name,
        _because,
        "The mean number of touching pairs is the contact ratio; STE repeats after one base pitch; load "
        "shares are positive and sum to one; two solvers agree.",
    )(partial(_handover_at_ratio, _ratio))


# Few teeth and many: undercut, and gears of very different size.


@SCENES.add(
    "undercut_9_teeth",
    "Nine teeth of profile shift 0.15: the fillet cuts into the involute, the root is thinner than the "
    "flank, and the tooth is softer than any formula knows.",
    "Three meshes converge to one curve; the mean number of touching pairs is the contact ratio; two "
    "solvers agree.",
)
def _undercut_pinion() -> Sequence[Measured]:
    """Drive 60 teeth by 9 that the tool has undercut."""
    pair = _undercut_pair()
    cases = [posed(pair, [0.2 * NOMINAL_TORQUE], level=level) for level in ("draft", "standard", "fine")]
    position = even_positions(240)
    curves = [case.ste(position)[:, 0] for case in cases]
    problem, solution = cases[-1].solve(position)
    errors = [mean_off(curve, curves[-1]) for curve in curves]
    ranges = [range_off(curve, curves[-1]) for curve in curves]
    alone = cases[0].with_model(corner_contact=False).solve(even_positions(2000), cases[0].plan.load)[1]
    pairs = float((alone.force[:, 0] > 0.0).sum(axis=1).mean())
    return (
        *soundness(problem, solution),
        Measured("undercut", float(pair.pinion.form_point.undercut), least=1.0),
        Measured("contact ratio", pair.transverse_contact_ratio),
        Measured("mean STE, draft against fine mesh", errors[0], most=1e-2),
        Measured("mean STE, standard against fine mesh", errors[1], most=3e-3),
        Measured("peak-to-peak, standard against fine mesh", ranges[1], most=1e-2),
        Measured("pairs off the contact ratio", abs(pairs - pair.transverse_contact_ratio), most=1e-3),
    )


def _undercut_pair() -> GearPair:
    """Return 9 teeth of little profile shift, and a wheel whose tip spares what is left of them."""
    module, shift = 3e-3, 0.15
    common = {"normal_module": module, "face_width": 20e-3, "root_radius_coefficient": 0.3}
    pinion = Gear(teeth=9, bore_diameter=10e-3, profile_shift_coefficient=shift, **common)  # type: ignore[arg-type]
    wheel = Gear(teeth=60, bore_diameter=80e-3, profile_shift_coefficient=-shift, **common)  # type: ignore[arg-type]
    tangent = (pinion.base_radius + wheel.base_radius) * math.tan(wheel.transverse_pressure_angle)
    highest = math.hypot(wheel.base_radius, tangent - pinion.form_roll_length)
    return GearPair(pinion, replace(wheel, tip_diameter=2.0 * (highest - 1e-3 * module)))


@SCENES.add(
    "teeth_20_to_200",
    "One gear is ten times as large as the other, with ten times the elements, and nearly rigid beside it.",
    "STE is the same whichever gear drives: position x by the one is -x by the other.",
)
def _twenty_to_two_hundred() -> Sequence[Measured]:
    """Drive 200 teeth by 20, and back."""
    common = {"normal_module": 2e-3, "face_width": 20e-3}
    pinion = Gear(teeth=20, bore_diameter=20e-3, **common)  # type: ignore[arg-type]
    wheel = Gear(teeth=200, bore_diameter=0.2, **common)  # type: ignore[arg-type]
    position = np.linspace(0.0, 0.98, 50)
    there = posed(GearPair(pinion, wheel), [20.0]).with_model(corner_contact=False)
    back = posed(GearPair(wheel, pinion), [200.0]).with_model(corner_contact=False)
    problem, driven = there.solve(position)
    driving = back.solve((1.0 - position) % 1.0, there.plan.load)[1]
    cornered, solution = posed(GearPair(pinion, wheel), [20.0]).solve(position, there.plan.load)
    return (
        *soundness(cornered, solution),
        Measured(
            "STE with the wheel driving, relative difference",
            off(driving.deflection, driven.deflection),
            CYCLIC,
        ),
        Measured("positions compared", float(problem.candidates.position.size), least=50.0),
    )
