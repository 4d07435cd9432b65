"""Plots of a result by one call: the figures of its report on axes of matplotlib, or by plotly."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from io import BytesIO
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes

from dynamics.results import RunResult
from fe_contact.ste import SteDatabase
from lineofaction.gearbox.problems import BadInput
from lineofaction.report.document import study_of
from lineofaction.report.drawing.figure import Figure
from lineofaction.report.drawing.image import draw_figure, draw_panels, drawable, png
from lineofaction.report.drawing.interactive import plotly_figure
from lineofaction.report.drawing.page import Section
from lineofaction.report.drawing.placing import rewritten
from lineofaction.report.presentation import presentation_of
from lineofaction.report.run.page import dynamic_results
from lineofaction.report.run.view import RunView
from lineofaction.report.ste.page import static_results

_SYNONYMS = {"harmonics": "spectrum", "orders": "spectrum", "k-chart": "profile of"}
"""Words of the trade for words in names of figures and titles of panels."""


def plot(result: Any, view: str = "", *, axes: Any = None, interactive: bool = False) -> Any:
    """Draw a figure of a result's report; see `Plottable.plot`.

    Raises `BadInput`: no figure has this name, or there are not as many axes as panels.
    """
    figure = figure_of(result, view)
    if interactive:
        from plotly import graph_objects  # noqa: PLC0415 (a second of imports)

        return graph_objects.Figure(plotly_figure(figure))
    if figure.picture is not None:
        return _picture(figure, axes)
    if axes is None:
        return np.array(draw_figure(plt.figure(layout="constrained"), figure), dtype=object)
    panels = rewritten(figure.content, drawable)
    drawn_axes = _axes_of(axes, len(panels))
    handles = draw_panels(panels, drawn_axes, range(len(panels)))
    if len(handles) > 1:
        drawn_axes[-1].legend(handles.values(), handles.keys(), frameon=False, fontsize=9)
    return np.array(drawn_axes, dtype=object)


def figure_of(result: Any, view: str, *, with_axes: bool = False) -> Figure:
    """Return the figure of a view.

    Raises `BadInput`: there is none, or `with_axes` it is a picture.
    """
    figure = _named_figure(figures_of(result), view)
    if with_axes and figure.picture is not None:
        remedy = "A picture has no numbers; name another figure."
        raise BadInput.of("view", view, "a figure with axes", remedy)
    return figure


def figures_of(result: Any) -> tuple[Figure, ...]:
    """Return the figures of the report on a result, the main one first."""
    if isinstance(result, SteDatabase):
        figures = _in_sections(static_results(result))
        return tuple(sorted(figures, key=lambda figure: figure.key != "ste"))
    if isinstance(result, RunResult):
        return _in_sections(dynamic_results(result, RunView()))
    presentation = presentation_of(study_of(result))
    first, others = presentation.figure(result), _in_sections(presentation.page(result).sections)
    return (first, *(figure for figure in others if figure.key != first.key))


def _in_sections(sections: Sequence[Section]) -> tuple[Figure, ...]:
    return tuple(figure for section in sections for figure in section.figures)


def _named_figure(figures: Sequence[Figure], view: str) -> Figure:
    """Return the figure of a name; else the first with all words of the view in its name or its title.

    Where there is none, return the panels of a figure that have the words in their titles.
    """
    if not view:
        return figures[0]
    exact = [figure for figure in figures if figure.key == view]
    words = [_SYNONYMS.get(word, word) for word in view.lower().split()]
    alike = [figure for figure in figures if _has(f"{figure.key} {figure.title}", words)]
    matches = exact or alike or [part for figure in figures for part in _panels_of(figure, words)]
    if not matches:
        names = ", ".join(figure.key for figure in figures)
        raise BadInput.of("view", view, f"words of one of {names}")
    return matches[0]


def _panels_of(figure: Figure, words: Sequence[str]) -> tuple[Figure, ...]:
    """Return a figure of the panels that have all words in their titles; empty: no panel has them."""
    panels = tuple(panel for panel in figure.content if _has(panel.title, words))
    return (replace(figure, content=panels),) if panels else ()


def _has(text: str, words: Sequence[str]) -> bool:
    return all(word in text.lower() for word in words)


def _axes_of(axes: Any, panels: int) -> list[Axes]:
    """Return the caller's axes as a list; raises `BadInput` unless there is one for each panel."""
    listed = list(np.atleast_1d(np.asarray(axes, dtype=object)).ravel())
    if len(listed) != panels:
        raise BadInput.of("axes", len(listed), f"exactly {panels}, one for each panel of the figure")
    return listed


def _picture(figure: Figure, axes: Any) -> Any:
    """Show a figure that is a picture as an image."""
    ax = plt.figure(layout="constrained").add_subplot() if axes is None else _axes_of(axes, 1)[0]
    ax.imshow(plt.imread(BytesIO(png(figure)), format="png"))
    ax.set_axis_off()
    ax.set_title(figure.title, loc="left", fontsize=10, fontweight="bold")
    return np.array([ax], dtype=object)
