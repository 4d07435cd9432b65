"""``loa flank``."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from service.cli.assessed_case import assessed_case
from service.cli.output import check_netcdf_output, console, print_json, progress_bar
from service.cli.warned import warn
from service.convert.checks import check_case
from service.convert.effect_lines import assumption_lines
from service.convert.flanks import flank_json, flanks_of
from service.convert.plausibility import phrased_flanks
from service.directories import cache_home
from service.schemas import validated
from service.schemas.flank import FlankPoint


def run_flank(file: Path, output: Path, point: dict[str, float | None], *, as_json: bool) -> None:
    """Compute, write, print; `point` holds the fields of `FlankPoint` that were given."""
    chosen = validated(FlankPoint, {name: value for name, value in point.items() if value is not None})
    case = assessed_case(file, chosen)
    check_netcdf_output(output)
    check_case(case, whole_table=False)
    with progress_bar() as report:
        flanks = phrased_flanks(flanks_of(case, cache_home() / "compliance", report), case)
    warn(flanks.metadata.warnings)
    flanks.to_netcdf(output)
    figures = {"file": str(output), **flank_json(flanks)}
    if as_json:
        print_json(figures)
    else:
        _show(figures)


def _show(figures: dict[str, Any]) -> None:
    """Print the figures for people."""
    low, high = figures["load_centroid_mm"]
    lines = [
        f"torque {figures['torque_n_m']:.6g} N m, normal force {figures['normal_force_n']:.6g} N, "
        f"misalignment {figures['misalignment_um']:.4g} um",
        f"largest pressure {figures['largest_pressure_mpa']:.4g} MPa, "
        f"largest line load {figures['largest_line_load_n_per_mm']:.4g} N/mm",
    ]
    if figures["slices"] > 1:
        lines.append(
            f"K_Hbeta {figures['k_h_beta']:.3g} over the cycle, at most "
            f"{figures['largest_face_load_factor']:.3g} at one position; "
            f"load centroid {low:.3g} to {high:.3g} mm from mid-face"
        )
    lines += assumption_lines(figures["receipt"])
    lines += [f"cost {figures['receipt']['cpu_seconds']:.3g} CPU s", f"written to {figures['file']}"]
    for line in lines:
        console().print(line, highlight=False)
