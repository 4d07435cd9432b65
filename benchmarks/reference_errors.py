"""STE of the 20/20 pair against resolved full finite-element contact, in plane strain."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np

from benchmarks.figures import Figure
from fe_contact import Gear, GearPair, SteDatabase, analyze
from fe_contact.types import BoolArray, FloatArray

REFERENCE = Path(__file__).parents[1] / "tests" / "reference" / "spur_20_20_full_contact.csv"
TORQUES = (50.0, 100.0, 200.0, 400.0)
_SUBJECT = "against full FE contact, 50 to 400 N m"


def figures() -> list[Figure]:
    """Return the worst errors over the torques."""
    gear = Gear(teeth=20, normal_module=4e-3, face_width=25e-3, bore_diameter=40e-3)
    pair = GearPair(gear, gear, center_distance=80e-3)
    database = analyze(pair, torques=list(TORQUES), model="plane_strain")
    errors = np.array([_errors(database, torque, pair.transverse_contact_ratio) for torque in TORQUES])
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


def _errors(database: SteDatabase, torque: float, contact_ratio: float) -> tuple[float, float, float, float]:
    """Relative errors of mean and peak-to-peak, and the largest on and off the line of action."""
    position, expected, corner = _reference(torque, contact_ratio)
    found = database.curve(torque=torque, at=position).ste
    span = position[-1] - position[0]
    mean = np.trapezoid(found, position) / np.trapezoid(expected, position) - 1.0
    swing = np.ptp(found) / np.ptp(expected) - 1.0
    relative = np.abs(found / expected - 1.0)
    if not 0.99 < span < 1.01:
        raise ValueError(f"the reference spans {span} pitches")
    return float(mean), float(swing), float(np.max(relative[~corner])), float(np.max(relative[corner]))


def _reference(torque: float, contact_ratio: float) -> tuple[FloatArray, FloatArray, BoolArray]:
    """Positions by the driving gear, STE in m, and where a pair carries load beyond the path of contact."""
    with REFERENCE.open(encoding="utf-8", newline="") as file:
        rows = [row for row in csv.DictReader(file) if float(row["torque_n_m"]) == torque]
    position = np.array([float(row["position_driver"]) for row in rows])
    order = np.argsort(position)
    neighbors = np.array([float(row["share_pair_minus1"]) + float(row["share_pair_plus1"]) for row in rows])
    single = np.abs(position) < 1.0 - contact_ratio / 2.0
    corner = (neighbors > 0.0) & single
    return position[order], np.array([float(row["ste_um"]) for row in rows])[order] * 1e-6, corner[order]
