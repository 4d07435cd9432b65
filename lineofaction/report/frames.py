"""Numbers of a result's plots as a table of pandas, one row per point."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from lineofaction.report.drawing.figure import Bars, HeatMap, Line, Panel, Strokes
from lineofaction.report.plots import figure_of

if TYPE_CHECKING:
    import pandas

COLUMNS = ("panel", "curve", "x_axis", "x", "y_axis", "y", "error", "value_of", "value")
_Columns = dict[str, Any]


def dataframe(result: Any, view: str = "") -> pandas.DataFrame:
    """Return the numbers of a figure of a result's report; see `Plottable.to_dataframe`.

    Raises `BadInput`: no figure has this name, or the figure is a picture without axes.
    """
    from host.optional_modules import pandas  # noqa: PLC0415 (named above for types)

    figure = figure_of(result, view, with_axes=True)
    parts = [
        pandas.DataFrame({**_axes_of(panel, number), **columns})
        for number, panel in enumerate(figure.content, start=1)
        for columns in _parts(panel)
    ]
    frame = pandas.concat(parts, ignore_index=True) if parts else pandas.DataFrame(columns=list(COLUMNS))
    present = [name for name in COLUMNS if name in frame]
    return frame[present]


def _axes_of(panel: Panel, number: int) -> _Columns:
    return {"panel": panel.title or str(number), "x_axis": panel.x.label, "y_axis": panel.y.label}


def _parts(panel: Panel) -> Iterator[_Columns]:
    """Yield the columns of each curve, row of bars and map of a panel."""
    yield from map(_line, panel.lines)
    yield from map(_bars, panel.bars)
    if isinstance(panel.shade, HeatMap):
        yield _map(panel.shade)
    elif isinstance(panel.shade, Strokes):
        yield _strokes(panel.shade)


def _line(line: Line) -> _Columns:
    """Return a curve; `error` is the half-height of its band, NaN: none is stated."""
    band = np.broadcast_to(np.asarray(line.band, dtype=float), np.shape(line.y))
    error = np.where(band > 0.0, band, np.nan)
    return {"curve": line.name or line.label, "x": line.x, "y": line.y, "error": error}


def _bars(bars: Bars) -> _Columns:
    return {"curve": bars.name, "x": bars.x, "y": bars.top}


def _map(shade: HeatMap) -> _Columns:
    x, y = np.meshgrid(shade.x, shade.y)
    return {"x": x.ravel(), "y": y.ravel(), "value_of": shade.label, "value": np.ravel(shade.z)}


def _strokes(strokes: Strokes) -> _Columns:
    """Return the middles of strokes with their values."""
    x, y = strokes.x.mean(axis=1), strokes.y.mean(axis=1)
    return {"x": x, "y": y, "value_of": strokes.label, "value": strokes.value}
