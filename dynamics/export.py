"""Runs as universal files: time series, spectra or order spectra at bearings and meshes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import chain
from pathlib import Path

import numpy as np

from dynamics.checks import one_of
from dynamics.orders import highest_valid_order, order_waterfall, window_spectrum
from dynamics.results import RunResult
from dynamics.results.run_result import SAMPLED
from dynamics.types import FloatArray, Json
from dynamics.universal_datasets import (
    SPECTRUM,
    FunctionType,
    NodalFunction,
    Quantity,
    function_dataset,
    nodes_dataset,
    units_dataset,
)
from host.directories import atomic_file

FUNCTIONS = ("time", "spectrum", "orders")
FIRST_MESH_NODE = 1001
"""Bearings are nodes 1, 2 ... in the order of the run, meshes 1001, 1002 ..."""
HIGHEST_ORDER = 20
ROTATIONS = ("bearing_moment",)
TEXT = {"time": "time series", "spectrum": SPECTRUM, "orders": f"{SPECTRUM}, power mean of all blocks"}


ORDINATES = {
    "bearing_force": Quantity(9, 0, 1, "Force", "N"),
    "bearing_moment": Quantity(9, 1, 1, "Moment", "N m"),
    "bearing_acceleration": Quantity(12, 1, 0, "Acceleration", "m/s2"),
    "mesh_force": Quantity(9, 0, 1, "Mesh force", "N"),
    "dynamic_transmission_error": Quantity(8, 1, 0, "Transmission error", "m"),
}
TACHO = Quantity(19, 0, 0, "Speed", "rpm")
ABSCISSAE = {
    "time": (FunctionType.TIME_RESPONSE, Quantity(17, 0, 0, "Time", "s")),
    "spectrum": (FunctionType.SPECTRUM, Quantity(18, 0, 0, "Frequency", "Hz")),
    "orders": (FunctionType.ORDER, Quantity(20, 0, 0, "Mesh order", "1")),
}


def write_universal_file(
    result: RunResult,
    path: str | Path,
    function: str = "time",
    start: float | None = None,
    end: float | None = None,
) -> int:
    """Write bearing forces, moments and accelerations, mesh forces and transmission errors, if there.

    Time series come with a tacho of every mesh: the speed of its driving gear against the line of centers,
    in rpm.

    Units (dataset 164), positions of bearings and meshes (2411), a dataset 58 per component. Directions 1, 2,
    3 are x, y, z of the fixed frame (of a planet bearing: of its carrier's), 4, 5, 6 moments about them, 0 a
    scalar. The format keeps six digits of the abscissa's increment and thirteen of every ordinate. Raises
    `InputError`: the function is unknown, or the stretch too short for it.

    Parameters
    ----------
    path : str or Path
        Written whole or not at all.
    function : str
        ``"time"``, ``"spectrum"`` (peak amplitude over frequency) or ``"orders"`` (over mesh orders of the
        first mesh, up to 20, blocks of 16 base pitches averaged in power).
    start, end : float, optional
        Stretch of time, s; left out: the whole run.

    Returns
    -------
    int
        Number of functions written.
    """
    one_of("function", function, FUNCTIONS)
    path = Path(path)
    first = result.time[0] if start is None else start
    window, count = result.window(float(first), float(result.time[-1] if end is None else end)), 0
    part = replace(result, **{name: getattr(result, name)[..., window] for name in SAMPLED})
    with atomic_file(path) as draft, draft.open("w", encoding="ascii", errors="replace") as file:
        file.write(units_dataset())
        file.write(nodes_dataset(_nodes(result)))
        for nodal in chain(_functions(part, function), _tachos(part, function)):
            file.write(function_dataset(nodal))
            count += 1
    return count


def _functions(result: RunResult, function: str) -> Iterator[NodalFunction]:
    """Yield one function per component of every exported series."""
    kind, abscissa = ABSCISSAE[function]
    for series, ordinate in ORDINATES.items():
        if not getattr(result, series).size:
            continue
        first, increment, values = _values(result, series, function)
        at_mesh = values.ndim == 2
        names = result.mesh if at_mesh else result.bearing
        turned = 3 if series in ROTATIONS else 0
        for component_index in np.ndindex(values.shape[:-1]):
            direction = 0 if at_mesh else component_index[1] + 1 + turned
            component = "" if at_mesh else f" {'xyz'[component_index[1]]}"
            title = f"{series} {names[component_index[0]]}{component} ({ordinate.unit})"
            lines = (title, TEXT[function], "NONE", _origin(result))
            node = component_index[0] + (FIRST_MESH_NODE if at_mesh else 1)
            axes = (abscissa, ordinate, first, increment)
            yield NodalFunction(
                kind, lines, names[component_index[0]], node, direction, *axes, values[component_index]
            )


def _tachos(result: RunResult, function: str) -> Iterator[NodalFunction]:
    """Yield the speed at every mesh, of the mean motion: what orders are tracked by."""
    if function != "time":
        return
    teeth = {gear["name"]: int(gear["teeth"]) for gear in result.case["gears"]}
    for index, mesh in enumerate(result.case["meshes"]):
        driver = mesh["driver"]
        lines = (f"tacho {driver} (rpm)", "speed of the driving gear", "NONE", _origin(result))
        start = float(result.time[0]), 1.0 / result.sample_rate
        speed = result.mesh_frequency[index] * 60.0 / teeth[driver]
        kind, abscissa = ABSCISSAE[function]
        yield NodalFunction(
            kind, lines, mesh["name"], FIRST_MESH_NODE + index, 0, abscissa, TACHO, *start, speed
        )


def _origin(result: RunResult) -> str:
    return f"lineofaction, {result.sample_rate:.17g} samples per second"


def _values(result: RunResult, series: str, function: str) -> tuple[float, float, FloatArray]:
    """Return the abscissa's first value and increment, and the ordinates."""
    if function == "time":
        return float(result.time[0]), 1.0 / result.sample_rate, getattr(result, series)
    if function == "spectrum":
        lines = window_spectrum(result, series, float(result.time[0]), float(result.time[-1]))
        return 0.0, lines.resolution, lines.amplitude
    orders = order_waterfall(result, series, highest=min(HIGHEST_ORDER, max(highest_valid_order(result), 1)))
    mean = np.sqrt(np.mean(orders.amplitude**2, axis=-2))
    return 0.0, float(orders.line[1]), np.asarray(mean)


def _nodes(result: RunResult) -> list[tuple[int, FloatArray]]:
    """Label and position of every bearing that was stored, and of every mesh."""
    origin = {shaft["name"]: np.array(shaft["origin"]) for shaft in result.case["shafts"]}
    parts: list[Json] = [*result.case["bushings"], *result.case["planet_bearings"]]
    seat = {part["name"]: origin[part["shaft"]] + [0.0, 0.0, part["position"]] for part in parts}
    nodes = [(index, seat[name]) for index, name in enumerate(result.bearing, start=1)]
    meshes = enumerate(result.case["meshes"], start=FIRST_MESH_NODE)
    return [*nodes, *((label, np.array(mesh["point_of_action"])) for label, mesh in meshes)]
