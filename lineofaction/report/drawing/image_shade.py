"""Heat maps and strokes as images."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import LinearSegmentedColormap, Normalize

from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import BLANK, HeatMap, Strokes

THIN, THICK = 0.7, 4.0  # points


def color_map(colors: Sequence[str] = palette.CIVIDIS) -> LinearSegmentedColormap:
    """Return colors that change evenly along a palette, by default the ordered one."""
    return LinearSegmentedColormap.from_list("palette", colors)


def draw_shade(ax: Axes, shade: HeatMap | Strokes) -> None:
    """Draw values as colors, with their scale beside the panel."""
    drawn = _cells(ax, shade) if isinstance(shade, HeatMap) else _strokes(ax, shade)
    figure: Any = ax.get_figure()
    figure.colorbar(drawn, ax=ax, label=shade.label, pad=0.015, fraction=0.06, aspect=14)


def _cells(ax: Axes, shade: HeatMap) -> Any:
    """Draw a heat map."""
    if shade.isolines:
        return _smooth(ax, shade)
    z = np.ma.masked_invalid(shade.z)
    x, y, span = _edges(shade.x), _edges(shade.y), Normalize(shade.least, shade.largest)
    return ax.pcolormesh(x, y, z, cmap=color_map(shade.colors), norm=span, rasterized=True)


def _smooth(ax: Axes, shade: HeatMap) -> Any:
    """Draw colors that change smoothly, and isolines with their values."""
    (left, *_, right), (low, *_, high) = _edges(shade.x), _edges(shade.y)
    span = Normalize(BLANK * shade.largest, shade.largest)
    colors = color_map().with_extremes(under=(1.0, 1.0, 1.0, 0.0))
    look: dict[str, Any] = {"cmap": colors, "norm": span, "origin": "lower", "aspect": "auto", "zorder": 1}
    smooth: dict[str, Any] = {"interpolation": "bilinear", "interpolation_stage": "data"}
    drawn = ax.imshow(shade.z, extent=(left, right, low, high), **look, **smooth)
    lines = ax.contour(shade.x, shade.y, shade.z, shade.isolines, colors="white", linewidths=0.7)
    ax.clabel(lines, fontsize=7, fmt=lambda value: f"{value:g}")
    return drawn


def _edges(middles: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    """Return the ends of cells, half way between their middles; a single one is a unit wide."""
    half = 0.5 * np.diff(middles) if middles.size > 1 else np.array([0.5])
    return np.concatenate(
        [[middles[0] - half[0]], middles[:-1] + half[: middles.size - 1], [middles[-1] + half[-1]]]
    )


def _strokes(ax: Axes, shade: Strokes) -> Any:
    """Draw strokes, those without a value below the others; the heaviest on top."""
    order = np.argsort(shade.value, kind="stable")
    ends = np.stack([shade.x[order], shade.y[order]], axis=-1)
    value = shade.value[order]
    bare = value <= 0.0
    ax.add_collection(LineCollection(list(ends[bare]), colors=palette.MUTED, linewidths=THIN, alpha=0.6))
    loaded = LineCollection(
        list(ends[~bare]),
        cmap=color_map(),
        linewidths=THIN + (THICK - THIN) * value[~bare] / shade.largest,
        array=value[~bare],
        capstyle="butt",
    )
    loaded.set_clim(0.0, shade.largest)
    ax.add_collection(loaded)
    ax.autoscale_view()
    return loaded
