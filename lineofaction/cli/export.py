"""``loa export``."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from bounds import leftover
from fe_contact.analysis import DeformedPair, deformed_pairs
from fe_contact.options import Run
from fe_contact.types import FloatArray
from host.directories import cache_home
from lineofaction.cli.assessed_case import assessed_case
from lineofaction.cli.output import console, print_json, progress_bar, table
from lineofaction.cli.ste import positions
from lineofaction.gearbox.convert.case import analysis_options, boundary_errors, operating_point
from lineofaction.gearbox.convert.checks import check_case
from lineofaction.gearbox.input_file import InputFile
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas import validated
from lineofaction.gearbox.schemas.flank import FlankPoint
from lineofaction.gearbox.units import UM

_MOST_POSITIONS = 256


def run_export(
    file: InputFile, output: Path, point: dict[str, float | None], at: str, beside: int, *, as_json: bool
) -> None:
    """Solve, expand, write, print; `point` holds the fields of `FlankPoint` that were given."""
    chosen = validated(FlankPoint, {name: value for name, value in point.items() if value is not None})
    case = assessed_case(file, chosen)
    where = positions(at)
    if len(where) > _MOST_POSITIONS:
        raise BadInput.of("--at", f"{len(where)} positions", f"at most {_MOST_POSITIONS} positions")
    _refuse_output(output)
    pair = check_case(case, whole_table=False)
    with progress_bar() as report, boundary_errors():
        pairs = deformed_pairs(
            pair,
            operating_point(case),
            analysis_options(case),
            Run(cache=cache_home() / "compliance", progress=report),
            at=where,
            beside=beside,
        )
    written = _written(pairs, output)
    if as_json:
        print_json({"written": [str(path) for path in written], "positions": _figures(pairs)})
    else:
        _show(pairs, written)


def _refuse_output(output: Path) -> None:
    """Refuse a folder that cannot be one, before the work is done."""
    if output.is_file() or output.suffix == ".vtu":
        raise BadInput.of("output", str(output), "a folder", "It gets pinion.vtu and wheel.vtu.")
    if not output.is_dir() and not output.parent.is_dir():
        raise BadInput.of("output", str(output), "in a folder that exists", "Make the folder first.")


def _written(pairs: tuple[DeformedPair, ...], output: Path) -> list[Path]:
    """Write two files per position, numbered if there are several, as viewers group them."""
    output.mkdir(exist_ok=True)
    written = []
    for number, pair in enumerate(pairs):
        ending = f"_{number:03d}.vtu" if len(pairs) > 1 else ".vtu"
        files = [output / f"{gear}{ending}" for gear in ("pinion", "wheel")]
        pair.write(*files)
        written += files
    return written


def _figures(pairs: tuple[DeformedPair, ...]) -> list[dict[str, float]]:
    """Return what each position came to."""
    return [
        {
            "position": pair.position,
            "ste_um": pair.deflection / UM,
            "largest_displacement_pinion_um": _largest(pair.pinion.displacement),
            "largest_displacement_wheel_um": _largest(pair.wheel.displacement),
            "residual": max(pair.pinion.residual, pair.wheel.residual),
        }
        for pair in pairs
    ]


def _largest(displacement: FloatArray) -> float:
    return float(np.linalg.norm(displacement, axis=1).max() / UM)


def _show(pairs: tuple[DeformedPair, ...], written: list[Path]) -> None:
    """Print the figures for people."""
    columns = ["position", "STE um", "pinion moves um", "wheel moves um", "residual"]
    rows = [
        [*(f"{row[name]:.4g}" for name in row if name != "residual"), leftover(row["residual"])]
        for row in _figures(pairs)
    ]
    out = console()
    out.print(table(columns, rows))
    for path in written:
        out.print(f"written to {path}", highlight=False)
