"""Marks of a complaint in every plot whose axes or orders contain it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any, Literal

import numpy as np

from bounds import engineering, order_name, order_words
from lineofaction.gearbox.studies.figures import metadata_of
from lineofaction.report.drawing.figure import Axis, Figure, FloatArray, Panel, Reference, largest, unit_of
from lineofaction.report.drawing.page import Page, Section

NAME = "complaint"
Marks = Mapping[str, Any]
"""Marks of a complaint, as `Complaint.marks` makes them.

``axes``: value of the complaint on each axis, by the label of the axis. ``order``: order of the complaint as
the result counts orders. ``meshes``: order, speed of the driving gear and torque by mesh, for plots whose
orders count by that mesh. ``bearing``: bearing of the complaint. ``words``: the complaint as a sentence.
"""
DRIVER = "speed of the driving gear, rpm"
TORQUE = "torque on the driving gear, N m"
"""Labels of axes of runs and tables."""
BOLDER = 2.0
"""Width of the complaint's order over the usual width of the line."""
LABEL_END = 0.98
"""End of the label of a horizontal line, in parts of the panel's width."""


def marks_of(result: Any) -> Marks | None:
    """Return the marks by the complaint of a result's scene, None without a complaint."""
    return metadata_of(result).get(NAME)


def of_run(marks: Marks, mesh: str) -> Marks:
    """Return the marks in the plots of a run or a table, whose orders, speeds and torques are of a mesh."""
    mesh_marks = marks["meshes"].get(mesh, {})
    # the other axes are speeds of shafts, which these plots do not have
    axes = {label: value for label, value in marks["axes"].items() if label == "frequency, Hz"}
    if mesh_marks:
        axes |= {"mesh order": mesh_marks["order"]}
        known = {DRIVER: mesh_marks["driver_rpm"], TORQUE: mesh_marks.get("torque_n_m")}
        axes |= {label: value for label, value in known.items() if value is not None}
    return {**marks, "order": mesh_marks.get("order", np.nan), "axes": axes}


def order_label(order: float, metadata: Mapping[str, Any]) -> str:
    """Return an order, with its name if it is no harmonic of the first mesh: "0.5789 (pinion 11)"."""
    text = f"{order:.4g}"
    unit_orders = metadata.get("turning")  # orders of meshes and of turns of shafts, by name
    if unit_orders is None or np.isclose(order, round(order), rtol=1e-6):
        return text
    name = order_name(order, unit_orders["mesh"], unit_orders["shaft"])
    return f"{text} ({name})" if name else text


def words_of_order(order: float, metadata: Mapping[str, Any]) -> str:
    """Return an order as a sentence names it: "order 20.0 of input, harmonic 1 of first stage".

    Orders of results count by the first mesh. Files of earlier versions do not know its order of a shaft.
    """
    leading, turning = metadata.get("leading"), metadata.get("turning")
    if not leading or not turning or not leading["mesh_order"]:
        return f"order {order_label(order, metadata)}"
    meshes = turning["mesh"]
    fitting = [name for name, rate in meshes.items() if np.isclose(order / rate, round(order / rate) or 1)]
    named = ", ".join(f"harmonic {round(order / meshes[name])} of {name}" for name in fitting)
    part = named or order_name(order, meshes, turning["shaft"])
    return order_words(order * leading["mesh_order"], leading["shaft"], part)


def drawn_orders(order: FloatArray, sizes: FloatArray, count: int, metadata: Mapping[str, Any]) -> list[int]:
    """Return the indices of `count` orders (H,), the largest by sizes (H,), one of them the complaint's."""
    is_marked = np.isclose(order, metadata.get(NAME, {}).get("order", np.nan), rtol=1e-6)
    return largest(np.where(is_marked, np.inf, sizes), count)


def marked_page(page: Page, marks: Marks) -> Page:
    """Return a page with the marks in all its plots, and their meaning in its lead."""
    sections = marked_sections(page.sections, marks)
    lead = " ".join(text for text in (page.lead, f"Complaint: {marks['words']}.") if text)
    return replace(page, lead=lead, sections=sections)


def marked_page_of_case(page: Page, marks: Marks) -> Page:
    """Return the page of a study of a case with the marks of its complaint."""
    return marked_page(page, of_run(marks, next(iter(marks["meshes"]), "")))


def marked_sections(sections: Iterable[Section], marks: Marks) -> tuple[Section, ...]:
    """Return sections with the marks in all their plots."""
    return tuple(
        replace(section, figures=tuple(marked(figure, marks) for figure in section.figures))
        for section in sections
    )


def marked(figure: Figure, marks: Marks) -> Figure:
    """Return a figure with a line at speed and frequency, and the order's curves bold and named.

    What lies beyond an axis is said in the caption.
    """
    panels = tuple(_marked_panel(panel, marks) for panel in figure.content)
    beyond = dict.fromkeys(text for panel in figure.content for text in _unreached_values(panel, marks))
    return replace(figure, content=panels, caption=" ".join([figure.caption, *beyond]))


def _marked_panel(panel: Panel, marks: Marks) -> Panel:
    references = tuple(
        Reference(f"{NAME}, {_value_label(axis, value)}", value, direction, at=LABEL_END)
        for axis, direction, value in _values(panel, marks)
        if _reaches(panel, axis, direction, value)
    )
    order = f"{marks['order']:.4g}"
    names = f"order {order}", f"{order}×"  # curves of an order are named so, then perhaps " (pinion 11)"
    lines = []
    for line in panel.lines:
        is_marked = line.name.partition(" (")[0] in names
        bold = replace(line, name=f"{line.name} ({NAME})", width=BOLDER * line.width)
        lines.append(bold if is_marked else line)
    return replace(panel, references=(*panel.references, *references), lines=tuple(lines))


def _value_label(axis: Axis, value: float) -> str:
    """Return a value with the unit of its axis, or after the label of an axis without a unit."""
    size, unit = engineering(value, 4), unit_of(axis.label)
    has_unit = unit != axis.label  # `unit_of` returns a label without a comma as it is
    return f"{size} {unit}" if has_unit else f"{axis.label} {size}"


def _values(panel: Panel, marks: Marks) -> list[tuple[Axis, Literal["vertical", "horizontal"], float]]:
    """Return axis, direction of the line and value of each axis of a panel on which the complaint lies."""
    values: list[tuple[Axis, Literal["vertical", "horizontal"], float]] = []
    if panel.x.label in marks["axes"]:
        values.append((panel.x, "vertical", marks["axes"][panel.x.label]))
    if panel.y.label in marks["axes"]:
        values.append((panel.y, "horizontal", marks["axes"][panel.y.label]))
    return values


def _reaches(panel: Panel, axis: Axis, direction: str, value: float) -> bool:
    """Whether a value lies within the limits of an axis, or within its data."""
    if axis.limits is not None:
        low, high = axis.limits
        return low <= value <= high
    name = "x" if direction == "vertical" else "y"
    coordinates = [getattr(line, name) for line in panel.lines]
    coordinates += [] if panel.shade is None else [np.ravel(getattr(panel.shade, name))]
    known = np.concatenate([np.empty(0), *coordinates])
    known = known[np.isfinite(known)]
    return bool(known.size and known.min() <= value <= known.max())


def _unreached_values(panel: Panel, marks: Marks) -> list[str]:
    """Return sentences on the values of the complaint that a panel does not reach."""
    return [
        f"The {NAME}, {_value_label(axis, value)}, lies beyond this axis."
        for axis, direction, value in _values(panel, marks)
        if not _reaches(panel, axis, direction, value)
    ]
