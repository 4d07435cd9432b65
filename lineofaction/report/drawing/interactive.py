"""Figure descriptions as plotly.js data and layout: plain JSON, made without the plotly package."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from html import escape
from typing import Any, Literal

import numpy as np

from bounds.types import Json
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import (
    BLANK,
    Axis,
    Bars,
    Figure,
    HeatMap,
    Line,
    Note,
    Panel,
    Reference,
    Strokes,
    counts,
    legend_names,
    number,
    numbers,
    panel_height,
    repeats_below,
    unit_of,
)
from lineofaction.report.drawing.placing import line_labels, rewritten, vertical_limits

STEPS = 12  # colors of strokes: a curve of plotly has one color
THIN, THICK = 1.0, 6.0  # pixels
_PANEL_HEIGHT, _BELOW, _BETWEEN = 280, 60, 62  # pixels
_LABEL = 26  # pixels of an axis label between panels
_LEGEND_ROW = 22  # pixels
_NOTE_ROW = 15  # pixels
_LABEL_ROW, _LEADER, _LABEL_CHARACTER = 15, 18, 7.6  # label at a line: row, leader, widest digit, pixels
_BAND_ALPHA = "33"  # opacity of an error band, after the six digits of its color
_ROW_CHARACTERS, _HANDLE_CHARACTERS = 120, 7  # width in characters: row of the legend, line before a name
_TINT = "22"  # opacity of the area in an outline
_BOX = "rgba(255,255,255,0.8)"  # under a text on colors
_FONT = {"family": "system-ui, -apple-system, 'Segoe UI', 'Liberation Sans', sans-serif", "size": 14}
_MAX_TICKS = 10


def _color_scale(colors: Sequence[str] = palette.CIVIDIS) -> list[list[Any]]:
    return [[i / (len(colors) - 1), color] for i, color in enumerate(colors)]


def _shade_traces(shade: HeatMap | Strokes, suffix: str, domain: list[float]) -> list[Json]:
    axes = {"xaxis": "x" + suffix, "yaxis": "y" + suffix, "showlegend": False}
    traces = [_cells(shade, domain)] if isinstance(shade, HeatMap) else _strokes(shade, domain)
    return [axes | trace for trace in traces]


def _color_bar(label: str, domain: list[float]) -> Json:
    middle, length = 0.5 * (domain[0] + domain[1]), domain[1] - domain[0]
    return {
        "title": {"text": label, "side": "right", "font": {"size": 14}},
        "thickness": 14,
        "len": length,
        "y": middle,
        "yanchor": "middle",
        "x": 1.01,
    }


def _cells(shade: HeatMap, domain: list[float]) -> Json:
    """Draw a heat map; with isolines its colors change smoothly."""
    cells: Json = {
        "type": "heatmap",
        "x": numbers(shade.x),
        "y": numbers(shade.y),
        "z": [numbers(row) for row in shade.z],
        "zmin": shade.minimum,
        "zmax": shade.largest,
        "hoverongaps": False,
        "colorscale": _color_scale(shade.colors),
        "colorbar": _color_bar(shade.label, domain),
        "hovertemplate": f"x %{{x:.4g}}<br>y %{{y:.4g}}<br>%{{z:.4g}} {unit_of(shade.label)}<extra></extra>",
    }
    return cells | _isolines(shade) if shade.isolines else cells


def _isolines(shade: HeatMap) -> Json:
    step = shade.isolines[-1] / len(shade.isolines)
    ends = {"start": shade.isolines[0], "end": shade.isolines[-1], "size": step}
    look = {"coloring": "heatmap", "showlabels": True, "labelfont": {"size": 11, "color": "#FFFFFF"}}
    clear = "rgba(255,255,255,0)"  # values below the share BLANK of the largest stay blank
    scale = [[0.0, clear], [BLANK, clear], *([BLANK + (1.0 - BLANK) * at, c] for at, c in _color_scale())]
    line = {"color": "#FFFFFF", "width": 1}
    return {"type": "contour", "contours": ends | look, "line": line, "colorscale": scale}


def _strokes(shade: Strokes, domain: list[float]) -> list[Json]:
    step = np.ceil(STEPS * np.clip(shade.value / shade.largest, 0.0, 1.0)).astype(int)
    unit = unit_of(shade.label)
    traces = [_step(shade, step == k, k, unit) for k in range(STEPS + 1) if np.any(step == k)]
    # a marker that is not drawn has the color bar
    marker: Json = {"color": [0.0], "cmin": 0.0, "cmax": shade.largest, "colorscale": _color_scale()}
    marker |= {"showscale": True, "colorbar": _color_bar(shade.label, domain)}
    scale: Json = {"type": "scatter", "mode": "markers", "x": [None], "y": [None]}
    return [*traces, scale | {"hoverinfo": "skip", "marker": marker}]


def _step(shade: Strokes, chosen: Any, k: int, unit: str) -> Json:
    """Draw the strokes of one step, with breaks between them; step 0 carries nothing."""
    gap = np.full((int(chosen.sum()), 1), np.nan)
    # a text for both ends of a stroke, none for the break
    labels = [[f"{number(v, 4)} {unit}"] * 2 + [""] for v in shade.value[chosen]]
    fraction = (k - 0.5) / STEPS
    return {
        "type": "scatter",
        "mode": "lines",
        "x": numbers(np.hstack([shade.x[chosen], gap]).ravel()),
        "y": numbers(np.hstack([shade.y[chosen], gap]).ravel()),
        "text": [word for group in labels for word in group],
        "hoverinfo": "text",
        "line": {
            "color": palette.MUTED if k == 0 else palette.cividis(fraction),
            "width": THIN + (THICK - THIN) * max(fraction, 0.0),
        },
    }


def plotly_figure(figure: Figure) -> Json:
    """Return ``{"data": [...], "layout": {...}}`` for ``Plotly.newPlot``."""
    panels = rewritten(figure.content, _plain)
    names = legend_names(figure.content)
    rows = math.ceil(sum(len(name) + _HANDLE_CHARACTERS for name in names) / _ROW_CHARACTERS)
    # pixels above the panels: one row of the legend, and a title
    above = (62 if panels[0].title else 44) + _LEGEND_ROW * max(rows - 1, 0)
    gaps = [_BETWEEN if repeats_below(panels, i) else _BETWEEN + _LABEL for i in range(len(panels) - 1)]
    heights = [round(_PANEL_HEIGHT * panel_height(panel)) for panel in panels]
    inner = sum(heights) + sum(gaps)
    layout: Json = _layout(inner + above + _BELOW)
    layout |= {"shapes": [], "annotations": [], "showlegend": len(names) > 1}
    layout["margin"] = layout["margin"] | {"t": above, "r": _margin(figure.content)}
    layout["barmode"] = "overlay"
    data: list[Json] = []
    unnamed = set(map(_plain, names))  # names without an entry in the legend yet: the first curve makes it
    for index, panel in enumerate(panels):
        suffix = str(index + 1) if index else ""
        top = inner - (sum(heights[:index]) + sum(gaps[:index]))
        domain = [round((top - heights[index]) / inner, 6), round(top / inner, 6)]
        frame = {"domain": domain, "anchor": "x" + suffix}
        layout["xaxis" + suffix] = _axis(panel.x) | _integer_ticks(panel, "x") | {"anchor": "y" + suffix}
        if repeats_below(panels, index):
            layout["xaxis" + suffix] |= {"title": {"text": ""}}
        upright = panel.y
        if any(line.label for line in panel.lines):  # with limits, so that the places of labels are known
            upright = replace(panel.y, limits=vertical_limits(panel))
        layout["yaxis" + suffix] = _axis(upright) | _integer_ticks(panel, "y") | frame
        if panel.equal:
            layout["xaxis" + suffix] |= {"scaleanchor": "y" + suffix, "constrain": "domain"}
        layout["annotations"] += _panel_title(panel, suffix) + _notes(panel, suffix)
        layout["annotations"] += _line_labels(panel, suffix)
        if panel.shade is not None:
            data += _shade_traces(panel.shade, suffix, domain)
        for line in panel.lines:
            data += _band(line, suffix)
            data.append(_line(line, suffix, show=line.name in unnamed))
            unnamed.discard(line.name)
        for bars in panel.bars:
            data.append(_bars(bars, suffix, show=bars.name in unnamed))
            unnamed.discard(bars.name)
        for reference in panel.references:
            _add_reference(layout, reference, panel, suffix)
    return {"data": data, "layout": layout}


def _plain(text: str) -> str:
    """Write a text so that plotly.js, which takes its texts for HTML, shows it as it is."""
    return escape(text, quote=False)


def _margin(panels: tuple[Panel, ...]) -> int:
    """Return the pixels on the right that the longest label of a line needs."""
    rows = [row for panel in panels for line in panel.lines for row in line.label.split("\n")]
    return 24 + math.ceil(_LABEL_CHARACTER * max(map(len, rows), default=0))


def _line_labels(panel: Panel, suffix: str) -> list[Json]:
    annotations = []
    for label in line_labels(panel, _LABEL_ROW / _PANEL_HEIGHT):
        at = {"xref": f"x{suffix} domain", "yref": f"y{suffix} domain", "x": 1, "y": label.end}
        tail = {"ax": _LEADER, "ay": round((label.end - label.middle) * _PANEL_HEIGHT, 1)}
        look = {"arrowhead": 0, "arrowwidth": 1.4, "arrowcolor": label.color, "font": {"size": 12}}
        text = {"text": label.text.replace("\n", "<br>"), "align": "left", "xanchor": "left"}
        annotations.append({"showarrow": True} | at | tail | look | text)
    return annotations


def _bars(bars: Bars, suffix: str, *, show: bool) -> Json:
    """Draw bars; `show` a line of the legend that names them."""
    return {
        "type": "bar",
        "name": bars.name,
        "showlegend": show,
        "x": numbers(bars.x),
        "y": numbers(bars.top - bars.base),
        "customdata": numbers(bars.top),
        "base": numbers(np.broadcast_to(bars.base, bars.top.shape)),
        "width": bars.width,
        "xaxis": "x" + suffix,
        "yaxis": "y" + suffix,
        "marker": {"color": bars.color, "opacity": 0.35 if bars.veiled else 1.0},
        "hovertemplate": "%{fullData.name}<br>%{x}: %{customdata:.4g}<extra></extra>",
    }


def _layout(height: int) -> Json:
    return {
        "height": height,
        "font": _FONT | {"color": palette.INK},
        "margin": {"l": 76, "r": 24, "t": 16, "b": _BELOW},
        "paper_bgcolor": "#FFFFFF",
        "plot_bgcolor": "#FFFFFF",
        "hovermode": "closest",
        "legend": {"orientation": "h", "x": 0, "y": 1, "yref": "container", "yanchor": "top"},
    }


def _axis(axis: Axis) -> Json:
    made: Json = {
        "title": {"text": axis.label, "standoff": 10, "font": {"size": 14}},
        "type": axis.scale,
        "gridcolor": palette.GRID,
        "linecolor": palette.MUTED,
        "zeroline": False,
        "ticks": "outside",
        "tickcolor": palette.MUTED,
        "automargin": True,
    }
    if axis.scale == "log":
        made |= {"exponentformat": "power", "dtick": 1}
    if axis.names:
        made |= {"tickvals": [value for value, _ in axis.names], "ticktext": [name for _, name in axis.names]}
    if axis.limits:
        limits = np.log10(axis.limits) if axis.scale == "log" else axis.limits
        made["range"] = [float(limit) for limit in limits]
    return made


def _integer_ticks(panel: Panel, name: Literal["x", "y"]) -> Json:
    """Return the ticks of an axis of orders or of few whole numbers: at whole numbers."""
    if not counts(panel, name):
        return {}
    parts: list[Any] = [*panel.lines, *([] if panel.shade is None else [panel.shade])]
    parts += panel.bars if name == "x" else ()
    values = [np.asarray(getattr(panel, name).limits or ())] + [getattr(part, name) for part in parts]
    ends = np.concatenate([*(value.ravel() for value in values), np.zeros(1)])  # never empty
    span = float(np.ptp(ends[np.isfinite(ends)]))
    return {"tick0": 0, "dtick": max(math.ceil(span / _MAX_TICKS), 1)}


def _line(line: Line, suffix: str, show: bool) -> Json:
    """Draw a curve; curves with the same name share a legend entry."""
    filled = {"fill": "toself", "fillcolor": line.color + _TINT, "hoveron": "points"} if line.filled else {}
    marked = "lines+markers" if line.width else "markers"
    return filled | {
        "type": "scatter",
        "mode": marked if line.markers else "lines",
        "name": line.name,
        "x": numbers(line.x),
        "y": numbers(line.y),
        "xaxis": "x" + suffix,
        "yaxis": "y" + suffix,
        "line": {"color": line.color, "dash": line.dash, "width": line.width},
        "legendgroup": line.name,
        "showlegend": show,
    }


def _band(line: Line, suffix: str) -> list[Json]:
    """Shade the error band of a curve, without its own entry in the legend."""
    if not line.has_band:
        return []
    edge: Json = {"type": "scatter", "mode": "lines", "line": {"width": 0}, "hoverinfo": "skip"}
    edge |= {"x": numbers(line.x), "xaxis": "x" + suffix, "yaxis": "y" + suffix}
    edge |= {"legendgroup": line.name, "showlegend": False}
    filled = {"fill": "tonexty", "fillcolor": line.color + _BAND_ALPHA}
    return [edge | {"y": numbers(line.y - line.band)}, edge | filled | {"y": numbers(line.y + line.band)}]


def _panel_title(panel: Panel, suffix: str) -> list[Json]:
    if not panel.title:
        return []
    frame = {"xref": f"x{suffix} domain", "yref": f"y{suffix} domain", "x": 0, "y": 1}
    anchor = {"xanchor": "left", "yanchor": "bottom", "showarrow": False}
    return [frame | anchor | {"text": f"<b>{panel.title}</b>"}]


def _notes(panel: Panel, suffix: str) -> list[Json]:
    """Put short texts at their points or at the tails of their leaders."""
    notes = []
    for note in panel.notes:
        text = note.text.replace("\n", "<br>")
        annotation = {"xref": "x" + suffix, "yref": "y" + suffix, "showarrow": False, "text": text}
        annotation |= {"x": _position(panel.x, note.x), "y": _position(panel.y, note.y)}
        box = {} if panel.shade is None else {"bgcolor": _BOX}
        where = _beside(note) if note.tail is None else _led(note, note.tail, panel, suffix)
        notes.append(annotation | {"align": "left"} | where | box | {"font": {"size": 12}})
    return notes


def _position(axis: Axis, value: float) -> float:
    """Return a value as annotations have it: they count decades on a logarithmic axis."""
    return float(np.log10(value)) if axis.scale == "log" else value


def _beside(note: Note) -> Json:
    shifts = {"xshift": -4 if note.left else 4, "yshift": _NOTE_ROW * note.row}
    return shifts | {"xanchor": "right" if note.left else "left", "yanchor": "bottom"}


def _led(note: Note, tail: tuple[float, float], panel: Panel, suffix: str) -> Json:
    """Return the leader of a note, whose text begins at the tail."""
    at = {"axref": "x" + suffix, "ax": _position(panel.x, tail[0])}
    at |= {"ayref": "y" + suffix, "ay": _position(panel.y, tail[1])}
    look = {"arrowhead": 0, "arrowwidth": 1.4, "arrowcolor": note.color}
    return {"showarrow": True, "xanchor": "left", "yanchor": "middle", "borderpad": 0} | at | look


def _add_reference(layout: Json, reference: Reference, panel: Panel, suffix: str) -> None:
    upright = reference.direction == "vertical"
    x, y = "x" + suffix, "y" + suffix
    along = {"xref": x, "yref": f"{y} domain"} if upright else {"xref": f"{x} domain", "yref": y}
    ends = ("x0", "x1", "y0", "y1") if upright else ("y0", "y1", "x0", "x1")
    extent = dict(zip(ends, (reference.value, reference.value, 0, 1), strict=True))
    stroke = {"line": {"color": palette.MUTED, "dash": "dash", "width": 1}}
    layer = "below" if panel.shade is None else "above"
    layout["shapes"].append({"type": "line", "layer": layer} | along | extent | stroke)
    scale = panel.x.scale if upright else panel.y.scale
    value = float(np.log10(reference.value)) if scale == "log" else reference.value
    position = {"x": value, "y": 1} if upright else {"x": reference.at, "y": value}
    across = "left" if upright else "center" if reference.at == 0.5 else "right"
    anchor = {"xanchor": across, "yanchor": "top" if upright else "bottom"}
    text: Json = {"text": reference.label, "showarrow": False, "font": {"size": 12, "color": palette.MUTED}}
    if panel.shade is not None:
        text |= {"bgcolor": _BOX, "font": {"size": 12, "color": palette.INK}}
    layout["annotations"].append(along | position | anchor | text)
