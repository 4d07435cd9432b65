"""``loa export STE.nc --for LIBRARY``: the mesh stiffness of a table for rotor and torsion libraries."""

from __future__ import annotations

import json
import math
from pathlib import Path
from textwrap import dedent
from typing import Any

import numpy as np

from bounds.error_digits import with_error
from fe_contact.ste import SteDatabase
from fe_contact.types import FloatArray
from lineofaction.cli.export_point import Point
from lineofaction.cli.output import check_writable, console, print_json, print_written
from lineofaction.cli.ste import open_ste
from lineofaction.gearbox.problems import BadInput

LIBRARIES = ("ross", "opentorsion", "json")
POSITIONS = 128
"""Positions of a base pitch that are written."""
HARMONICS = 10

_ROSS = dedent('''\
    """Mesh stiffness for ross.MultiRotor (ROSS 2) over the angle of the driving gear, N/m and rad.

    Along the normal of the flanks: that of the transverse line of action over the square of cos(beta_b).
    """

    import numpy as np

    gear_mesh_stiffness = {mean!r}  # force over mean transmission error at {force:.6g} N
    theta_range = np.linspace(0.0, {period!r}, {count})
    stiffness_range = np.array({values!r})


    def use_in(multi_rotor):
        """Give a ross.MultiRotor this mesh stiffness; its update_mesh_stiffness=True follows the angle."""
        mesh = multi_rotor.mesh
        mesh.stiffness = gear_mesh_stiffness
        mesh.theta_range, mesh.stiffness_range = theta_range, stiffness_range
    ''')
_OPENTORSION = dedent('''\
    """Mesh stiffness for opentorsion.ElasticGear: base radii R in m, k in N m/rad."""

    R_driving, R_driven = {radii!r}
    k_mesh = {mean!r}  # N/m along the line of action at {force:.6g} N
    k = k_mesh * R_driving**2  # ElasticGear(node, I, R_driven, k=k, parent=Gear(node, I, R_driving))
    ''')


def stiffness_of(database: SteDatabase, point: Point) -> dict[str, Any]:
    """Return the transverse mesh stiffness over position, at one load (default: highest) and at all stored.

    Stiffness is the transverse force over the transmission error, N/m. Raises `BadInput`: two loads.
    """
    geometry = database.geometry
    wished = {"torque": point["torque_n_m"], "force": point["normal_force_n"]}
    given: dict[str, Any] = {name: value for name, value in wished.items() if value is not None}
    if len(given) > 1:
        raise BadInput.of("--torque", wished["torque"], "given, or --force instead, but not both")
    given = given or {"force": float(database.force[-1])}
    alignment: dict[str, Any] = {
        "misalignment": _scaled(point["misalignment_um"], 1e-6),
        "center_distance_change": _scaled(point["center_distance_change_mm"], 1e-3),
    }
    at = np.arange(POSITIONS) / POSITIONS
    transverse = math.cos(geometry.base_helix_angle)
    loads = [float(load) for load in database.force]
    curves = [database.curve(force=load, at=at, **alignment) for load in loads]
    chosen = database.curve(**given, at=at, **alignment)
    force = given["force"] * transverse if "force" in given else given["torque"] / geometry.base_radius[0]
    stiffness = force / chosen.ste
    return {
        "teeth": list(geometry.teeth),
        "base_radius_m": list(geometry.base_radius),
        "base_helix_angle_rad": geometry.base_helix_angle,
        "position_base_pitches": at.tolist(),
        "transverse_force_n": force,
        "mean_stiffness_n_per_m": force / chosen.mean.value,
        "mean_stiffness_error_n_per_m": force / chosen.mean.value * chosen.mean.error / chosen.mean.value,
        "stiffness_n_per_m": stiffness.tolist(),
        "harmonics_n_per_m": _harmonics(stiffness),
        "loads_n": [load * transverse for load in loads],
        "stiffness_over_loads_n_per_m": [
            (load * transverse / curve.ste).tolist() for load, curve in zip(loads, curves, strict=True)
        ],
    }


def _scaled(value: float | None, unit: float) -> float | None:
    return None if value is None else value * unit


def _harmonics(values: FloatArray) -> list[float]:
    """Return the amplitudes of the mesh harmonics 1 to `HARMONICS`."""
    amplitudes = 2.0 * np.abs(np.fft.rfft(values)) / values.size
    return [float(amplitude) for amplitude in amplitudes[1 : HARMONICS + 1]]


def export_stiffness(file: Path, output: Path, library: str, point: Point, *, as_json: bool) -> None:
    """Write the mesh stiffness of a table in the form that a library takes."""
    if library not in LIBRARIES:
        raise BadInput.of("--for", library, f"one of {', '.join(LIBRARIES)}")
    check_writable(output)
    answer = stiffness_of(open_ste(file), point)
    output.write_text(_text(library, answer), encoding="utf-8")
    if as_json:
        print_json({"written": [str(output)]} | answer)
        return
    mean, error = (1e-6 * answer[f"mean_stiffness{name}_n_per_m"] for name in ("", "_error"))
    console().print(f"mesh stiffness {with_error(mean, error)} N/µm at {answer['transverse_force_n']:.4g} N")
    print_written([output])


def _text(library: str, answer: dict[str, Any]) -> str:
    if library == "json":
        return json.dumps(answer, indent=1, allow_nan=False) + "\n"
    mean, force = answer["mean_stiffness_n_per_m"], answer["transverse_force_n"]
    if library == "opentorsion":
        return _OPENTORSION.format(radii=tuple(answer["base_radius_m"]), mean=mean, force=force)
    normal = math.cos(answer["base_helix_angle_rad"]) ** -2
    values = [normal * value for value in answer["stiffness_n_per_m"]]
    values.append(values[0])  # at the end of the pitch
    period = 2.0 * math.pi / answer["teeth"][0]
    return _ROSS.format(mean=normal * mean, force=force, period=period, count=len(values), values=values)
