"""Loaded transmission error and root stress compared with a series of solid models of a gear sector."""

from __future__ import annotations

import csv
from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np

from fe_contact import AnalysisOptions, GearPair, OperatingPoint, TableAxes, analyze, root_stress
from fe_contact.types import FloatArray
from lineofaction.validation.comparison import Comparison

POSITIONS = range(66, 129)
"""Numbers of the positions that span one base pitch from the pitch point on; the middle tooth carries."""
MIDDLE_ROOT = range(66, 127)
"""Positions at which the root of the middle tooth is the most loaded one."""
NODES = 128
"""Positions of our table; evenly spaced, since the series of a sector does not repeat from pitch to pitch."""
SAMPLES = 240
"""Points of a pitch to which the series is interpolated."""


def _series(
    pair: GearPair, data: Path, column: str, positions: range = POSITIONS
) -> tuple[FloatArray, FloatArray]:
    """Return positions in base pitches and values of a column, of the runs that were completed."""
    with data.open(encoding="utf-8", newline="") as lines:
        rows = [row for row in csv.DictReader(lines) if int(row["position_index"]) in positions]
    complete = [row for row in rows if row["source"] == "table" and row["run_status"] == "complete"]
    path = pair.path_of_contact
    roll_length = 1e-3 * np.array([float(row["rho1_mm"]) for row in complete])
    values = np.array([float(row[column]) for row in complete])
    return (roll_length - path.pitch_point) / path.base_pitch, values


def transmission_error(
    pair: GearPair, data: Path, torque_n_m: float, errors_um: Mapping[str, float]
) -> Iterator[Comparison]:
    """Yield mean, peak-to-peak and first two harmonics over one pitch; `errors_um` are theirs."""
    position, values = _series(pair, data, "te_um")
    theirs = np.interp(np.arange(SAMPLES) / SAMPLES, position, values)
    harmonics = 2.0 * np.abs(np.fft.rfft(theirs)) / SAMPLES
    table = analyze(pair, TableAxes(torques=[torque_n_m]), AnalysisOptions(positions=NODES))
    ours = table.mean(torque=torque_n_m), table.peak_to_peak(torque=torque_n_m)
    numbers = {"mean": theirs.mean(), "peak-to-peak": np.ptp(theirs)}
    numbers |= {f"harmonic {order}": harmonics[order] for order in (1, 2)}
    estimates = (*ours, *table.harmonics(torque=torque_n_m)[:2])
    for (name, number), estimate in zip(numbers.items(), estimates, strict=True):
        value, error = 1e6 * estimate.value, 1e6 * estimate.error
        yield Comparison(name, "µm", float(number), errors_um[name], value, error)


def largest_root_stress(
    pair: GearPair, data: Path, torque_n_m: float, mesh_error: float, relative_error: float
) -> Iterator[Comparison]:
    """Yield the largest tensile root stress of the wheel; the series reads low by `mesh_error`."""
    position, values = _series(pair, data, "max_root_sigma1_MPa", MIDDLE_ROOT)
    stresses = root_stress(pair, OperatingPoint(torque=torque_n_m), AnalysisOptions(), at=position)
    peak, theirs = stresses.wheel.peak("tension").stress, (1.0 + mesh_error) * values.max()
    ours = 1e-6 * peak.value, 1e-6 * peak.error
    yield Comparison("largest root stress", "MPa", theirs, relative_error * theirs, *ours)
