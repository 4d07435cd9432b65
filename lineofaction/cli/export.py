"""``loa export``: bent gears, a run for other programs, the mesh force as FMU, results in REXS."""

from __future__ import annotations

import math
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from bounds import leftover
from dynamics.engines import MeshElement
from dynamics.engines.fmu import export_fmu
from dynamics.export import FUNCTIONS, write_universal_file
from dynamics.mechanism.flanks import DAMPING_REACH
from dynamics.meshes import CoastFlank
from fe_contact.analysis.flanks.deformed_pair import DeformedPair, deformed_pairs
from fe_contact.options import Run
from fe_contact.ste import SteDatabase
from fe_contact.types import FloatArray
from host.directories import cache_home
from lineofaction.cli.guard import warn
from lineofaction.cli.output import check_writable, console, print_json, print_written, progress_bar, table
from lineofaction.cli.ste import open_ste, positions
from lineofaction.cli.subjects import assessed_case
from lineofaction.gearbox.convert.case import boundary_errors
from lineofaction.gearbox.from_rexs.opened import OpenedUnit
from lineofaction.gearbox.input_file import InputFile
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.rexs.files import read_rexs, serialized
from lineofaction.gearbox.rexs.model import Document
from lineofaction.gearbox.schemas import validated
from lineofaction.gearbox.schemas.gear import FlankPoint
from lineofaction.gearbox.schemas.plan import left_out_warnings
from lineofaction.gearbox.to_rexs.attributes import CALCULATED
from lineofaction.gearbox.to_rexs.deflection import deflected, left_out
from lineofaction.gearbox.to_rexs.stage import exported
from lineofaction.gearbox.units import UM
from lineofaction.report.document import file_attributes, read_run, read_stored, stored_study

_MOST_POSITIONS = 256


Point = dict[str, float | None]
"""The fields of a `FlankPoint`, None where nothing is said."""


def run_export(
    file: InputFile, output: Path, point: Point, rexs: Path | None, *, as_json: bool, **further: Any
) -> None:
    """Write what the output's name promises; `further` holds the options of each kind by their names."""
    if rexs is not None:
        _export_rexs(file.as_it_is, rexs, output, point, as_json=as_json)
    elif output.suffix in (*UNIVERSAL, TABLE):
        window = further["start"], further["end"]
        _export_run(file.as_it_is, output, further["function"], window, as_json=as_json)
    elif output.suffix == ".fmu":
        damping, backlash = further["damping_n_s_per_m"], further["backlash_um"]
        _export_fmu(file.as_it_is, output, point, damping, backlash, as_json=as_json)
    else:
        _export_deformed(file, output, point, further["at"], further["beside"], as_json=as_json)


def _export_deformed(
    file: InputFile, output: Path, point: Point, at: str, beside: int, *, as_json: bool
) -> None:
    """Solve, expand, write, print."""
    chosen = validated(FlankPoint, {name: value for name, value in point.items() if value is not None})
    case = assessed_case(file, chosen)
    where = positions(at)
    if len(where) > _MOST_POSITIONS:
        raise BadInput.of("--at", f"{len(where)} positions", f"at most {_MOST_POSITIONS} positions")
    if output.is_file() or output.suffix == ".vtu":
        raise BadInput.of("output", str(output), "a folder", "It gets pinion.vtu and wheel.vtu.")
    if not output.is_dir() and not output.parent.is_dir():
        raise BadInput.of("output", str(output), "in a folder that exists", "Make the folder first.")
    checked = case.at_point
    with progress_bar() as report, boundary_errors():
        run = Run(cache=cache_home() / "compliance", progress=report)
        pairs = deformed_pairs(checked, run=run, at=where, beside=beside)
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


# ``loa export RUN.nc``: a run for other programs.


UNIVERSAL = (".unv", ".uff", ".uf")
TABLE = ".csv"


def _export_run(
    file: Path, output: Path, function: str, window: tuple[float | None, float | None], *, as_json: bool
) -> None:
    if function not in FUNCTIONS or (output.suffix == TABLE and function != "time"):
        allowed = "time" if output.suffix == TABLE else ", ".join(FUNCTIONS)
        raise BadInput.of("--function", function, f"one of {allowed}")
    check_writable(output)
    run = read_run(file, "file")
    facts: dict[str, object] = {"written": [str(output)]}
    if output.suffix == TABLE:
        run.to_csv(output)
    else:
        facts["functions"] = write_universal_file(run, output, function, *window)
    if as_json:
        print_json(facts)
        return
    if "functions" in facts:
        console().print(f"{facts['functions']} functions of dataset 58")
    print_written([output])


# ``loa export STE.nc -o MESH.fmu``.


_INPUTS_INSTEAD = {
    "misalignment_um": "the unit's input misalignment",
    "center_distance_change_mm": "the unit's input center_distance_change",
}


