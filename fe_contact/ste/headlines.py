"""An STE database in a dozen lines: gear pair, loads, figures with their errors, effects, cost."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from bounds import engineering
from bounds.brief import Row
from fe_contact.errors import FeContactError
from fe_contact.ste.curve import Curve
from fe_contact.ste.fields import SteFields
from fe_contact.types import FloatArray

MAX_NUMBERS = 8
"""Most values of an axis that are listed. Of a longer axis the ends and the number of values are."""
MAX_LOADS = 4
"""Largest number of loads whose figures are listed; they are spread over the loads of the table."""
LONGEST_PERIOD = 32
"""Largest period, base pitches, of a table that shows the figures of several loads; others show one load."""


def headlines(table: SteFields, curve_at: Callable[..., Curve]) -> tuple[str, list[Row]]:
    """Return the title of a database and its rows; `curve_at` gives its curves, as `SteDatabase.curve`."""
    gears = table.geometry
    ring = " (ring)" if gears.internal else ""
    helix = (
        f", base helix angle {math.degrees(gears.base_helix_angle):.3g}°" if gears.base_helix_angle else ""
    )
    title = (
        f"SteDatabase {gears.teeth[0]}/{gears.teeth[1]}{ring}, "
        f"center distance {1e3 * gears.center_distance:.6g} mm{helix}"
    )
    rows = [("loads", f"{_numbers(table.torque)} N m"), ("positions", _positions(table))]
    rows += [
        (name, f"{_numbers(1e6 * axis)} µm")
        for name, axis in (
            ("misalignment", table.misalignment),
            ("center distance change", table.center_distance_change),
        )
        if axis.size > 1 or axis.any()
    ]
    return title, [*rows, *_figures(table, curve_at), *_provenance(table)]


def _numbers(values: FloatArray) -> str:
    listed = [engineering(float(value), 4) for value in values]
    return ", ".join(listed) if len(listed) <= MAX_NUMBERS else f"{listed[0]} to {listed[-1]} ({len(listed)})"


def _positions(table: SteFields) -> str:
    pitches = "a base pitch" if table.period == 1 else f"over {table.period} base pitches"
    failed = f", {table.n_failed} points failed" if table.n_failed else ""
    return f"{table.position.size} {pitches}{failed}"


def _figures(table: SteFields, curve_at: Callable[..., Curve]) -> list[Row]:
    """Return mean, peak-to-peak and first harmonic at some of the loads, aligned or nearest to it."""
    limit = MAX_LOADS if table.period <= LONGEST_PERIOD else 1
    count = min(limit, table.torque.size)
    loads = np.unique(np.linspace(0, table.torque.size - 1, count).round().astype(int))
    rows = []
    for torque in table.torque[loads]:
        name = f"at {engineering(float(torque), 4)} N m"
        try:
            curve = curve_at(torque=float(torque), allow_failed=True, **_alignment(table))
        except FeContactError as error:
            rows.append((name, str(error)))
            continue
        rows.append((name, f"mean {curve.mean}, p-p {curve.peak_to_peak}, order 1 {curve.harmonics[0]}"))
    return rows


def _alignment(table: SteFields) -> dict[str, float]:
    """Return the stored alignment that is nearest to none."""
    axes = (("misalignment", table.misalignment), ("center_distance_change", table.center_distance_change))
    return {name: float(axis[np.abs(axis).argmin()]) for name, axis in axes}


def _provenance(table: SteFields) -> list[Row]:
    """Return the effects that are on, and cost, version and hash of the table."""
    metadata = table.metadata
    rows: list[Row] = []
    ledger: list[Any] = metadata.effect_ledger if isinstance(metadata.effect_ledger, list) else []
    effects = [str(entry.get("name", "")).replace("_", " ") for entry in ledger if entry.get("on")]
    if any(effects):
        rows.append(("effects on", ", ".join(effects)))
    version = metadata.software_versions.get("lineofaction", "")
    seconds = metadata.receipt.get("cpu_seconds")
    cost = f"{engineering(seconds, 3)} CPU s" if seconds is not None else ""
    origin = [cost, f"lineofaction {version}" if version else "", f"content {metadata.content_hash[:6]}"]
    if metadata.content_hash or cost:
        rows.append(("made", "; ".join(filter(None, origin))))
    return rows
