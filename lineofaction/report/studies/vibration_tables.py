"""Tables of a housing's vibration."""

from __future__ import annotations

import numpy as np

from dynamics.vibration import VibrationAnalysis, vibration_level
from dynamics.vibration.vibration_analysis import Shares
from lineofaction.gearbox.studies.vibration.run import MM_PER_S, HousingVibrationResult
from lineofaction.gearbox.units import RPM
from lineofaction.report.drawing.figure import Table, number

SHOWN = 12
"""Modes in the table of contributions."""


def where(found: VibrationAnalysis) -> str:
    """Say the order, speed and frequency looked at."""
    vibration, s, h = found.vibration, found.at_speed, found.at_order
    speed, hertz = number(float(vibration.speed[s]) / RPM, 4), number(float(vibration.frequency[s, h]), 4)
    return f"order {vibration.order[h]:.4g} at {speed} rpm, {hertz} Hz"


def largest_table(result: HousingVibrationResult) -> Table:
    """List the largest velocity of every point and of the outer hull, with the nearest mode."""
    vibration = result.analysis.vibration
    sizes = [(name, vibration.rms[k]) for k, name in enumerate(vibration.point)]
    if result.analysis.deflection is not None:
        sizes.append(("outer hull, normal", np.sqrt(vibration.mean_square_velocity)))
    rows = []
    for name, rms in sizes:
        s, h = map(int, np.unravel_index(int(np.argmax(rms)), rms.shape))
        hertz = float(vibration.frequency[s, h])
        near = result.natural_frequency[int(np.argmin(np.abs(result.natural_frequency - hertz)))]
        rows.append(
            (
                name,
                f"{vibration.order[h]:.4g}",
                number(float(vibration.speed[s]) / RPM, 5),
                number(hertz, 5),
                number(float(near), 5),
                number(float(rms[s, h]) / MM_PER_S, 4),
                number(float(vibration_level(rms[s, h])), 4),
                "yes" if vibration.valid[s, h] else "no",
            )
        )
    head = ["velocity of", "order", "speed, rpm", "frequency, Hz", "nearest mode, Hz"]
    head += ["rms, mm/s", "level, dB re 1 nm/s", "within valid modes"]
    return Table("Largest velocity of every point", tuple(head), tuple(rows))


def contribution_table(result: HousingVibrationResult) -> Table:
    """List the contributions of bearings and of the largest modes."""
    found = result.analysis
    head = ["part", "frequency, Hz", *(f"{point}, %" for point in found.vibration.point)]
    with_surface = found.deflection is not None
    rows = [*_rows(found.bearings, with_surface), *_rows(found.modes, with_surface)]
    if with_surface:
        head.append("outer hull, %")
    return Table(f"Contributions to the mean square velocity at {where(found)}", tuple(head), tuple(rows))


def _rows(shares: Shares, with_surface: bool) -> list[tuple[str, ...]]:
    """Return rows of the largest parts, in their order."""
    every = np.vstack([shares.point, shares.surface]) if with_surface else shares.point
    most = np.sort(np.argsort(-np.max(np.abs(every), axis=0), kind="stable")[:SHOWN])
    return [
        (
            shares.name[p],
            number(float(shares.frequency[p]), 5) if np.isfinite(shares.frequency[p]) else "",
            *(f"{100.0 * float(value):.1f}" for value in every[:, p]),
        )
        for p in most
    ]


def series(result: HousingVibrationResult) -> Table:
    """Return every velocity: a row for each speed and order, rms along x, y, z in mm/s."""
    found = result.analysis
    vibration = found.vibration
    head = ["speed_rpm", "order", "frequency_hz", "valid"]
    head += [f"{name}_{axis}_mm_per_s" for name in vibration.point for axis in "xyz"]
    columns = [
        np.repeat(vibration.speed / RPM, vibration.order.size),
        np.tile(vibration.order, vibration.speed.size),
        vibration.frequency.ravel(),
        vibration.valid.ravel().astype(float),
        *(np.abs(vibration.velocity) / np.sqrt(2.0) / MM_PER_S).reshape(-1, vibration.frequency.size),
    ]
    if found.deflection is not None:
        head.append("surface_mm_per_s")
        columns.append(np.sqrt(vibration.mean_square_velocity).ravel() / MM_PER_S)
    rows = tuple(tuple(f"{value:.9g}" for value in row) for row in zip(*columns, strict=True))
    return Table("Velocities by speed and order", tuple(head), rows)
