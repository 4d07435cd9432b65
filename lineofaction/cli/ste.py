"""``loa ste``."""

from __future__ import annotations

import math
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from bounds import engineering, order_words
from bounds.error_digits import error_text, to_error, with_error
from fe_contact.ste import SteDatabase
from lineofaction.cli.output import EMPHASIS, aligned, console, csv_text, print_json, table
from lineofaction.cli.verb_warnings import warn
from lineofaction.gearbox.convert.answers import curve_json, teeth_text
from lineofaction.gearbox.convert.operating_point import pair_point
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.project import sole_file, tables_in
from lineofaction.gearbox.schemas import Case, read_model
from lineofaction.gearbox.units import MM, UM

_FARTHEST = 1e6
"""Largest position that ``--at`` accepts, base pitches."""
_MAX_ORDERS = 8
"""Largest number of orders that are listed."""
_NAME = 17  # characters of a name
_BAR = 16  # characters of the bar of the largest order
_SPARKS = 24  # characters of the curve
_DECIMALS = 4
"""Decimals of a figure in µm without an error."""
_BLOCKS = "▁▂▃▄▅▆▇█"
"""Characters of a drawn curve, from its least to its largest value."""


class _Line(NamedTuple):
    """A figure in µm with its error; None: the error was not estimated."""

    name: str
    value: float
    error: float | None


def run_ste(
    named: Path,
    point: dict[str, float | None],
    at: str | None,
    *,
    as_table: bool,
    as_csv: bool,
    as_json: bool,
) -> None:
    """Read, evaluate, print each table; `point` holds the options of load and alignment by their names."""
    tables = tables_in(named, _cached_table)
    if as_csv or as_json:
        tables = {"": sole_file([*filter(None, tables.values())], named, "table")}
    for name, file in tables.items():
        if len(tables) > 1:
            console().print(f"\n{name}", style=EMPHASIS)
        if file is None:
            console().print(f"no table: make it with loa analyze {named}", soft_wrap=True)
            continue
        following = f"analyze {named}" if named.is_dir() and file.parent != named else f"report {file}"
        _show(file, point, at, following, as_table=as_table, as_csv=as_csv, as_json=as_json)


def _cached_table(case: Path) -> Path:
    """Return the file of the table that the cache has for a case."""
    from lineofaction.cli.cached_tables import CachedTables  # noqa: PLC0415 (the base reads tables)

    return CachedTables.file(read_model(Case, case))


def _show(
    file: Path,
    point: dict[str, float | None],
    at: str | None,
    following: str,
    *,
    as_table: bool,
    as_csv: bool,
    as_json: bool,
) -> None:
    database = open_ste(file)
    warn(database.metadata.warnings)
    curve = curve_json(database, **_arguments(point, database), at=None if at is None else positions(at))
    if as_json:
        print_json(curve)
    elif as_csv:
        sys.stdout.write(csv_text(_columns(curve), _rows(curve)))
    elif as_table or at is not None:
        console().print(
            table(_columns(curve), [_typed(row, with_error="error_um" in curve) for row in _rows(curve)])
        )
    else:
        for number, line in enumerate(_answer(database, following, curve)):
            console().print(line, soft_wrap=True, style=None if number else EMPHASIS)


def open_ste(file: Path) -> SteDatabase:
    """Return the database in a file; raises `BadInput` if there is no file, `DatabaseError` if it is none."""
    if not file.is_file():
        raise BadInput.of(
            "file", str(file), "an STE database", "Check the path, or make one with: loa analyze"
        )
    if file.suffix in (".toml", ".json"):
        remedy = f"Make one with: loa analyze {file} -o ste.nc"
        raise BadInput.of("file", str(file), "an STE database (netCDF)", remedy)
    return SteDatabase.from_netcdf(file)


def _arguments(point: dict[str, float | None], database: SteDatabase) -> dict[str, Any]:
    """Return the arguments of `curve_json` by the options; without a load the highest one is taken."""
    # the options stand in this order in the signature of the verb
    torque, force, misalignment_um, center_distance_change_mm = point.values()
    if torque is not None and force is not None:
        remedy = "Leave out one of them, or both for the highest load."
        raise BadInput.of("--torque", f"{torque:g} --force {force:g}", "the only load", remedy)
    force = float(database.force[-1]) if torque is None and force is None else force
    for name, value in point.items():
        if value is not None and not math.isfinite(value):
            raise BadInput.of(f"--{name.replace('_', '-')}", value, "a finite number")
    alignment = {"misalignment_um": misalignment_um, "center_distance_change_mm": center_distance_change_mm}
    return {"torque_n_m": torque, "force_n": force, **alignment}


def positions(text: str) -> list[float]:
    """Return the positions that the text of ``--at`` lists, base pitches."""
    bound = f"numbers from {-_FARTHEST:g} to {_FARTHEST:g}, separated by commas"
    try:
        numbers = [float(part) for part in text.split(",")]
    except ValueError:
        raise BadInput.of("--at", text, bound, "For example --at 0,0.25,0.5.") from None
    if not all(abs(position) <= _FARTHEST for position in numbers):
        raise BadInput.of("--at", text, bound, "One base pitch is 1.")
    return numbers


def _rows(curve: dict[str, Any]) -> list[list[str]]:
    """Return the rows of a curve as texts, in the order of `_columns`."""
    shares = [[f"{share:.6g}" for share in row] for row in curve["load_share"]]
    bands = [[f"{band:.3g}"] for band in curve["error_um"]] if "error_um" in curve else [[]] * len(shares)
    lines = zip(curve["position"], curve["ste_um"], shares, bands, strict=True)
    return [[repr(x), f"{ste:.9g}", *row, *band] for x, ste, row, band in lines]


