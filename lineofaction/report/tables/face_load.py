"""Position of the load along the face, and the largest pressure, over position."""

from __future__ import annotations

import numpy as np

from fe_contact.ste import SteDatabase
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import Axis, Figure, FloatArray, Line, Panel, Reference, number
from lineofaction.report.tables.aligned import (
    aligned_index,
    load_labels,
    middle_load,
    position_axis,
    shown_rows,
)


def has_face_load(database: SteDatabase) -> bool:
    """Whether the load moves along the face: a table in three dimensions of a helical or misaligned pair."""
    moves = np.nanmax(database.face_centroid) - np.nanmin(database.face_centroid)
    return bool(moves > 1e-6 * database.facts.face_width)


def face_load(database: SteDatabase) -> Figure:
    """Draw load centroid and peak pressure at the middle load, one line per misalignment."""
    load, (_, d) = middle_load(database), aligned_index(database)
    centroid = 1e3 * database.face_centroid[:, load, :, d]
    pressure = 1e-6 * database.max_pressure[:, load, :, d]
    label = load_labels(database)[load]
    return Figure(
        key="face_load",
        title="Load along the face",
        caption="Above: distance of the load's centroid from the pinion's mid-face. Below: the largest Hertz "
        f"pressure anywhere on the flanks{_waves(database)}; at a tip edge the true pressure is singular.",
        alternative=f"At {label} the load acts from {number(float(np.nanmin(centroid)), 3)} to "
        f"{number(float(np.nanmax(centroid)), 3)} mm from mid-face; the largest pressure is "
        f"{number(float(np.nanmax(pressure)), 3)} MPa.",
        content=(
            Panel(
                position_axis(database),
                Axis("load centroid, mm"),
                _lines(database, centroid),
                (Reference("mid-face", 0.0, "horizontal"),),
                title=label,
            ),
            Panel(position_axis(database), Axis("largest pressure, MPa"), _lines(database, pressure)),
        ),
    )


def _waves(database: SteDatabase) -> str:
    """Say what of the pressure is the model's."""
    return (
        ", which fluctuates as the contact lines pass from slice to slice of the model"
        if database.facts.base_helix_angle
        else ""
    )


def _lines(database: SteDatabase, values: FloatArray) -> tuple[Line, ...]:
    """Draw `values` (P, M) over the pitches shown, dark for the first misalignment."""
    position, rows = shown_rows(database)
    names = [f"misalignment {number(1e6 * float(m), 3)} µm" for m in database.misalignment]
    return tuple(
        Line(
            name,
            position,
            values[rows, m],
            palette.ordered(m, len(names)),
            label=name if len(names) > 1 else "",
        )
        for m, name in enumerate(names)
    )
