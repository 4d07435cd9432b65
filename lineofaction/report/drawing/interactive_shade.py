"""Heat maps and strokes as plotly.js traces."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import BLANK, HeatMap, Strokes, number, numbers, unit_of

Json = dict[str, Any]

STEPS = 12  # colors of strokes: a curve of plotly has one color
THIN, THICK = 1.0, 6.0  # pixels


def color_scale(colors: Sequence[str] = palette.CIVIDIS) -> list[list[Any]]:
    """Return colors that change evenly along a palette, by default the ordered one."""
    return [[i / (len(colors) - 1), color] for i, color in enumerate(colors)]


def shade_traces(shade: HeatMap | Strokes, suffix: str, domain: list[float]) -> list[Json]:
    """Return the traces of one panel whose axes carry `suffix` and which spans `domain` of the height."""
    axes = {"xaxis": "x" + suffix, "yaxis": "y" + suffix, "showlegend": False}
    traces = [_cells(shade, domain)] if isinstance(shade, HeatMap) else _strokes(shade, domain)
    return [axes | trace for trace in traces]


def _color_bar(label: str, domain: list[float]) -> Json:
    """Place the scale beside its panel."""
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
        "zmin": shade.least,
        "zmax": shade.largest,
        "hoverongaps": False,
        "colorscale": color_scale(shade.colors),
        "colorbar": _color_bar(shade.label, domain),
        "hovertemplate": f"x %{{x:.4g}}<br>y %{{y:.4g}}<br>%{{z:.4g}} {unit_of(shade.label)}<extra></extra>",
    }
    return cells | _isolines(shade) if shade.isolines else cells


def _isolines(shade: HeatMap) -> Json:
    """Return what makes a map of isolines, evenly spaced, over smooth colors."""
    step = shade.isolines[-1] / len(shade.isolines)
    ends = {"start": shade.isolines[0], "end": shade.isolines[-1], "size": step}
    look = {"coloring": "heatmap", "showlabels": True, "labelfont": {"size": 11, "color": "#FFFFFF"}}
    clear = "rgba(255,255,255,0)"
    scale = [[0.0, clear], [BLANK, clear], *([BLANK + (1.0 - BLANK) * at, c] for at, c in color_scale())]
    line = {"color": "#FFFFFF", "width": 1}
    return {"type": "contour", "contours": ends | look, "line": line, "colorscale": scale}


def _strokes(shade: Strokes, domain: list[float]) -> list[Json]:
    """Draw strokes in steps of color and width, and a scale for them."""
    step = np.ceil(STEPS * np.clip(shade.value / shade.largest, 0.0, 1.0)).astype(int)
    unit = unit_of(shade.label)
    traces = [_step(shade, step == k, k, unit) for k in range(STEPS + 1) if np.any(step == k)]
    scale: Json = {
        "type": "scatter",
        "mode": "markers",
        "x": [None],
        "y": [None],
        "hoverinfo": "skip",
        "marker": {
            "color": [0.0],
            "cmin": 0.0,
            "cmax": shade.largest,
            "colorscale": color_scale(),
            "showscale": True,
            "colorbar": _color_bar(shade.label, domain),
        },
    }
    return [*traces, scale]


def _step(shade: Strokes, chosen: Any, k: int, unit: str) -> Json:
    """Draw the strokes of one step, with breaks between them; step 0 carries nothing."""
    gap = np.full((int(chosen.sum()), 1), np.nan)
    words = [[f"{number(v, 4)} {unit}"] * 2 + [""] for v in shade.value[chosen]]
    fraction = (k - 0.5) / STEPS
    return {
        "type": "scatter",
        "mode": "lines",
        "x": numbers(np.hstack([shade.x[chosen], gap]).ravel()),
        "y": numbers(np.hstack([shade.y[chosen], gap]).ravel()),
        "text": [word for group in words for word in group],
        "hoverinfo": "text",
        "line": {
            "color": palette.MUTED if k == 0 else palette.cividis(fraction),
            "width": THIN + (THICK - THIN) * max(fraction, 0.0),
        },
    }
