"""Runs as universal files: time series, spectra or order spectra at bearings and meshes."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from enum import IntEnum
from itertools import chain
from pathlib import Path

import numpy as np

from dynamics.checks import one_of
from dynamics.orders import highest_valid_order, order_waterfall, window_spectrum
from dynamics.results import RunResult
from dynamics.results.run_result import SAMPLED
from dynamics.types import FloatArray, Json
from host.directories import whole_file

# Datasets of universal files: 58 (function at a nodal degree of freedom), 164 (units), 2411 (nodes). Pyuff,
# which reads them, writes neither spectra (function 12) nor orders (24), and a digit less of every ordinate.


DOUBLE = 4  # ordinates are real, double precision
EVEN = 1  # abscissa by its first value and its increment
NO_AXIS = (0, 0, 0, "NONE", "NONE")
FUNCTIONS = ("time", "spectrum", "orders")
FIRST_MESH_NODE = 1001
"""Bearings are nodes 1, 2 ... in the order of the run, meshes 1001, 1002 ..."""
HIGHEST_ORDER = 20
ROTATIONS = ("bearing_moment",)
SPECTRUM = "amplitude (peak), Hann window"
TEXT = {"time": "time series", "spectrum": SPECTRUM, "orders": f"{SPECTRUM}, power mean of all blocks"}


class _FunctionType(IntEnum):
    """Kinds of function of dataset 58."""

    TIME_RESPONSE = 1
    SPECTRUM = 12
    ORDER = 24


@dataclass(frozen=True)
class _Quantity:
    """An axis of dataset 58."""

    code: int
    """Specific data type: 8 displacement, 9 reaction force, 12 acceleration, 17 time, 18 frequency, 19
    revolutions per minute, 20 order.
    """
    length: int
    force: int
    """`length`, `force`: Exponents of the units of length and force."""
    label: str
    unit: str
    """`label`, `unit`: At most 20 characters."""


@dataclass(frozen=True)
class _NodalFunction:
    """A function for dataset 58."""

    kind: _FunctionType
    lines: tuple[str, ...]
    """Up to five lines of text."""
    entity: str
    """Name of the response, at most 10 characters."""
    node: int
    direction: int
    """`node`, `direction`: Of the response: 1, 2, 3 for x, y, z; 4, 5, 6 for rotation about them; 0 scalar.
    """
    abscissa: _Quantity
    ordinate: _Quantity
    first: float
    increment: float
    """`first`, `increment`: Of the abscissa; the file keeps six digits."""
    values: FloatArray
    """Shape (N,)."""


def _units_dataset() -> str:
    factors = "".join(f"{value:25.16E}" for value in (1.0, 1.0, 1.0)).replace("E", "D")
    offset = f"{273.15:25.16E}".replace("E", "D")
    return _dataset(164, [f"{1:10d}{'SI: Meter (newton)':<20}{2:10d}", factors, offset])


def _nodes_dataset(nodes: Iterable[tuple[int, FloatArray]]) -> str:
    """Return dataset 2411: labels and positions (3,) in m, in the fixed frame."""
    records = []
    for label, origin in nodes:
        records.append(f"{label:10d}{1:10d}{1:10d}{11:10d}")
        records.append("".join(f"{value:25.16E}" for value in origin).replace("E", "D"))
    return _dataset(2411, records)


def _function_dataset(function: _NodalFunction) -> str:
    lines = [line[:80] for line in (*function.lines, *["NONE"] * 5)][:5]
    entity = f"{function.entity[:10]:<10}"
    node = f" {entity}{function.node:10d}{function.direction:4d} {'NONE':<10}{0:10d}{0:4d}"
    form = f"{DOUBLE:10d}{function.values.size:10d}{EVEN:10d}"
    axes = [_axis(quantity) for quantity in (function.abscissa, function.ordinate, None, None)]
    return _dataset(
        58,
        [
            *lines,
            f"{function.kind:5d}{0:10d}{0:5d}{0:10d}{node}",
            f"{form}{function.first:13.5E}{function.increment:13.5E}{0.0:13.5E}",
            *axes,
            *_numbers(function.values),
        ],
    )


def _axis(quantity: _Quantity | None) -> str:
    code, length, force, label, unit = vars(quantity).values() if quantity else NO_AXIS
    return f"{code:10d}{length:5d}{force:5d}{0:5d} {label[:20]:<20} {unit[:20]:<20}"


def _numbers(values: FloatArray) -> list[str]:
    """Four numbers a record."""
    whole = values.size // 4 * 4
    rows = (("%20.12E" * 4 + "\n") * (whole // 4) % tuple(values[:whole])).splitlines()
    rest = values[whole:]
    return [*rows, "%20.12E" * rest.size % tuple(rest)] if np.size(rest) else rows


def _dataset(number: int, records: list[str]) -> str:
    return "\n".join([f"{-1:6d}", f"{number:6d}", *records, f"{-1:6d}"]) + "\n"


ORDINATES = {
    "bearing_force": _Quantity(9, 0, 1, "Force", "N"),
    "bearing_moment": _Quantity(9, 1, 1, "Moment", "N m"),
    "bearing_acceleration": _Quantity(12, 1, 0, "Acceleration", "m/s2"),
    "mesh_force": _Quantity(9, 0, 1, "Mesh force", "N"),
    "dynamic_transmission_error": _Quantity(8, 1, 0, "Transmission error", "m"),
}
TACHO = _Quantity(19, 0, 0, "Speed", "rpm")
ABSCISSAE = {
    "time": (_FunctionType.TIME_RESPONSE, _Quantity(17, 0, 0, "Time", "s")),
    "spectrum": (_FunctionType.SPECTRUM, _Quantity(18, 0, 0, "Frequency", "Hz")),
    "orders": (_FunctionType.ORDER, _Quantity(20, 0, 0, "Mesh order", "1")),
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
    with whole_file(path) as draft, draft.open("w", encoding="ascii", errors="replace") as file:
        file.write(_units_dataset())
        file.write(_nodes_dataset(_nodes(result)))
        for nodal in chain(_functions(part, function), _tachos(part, function)):
            file.write(_function_dataset(nodal))
            count += 1
    return count


def _functions(result: RunResult, function: str) -> Iterator[_NodalFunction]:
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
            yield _NodalFunction(
                kind, lines, names[component_index[0]], node, direction, *axes, values[component_index]
            )


def _tachos(result: RunResult, function: str) -> Iterator[_NodalFunction]:
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
        yield _NodalFunction(
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
