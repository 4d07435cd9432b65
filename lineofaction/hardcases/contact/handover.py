"""Contact ratios where pairs hand over in no time, or all at once."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import partial

import numpy as np
from scipy.optimize import brentq

from fe_contact.geometry import Gear, GearPair
from lineofaction.hardcases.contact.contact_case import (
    CYCLIC,
    NOMINAL_TORQUE,
    ContactCase,
    contact_case,
    even_positions,
    max_relative,
)
from lineofaction.hardcases.contact.laws import soundness
from lineofaction.hardcases.scene import Measured, Scenes, largest

SCENES = Scenes("contact")

_COUNTED = 2000
"""Positions at which the touching pairs are counted."""

_TIP_CLEARANCE = 0.25

_NOMINAL_RADIUS = 0.0376
"""Base radius of the nominal gear, m."""


def _handover_at_ratio(ratio: float) -> Sequence[Measured]:
    """Choose the addendum for the contact ratio, load the pair, and follow it past the end of the pitch."""
    low, high = (0.587, 1.0) if ratio < 1.5 else (1.0, 1.75)  # addenda in modules around the root
    addendum = brentq(
        lambda height: _pair(height, ratio).transverse_contact_ratio - ratio, low, high, xtol=1e-13
    )
    pair = _pair(addendum, ratio)
    # the tooth force of the nominal pair
    torque = NOMINAL_TORQUE * pair.pinion.base_radius / _NOMINAL_RADIUS
    case = contact_case(pair, torque * np.array([1e-3, 1.0]))
    position = even_positions(240)
    problem, solution = case.solve(position)
    ends = case.ste(np.array([0.0, 1.0]))
    loaded = solution.force * problem.candidates.torque_share[:, None, :]
    shares = loaded.sum(axis=2) / case.plan.load
    return (
        *soundness(problem, solution),
        Measured("contact ratio", pair.transverse_contact_ratio, maximum=ratio + 1e-9, minimum=ratio - 1e-9),
        Measured(
            "pairs that touch, mean over positions, off the contact ratio",
            abs(_mean_pairs(case) - ratio),
            maximum=2.0 / _COUNTED,
        ),
        Measured("STE one pitch further, relative change", max_relative(ends[1], ends[0]), maximum=CYCLIC),
        Measured("load shares off one", largest(shares - 1.0), maximum=1e-12),
        Measured("smallest share", loaded.min(), minimum=0.0),
    )


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


def _mean_pairs(case: ContactCase) -> float:
    without = case.with_model(corner_contact=False)
    _, solution = without.solve(even_positions(_COUNTED), case.plan.load[:1])
    return float((solution.force[:, 0] > 0.0).sum(axis=1).mean())