def _export_fmu(
    file: Path, output: Path, point: Point, damping: float, backlash_um: float | None, *, as_json: bool
) -> None:
    for name, instead in _INPUTS_INSTEAD.items():
        if point[name] is not None:
            advice = f"The whole table goes in; set {instead}."
            raise BadInput.of(f"--{name.replace('_', '-')}", point[name], "left out for an FMU", advice)
    check_writable(output)
    if not (math.isfinite(damping) and damping >= 0.0):
        raise BadInput.of("--damping-n-s-per-m", damping, "0 or above")
    if backlash_um is not None and not (math.isfinite(backlash_um) and backlash_um > 0.0):
        raise BadInput.of("--backlash-um", backlash_um, "above 0", "Leave it out for driving flanks alone.")
    database = open_ste(file)
    element = _element(database, damping, _nominal_force(database, point), backlash_um)
    export_fmu(element, output)
    facts: dict[str, Any] = {
        "file": str(output),
        "positions": int(element.table.position.size),
        "levels": int(element.table.level.size),
        "misalignments": int(element.table.misalignment.size),
        "center_distances": int(element.table.center_distance_change.size),
        "largest_force_n": float(element.table.level[-1]),
        "damping_n_s_per_m": damping,
        "damping_reach_n": element.reach,
        **({} if backlash_um is None else {"backlash_um": backlash_um}),
    }
    if as_json:
        print_json(facts)
    else:
        _show_fmu(facts)


def _nominal_force(database: SteDatabase, point: Point) -> float:
    """Return the transverse mesh force in N at the load given, or at the database's highest."""
    torque, force = point["torque_n_m"], point["normal_force_n"]
    if torque is not None and force is not None:
        raise BadInput.of("--torque", torque, "given, or --force instead, but not both")
    for name, value in (("--torque", torque), ("--force", force)):
        if value is not None and not (math.isfinite(value) and value > 0.0):
            raise BadInput.of(name, value, "above 0")
    if torque is not None:
        return torque / database.facts.base_radius[0]
    normal = float(database.force[-1]) if force is None else force
    return normal * math.cos(database.facts.base_helix_angle)


def _element(database: SteDatabase, damping: float, nominal: float, backlash_um: float | None) -> MeshElement:
    """Return the mesh of the database, gear 1 driving; both gears' teeth are equally thick."""
    facts = database.facts
    backlash = None if backlash_um is None else backlash_um * UM
    return MeshElement(
        database.force_table(),
        facts.teeth,
        facts.base_radius,
        facts.helix_hand * facts.base_helix_angle,
        damping,
        DAMPING_REACH * nominal,
        coast=None if backlash is None else CoastFlank(backlash, 0.5 * (1.0 - backlash / facts.base_pitch)),
    )


def _show_fmu(facts: dict[str, Any]) -> None:
    out = console()
    out.print(
        f"{facts['positions']} positions x {facts['levels']} levels to {facts['largest_force_n']:.4g} N, "
        f"{facts['misalignments']} misalignments x {facts['center_distances']} center distances"
    )
    out.print(
        f"damping {facts['damping_n_s_per_m']:.4g} N s/m, in full from {facts['damping_reach_n']:.4g} N on"
    )
    print_written([Path(facts["file"])])


# ``loa export STE.nc | DEFLECTION.nc --rexs UNIT.rexs -o OUT.rexs``.


_ONLY_TORQUE = ("normal_force_n", "misalignment_um", "center_distance_change_mm")


def _export_rexs(file: Path, rexs: Path, output: Path, point: Point, *, as_json: bool) -> None:
    """Add the results of a table or a deflection to the unit."""
    check_writable(output)
    document = read_rexs(rexs)
    unit = OpenedUnit.of(document)
    warn(left_out_warnings(unit.left_out))
    facts: dict[str, Any] = {"file": str(output)}
    readable = file.is_file() and file.suffix not in (".toml", ".json")
    study = stored_study(file_attributes(file)) if readable else None
    if study is not None and study.name == "deflect":
        _refuse_point(point, tuple(point))
        result = read_stored(study, file)
        written = deflected(document, unit, result)
        facts["left_out"] = left_out(unit, result)
    else:
        _refuse_point(point, _ONLY_TORQUE)
        written = exported(document, unit.cases, [open_ste(file)], point["torque_n_m"])
    output.write_bytes(serialized(written, output.name))
    facts["calculated"] = _calculated(written)
    if as_json:
        print_json(facts)
        return
    for line in _lines(facts["calculated"]):
        console().print(line, soft_wrap=True)
    if facts.get("left_out"):
        console().print(f"left out, no component of their own: {', '.join(facts['left_out'])}")
    print_written([output])


def _lines(calculated: dict[str, list[str]]) -> list[str]:
    """Return a line for components with the same results."""
    alike: dict[tuple[str, ...], list[str]] = {}
    for number, names in calculated.items():
        alike.setdefault(tuple(names), []).append(number)
    return [
        f"component{'s' * (len(numbers) > 1)} {', '.join(numbers)}: {', '.join(names)}"
        for names, numbers in alike.items()
    ]


def _refuse_point(point: Point, names: Iterable[str]) -> None:
    """Refuse the options of a load point that the results do not depend on."""
    for name in names:
        if point[name] is not None:
            option = f"--{name.replace('_', '-')}"
            bound = "Results are those of --torque, of a deflection those of its load cases."
            raise BadInput.of(option, point[name], "left out with --rexs", bound)


def _calculated(document: Document) -> dict[str, list[str]]:
    names: dict[str, dict[str, None]] = {}
    for _, component in document.model.all_components():
        for entry in component.attributes:
            if entry.origin == CALCULATED:
                names.setdefault(str(component.id), {})[entry.id] = None
    return {number: list(found) for number, found in names.items()}
