"""Few teeth and many: undercut, and gears of very different size."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from fe_contact.geometry import Gear, GearPair
from lineofaction.hardcases.contact.contact_case import (
    CYCLIC,
    NOMINAL_TORQUE,
    contact_case,
    even_positions,
    max_relative,
    mean_relative,
    range_off,
)
from lineofaction.hardcases.contact.laws import soundness
from lineofaction.hardcases.scene import Measured, Scenes

SCENES = Scenes("contact")


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
    cases = [
        contact_case(pair, [0.2 * NOMINAL_TORQUE], level=level) for level in ("draft", "standard", "fine")
    ]
    position = even_positions(240)
    curves = [case.ste(position)[:, 0] for case in cases]
    problem, solution = cases[-1].solve(position)
    errors = [mean_relative(curve, curves[-1]) for curve in curves]
    ranges = [range_off(curve, curves[-1]) for curve in curves]
    # without corner contact, since the contact ratio knows none
    _, alone = cases[0].with_model(corner_contact=False).solve(even_positions(2000), cases[0].plan.load)
    pairs = float((alone.force[:, 0] > 0.0).sum(axis=1).mean())
    return (
        *soundness(problem, solution),
        Measured("undercut", pair.pinion.form_point.undercut, minimum=1.0),
        Measured("contact ratio", pair.transverse_contact_ratio),
        Measured("mean STE, draft against fine mesh", errors[0], maximum=1e-2),
        Measured("mean STE, standard against fine mesh", errors[1], maximum=3e-3),
        Measured("peak-to-peak, standard against fine mesh", ranges[1], maximum=1e-2),
        Measured("pairs off the contact ratio", abs(pairs - pair.transverse_contact_ratio), maximum=1e-3),
    )


def _undercut_pair() -> GearPair:
    """Return 9 teeth of little profile shift, and a wheel whose tip reaches the end of their involute.

    The tip stays off the undercut by 1/1000 module.
    """
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
    forward = contact_case(GearPair(pinion, wheel), [20.0]).with_model(corner_contact=False)
    back = contact_case(GearPair(wheel, pinion), [200.0]).with_model(corner_contact=False)
    problem, driven = forward.solve(position)
    # position x by the pinion is -x by the wheel
    _, driving = back.solve((1.0 - position) % 1.0, forward.plan.load)
    cornered, solution = contact_case(GearPair(pinion, wheel), [20.0]).solve(position, forward.plan.load)
    return (
        *soundness(cornered, solution),
        Measured(
            "STE with the wheel driving, relative difference",
            max_relative(driving.deflection, driven.deflection),
            maximum=CYCLIC,
        ),
        Measured("positions compared", problem.candidates.position.size, minimum=50.0),
    )
