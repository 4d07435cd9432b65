"""Static transmission error over two base pitches at every load of the database."""

from __future__ import annotations

import numpy as np

from fe_contact.ste import SteDatabase
from service.report.aligned import load_curve, load_labels, load_lines, shown_loads, two_pitches
from service.report.figure import Axis, Figure, Panel, Table, number

POSITION_AXIS = Axis(
    "position of the driving gear, base pitches (0 = reference pair at the pitch point)", limits=(0, 2)
)
_TONES = 3


def ste_curves(database: SteDatabase) -> Figure:
    """Draw STE against position, one line per load."""
    position, values = two_pitches(database)
    y = Axis("static transmission error, µm", limits=(0.0, 1.05e6 * float(np.nanmax(values))))
    panel = Panel(POSITION_AXIS, y, load_lines(database, position, values * 1e6))
    return Figure(
        key="ste",
        title="Static transmission error over two base pitches",
        caption="Displacement on the transverse line of action by which the driven gear lags, relative to "
        "conjugate motion. Low plateaus: two pairs share the load; high plateaus: one pair carries it.",
        alternative=_words(database),
        content=(panel,),
        table=_table(database),
    )


def _words(database: SteDatabase) -> str:
    """Say what the plot shows at its ends."""
    labels, loads = load_labels(database), shown_loads(database)
    ends = [
        f"{_um(load_curve(database, k).peak_to_peak.value, 3)} µm at {labels[k]}"
        for k in (loads[0], loads[-1])
    ]
    return f"{len(loads)} periodic curves rise with load; peak to peak from {ends[0]} to {ends[1]}."


def _table(database: SteDatabase) -> Table:
    """Mean, peak to peak and the first harmonics with their error estimates at every load."""
    rows = []
    for load, label in enumerate(load_labels(database)):
        curve = load_curve(database, load)
        band = [f"{_um(e.value)} ± {_um(e.error, 2)}" for e in (curve.mean, curve.peak_to_peak)]
        tones = [_um(e.value, 3) for e in curve.harmonics[:_TONES]]
        rows.append((label, number(float(database.force[load]), 5), *band, *tones))
    head = ("torque", "normal force, N", "mean, µm", "peak to peak, µm")
    orders = tuple(f"harmonic {k}, µm" for k in range(1, _TONES + 1))
    return Table("Static transmission error by load", head + orders, tuple(rows))


def _um(value: float, digits: int = 4) -> str:
    """Write metres as micrometres."""
    return number(value * 1e6, digits)
