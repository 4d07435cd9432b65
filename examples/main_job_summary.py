"""What the main job found, in a few lines."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from dynamics.orders import Spectrum, find_peaks, mesh_orders, window_spectrum
from dynamics.results import RunResult
from fe_contact.ste import SteDatabase
from fe_contact.types import Estimate

TORQUE = 100.0  # N m on the driving gear
WINDOW = (4.5, 4.75)  # s


def summary(table: Path, run: Path, helical: Path, seconds: Mapping[str, float]) -> str:
    """Return the main numbers of an STE database, of a run made with it, of a second pair, and wall times."""
    database, result = SteDatabase.from_netcdf(table), RunResult.from_netcdf(run)
    lines = [
        "spur 20/20 (ISMA 2010)",
        *static_lines(database),
        *dynamic_lines(result),
        "",
        "helical 23/67, EV reducer",
        *static_lines(SteDatabase.from_netcdf(helical)),
        "",
        *(f"{name + ', wall time':<34}{value:9.2f} s" for name, value in seconds.items()),
        f"{'STE database, CPU time':<34}{database.metadata.receipt['cpu_seconds']:9.2f} s",
        f"{'run-up, integration':<34}{result.receipt['seconds']['integration']:9.2f} s",
    ]
    return "\n".join(lines)


def static_lines(database: SteDatabase) -> list[str]:
    """Mean and peak-to-peak STE with their errors, and what a plane leaves out of them."""
    load, bias = f" at {TORQUE:g} N m", database.metadata.receipt.get("bias")
    return [
        _estimate("mean STE" + load, database.mean(torque=TORQUE)),
        _estimate("peak-to-peak STE" + load, database.peak_to_peak(torque=TORQUE)),
        *([bias["words"]] if bias else []),
    ]


def _estimate(name: str, estimate: Estimate) -> str:
    """One number in micrometers with its error."""
    return f"{name:<34}{1e6 * estimate.value:9.3f} ± {1e6 * estimate.error:.3f} µm"


def dynamic_lines(run: RunResult) -> list[str]:
    """Mean contact force, and where the bearing force peaks between the mesh frequencies of the window."""
    bearing, direction = _loudest(run)
    made = window_spectrum(run, "bearing_force", *WINDOW)
    one = replace(made, amplitude=made.amplitude[bearing, direction])
    order = mesh_orders(run, *WINDOW, count=1)[0]
    peak = find_peaks(one, 1, order.low - one.resolution, order.high + one.resolution)[0]
    return [
        f"{'mean contact force':<34}{np.mean(run.mesh_force[0]):9.1f} N",
        f"{'spectrum: fundamental':<34}{peak.frequency:9.1f} Hz, {peak.amplitude:.2f} N on bearing "
        f"{run.bearing[bearing]} (mesh frequency {order.low:.1f} to {order.high:.1f} Hz)",
        f"{'spectrum: highest lines':<34}{_multiples(one, peak.frequency)}",
    ]


def _loudest(run: RunResult) -> tuple[int, int]:
    """Bearing and direction of the force that varies most in the window."""
    spread = np.std(run.bearing_force[..., run.window(*WINDOW)], axis=-1)
    bearing, direction = np.unravel_index(int(np.argmax(spread)), spread.shape)
    return int(bearing), int(direction)


def _multiples(spectrum: Spectrum, fundamental: float) -> str:
    """Name the highest peaks as multiples of the fundamental."""
    peaks = sorted(find_peaks(spectrum, 5), key=lambda peak: peak.frequency)
    return " " * 4 + ", ".join(
        f"{peak.frequency / fundamental:.2f}x {peak.amplitude:.2f} N" for peak in peaks
    )
