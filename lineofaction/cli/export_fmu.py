"""``loa export STE.nc -o MESH.fmu``: the mesh force for simulators."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

from dynamics.engines import MeshElement
from dynamics.engines.fmu import export_fmu
from dynamics.mechanism.flanks import DAMPING_REACH
from dynamics.meshes import CoastFlank
from fe_contact.ste import SteDatabase
from lineofaction.cli.export_point import Point
from lineofaction.cli.output import check_writable, console, print_json, print_written
from lineofaction.cli.ste import open_ste
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.units import UM

_INPUTS_INSTEAD = {
    "misalignment_um": "the unit's input misalignment",
    "center_distance_change_mm": "the unit's input center_distance_change",
}


def export_mesh_fmu(
    file: Path, output: Path, point: Point, damping: float, backlash_um: float | None, *, as_json: bool
) -> None:
    """Write the mesh force of a table as a functional mock-up unit."""
    for name, instead in _INPUTS_INSTEAD.items():
        if point[name] is not None:
            remedy = f"The whole table goes in; set {instead}."
            raise BadInput.of(f"--{name.replace('_', '-')}", point[name], "left out for an FMU", remedy)
    check_writable(output)
    if not (math.isfinite(damping) and damping >= 0.0):
        raise BadInput.of("--damping-n-s-per-m", damping, "0 or above")
    if backlash_um is not None and not (math.isfinite(backlash_um) and backlash_um > 0.0):
        raise BadInput.of("--backlash-um", backlash_um, "above 0", "Leave it out for driving flanks alone.")
    database = open_ste(file)
    element = _element(database, damping, _nominal_force(database, point), backlash_um)
    export_fmu(element, output)
    answer: dict[str, Any] = {
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
        print_json(answer)
    else:
        _show_fmu(answer)


def _nominal_force(database: SteDatabase, point: Point) -> float:
    """Return the transverse mesh force in N at the load given, or at the database's highest."""
    torque, force = point["torque_n_m"], point["normal_force_n"]
    if torque is not None and force is not None:
        raise BadInput.of("--torque", torque, "given, or --force instead, but not both")
    for name, value in (("--torque", torque), ("--force", force)):
        if value is not None and not (math.isfinite(value) and value > 0.0):
            raise BadInput.of(name, value, "above 0")
    if torque is not None:
        return torque / database.geometry.base_radius[0]
    normal = float(database.force[-1]) if force is None else force
    return normal * math.cos(database.geometry.base_helix_angle)


def _element(database: SteDatabase, damping: float, nominal: float, backlash_um: float | None) -> MeshElement:
    """Return the mesh of the database, gear 1 driving; both gears' teeth are equally thick."""
    geometry = database.geometry
    backlash = None if backlash_um is None else backlash_um * UM
    return MeshElement(
        database.force_table(),
        geometry.teeth,
        geometry.base_radius,
        geometry.helix_hand * geometry.base_helix_angle,
        damping,
        DAMPING_REACH * nominal,
        coast=None
        if backlash is None
        else CoastFlank(backlash, 0.5 * (1.0 - backlash / geometry.base_pitch)),
    )


def _show_fmu(answer: dict[str, Any]) -> None:
    out = console()
    out.print(
        f"{answer['positions']} positions x {answer['levels']} levels to {answer['largest_force_n']:.4g} N, "
        f"{answer['misalignments']} misalignments x {answer['center_distances']} center distances"
    )
    out.print(
        f"damping {answer['damping_n_s_per_m']:.4g} N s/m, in full from {answer['damping_reach_n']:.4g} N on"
    )
    print_written([Path(answer["file"])])
