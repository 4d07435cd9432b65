"""Runs as universal files: time series, spectra or order spectra at bearings and meshes.

A universal file is a sequence of numbered datasets: 164 holds the units, 2411 the nodes, and each 58 one
function at a node in one direction. Nodes are the bearings and the meshes of the run. The series of a bearing
has three components, shape (bearings, 3, N); that of a mesh is a scalar, shape (meshes, N).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import chain
from pathlib import Path
from typing import NamedTuple

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
"""Label of the node of the first mesh. Bearings are nodes 1, 2 ... in the order of the run, meshes 1001,
1002 ...
"""
HIGHEST_ORDER = 20
"""Highest mesh order of an order spectrum."""
ROTATIONS = ("bearing_moment",)
"""Series whose components are about the axes (directions 4 to 6), not along them (1 to 3)."""
TEXT = {"time": "time series", "spectrum": SPECTRUM, "orders": f"{SPECTRUM}, power mean of all blocks"}
"""Second line of text of every dataset, by function."""
NO_TEXT = "NONE"
"""Text of a line that is left empty; the third line of a dataset 58 is its date."""

ORDINATES = {
    "bearing_force": Quantity(code=9, length=0, force=1, label="Force", unit="N"),
    "bearing_moment": Quantity(code=9, length=1, force=1, label="Moment", unit="N m"),
    "bearing_acceleration": Quantity(code=12, length=1, force=0, label="Acceleration", unit="m/s2"),
    "mesh_force": Quantity(code=9, length=0, force=1, label="Mesh force", unit="N"),
    "dynamic_transmission_error": Quantity(code=8, length=1, force=0, label="Transmission error", unit="m"),
}
"""Axis of the values of every series that is exported."""
TACHO = Quantity(code=19, length=0, force=0, label="Speed", unit="rpm")
ABSCISSAE = {
    "time": (FunctionType.TIME_RESPONSE, Quantity(code=17, length=0, force=0, label="Time", unit="s")),
    "spectrum": (FunctionType.SPECTRUM, Quantity(code=18, length=0, force=0, label="Frequency", unit="Hz")),
    "orders": (FunctionType.ORDER, Quantity(code=20, length=0, force=0, label="Mesh order", unit="1")),
}
"""Kind of dataset 58 and axis of its abscissa, by function."""


class _Sampled(NamedTuple):
    """Values (..., N) of a series over an even abscissa."""

    first: float
    increment: float
    values: FloatArray


def write_universal_file(
    result: RunResult,
    path: str | Path,
    function: str = "time",
    start: float | None = None,
    end: float | None = None,
) -> int:
    """Write the forces, moments and accelerations of bearings, mesh forces and transmission errors of a run.

    Series that the run does not store are left out. Time series come with a tacho of every mesh: the speed of
    its driving gear against the line of centers, in rpm.

    The file has the units (dataset 164), the positions of bearings and meshes (2411), and a dataset 58 for
    every component. Directions 1, 2, 3 are x, y, z of the fixed frame, for a planet bearing of the frame of
    its carrier; 4, 5, 6 are moments about these axes; 0 is a scalar. The format keeps six digits of the
    abscissa's increment and thirteen of every ordinate. Raises `InputError`: the function is unknown, or the
    span of time is too short for it.

    Parameters
    ----------
    path : str or Path
        The file appears under this name when it is complete, or not at all.
    function : str
        ``"time"``, ``"spectrum"`` (peak amplitude over frequency) or ``"orders"`` (over mesh orders of the
        first mesh, up to 20, blocks of 16 base pitches averaged in power).
    start, end : float, optional
        Span of time to export, s. The defaults are the ends of the run.

    Returns
    -------
    int
        Number of functions written.
    """
    one_of("function", function, FUNCTIONS)
    path = Path(path)
    first = result.time[0] if start is None else start
    last = result.time[-1] if end is None else end
    window = result.window(float(first), float(last))
    part = replace(result, **{name: getattr(result, name)[..., window] for name in SAMPLED})
    count = 0
    # The format is ASCII: other characters of names become question marks.
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
        sampled = _sampled(result, series, function)
        at_mesh = sampled.values.ndim == 2  # (meshes, N), else (bearings, 3, N)
        names = result.mesh if at_mesh else result.bearing
        first_node = FIRST_MESH_NODE if at_mesh else 1
        first_direction = 4 if series in ROTATIONS else 1
        for indices in np.ndindex(sampled.values.shape[:-1]):
            part = indices[0]  # number of the mesh or bearing
            component = "" if at_mesh else f" {'xyz'[indices[1]]}"
            title = f"{series} {names[part]}{component} ({ordinate.unit})"
            yield NodalFunction(
                kind=kind,
                lines=(title, TEXT[function], NO_TEXT, _origin(result)),
                entity=names[part],
                node=first_node + part,
                direction=0 if at_mesh else first_direction + indices[1],
                abscissa=abscissa,
                ordinate=ordinate,
                first=sampled.first,
                increment=sampled.increment,
                values=sampled.values[indices],
            )


def _tachos(result: RunResult, function: str) -> Iterator[NodalFunction]:
    """Yield the speed of the driving gear at every mesh, in the mean motion; it is the reference of orders.

    Spectra and order spectra have none.
    """
    if function != "time":
        return
    teeth = {gear["name"]: int(gear["teeth"]) for gear in result.case["gears"]}
    kind, abscissa = ABSCISSAE[function]
    for index, mesh in enumerate(result.case["meshes"]):
        driver = mesh["driver"]
        yield NodalFunction(
            kind=kind,
            lines=(f"tacho {driver} (rpm)", "speed of the driving gear", NO_TEXT, _origin(result)),
            entity=mesh["name"],
            node=FIRST_MESH_NODE + index,
            direction=0,  # a scalar
            abscissa=abscissa,
            ordinate=TACHO,
            first=float(result.time[0]),
            increment=1.0 / result.sample_rate,
            values=result.mesh_frequency[index] * 60.0 / teeth[driver],  # Hz of teeth to rpm
        )


def _origin(result: RunResult) -> str:
    """Return the last line of text of every dataset; 17 digits give the exact rate, the abscissa six."""
    return f"lineofaction, {result.sample_rate:.17g} samples per second"


def _sampled(result: RunResult, series: str, function: str) -> _Sampled:
    """Return a series as the requested function: over time, frequency or mesh order."""
    if function == "time":
        return _Sampled(float(result.time[0]), 1.0 / result.sample_rate, getattr(result, series))
    if function == "spectrum":
        spectrum = window_spectrum(result, series, float(result.time[0]), float(result.time[-1]))
        return _Sampled(0.0, spectrum.resolution, spectrum.amplitude)
    # At least order 1 is requested: `order_waterfall` says why a run does not hold it.
    highest = min(HIGHEST_ORDER, max(highest_valid_order(result), 1))
    orders = order_waterfall(result, series, highest=highest)
    mean = np.sqrt(np.mean(orders.amplitude**2, axis=-2))  # over the blocks, in power
    return _Sampled(0.0, float(orders.line[1]), np.asarray(mean))  # lines are evenly spaced from order 0


def _nodes(result: RunResult) -> list[tuple[int, FloatArray]]:
    """Return label and position (3,), m, of every bearing that was stored and of every mesh."""
    case = result.case
    origin = {shaft["name"]: np.array(shaft["origin"]) for shaft in case["shafts"]}
    bearings: list[Json] = [*case["bushings"], *case["planet_bearings"]]
    position = {
        bearing["name"]: origin[bearing["shaft"]] + [0.0, 0.0, bearing["position"]]  # along the shaft: z
        for bearing in bearings
    }
    nodes = [(label, position[name]) for label, name in enumerate(result.bearing, start=1)]
    meshes = enumerate(case["meshes"], start=FIRST_MESH_NODE)
    return [*nodes, *((label, np.array(mesh["point_of_action"])) for label, mesh in meshes)]
