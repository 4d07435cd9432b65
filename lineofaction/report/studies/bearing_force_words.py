"""Whose bearing forces a result rests on, in words, and the axis of its rows."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from bounds.types import FloatArray
from lineofaction.gearbox.studies.bearing_forces import LINEAR
from lineofaction.gearbox.units import RPM
from lineofaction.report.drawing.figure import Axis, number

Json = dict[str, Any]
COARSE = 10.0 ** (1.0 / 20.0) - 1.0
"""Smearing by 1 dB: above it a window does not resolve an order."""


def of_run(facts: Json) -> Json | None:
    """Return the facts `forces` of a result if they are a run's; None for the linear response."""
    forces: Json = facts.get("forces", LINEAR)
    return forces if forces["source"] == "run" else None


def row_axis(speed: FloatArray, facts: Json) -> tuple[Axis, FloatArray]:
    """Return the axis of the rows: their speed (S,) in rad/s where it rises all along, else the time."""
    run = of_run(facts)
    if run is not None and not np.all(np.diff(speed) > 1e-6 * speed[:-1]):
        return _whole(Axis("time, s"), np.array(run["time_s"]))
    return _whole(Axis(f"speed of {facts['leading_shaft']}, rpm"), speed / RPM)


def _whole(axis: Axis, values: FloatArray) -> tuple[Axis, FloatArray]:
    """Let an axis end where its values do."""
    ends = (float(values[0]), float(values[-1])) if values.size > 1 else None
    return replace(axis, limits=ends), values


def force_words(facts: Json) -> tuple[tuple[str, str], ...]:
    """Say whose forces on bearings a result rests on, and how far the orders of a run hold."""
    run = of_run(facts)
    if run is None:
        return (("forces on bearings", "linear steady response: mean mesh stiffness, flanks in contact"),)
    windows = f"{len(run['time_s'])} windows of {run['window_pitches']} base pitches"
    if run["windows_left_out"]:
        windows += f", {run['windows_left_out']} left out: standstill, or too fast a change of speed"
    rows = [("forces on bearings", f"orders of the run, {windows}")]
    rows += [
        (f"housing {name}", "not that in which the run moved: its forces lack what this one does")
        for name in run.get("other_housings", ())
    ]
    name, share = _largest_remainder(run)
    rows.append(
        (
            "what orders do not hold",
            f"at most {number(100.0 * share, 3)} % of the force on {name}, in variance",
        )
    )
    if run["smearing"] is None:
        rows.append(("smearing by the windows", "not known: the run states no modes"))
        return tuple(rows)
    smearing = np.array(run["smearing"])
    coarse = int(np.sum(np.any(smearing > COARSE, axis=0)))
    words = f"median {number(20.0 * np.log10(1.0 + float(np.median(smearing))), 2)} dB"
    if coarse:
        words += f"; above 1 dB in {coarse} windows: run up more slowly"
    rows.append(("smearing by the windows", words))
    return tuple(rows)


def _largest_remainder(run: Json) -> tuple[str, float]:
    """Return the bearing of whose force orders leave most, and how much."""
    most = {name: max(shares) for name, shares in run["remainder"].items()}
    name = max(most, key=lambda bearing: most[bearing])
    return name, most[name]
