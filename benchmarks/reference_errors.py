"""STE of the 20/20 pair against resolved full finite-element contact, in plane strain.

The gears of the reference have five teeth, which makes them 0.13 % softer than whole gears: ours have five
here.
"""

from __future__ import annotations

import csv
from dataclasses import replace
from pathlib import Path

import numpy as np

from benchmarks.figures import Figure
from fe_contact import AnalysisOptions, Gear, GearPair, TableAxes
from fe_contact.analysis.pairs.pair_contact import pair_contact
from fe_contact.analysis.request.request_check import check_request
from fe_contact.planning.plan import make_plan
from fe_contact.types import BoolArray, FloatArray

REFERENCE = Path(__file__).parents[1] / "tests" / "reference" / "spur_20_20_full_contact.csv"
TORQUES = (50.0, 100.0, 200.0, 400.0)
REAL_TEETH = 5
SINGLE_CONTACT, DOUBLE_CONTACT = 0.15, 0.2235
"""Distances from the pitch point, base pitches: on the line of action below the one and above the other.

Between them are the ends of the line of action and the outermost handover of the largest load.
"""
_SUBJECT = "against full FE contact, same bodies, 50 to 400 N m"


def figures() -> list[Figure]:
    """Return the worst errors over the torques."""
    gear = Gear(teeth=20, normal_module=4e-3, face_width=25e-3, bore_diameter=40e-3)
    pair = GearPair(gear, gear, center_distance=80e-3)
    errors = np.array([_errors(pair, torque) for torque in TORQUES])
    names = (
        "mean STE",
        "peak-to-peak STE",
        "any position on the line of action",
        "any position in corner contact",
    )
    limits = (0.3, 1.0, 1.0, 1.0)
    worst = 100.0 * np.max(np.abs(errors), axis=0)
    return [
        Figure(_SUBJECT, name, float(value), "%", limit)
        for name, value, limit in zip(names, worst, limits, strict=True)
    ]


def _errors(pair: GearPair, torque: float) -> tuple[float, float, float, float]:
    """Relative errors of mean and peak-to-peak, and the largest on and off the line of action."""
    position, expected, corner = _reference(torque)
    found = ste_of_five_teeth(pair, torque, position)
    span = position[-1] - position[0]
    if not 0.99 < span < 1.01:
        raise ValueError(f"the reference spans {span} pitches")
    mean = np.trapezoid(found, position) / np.trapezoid(expected, position) - 1.0
    swing = np.ptp(found) / np.ptp(expected) - 1.0
    relative = np.abs(found / expected - 1.0)
    return float(mean), float(swing), float(np.max(relative[~corner])), float(np.max(relative[corner]))


def ste_of_five_teeth(pair: GearPair, torque: float, position: FloatArray) -> FloatArray:
    """Return STE (m, (P,)) at positions (base pitches), on bodies of the reference in a usual mesh."""
    asked = check_request(pair, TableAxes(torques=[max(TORQUES)]), AnalysisOptions(model="plane_strain"))
    plan = make_plan(pair, asked.request.load, asked.request.options, asked.model)
    first, second = (replace(recipe, real_teeth=REAL_TEETH) for recipe in plan.discretization.recipes)
    plan = replace(plan, discretization=replace(plan.discretization, recipes=(first, second)))
    force = np.array([torque / pair.pinion.base_radius])
    deflection: FloatArray = pair_contact(pair, plan, None).solve(asked.model, position, force)[1].deflection
    return deflection[:, 0]


def _reference(torque: float) -> tuple[FloatArray, FloatArray, BoolArray]:
    """Positions by the driving gear, STE in m, and where a pair may carry load beyond the path of contact.

    Rows made by an exchange of the gears have the torque on the driven gear: they count on the line of
    action, where both are equal.
    """
    with REFERENCE.open(encoding="utf-8", newline="") as file:
        rows = [row for row in csv.DictReader(file) if float(row["torque_n_m"]) == torque]
    position = np.array([float(row["position_driver"]) for row in rows])
    distance = np.abs(position)
    corner = (distance >= SINGLE_CONTACT) & (distance <= DOUBLE_CONTACT)
    valid = ~corner | np.array([row["origin"] == "computed" for row in rows])
    kept = np.flatnonzero(valid)[np.argsort(position[valid])]
    return position[kept], np.array([float(row["ste_um"]) for row in rows])[kept] * 1e-6, corner[kept]
