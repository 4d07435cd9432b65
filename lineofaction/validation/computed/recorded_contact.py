"""Transmission error beside recorded curves of resolved full contact."""

from __future__ import annotations

import csv
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from fe_contact import AnalysisOptions, GearPair, TableAxes, analyze
from lineofaction.validation.comparison import Comparison


def curve_means(
    pair: GearPair, data: Path, torques_n_m: list[float], relative_error: float, softer: float = 0.0
) -> Iterator[Comparison]:
    """Yield the mean over the recorded positions at each torque, in plane strain.

    `softer` is the part by which bodies of the record deflect more than whole gears.
    """
    with data.open(encoding="utf-8", newline="") as lines:
        rows = [row for row in csv.DictReader(lines) if row.get("origin", "computed") == "computed"]
    table = analyze(pair, TableAxes(torques=torques_n_m), AnalysisOptions(model="plane_strain"))
    for torque in torques_n_m:
        points = [
            (float(row["position_driver"]), float(row["ste_um"]))
            for row in rows
            if float(row["torque_n_m"]) == torque
        ]
        at, theirs = np.array(points).T
        curve = table.curve(torque=torque, at=at)
        mean = theirs.mean() / (1.0 + softer)
        error = 1e6 * table.mean(torque=torque).error
        ours = 1e6 * float(curve.ste.mean())
        yield Comparison(f"mean STE at {torque:g} N m", "µm", mean, relative_error * mean, ours, error)
