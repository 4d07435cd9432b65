"""``loa root-stress``."""

from __future__ import annotations

import csv
import sys
from pathlib import Path
from typing import Any

from service.cli.assessed_case import assessed_case
from service.cli.output import check_writable, console, print_json, progress_bar, table
from service.cli.warned import warn
from service.convert.checks import check_case
from service.convert.effect_lines import assumption_lines
from service.convert.plausibility import phrased
from service.convert.root_stress import GEARS, root_stress_json, root_stress_of
from service.convert.vocabulary import case_field
from service.directories import cache_home
from service.report.image import png
from service.report.root_stress import root_stress_figure
from service.schemas import validated
from service.schemas.flank import FlankPoint

_SERIES = ("tension_mpa", "compression_mpa", "at_tension_peak_mpa", "at_compression_peak_mpa")


def run_root_stress(
    file: Path, point: dict[str, float | None], image: Path | None, *, as_csv: bool, as_json: bool
) -> None:
    """Compute, draw and print; `point` holds the fields of `FlankPoint` that were given."""
    chosen = validated(FlankPoint, {name: value for name, value in point.items() if value is not None})
    case = assessed_case(file, chosen)
    if image is not None:
        check_writable(image)
    check_case(case)
    with progress_bar() as report:
        stress = root_stress_of(case, cache_home() / "compliance", report)
    if image is not None:
        image.write_bytes(png(root_stress_figure(stress)))
    warn(phrased(stress.warnings, case_field))
    facts = root_stress_json(stress)
    if as_json:
        print_json(facts)
    elif as_csv:
        _write_csv(facts)
    else:
        _show(facts)


def _show(facts: dict[str, Any]) -> None:
    """Print the peaks for people."""
    out = console()
    heads = ["gear", "root", "stress MPa", "position", "tangent deg", "face mm"]
    rows = [_row(gear, root, facts[gear][root]) for gear in GEARS for root in ("tension", "compression")]
    out.print(table(heads, rows, "Tooth-root stress"))
    out.print(
        f"\ntorque {facts['torque_n_m']:.6g} N m, normal force {facts['normal_force_n']:.6g} N, "
        f"misalignment {facts['misalignment_um']:.4g} um",
        highlight=False,
    )
    for line in assumption_lines(facts["receipt"]):
        out.print(line, highlight=False)
    out.print(f"cost {facts['receipt']['cpu_seconds']:.3g} CPU s", highlight=False)


def _row(gear: str, root: str, peak: dict[str, float]) -> list[str]:
    """One peak: the stress with its error, and where it is."""
    return [
        gear,
        root,
        f"{peak['stress_mpa']:.4g} ±{peak['error_mpa']:.1g}",
        f"{peak['position']:.3f}",
        f"{peak['tangent_angle_deg']:.1f}",
        f"{peak['face_position_mm']:.2f}",
    ]


def _write_csv(facts: dict[str, Any]) -> None:
    """Print what one tooth of each gear meets, as CSV."""
    writer = csv.writer(sys.stdout, lineterminator="\n")
    writer.writerow(["gear", "position", *_SERIES])
    for gear in GEARS:
        passage = facts[gear]["passage"]
        lines = zip(passage["position"], *(passage[name] for name in _SERIES), strict=True)
        writer.writerows([gear, repr(position), *(f"{v:.6g}" for v in values)] for position, *values in lines)