def _typed(row: list[str], *, with_error: bool) -> list[str]:
    """Return a row of the printed table: the STE up to its error, shares of three digits."""
    position, ste, *shares = map(float, row)
    cells = [f"{position:.5f}"]
    if with_error:
        *shares, error = shares
        return [*cells, to_error(ste, error), *map(engineering, shares), error_text(ste, error)]
    return [*cells, engineering(ste, 4), *map(engineering, shares)]


def _columns(curve: dict[str, Any]) -> list[str]:
    shares = [f"load_share_{pair:+d}" for pair in curve["pair"]]
    return ["position", "ste_um", *shares, *(["ste_error_um"] if "error_um" in curve else [])]


def _answer(database: SteDatabase, following: str, curve: dict[str, Any]) -> Iterator[str]:
    """Yield the lines of a curve: figures with errors, harmonics, load sharing, the next verb."""
    pinion_teeth, wheel_teeth = database.geometry.teeth
    yield f"gear pair {pinion_teeth}/{wheel_teeth} {_point(curve)}"
    if curve["period"] == 1:
        yield f"harmonic 1 is {order_words(pinion_teeth, 'pinion')}"
    yield ""
    known, unknown = _orders(curve)
    lines = [
        _Line("mean", *_with_error(curve, "mean_um")),
        _Line("peak to peak", *_with_error(curve, "peak_to_peak_um")),
        *known,
    ]
    cells = aligned([_figure(line) for line in lines])
    width = max(map(len, cells))
    mean, ripple, *orders = (
        f"  {line.name:<{_NAME}} {cell:>{width}}" for line, cell in zip(lines, cells, strict=True)
    )
    largest = max((line.value for line in known), default=1.0)
    yield mean.rstrip()
    yield f"{ripple}  {_sparkline(curve['ste_um'])}  two periods"
    for order, line in zip(orders, known, strict=True):
        level, bar = 20.0 * math.log10(line.value), "█" * round(_BAR * line.value / largest)
        yield f"{order}   {level:6.1f} dB re 1 µm  {bar}".rstrip()
    if unknown:
        names = ", ".join(line.name for line in unknown)
        below = max(line.error for line in unknown if line.error)
        yield f"  {names.replace(', harmonic', ',')}: below {engineering(below, 2)} µm, their error"
    yield from _bands(curve)
    shares = np.array(curve["load_share"])
    carrying = (shares > 0.0).sum(axis=1)
    pairs = " to ".join(f"{number}" for number in dict.fromkeys([carrying.min(), carrying.max()]))
    yield f"  load sharing: {pairs} pairs carry; most on one {100.0 * shares.max():.0f} %"
    for gear, loads in curve.get("tooth_loads", {}).items():
        if worst := loads["most_loaded"]:
            times = f"{loads['over_mean']:.3f} times the mean tooth"
            yield f"  {gear}: most on {teeth_text(worst)}, {loads['force_n']:.0f} N, {times}"
        if worst := loads["most_pressed"]:
            yield f"  {gear}: largest pressure on {teeth_text(worst)}, {loads['pressure_mpa']:.0f} MPa"
    yield ""
    yield f"next: loa {following}     all positions: --table, --csv"


def _point(curve: dict[str, Any]) -> str:
    """Return the operating point of a curve in words."""
    change = curve.get("center_distance_change_mm", 0.0) * MM
    return pair_point(curve["torque_n_m"], curve["normal_force_n"], curve["misalignment_um"] * UM, change)


def _bands(curve: dict[str, Any]) -> Iterator[str]:
    """Yield lines on the error of a single point of the curve, and on its share by interpolation."""
    if "error_um" not in curve:
        yield "  error of a point: not estimated"
        return
    text = f"  error of a point: up to {engineering(max(curve['error_um']), 2)} µm"
    if interpolated := curve["interval_error_um"]:
        text += f", {engineering(interpolated, 2)} µm of it by interpolation between the nodes"
    yield text


def _with_error(curve: dict[str, Any], name: str) -> tuple[Any, Any]:
    return curve[name], curve.get(name.replace("_um", "_error_um"))


def _figure(line: _Line) -> str:
    """Write a figure to the digits of its error."""
    if line.error is None:
        return f"{line.value:.{_DECIMALS}f} (error not estimated)"
    return with_error(line.value, line.error, "µm")


def _orders(curve: dict[str, Any]) -> tuple[list[_Line], list[_Line]]:
    """Return the largest lines of the spectrum above their errors, and the lines below."""
    if curve["period"] > 1:
        sizes, errors = _with_error(curve, "amplitude_um")
        figures = zip(curve["order_name"], sizes, errors or [None] * len(sizes), strict=True)
        lines = sorted((_Line(*figure) for figure in figures), key=lambda line: -line.value)
        return [line for line in lines if line.value > (line.error or 0.0)][:_MAX_ORDERS], []
    sizes, errors = _with_error(curve, "harmonics_um")
    names = (f"harmonic {order}" for order in range(1, _MAX_ORDERS + 1))
    lines = list(map(_Line, names, sizes, errors or [None] * len(sizes)))
    known = [line for line in lines if line.value > (line.error or 0.0)]
    return known, [line for line in lines if line not in known]


def _sparkline(values: list[float]) -> str:
    """Return two periods of a curve as one line of blocks, from its least to its largest value."""
    # half the characters span the period; the index starts again behind its end
    samples = np.array(values)[np.arange(_SPARKS) * len(values) // (_SPARKS // 2) % len(values)]
    span = np.ptp(values)
    steps = (len(_BLOCKS) - 1) * (samples - min(values)) / span if span > 0.0 else np.zeros(_SPARKS)
    return "".join(_BLOCKS[round(step)] for step in steps)
