"""Largest flank pressure and place of the load along the face over torque."""

from __future__ import annotations

import numpy as np

from fe_contact.ste import SteDatabase
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import Axis, Figure, FloatArray, Line, Panel, Reference, Table, number
from lineofaction.report.tables.aligned import aligned_index, load_labels, shown_loads
from lineofaction.report.tables.face_load import has_face_load

_MPA, _MM = 1e-6, 1e3
_ROOM = 0.02  # of the torques' range, at both ends


def flanks_over_torque(database: SteDatabase) -> Figure:
    """Draw the largest pressure over torque, and where the load moves along the face, its range."""
    loads = list(shown_loads(database))
    m, d = aligned_index(database)
    torque = database.torque[loads]
    pressure = _MPA * np.nanmax(database.max_pressure[:, loads, m, d], axis=0)
    centroid = _MM * database.face_centroid[:, loads, m, d]
    ends = np.stack([np.nanmin(centroid, axis=0), np.nanmean(centroid, axis=0), np.nanmax(centroid, axis=0)])
    room = _ROOM * float(np.ptp(torque))
    across = Axis("torque on the driving gear, N m", limits=(torque[0] - room, torque[-1] + room))
    y = Axis("largest pressure, MPa", limits=(0.0, 1.05 * float(pressure.max())))
    line = Line("largest pressure", torque, pressure, palette.BLUE, markers=True)
    panels: tuple[Panel, ...] = (Panel(across, y, (line,), title="Flank pressure"),)
    panels += (_centroid(across, torque, ends),) if has_face_load(database) else ()
    return Figure(
        key="flanks_over_torque",
        title="Flank pressure over torque"
        if len(panels) == 1
        else "Flank pressure and load centroid over torque",
        caption="The largest Hertz pressure of the mesh cycle at every stored load"
        + ("; below, how far the load's centroid is from the pinion's mid-face." if len(panels) > 1 else "."),
        alternative=_words(database, loads, pressure),
        content=panels,
        table=_table(database, loads, pressure, ends),
    )


def _centroid(across: Axis, torque: FloatArray, ends: FloatArray) -> Panel:
    """Draw the least, mean and largest distance from mid-face over the cycle."""
    names = ("least", "mean", "largest")
    colors = (palette.SKY, palette.BLUE, palette.VERMILLION)
    lines = tuple(
        Line(name, torque, values, color, markers=True, label=name)
        for name, values, color in zip(names, ends, colors, strict=True)
    )
    mark = Reference("mid-face", 0.0, "horizontal")
    return Panel(across, Axis("load centroid, mm"), lines, (mark,), title="Load along the face")


def _words(database: SteDatabase, loads: list[int], pressure: FloatArray) -> str:
    """Say how much the pressure grows for the growth of the torque."""
    names, torque = load_labels(database), database.torque
    first, last = loads[0], loads[-1]
    growth = f"{number(float(torque[last] / torque[first]), 3)} times the torque"
    return (
        f"The largest pressure grows from {number(float(pressure[0]), 3)} MPa at {names[first]} to "
        f"{number(float(pressure[-1]), 3)} MPa at {names[last]}: "
        f"{number(float(pressure[-1] / pressure[0]), 3)} times for {growth}."
    )


def _table(database: SteDatabase, loads: list[int], pressure: FloatArray, ends: FloatArray) -> Table:
    """Pressure and centroid at every load."""
    labels = load_labels(database)
    rows = tuple(
        (labels[k], number(float(p), 4), *(number(float(end), 3) for end in column))
        for k, p, column in zip(loads, pressure, ends.T, strict=True)
    )
    places = (f"{name} centroid, mm" for name in ("least", "mean", "largest"))
    return Table("Flanks by load", ("torque", "largest pressure, MPa", *places), rows)
