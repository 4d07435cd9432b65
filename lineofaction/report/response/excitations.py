"""Excitations of a linear response, by mesh and harmonic, each amplitude with its error."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import numpy as np

from bounds import engineering
from bounds.error_digits import with_error
from lineofaction.gearbox.studies.excitation import Excitation, stored_excitations
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import Axis, Bars, Figure, Panel, Table, number
from lineofaction.report.drawing.marks import order_label

MAX_HARMONIC = 6
"""Highest harmonic of each mesh that is listed and drawn; orders between the harmonics are listed only."""
_WIDTH = 0.8
"""Width of all bars of a harmonic together."""


class _Quantity(NamedTuple):
    """An amplitude of an excitation with its error, drawn as `scale` times its value in SI."""

    label: str
    scale: float
    amplitude: Callable[[Excitation], tuple[float, float | None]]

    def cell(self, row: Excitation) -> str:
        value, error = self.amplitude(row)
        value *= self.scale
        if value == 0.0 and not error:
            return "0"
        return number(value, 3) if error is None else with_error(value, self.scale * error)


_QUANTITIES = (
    _Quantity(
        "transmission error, nm", 1e9, lambda row: (row.transmission_error, row.error_of_transmission_error)
    ),
    _Quantity("moment of the load F z_c, N m", 1.0, lambda row: (row.load_moment, row.error_of_load_moment)),
    _Quantity("friction, N", 1.0, lambda row: (row.friction_force, row.error_of_friction_force)),
)


def excitation_table(metadata: Mapping[str, Any]) -> Table | None:
    """List the first harmonics of every mesh's excitation; None: the result (such as a run) lists none."""
    rows = _low_harmonics(metadata)
    if not rows:
        return None
    head = "mesh", "load, N m", "harmonic", "order", *(quantity.label for quantity in _QUANTITIES)
    cells = []
    for row in rows:
        harmonic = "" if row.harmonic is None else str(row.harmonic)
        amplitudes = (quantity.cell(row) for quantity in _QUANTITIES)
        order = order_label(row.order, metadata)
        cells.append((row.mesh, engineering(row.torque, 4), harmonic, order, *amplitudes))
    caption = "What excites: amplitudes at the static mesh forces, each with its error"
    return Table(caption, head, tuple(cells))


def omitted_orders(metadata: Mapping[str, Any]) -> tuple[tuple[str, str], ...]:
    """Return a row on the orders that a response left out of a table with very many orders, or none.

    Metadata ``lines_left_out``: count, share of the force (rms), whether totals include them.
    """
    omitted = metadata.get("lines_left_out")
    if not omitted:
        return ()
    share = engineering(100.0 * omitted["force"], 2)
    part = f"up to {share} % of the exciting force of a mesh order (rms)"
    totals = "have" if omitted.get("in_totals") else "lack"
    text = f"{omitted['count']} not listed, {part}, which totals {totals}: fewer speeds list more"
    return (("weaker orders of a long table", text),)


def excitation_figures(metadata: Mapping[str, Any]) -> tuple[Figure, ...]:
    """Draw the excitations: a panel for each exciting quantity, a color for each mesh."""
    rows, table = _low_harmonics(metadata), excitation_table(metadata)
    if table is None:
        return ()
    meshes = list(dict.fromkeys(row.mesh for row in rows))
    acting = [quantity for quantity in _QUANTITIES if any(quantity.amplitude(row)[0] for row in rows)]
    largest = max(rows, key=lambda row: row.transmission_error)
    size = number(1e9 * largest.transmission_error, 3)
    figure = Figure(
        key="excitations",
        title="What excites",
        caption="Amplitudes of the harmonics at the static mesh forces; from bottom to top of the pale bars "
        "they lie within the errors of the table.",
        alternative=f"The largest transmission error is {size} nm in order "
        f"{order_label(largest.order, metadata)} of {largest.mesh}.",
        content=tuple(_panel(rows, quantity, meshes) for quantity in acting),
        table=table,
    )
    return (figure,) if acting else ()


def _low_harmonics(metadata: Mapping[str, Any]) -> list[Excitation]:
    return [row for row in stored_excitations(metadata) if (row.harmonic or 0) <= MAX_HARMONIC]


def _panel(rows: list[Excitation], quantity: _Quantity, meshes: list[str]) -> Panel:
    width = _WIDTH / len(meshes)
    bars = []
    for index, mesh in enumerate(meshes):
        mesh_rows = [row for row in rows if row.mesh == mesh and row.harmonic]
        # the bars of all meshes stand side by side, centered on the harmonic
        at = np.array([row.harmonic for row in mesh_rows]) + (index - 0.5 * (len(meshes) - 1)) * width
        amplitudes = [quantity.amplitude(row) for row in mesh_rows]
        size = quantity.scale * np.array([value for value, _ in amplitudes])
        error = quantity.scale * np.array([error or 0.0 for _, error in amplitudes])
        bars.append(Bars(name=mesh, x=at, top=size, base=0.0, width=width, color=palette.category(index)))
        # the error bar is narrower, and drawn pale over the end of the amplitude's bar
        ends = size + error, np.maximum(size - error, 0.0)
        bars.append(Bars("error", at, *ends, 0.4 * width, palette.INK, veiled=True))
    names = tuple((float(k), str(k)) for k in range(1, MAX_HARMONIC + 1))
    x = Axis("harmonic of the mesh", limits=(0.4, MAX_HARMONIC + 0.6), names=names)
    return Panel(x, Axis(quantity.label), bars=tuple(bars))
