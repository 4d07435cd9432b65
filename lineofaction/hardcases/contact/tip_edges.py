"""Contact at the tip edges, with teeth whose tips are sharp, pointed or rounded."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from scipy.optimize import brentq

from fe_contact.geometry import FlankModification, Gear, GearPair
from lineofaction.hardcases.contact.contact_case import (
    NOMINAL_TORQUE,
    ContactCase,
    contact_case,
    even_positions,
    mean_relative,
    nominal_gear,
    nominal_pair,
    range_off,
)
from lineofaction.hardcases.contact.laws import soundness
from lineofaction.hardcases.scene import Measured, Scenes, largest

SCENES = Scenes("contact")

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
    case = contact_case(nominal_pair(), [10.0 * NOMINAL_TORQUE])
    problem, solution = case.solve(even_positions(400))
    _, without_edges = case.with_model(corner_contact=False).solve(even_positions(400), case.plan.load)
    relief = (without_edges.deflection - solution.deflection) / solution.deflection
    return (
        *soundness(problem, solution),
        Measured("least relief by the tip edges", relief.min(), minimum=-1e-12),
        Measured("largest relief by the tip edges", relief.max(), minimum=0.02),
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
    coarse, fine = (contact_case(GearPair(gear, gear), level=level) for level in ("standard", "fine"))
    problem, solution = fine.solve(even_positions(200))
    _, coarse_solution = coarse.solve(even_positions(200), fine.plan.load)
    return (
        *soundness(problem, solution),
        Measured("tip thickness, modules", gear.tip_tooth_thickness / gear.normal_module),
        Measured(
            "mean STE of two meshes apart",
            mean_relative(coarse_solution.deflection, solution.deflection),
            maximum=3e-3,
        ),
        Measured(
            "peak-to-peak likewise", range_off(coarse_solution.deflection, solution.deflection), maximum=2e-2
        ),
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
    sharp = contact_case(nominal_pair(), [2.0 * NOMINAL_TORQUE])
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
        case = contact_case(pair, [2.0 * NOMINAL_TORQUE], bodies=sharp.contact)
        problem, solution = case.solve(position)
        curves.append(solution.deflection)
    # the deepest rounding turns the normal, so that it has a bound of its own
    *rises, turned = (float(np.min(deep - shallow)) for shallow, deep in pairwise(curves))
    return (
        *soundness(problem, solution),
        Measured("no rounding against none given, m", np.ptp(curves[0] - plain), maximum=0.0),
        Measured("1 nm of rounding, largest change of STE, m", largest(curves[1] - plain), maximum=1e-9),
        Measured("least rise of STE with the depth, m", min(rises), minimum=-1e-14),
        Measured("least rise with a normal that turns, over STE", turned / float(plain.max()), minimum=-0.02),
        _smoothness(case),
    )


def _tall(addendum: float) -> Gear:
    """Return the nominal gear with another addendum and room for its mate's."""
    return nominal_gear(
        addendum_coefficient=addendum, dedendum_coefficient=addendum + 0.15, root_radius_coefficient=0.1,
        teeth=40, bore_diameter=80e-3,
    )  # fmt: skip


def _smoothness(case: ContactCase) -> Measured:
    """Return the ratio of the largest step of STE on positions four times as close: 1/4 if smooth."""
    steps = []
    for count in (256, 1024):
        curve = case.ste(even_positions(count))[:, -1]
        steps.append(largest(np.diff(curve, append=curve[0])))
    return Measured("largest step of STE, at a quarter of the spacing", steps[1] / steps[0], maximum=0.4)
