"""``loa ste``."""

from __future__ import annotations

import math
import sys
from pathlib import Path
from typing import Any

from bounds import engineering
from fe_contact.ste import SteDatabase
from lineofaction.cli.guard import warn
from lineofaction.cli.output import console, csv_text, print_json, table
from lineofaction.gearbox.convert.answers import curve_json
from lineofaction.gearbox.problems import BadInput

_FARTHEST = 1e6
_SHOWN_ORDERS = 8


def run_ste(
    file: Path, point: dict[str, float | None], at: str | None, *, as_csv: bool, as_json: bool
) -> None:
    """Read, evaluate, print; `point` holds the options of load and alignment by their names."""
    database = open_ste(file)
    warn(database.metadata.warnings)
    curve = curve_json(database, **_arguments(point), at=None if at is None else positions(at))
    if as_json:
        print_json(curve)
    elif as_csv:
        sys.stdout.write(csv_text(_columns(curve), _rows(curve)))
    else:
        _show(curve)


def open_ste(file: Path) -> SteDatabase:
    """Return the database in a file; raises `BadInput` if there is no file, `DatabaseError` if it is none."""
    if not file.is_file():
        raise BadInput.of(
            "file", str(file), "an STE database", "Check the path, or make one with: loa analyze"
        )
    if file.suffix in (".toml", ".json"):
        advice = f"Make one with: loa analyze {file} -o ste.nc"
        raise BadInput.of("file", str(file), "an STE database (netCDF)", advice)
    return SteDatabase.from_netcdf(file)


def _arguments(point: dict[str, float | None]) -> dict[str, Any]:
    torque, force, misalignment_um, center_distance_change_mm = point.values()
    if (torque is None) == (force is None):
        both = None if torque is None else f"--torque {torque:g} --force {force:g}"
        raise BadInput.of(
            "--torque", both, "given, or --force instead, but not both", "For example --torque 100."
        )
    for name, value in point.items():
        if value is not None and not math.isfinite(value):
            raise BadInput.of(f"--{name.replace('_', '-')}", value, "a finite number")
    place = {"misalignment_um": misalignment_um, "center_distance_change_mm": center_distance_change_mm}
    return {"torque_n_m": torque, "force_n": force, **place}


def positions(text: str) -> list[float]:
    """Positions of ``--at``."""
    bound = f"numbers from {-_FARTHEST:g} to {_FARTHEST:g}, separated by commas"
    try:
        numbers = [float(part) for part in text.split(",")]
    except ValueError:
        raise BadInput.of("--at", text, bound, "For example --at 0,0.25,0.5.") from None
    if not all(abs(position) <= _FARTHEST for position in numbers):
        raise BadInput.of("--at", text, bound, "One base pitch is 1.")
    return numbers


def _rows(curve: dict[str, Any]) -> list[list[str]]:
    lines = zip(curve["position"], curve["ste_um"], curve["load_share"], strict=True)
    return [[repr(x), f"{ste:.9g}", *(f"{share:.6g}" for share in shares)] for x, ste, shares in lines]


def _columns(curve: dict[str, Any]) -> list[str]:
    return ["position", "ste_um", *(f"load_share_{pair:+d}" for pair in curve["pair"])]


def _show(curve: dict[str, Any]) -> None:
    out = console()
    rows = [[f"{float(row[0]):.5f}", f"{float(row[1]):.4f}", *row[2:]] for row in _rows(curve)]
    out.print(table(_columns(curve), rows))
    out.print()
    out.print(f"torque {curve['torque_n_m']:.6g} N m, normal force {curve['normal_force_n']:.6g} N")
    if curve["period"] > 1:
        lines = sorted(zip(curve["amplitude_um"], curve["order"], strict=True), reverse=True)[:_SHOWN_ORDERS]
        orders = ", ".join(f"{order:.4g}: {amplitude:.4f}" for amplitude, order in lines)
        out.print(f"period {curve['period']} base pitches; largest orders of the mesh {orders} um")
    harmonics = ", ".join(f"{value:.4f}" for value in curve["harmonics_um"][:_SHOWN_ORDERS])
    out.print(f"harmonics {harmonics} um")
    for name in ("mean", "peak_to_peak"):
        error = curve.get(f"{name}_error_um")
        band = "(error not estimated)" if error is None else f"± {engineering(error, 2)} µm"
        value = f"{engineering(curve[f'{name}_um'], 4)} µm"
        words = f"{name.replace('_', '-')} STE at {curve['torque_n_m']:.6g} N m"
        out.print(f"{words}: {value} {band}")
