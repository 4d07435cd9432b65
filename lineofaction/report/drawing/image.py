"""Figure descriptions as images, by matplotlib without a display."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from functools import cache
from io import BytesIO
from textwrap import fill
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import LinearSegmentedColormap, Normalize
from matplotlib.figure import Figure as Sheet
from matplotlib.font_manager import FontProperties, findfont, get_font
from matplotlib.ticker import (
    FuncFormatter,
    LogLocator,
    MaxNLocator,
    NullFormatter,
    NullLocator,
    ScalarFormatter,
)
from PIL import Image

from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import (
    BLANK,
    Axis,
    Bars,
    Figure,
    HeatMap,
    Line,
    Panel,
    Reference,
    Strokes,
    counts,
    legend_names,
    panel_height,
    panel_rows,
    repeats_below,
)
from lineofaction.report.drawing.placing import line_labels, rewritten, vertical_limits

THIN, THICK = 0.7, 4.0  # points
_WIDTH, _DPI = 9.0, 150
_PANEL_HEIGHT, _NARROW_HEIGHT, _DRAWING_HEIGHT = 2.0, 1.64, 2.6  # inches
_LEGEND_HEIGHT, _SHADED_WIDTH = 0.9, 0.82  # inches for title and legend; width of a panel with colors
_LEGEND_CHARACTERS, _HANDLE_CHARACTERS = 120, 9  # of the legend's type: across the sheet, beside a name
_NOTE_ROW = 10  # points
_HALF_LABEL, _HIGH_LABEL, _NARROW_LABEL = 46, 26, 20  # characters of a row below and beside panels
_NARROW_TYPE = 9  # points, of the labels of a panel of half the width
_LONGEST_WORD = 26  # characters; longer ones would leave panels no width
_LABEL_ROW = 0.1  # of a row of a label at a line, in parts of the panel's height
_LEADER = 0.02  # of the panel's width, from the end of a line to its label
_NARROW = 100.0  # largest over smallest value of a logarithmic axis with plain numbers
_DECADE = (1.0, 10.0)  # of a logarithmic axis that has nothing to show
_BOX = {"fc": "white", "ec": "none", "alpha": 0.8, "pad": 1.0}  # under a text on colors
_TINT = 0.13  # of what an outline holds
_DASH = {"solid": "-", "dash": "--", "dot": ":"}


def _color_map(colors: Sequence[str] = palette.CIVIDIS) -> LinearSegmentedColormap:
    return LinearSegmentedColormap.from_list("palette", colors)


def _draw_shade(ax: Axes, shade: HeatMap | Strokes) -> None:
    drawn = _cells(ax, shade) if isinstance(shade, HeatMap) else _strokes(ax, shade)
    figure: Any = ax.get_figure()
    figure.colorbar(drawn, ax=ax, label=fill(shade.label, _HIGH_LABEL), pad=0.015, fraction=0.06, aspect=14)


def _cells(ax: Axes, shade: HeatMap) -> Any:
    if shade.isolines:
        return _smooth(ax, shade)
    z = np.ma.masked_invalid(shade.z)
    x, y, span = _edges(shade.x), _edges(shade.y), Normalize(shade.minimum, shade.largest)
    return ax.pcolormesh(x, y, z, cmap=_color_map(shade.colors), norm=span, rasterized=True)


def _smooth(ax: Axes, shade: HeatMap) -> Any:
    (left, *_, right), (low, *_, high) = _edges(shade.x), _edges(shade.y)
    span = Normalize(BLANK * shade.largest, shade.largest)
    colors = _color_map().with_extremes(under=(1.0, 1.0, 1.0, 0.0))
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
        cmap=_color_map(),
        linewidths=THIN + (THICK - THIN) * value[~bare] / shade.largest,
        array=value[~bare],
        capstyle="butt",
    )
    loaded.set_clim(0.0, shade.largest)
    ax.add_collection(loaded)
    ax.autoscale_view()
    return loaded


def png(figure: Figure, across: int = 1) -> bytes:
    """Draw `figure`, narrow panels `across` beside each other, and return the PNG file's bytes."""
    if figure.picture is not None:
        return figure.picture()
    return _image(figure, "png", {"Title": figure.title, "Description": figure.alternative}, across)


def still(image: bytes) -> bytes:
    """Return a PNG file in few colors, for a page: a third of the bytes."""
    buffer = BytesIO()
    drawn = Image.open(BytesIO(image)).convert("RGB")
    drawn.quantize(96, dither=Image.Dither.NONE).save(buffer, "png", optimize=True)
    return buffer.getvalue()


def svg(figure: Figure) -> bytes:
    """Draw `figure` and return the SVG file's bytes."""
    return _image(figure, "svg", {"Title": figure.title, "Description": figure.alternative, "Date": None})


