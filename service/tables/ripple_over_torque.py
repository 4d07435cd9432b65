"""Peak-to-peak STE and its mesh harmonics over torque."""

from __future__ import annotations

import numpy as np

from fe_contact.ste import Curve, SteDatabase
from service.drawing import palette
from service.drawing.figure import Axis, Figure, FloatArray, Line, Note, Panel, Table, number
from service.drawing.note_places import placed
from service.tables.aligned import load_curve, load_labels, shown_loads

HARMONICS = 8
_UM = 1e6
_ROOM = 0.08  # of the axis beyond the last torque: for the names of the harmonics


def ripple_over_torque(database: SteDatabase) -> Figure:
    """Draw peak-to-peak with its error, and harmonics in dB, over torque."""
    curves = {load: load_curve(database, load) for load in shown_loads(database)}
    torque = np.array([curve.torque for curve in curves.values()])
    room = _ROOM * float(np.ptp(torque))
    ends = (float(torque[0]) - 0.5 * room, float(torque[-1]) + room)
    across = Axis("torque on the driving gear, N m", limits=ends)
    return Figure(
        key="ripple",
        title="Ripple over torque",
        caption="Peak-to-peak STE with the band of its error, and its mesh harmonics; what is below its own "
        "error is left out.",
        alternative=_words(database, curves),
        content=(_ripple(across, torque, curves), _harmonics(across, torque, curves)),
        table=_table(database, curves),
    )


def _ripple(across: Axis, torque: FloatArray, curves: dict[int, Curve]) -> Panel:
    """Draw peak-to-peak."""
    sizes = [curve.peak_to_peak for curve in curves.values()]
    value, error = (_UM * np.array(these) for these in ([e.value for e in sizes], [e.error for e in sizes]))
    line = Line("peak to peak", torque, value, palette.BLUE, markers=True, band=error)
    top = 1.05 * float(np.nanmax(value + np.nan_to_num(error)))
    return Panel(across, Axis("peak to peak, µm", limits=(0.0, top)), (line,), title="Peak to peak")


def _harmonics(across: Axis, torque: FloatArray, curves: dict[int, Curve]) -> Panel:
    """Draw the level of each harmonic, named at its last point."""
    levels = np.array([[_level(curve, order) for order in range(HARMONICS)] for curve in curves.values()])
    kept = [order for order in range(HARMONICS) if np.isfinite(levels[:, order]).any()]
    finite = levels[np.isfinite(levels)]
    low, high = (float(finite.min()), float(finite.max())) if finite.size else (-60.0, 0.0)
    axis = Axis("amplitude, dB re 1 µm", limits=(low - 3.0, high + 3.0))
    lines, notes = [], []
    for order in kept:
        name, last = f"{order + 1}", int(np.flatnonzero(np.isfinite(levels[:, order]))[-1])
        color = palette.ordered(order, HARMONICS)
        lines.append(Line(name, torque, levels[:, order], color, markers=True))
        notes.append(Note(float(torque[last]), float(levels[last, order]), name))
    names = placed(notes, across, axis, (low, high))
    return Panel(across, axis, tuple(lines), title=f"Mesh harmonics 1 to {HARMONICS}", notes=names)


def _level(curve: Curve, order: int) -> float:
    """Amplitude of a harmonic in dB re 1 µm; NaN where it is below its error."""
    harmonic = curve.harmonics[order]
    shown = harmonic.value > 0.0 and not harmonic.error >= harmonic.value
    return 20.0 * float(np.log10(_UM * harmonic.value)) if shown else float("nan")


def _words(database: SteDatabase, curves: dict[int, Curve]) -> str:
    """Say where the ripple is least and largest."""
    labels = load_labels(database)
    ripple = {load: curve.peak_to_peak.value for load, curve in curves.items()}
    least, most = min(ripple, key=ripple.__getitem__), max(ripple, key=ripple.__getitem__)
    return (
        f"Peak to peak is least at {labels[least]}, {number(_UM * ripple[least], 3)} µm, "
        f"and largest at {labels[most]}, {number(_UM * ripple[most], 3)} µm."
    )


def _table(database: SteDatabase, curves: dict[int, Curve]) -> Table:
    """Amplitudes of the harmonics at every load."""
    labels = load_labels(database)
    rows = tuple(
        (labels[load], *(number(_UM * harmonic.value, 3) for harmonic in curve.harmonics[:HARMONICS]))
        for load, curve in curves.items()
    )
    head = ("torque", *(f"harmonic {k}, µm" for k in range(1, HARMONICS + 1)))
    return Table("Mesh harmonics by load", head, rows)
