"""``loa export``: deformed gears, or by ending and options a run, a mesh force, stiffness, results in REXS.

`InputFile.as_it_is` is the path of a file; it refuses values that options set over those of the file.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from bounds import leftover
from fe_contact.analysis.flanks.deformed_pair import DeformedPair, deformed_pairs
from fe_contact.options import Run
from fe_contact.types import FloatArray
from host.directories import cache_home
from lineofaction.cli.assessed_case import assessed_case
from lineofaction.cli.export_fmu import export_mesh_fmu
from lineofaction.cli.export_point import Point
from lineofaction.cli.export_rexs import export_rexs
from lineofaction.cli.export_run import TABLE, UNIVERSAL, export_run
from lineofaction.cli.export_stiffness import export_stiffness
from lineofaction.cli.output import console, print_json, print_written, table
from lineofaction.cli.ste import positions
from lineofaction.gearbox.convert.boundary_errors import boundary_errors
from lineofaction.gearbox.input_file import InputFile
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.progress_bars import progress_bar
from lineofaction.gearbox.schemas import validated
from lineofaction.gearbox.schemas.flank_point import FlankPoint
from lineofaction.gearbox.units import UM

_MAX_POSITIONS = 256
"""Most positions of an export of deformed gears."""


def run_export(
    file: InputFile, output: Path, point: Point, rexs: Path | None, *, as_json: bool, **further: Any
) -> None:
    """Write the export that the ending of the output names.

    `further` has the options of single kinds: `start`, `end`, `function` of a run, `damping_n_s_per_m` and
    `backlash_um` of a mesh force, `library` that mesh stiffness is written for, `at` and `beside` (number of
    neighboring teeth) of deformed gears.
    """
    if further["library"]:
        export_stiffness(file.as_it_is, output, further["library"], point, as_json=as_json)
    elif rexs is not None:
        export_rexs(file.as_it_is, rexs, output, point, as_json=as_json)
    elif output.suffix in (*UNIVERSAL, TABLE):
        window = further["start"], further["end"]
        export_run(file.as_it_is, output, further["function"], window, as_json=as_json)
    elif output.suffix == ".fmu":
        damping, backlash = further["damping_n_s_per_m"], further["backlash_um"]
        export_mesh_fmu(file.as_it_is, output, point, damping, backlash, as_json=as_json)
    else:
        _export_deformed(file, output, point, further["at"], further["beside"], as_json=as_json)


def _export_deformed(
    file: InputFile, output: Path, point: Point, at: str, neighbors: int, *, as_json: bool
) -> None:
    """Solve the contact, recover the displacements of both gears, write and print them."""
    chosen = validated(FlankPoint, {name: value for name, value in point.items() if value is not None})
    case = assessed_case(file, chosen)
    where = positions(at)
    if len(where) > _MAX_POSITIONS:
        raise BadInput.of("--at", f"{len(where)} positions", f"at most {_MAX_POSITIONS} positions")
    if output.is_file() or output.suffix == ".vtu":
        raise BadInput.of("output", str(output), "a folder", "It gets pinion.vtu and wheel.vtu.")
    if not output.is_dir() and not output.parent.is_dir():
        raise BadInput.of("output", str(output), "in a folder that exists", "Make the folder first.")
    checked = case.at_point
    with progress_bar() as report, boundary_errors():
        run = Run(cache=cache_home() / "compliance", progress=report)
        pairs = deformed_pairs(checked, run=run, at=where, neighbors=neighbors)
    written = _written(pairs, output)
    if as_json:
        print_json({"written": [str(path) for path in written], "positions": _figures(pairs)})
    else:
        _show_deformed(pairs, written)


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


def _show_deformed(pairs: tuple[DeformedPair, ...], written: list[Path]) -> None:
    columns = ["position", "STE µm", "pinion moves µm", "wheel moves µm", "residual"]
    rows = [
        [*(f"{row[name]:.4g}" for name in row if name != "residual"), leftover(row["residual"])]
        for row in _figures(pairs)
    ]
    out = console()
    out.print(table(columns, rows))
    for path in written:
        print_written([path])