def _image(figure: Figure, form: str, metadata: dict[str, str | None], across: int = 1) -> bytes:
    sheet = panel_sheet(rewritten(figure.content, drawable), across)
    sheet.suptitle(drawable(figure.title), x=0.01, ha="left", size=12, weight="bold", color=palette.INK)
    FigureCanvasAgg(sheet)
    if any(panel.equal for panel in figure.content):
        sheet.draw_without_rendering()  # margins follow from a height that a drawing takes afterwards
    buffer = BytesIO()
    sheet.savefig(buffer, format=form, dpi=_DPI, metadata=metadata)
    return buffer.getvalue()


def drawable(text: str) -> str:
    """Write a text so that it is no formula to matplotlib and has no endless words.

    Characters that the font lacks are written by their numbers.
    """
    known = "".join(
        c if c == "\n" or ord(c) in _glyphs() else c.encode("unicode_escape").decode() for c in text
    )
    cut = re.sub(rf"(\S{{{_LONGEST_WORD - 1}}})\S+", "\\1\N{HORIZONTAL ELLIPSIS}", known)
    return cut.replace("$", r"\$")


@cache
def _glyphs() -> frozenset[int]:
    return frozenset(get_font(findfont(FontProperties())).get_charmap())


def panel_sheet(panels: tuple[Panel, ...], across: int = 1) -> Sheet:
    """Draw panels in rows of at most `across`; curves of one name share one entry in the legend below."""
    rows = panel_rows(panels, across)
    heights = [max(_height(panels[index], len(row)) for index in row) for row in rows]
    sheet = Sheet(figsize=(_WIDTH, sum(heights) + _LEGEND_HEIGHT), layout="constrained")
    grid = sheet.add_gridspec(len(rows), max(map(len, rows)), height_ratios=heights)
    axes: list[Axes] = [
        sheet.add_subplot(grid[row, :] if len(columns) == 1 else grid[row, column])
        for row, columns in enumerate(rows)
        for column in range(len(columns))
    ]
    alone = {row[0] for row in rows if len(row) == 1}
    handles: dict[str, Any] = {}
    names = legend_names(panels)
    for index, (panel, ax) in enumerate(zip(panels, axes, strict=True)):
        if panel.shade is not None:
            _draw_shade(ax, panel.shade)
        drawn = [(line.name, _draw(ax, line)) for line in panel.lines]
        drawn += [(bars.name, _draw_bars(ax, bars)) for bars in panel.bars]
        for name, handle in drawn:
            if name in names:
                handles.setdefault(name, handle)
        _finish(ax, panel)
        if index in alone:
            ax.set_ylabel(fill(panel.y.label, _HIGH_LABEL))
        else:
            ax.set_xlabel(fill(panel.x.label, _HALF_LABEL), fontsize=_NARROW_TYPE)
            ax.set_ylabel(fill(panel.y.label, _NARROW_LABEL), fontsize=_NARROW_TYPE)
            title = fill(panel.title, _HALF_LABEL)
            ax.set_title(title, loc="left", fontsize=_NARROW_TYPE, fontweight="bold")
        if repeats_below(panels, index) and {index, index + 1} <= alone:
            ax.set_xlabel("")
    if len(handles) > 1:
        sheet.legend(
            handles.values(),
            handles.keys(),
            loc="outside lower left",
            ncols=_legend_columns(list(handles)),
            frameon=False,
            fontsize=9,
        )
    return sheet


def _height(panel: Panel, columns: int) -> float:
    usual = _PANEL_HEIGHT if columns == 1 else _NARROW_HEIGHT
    drawing = _DRAWING_HEIGHT if panel.shade is None else _SHADED_WIDTH * _DRAWING_HEIGHT
    return panel_height(panel, columns) * (drawing if panel.equal else usual)


