"""Peak-to-peak STE and its mesh harmonics over torque."""

from __future__ import annotations

import numpy as np

from fe_contact.ste import Curve, SteDatabase
from fe_contact.types import BoolArray
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import Axis, Figure, FloatArray, Line, Panel, Table, number
from lineofaction.report.tables.aligned import load_curve, load_labels, shown_loads

HARMONICS = 8
_UM = 1e6
_DEPTH = 1e-4  # of the largest harmonic: 80 dB, the lowest level drawn
_ROOM = 0.02  # of the range of torques, beside its ends


def ripple_over_torque(database: SteDatabase) -> Figure:
    """Draw peak-to-peak with its error, and harmonics as they are and in dB, over torque."""
    curves = {load: load_curve(database, load) for load in shown_loads(database)}
    torque = np.array([curve.torque for curve in curves.values()])
    room = _ROOM * float(np.ptp(torque))
    across = Axis("torque on the driving gear, N m", limits=(torque[0] - room, torque[-1] + room))
    tones = [curve.harmonics[:HARMONICS] for curve in curves.values()]
    value, error = (
        _UM * np.array([[getattr(e, name) for e in row] for row in tones]) for name in ("value", "error")
    )
    known = ~(error >= value)  # also where no error was estimated
    level = 20.0 * np.log10(np.maximum(value, _DEPTH * value.max()))
    return Figure(
        key="ripple",
        title="Ripple over torque",
        caption="Peak-to-peak STE with the band of its error, and its mesh harmonics; dotted: below their "
        "errors.",
        alternative=ripple_words({f"at {load_labels(database)[k]}": c for k, c in curves.items()}),
        content=(
            _ripple(across, torque, curves),
            _harmonics(across, torque, value, known, "amplitude, µm"),
            _harmonics(across, torque, level, known, "amplitude, dB re 1 µm"),
        ),
        table=_table(database, curves),
    )


def _ripple(across: Axis, torque: FloatArray, curves: dict[int, Curve]) -> Panel:
    """Draw peak-to-peak."""
    sizes = [curve.peak_to_peak for curve in curves.values()]
    value, error = (_UM * np.array(these) for these in ([e.value for e in sizes], [e.error for e in sizes]))
    line = Line("peak to peak", torque, value, palette.BLUE, markers=True, band=error)
    top = 1.05 * float(np.nanmax(value + np.nan_to_num(error)))
    return Panel(across, Axis("peak to peak, µm", limits=(0.0, top)), (line,), title="Peak to peak")


def _harmonics(across: Axis, torque: FloatArray, values: FloatArray, known: BoolArray, label: str) -> Panel:
    """Draw the harmonics (n, H), each labeled by its number; solid lines where they are known."""
    lines: list[Line] = []
    for order in range(values.shape[1]):
        name, color = f"{order + 1}", palette.ordered(order, values.shape[1])
        lines.append(Line(name, torque, values[:, order], color, "dot", 1.2, label=name))
        sure = np.where(known[:, order], values[:, order], np.nan)
        if known[:, order].any():
            lines.append(Line(name, torque, sure, color, markers=True))
    return Panel(across, Axis(label), tuple(lines), title=f"Mesh harmonics 1 to {HARMONICS}")


def ripple_words(curves: dict[str, Curve]) -> str:
    """Say where, by the names of the curves, the ripple is least and largest, and whether that is shown."""
    ripple = {name: curve.peak_to_peak for name, curve in curves.items()}
    least, most = (ripple[end(ripple, key=lambda name: ripple[name].value)] for end in (min, max))
    where = {name: f"{number(_UM * e.value, 3)} µm {name}" for name, e in ripple.items()}
    ends = [next(where[name] for name, e in ripple.items() if e is end) for end in (least, most)]
    if most.value - least.value <= least.error + most.error:
        return f"Peak to peak, {ends[0]} to {ends[1]}, changes by no more than its errors."
    return f"Peak to peak is least, {ends[0]}, and largest, {ends[1]}."


def _table(database: SteDatabase, curves: dict[int, Curve]) -> Table:
    """Amplitudes of the harmonics at every load."""
    labels = load_labels(database)
    rows = tuple(
        (labels[load], *(number(_UM * harmonic.value, 3) for harmonic in curve.harmonics[:HARMONICS]))
        for load, curve in curves.items()
    )
    head = ("torque", *(f"harmonic {k}, µm" for k in range(1, HARMONICS + 1)))
    return Table("Mesh harmonics by load", head, rows)
