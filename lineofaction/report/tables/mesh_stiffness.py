"""Secant mesh stiffness per unit of face width, beside the mean mesh stiffness of ISO 6336-1."""

from __future__ import annotations

import math

import numpy as np

from fe_contact.ste import SteDatabase
from lineofaction.report.drawing.figure import Axis, Figure, FloatArray, Panel, Reference, Table, number
from lineofaction.report.tables.aligned import (
    load_labels,
    load_lines,
    mean_over,
    middle_load,
    position_axis,
    ste_shown,
)
from lineofaction.report.tables.pair import iso_mesh_stiffness

_N_PER_MM_UM = 1e-9  # N/m per m of face width to N/(mm µm)
_CAPTION = "Transverse mesh force over static transmission error and face width."
_STANDARD = (
    " The dashed line is the mean mesh stiffness c γα of ISO 6336-1 method B, which includes a correction of "
    "0.8 for real gears."
)


def mesh_stiffness(database: SteDatabase) -> Figure:
    """Draw the transverse mesh force over STE and face width, one line per load."""
    position, values = secant_stiffness(database)
    iso = iso_mesh_stiffness(database)
    lines = load_lines(database, position, values * _N_PER_MM_UM)
    top = 1.08 * max(*(float(np.nanmax(line.y)) for line in lines), (iso or 0.0) * _N_PER_MM_UM)
    references = () if iso is None else (Reference("ISO 6336-1, c γα", iso * _N_PER_MM_UM, "horizontal"),)
    y = Axis("secant mesh stiffness, N/(mm µm)", limits=(0.0, top))
    return Figure(
        key="mesh_stiffness",
        title="Mesh stiffness",
        caption=_CAPTION + (_STANDARD if iso is not None else ""),
        alternative=_words(database, position, values, iso),
        content=(Panel(position_axis(database), y, lines, references),),
        table=_table(database, position, values, iso),
    )


def secant_stiffness(database: SteDatabase) -> tuple[FloatArray, FloatArray]:
    """Return the positions shown (n,) and F_bt / (STE b) there, (n, F), in N/m per m of face width."""
    position, values = ste_shown(database)
    facts = database.facts
    force = database.force * math.cos(facts.base_helix_angle)
    return position, force / (values * facts.face_width)


def _words(database: SteDatabase, position: FloatArray, values: FloatArray, iso: float | None) -> str:
    """Compare the middle load's mean with the standard's value."""
    load = middle_load(database)
    mean = mean_over(position, values[:, load]) * _N_PER_MM_UM
    text = f"Mean {number(mean, 3)} N/(mm µm) at {load_labels(database)[load]}"
    if iso is None:
        return f"{text}."
    standard = iso * _N_PER_MM_UM
    beyond = 100.0 * (mean / standard - 1.0)
    side = "above" if beyond > 0.0 else "below"
    return f"{text}, {number(abs(beyond), 2)} % {side} the {number(standard, 4)} N/(mm µm) of ISO 6336-1."


def _table(database: SteDatabase, position: FloatArray, values: FloatArray, iso: float | None) -> Table:
    """Lowest, mean and highest stiffness at every load."""
    columns = values * _N_PER_MM_UM
    rows = [
        (label, number(np.nanmin(v), 4), number(mean_over(position, v), 4), number(np.nanmax(v), 4))
        for label, v in zip(load_labels(database), columns.T, strict=True)
    ]
    if iso is not None:
        rows.append(("ISO 6336-1 method B", "", number(iso * _N_PER_MM_UM, 4), ""))
    return Table("Secant mesh stiffness, N/(mm µm)", ("torque", "lowest", "mean", "highest"), tuple(rows))