def _legend_columns(names: list[str]) -> int:
    """As many columns as the width holds, at most six, in rows of equal length."""
    fit = max(_LEGEND_CHARACTERS // (max(map(len, names)) + _HANDLE_CHARACTERS), 1)
    rows = math.ceil(len(names) / min(fit, 6))
    return math.ceil(len(names) / rows)


def _draw(ax: Axes, line: Line) -> Any:
    stroke: dict[str, Any] = {"color": line.color, "ls": _DASH[line.dash], "lw": line.width * 0.8}
    if line.markers:
        stroke |= {"marker": "o", "ms": 6}
    (handle,) = ax.plot(line.x, line.y, solid_capstyle="butt", **stroke)
    if line.filled:
        ax.fill(line.x, line.y, color=line.color, alpha=_TINT, lw=0, zorder=0.4)
    if line.has_band:
        ax.fill_between(line.x, line.y - line.band, line.y + line.band, color=line.color, alpha=0.2, lw=0)
    return handle


def _draw_bars(ax: Axes, bars: Bars) -> Any:
    """Draw all bars as one artist: a spectrum of a hunting cycle has thousands."""
    left, right = bars.x - 0.5 * bars.width, bars.x + 0.5 * bars.width
    base, top = np.broadcast_arrays(bars.base, bars.top)
    corners = np.stack([left, base, left, top, right, top, right, base], axis=-1).reshape(-1, 4, 2)
    look: dict[str, Any] = {"facecolor": bars.color, "alpha": 0.35 if bars.veiled else 1.0, "lw": 0}
    drawn = ax.add_collection(PolyCollection(list(corners), **look))
    drawn.sticky_edges.y.extend(np.unique(base).tolist())
    ax.update_datalim(corners.reshape(-1, 2))
    ax.autoscale_view()
    return drawn


def _label_lines(ax: Axes, panel: Panel) -> None:
    for label in line_labels(panel, _LABEL_ROW):
        ax.annotate(
            label.text,
            (1.0, label.end),
            (1.0 + _LEADER, label.middle),
            xycoords="axes fraction",
            va="center",
            fontsize=8,
            linespacing=1.05,
            arrowprops={
                "arrowstyle": "-",
                "color": label.color,
                "lw": 1.2,
                "relpos": (0, 0.5),
                "shrinkA": 1,
                "shrinkB": 0,
            },
            annotation_clip=False,
        )


def _finish(ax: Axes, panel: Panel) -> None:
    for axis, name in ((panel.x, "x"), (panel.y, "y")):
        _scale(ax, axis, name)
    if any(line.label for line in panel.lines):
        ax.set_ylim(vertical_limits(panel))
        _label_lines(ax, panel)
    for ticked, is_integer in ((ax.xaxis, counts(panel, "x")), (ax.yaxis, counts(panel, "y"))):
        if is_integer:
            ticked.set_major_locator(MaxNLocator(integer=True))
    for reference in panel.references:
        _refer(ax, reference, boxed=panel.shade is not None)
    for note in panel.notes:
        offset = (-5 if note.left else 5, 4 + _NOTE_ROW * note.row - (8 if note.row < 0 else 0))
        side = "right" if note.left else "left"
        box = None if panel.shade is None else _BOX
        text = ax.annotate(note.text, (note.x, note.y), offset, textcoords="offset points", ha=side, bbox=box)
        text.set_fontsize(8)
    if panel.title:
        ax.set_title(panel.title, loc="left", fontsize=10, fontweight="bold")
    ax.grid(color=palette.GRID, lw=0.6)
    ax.spines[["top", "right"]].set_visible(False)
    ax.set_axisbelow(True)
    if panel.equal:
        ax.set_aspect("equal")


def _scale(ax: Axes, axis: Axis, name: str) -> None:
    empty = axis.scale == "log" and not np.isfinite(getattr(ax.dataLim, f"minpos{name}"))
    limits = axis.limits or (_DECADE if empty else None)
    if limits:
        ax.set(**{f"{name}lim": limits})
    ax.set(**{f"{name}label": axis.label, f"{name}scale": axis.scale})
    drawn = getattr(ax, f"{name}axis")
    if axis.names:
        many = name == "x" and sum(len(text) for _, text in axis.names) > _HALF_LABEL
        texts = [text.replace(" ", "\n") if many else text for _, text in axis.names]
        drawn.set_ticks([value for value, _ in axis.names], labels=texts)
        drawn.set_minor_locator(NullLocator())
        return
    if axis.scale == "linear":
        drawn.set_major_formatter(ScalarFormatter(useOffset=False))
        return
    low, high = getattr(ax, f"get_{name}lim")()
    if high <= _NARROW * low:  # powers of ten would stand alone, or not at all
        drawn.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        drawn.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        drawn.set_minor_formatter(NullFormatter())


def _refer(ax: Axes, reference: Reference, *, boxed: bool) -> None:
    """Draw a reference line with its label, in a white box where colors lie under it."""
    text = f" {reference.label}"
    stroke: dict[str, Any] = {"color": palette.MUTED, "ls": "--", "lw": 0.8, "zorder": 2.5 if boxed else 0.5}
    if reference.direction == "vertical":
        ax.axvline(reference.value, **stroke)
        written = ax.text(
            reference.value, 0.98, text, ha="left", va="top", transform=ax.get_xaxis_transform()
        )
    else:
        ax.axhline(reference.value, **stroke)
        anchor = "center" if reference.at == 0.5 else "right"
        written = ax.text(
            reference.at, reference.value, text, ha=anchor, va="bottom", transform=ax.get_yaxis_transform()
        )
    written.set(fontsize=8, color=palette.MUTED)
    if boxed:
        written.set(color=palette.INK, bbox=_BOX)
