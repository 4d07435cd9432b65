"""The sampling of a run: rate and filter, the part they removed, and the peaks between the samples."""

from __future__ import annotations

from typing import Any

from dynamics.orders import highest_valid_order
from dynamics.results import RunResult
from lineofaction.report.drawing.figure import Table, number


def sampling_table(run: RunResult) -> Table:
    """Tabulate rate, filter, highest valid order and the sampling error of the mesh forces."""
    sampling, error = run.receipt["sampling"], run.receipt["error"].get("sampling", {})
    of = "mesh" if run.mesh else "shaft"
    rows = [
        ("rate, samples per second", number(float(sampling["rate"]), 6)),
        ("chosen by", str(sampling["chosen"])),
        ("passed up to, Hz", number(float(sampling["pass_frequency"]), 6)),
        *_filter(sampling),
        (f"highest valid {of} order at the highest speed", str(highest_valid_order(run))),
    ]
    for mesh, part in error.get("mesh_force", {}).items():
        rows.append((f"mesh force of {mesh} above the pass band, N rms", number(float(part["removed"]), 3)))
        rows.append((f"mesh force of {mesh} that may have folded, N rms", number(float(part["folded"]), 3)))
    return Table("Sampling of the output", ("quantity", "value"), tuple(rows))


def _filter(sampling: dict[str, Any]) -> list[tuple[str, str]]:
    """Say how the filter works."""
    if not sampling["stop_band"]:
        return [("anti-alias filter", "none: unfiltered samples")]
    stop = (
        f"{number(float(sampling['stop_band']), 3)} dB from {number(float(sampling['stop_frequency']), 6)} Hz"
    )
    edge = f"{number(1e3 * float(sampling['edge']), 3)} ms"
    return [
        ("anti-alias filter stops", stop),
        ("continued beyond start and end for the filter", edge),
    ]


def peak_table(run: RunResult) -> Table:
    """Tabulate largest magnitude and rms of the forces, between the samples and before the filter."""
    rows = []
    for title, parts in run.receipt.get("peaks", {}).items():
        for name, part in parts.items():
            peaks, rms = (_each(part[key]) for key in ("peak", "rms"))
            rows += [
                (f"{title.replace('_', ' ')}, {name}{axis}", number(p, 5), number(r, 5))
                for axis, p, r in zip(_axes(len(peaks)), peaks, rms, strict=True)
            ]
    return Table("Peaks of the whole run, unfiltered", ("force", "peak, N", "rms, N"), tuple(rows))


def _each(value: Any) -> list[float]:
    return [float(entry) for entry in value] if isinstance(value, list) else [float(value)]


def _axes(count: int) -> tuple[str, ...]:
    return ("",) if count == 1 else tuple(f" {axis}" for axis in "xyz"[:count])
