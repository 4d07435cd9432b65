"""Figure descriptions as images, by matplotlib without a display.

`png` and `svg` draw a `Figure`, `panel_sheet` its panels. A panel has lines, bars, and at most one shade
under them, a heat map or strokes colored by value. A narrow panel shares its row with others; a wide one is
alone in its row. The sheet is the matplotlib figure.
"""

from __future__ import annotations

import math
import re
from collections.abc import Container, Sequence
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
    Note,
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

THIN, THICK = 0.7, 4.0  # points, width of strokes at zero and at the largest value
_WIDTH = 9.0  # width of the sheet, inches
_DPI = 150
_PANEL_HEIGHT = 1.7  # height of a wide panel, inches
_NOTED_HEIGHT, _MANY_NOTES = 2.0, 5  # height of a wide panel with as many notes, inches
_NARROW_HEIGHT = 1.45  # height of a narrow panel, inches
_DRAWING_HEIGHT = 2.6  # height of a panel with equal units in both directions, inches
_LEGEND_HEIGHT = 0.9  # height of title and legend of one row each together, inches
_ROW_HEIGHT = 0.2  # height of a further row of the title or the legend, inches
_SHADED_WIDTH = 0.82  # width of a panel beside its color bar, over the width without one
_LEGEND_CHARACTERS = 120  # characters of the legend's type across the sheet
_HANDLE_CHARACTERS = 9  # the same, for the sample of the curve and the gap beside a name
_LEGEND_COLUMNS = 6  # most columns of the legend
_NOTE_ROW = 10  # points, height of a row of notes at one position
_HALF_TITLE = 40  # characters in a row of the title of a figure of half the width
_HALF_LABEL = 46  # characters in a row of a label below a narrow panel, and of its title
_HIGH_LABEL = 26  # characters in a row of a label beside a wide panel
_NARROW_LABEL = 20  # characters in a row of a label beside a narrow panel
_NARROW_TICKS = 6  # most intervals between ticks below a narrow panel
_NARROW_NAMES = 9  # most named ticks of a narrow panel of which all have their name
_NARROW_TYPE = 9  # points, type of the labels of a narrow panel
_LONGEST_WORD = 26  # characters; a longer word would leave no width for panels
_LABEL_ROW = 0.09  # height of a row of a label at the end of a line, over the height of the panel
_LEADER = 0.02  # distance from the end of a line to its label, over the width of the panel
_NARROW = 100.0  # a logarithmic axis whose ends have at most this ratio shows plain numbers
_DECADE = (1.0, 10.0)  # limits of a logarithmic axis without a positive value
_COLORS = 96  # colors of a picture for a page
_BOX = {"fc": "white", "ec": "none", "alpha": 0.8, "pad": 1.0}  # under a text on colors
_TINT = 0.13  # opacity of the inside of an outline
_DASH = {"solid": "-", "dash": "--", "dot": ":"}


def png(figure: Figure, across: int = 1, *, half: bool = False) -> bytes:
    """Draw `figure` with at most `across` panels in a row, and return the bytes of the PNG file.

    `half`: a figure of narrow panels is drawn on half the width. Of a figure that has a picture, the picture
    is returned.
    """
    if figure.picture is not None:
        return figure.picture()
    metadata: dict[str, str | None] = {"Title": figure.title, "Description": figure.alternative}
    return _image(figure, "png", metadata, across, half=half)


def still(image: bytes) -> bytes:
    """Return a PNG file reduced to few colors, for a page; it has a third of the bytes."""
    buffer = BytesIO()
    picture = Image.open(BytesIO(image)).convert("RGB")
    picture.quantize(_COLORS, dither=Image.Dither.NONE).save(buffer, "png", optimize=True)
    return buffer.getvalue()


def svg(figure: Figure) -> bytes:
    """Draw `figure` and return the bytes of the SVG file; it has no date, so that equal figures are equal."""
    return _image(figure, "svg", {"Title": figure.title, "Description": figure.alternative, "Date": None})


def _image(
    figure: Figure, form: str, metadata: dict[str, str | None], across: int = 1, *, half: bool = False
) -> bytes:
    """Return the bytes of a file of the `form` "png" or "svg"; a metadata entry of None is left out."""
    sheet = Sheet(layout="constrained")
    draw_figure(sheet, figure, across, half=half)
    FigureCanvasAgg(sheet)
    if any(panel.equal for panel in figure.content):
        # Equal units change the height of a panel when it is drawn: a first pass gives the layout that
        # height.
        sheet.draw_without_rendering()
    buffer = BytesIO()
    sheet.savefig(buffer, format=form, dpi=_DPI, metadata=metadata)
    return buffer.getvalue()


def drawable(text: str) -> str:
    """Return a text as matplotlib can draw it: without formulas, unknown characters and very long words.

    Dollar signs are escaped, as they enclose formulas. Characters that the font lacks become their Unicode
    escapes. Longer words than `_LONGEST_WORD` are cut, with an ellipsis as their last character.
    """
    glyphs = _glyphs() | {ord("\n")}
    known = "".join(c if ord(c) in glyphs else c.encode("unicode_escape").decode() for c in text)
    cut = re.sub(rf"(\S{{{_LONGEST_WORD - 1}}})\S+", "\\1\N{HORIZONTAL ELLIPSIS}", known)
    return cut.replace("$", r"\$")


@cache
def _glyphs() -> frozenset[int]:
    """Return the code points of all characters of the default font."""
    return frozenset(get_font(findfont(FontProperties())).get_charmap())


def draw_figure(sheet: Sheet, figure: Figure, across: int = 1, *, half: bool = False) -> list[Axes]:
    """Draw a figure with its title on an empty sheet; return the axes of its panels."""
    axes = panel_axes(sheet, rewritten(figure.content, drawable), across, half=half)
    title = fill(drawable(figure.title), _HALF_TITLE) if half else drawable(figure.title)
    sheet.set_figheight(sheet.get_figheight() + _ROW_HEIGHT * title.count("\n"))
    sheet.suptitle(title, x=0.01, ha="left", size=12, weight="bold", color=palette.INK)
    return axes


def panel_sheet(panels: tuple[Panel, ...], across: int = 1) -> Sheet:
    """Draw panels in rows of at most `across`, and return the sheet."""
    sheet = Sheet(layout="constrained")
    panel_axes(sheet, panels, across)
    return sheet


def panel_axes(sheet: Sheet, panels: tuple[Panel, ...], across: int = 1, *, half: bool = False) -> list[Axes]:
    """Draw panels in rows of at most `across` on an empty sheet; return the axes of each.

    Curves of one name share one entry in the legend below the panels. A single entry needs no legend.
    `half`: the sheet has half the usual width, and a panel of a row is as narrow as one of two.
    """
    rows = panel_rows(panels, across)  # indices of the panels of every row
    shares = 2 if half else 1  # of the usual width
    heights = [max(_height(panels[index], shares * len(row)) for index in row) for row in rows]
    sheet.set_size_inches(_WIDTH / shares, sum(heights) + _LEGEND_HEIGHT)
    grid = sheet.add_gridspec(len(rows), max(map(len, rows)), height_ratios=heights)
    axes: list[Axes] = []
    for row, columns in enumerate(rows):
        cells = [grid[row, :]] if len(columns) == 1 else [grid[row, k] for k in range(len(columns))]
        axes += [sheet.add_subplot(cell) for cell in cells]
    handles = draw_panels(panels, axes, {row[0] for row in rows if len(row) == 1 and not half})
    if len(handles) > 1:
        look: dict[str, Any] = {"loc": "outside lower left", "frameon": False, "fontsize": 9}
        across_legend = _legend_columns(list(handles), _LEGEND_CHARACTERS // shares)
        sheet.legend(handles.values(), handles.keys(), ncols=across_legend, **look)
        further = math.ceil(len(handles) / across_legend) - 1
        sheet.set_figheight(sheet.get_figheight() + _ROW_HEIGHT * further)
    return axes


def draw_panels(panels: Sequence[Panel], axes: Sequence[Axes], wide: Container[int]) -> dict[str, Any]:
    """Draw panels, of which some are as `wide` as the sheet; return the first curve of every name."""
    handles: dict[str, Any] = {}
    names = legend_names(panels)
    for index, (panel, ax) in enumerate(zip(panels, axes, strict=True)):
        if panel.shade is not None:
            _draw_shade(ax, panel, _HIGH_LABEL if index in wide else _NARROW_LABEL)
        drawn = [(line.name, _draw(ax, line)) for line in panel.lines]
        drawn += [(bars.name, _draw_bars(ax, bars)) for bars in panel.bars]
        for name, handle in drawn:
            if name in names:
                handles.setdefault(name, handle)
        _finish(ax, panel)
        if index in wide:
            ax.set_ylabel(fill(panel.y.label, _HIGH_LABEL))
        else:  # small type and more rows
            ax.set_xlabel(fill(panel.x.label, _HALF_LABEL), fontsize=_NARROW_TYPE)
            ax.set_ylabel(fill(panel.y.label, _NARROW_LABEL), fontsize=_NARROW_TYPE)
            title = fill(panel.title, _HALF_LABEL)
            ax.set_title(title, loc="left", fontsize=_NARROW_TYPE, fontweight="bold")
            if panel.x.scale == "linear" and not panel.x.names:
                ax.locator_params(axis="x", nbins=_NARROW_TICKS)
            if len(panel.x.names) > _NARROW_NAMES:  # every second name, or they would overlap
                texts = [text if k % 2 == 0 else "" for k, (_, text) in enumerate(panel.x.names)]
                ax.set_xticks([value for value, _ in panel.x.names], labels=texts)
        # the panel below, of the same width, has the same label
        if repeats_below(panels, index) and index in wide and index + 1 in wide:
            ax.set_xlabel("")
    return handles


def _height(panel: Panel, columns: int) -> float:
    """Return the height in inches of a panel in a row of some columns."""
    wide = _PANEL_HEIGHT if len(panel.notes) < _MANY_NOTES else _NOTED_HEIGHT
    usual = wide if columns == 1 else _NARROW_HEIGHT
    drawing = _DRAWING_HEIGHT if panel.shade is None else _SHADED_WIDTH * _DRAWING_HEIGHT
    return panel_height(panel, columns) * (drawing if panel.equal else usual)


def _legend_columns(names: list[str], characters: int) -> int:
    """Return the number of columns of a legend of a width in `characters`, with rows about equally long."""
    fitting = max(characters // (max(map(len, names)) + _HANDLE_CHARACTERS), 1)
    rows = math.ceil(len(names) / min(fitting, _LEGEND_COLUMNS))
    return math.ceil(len(names) / rows)


def _color_map(colors: Sequence[str] = palette.CIVIDIS) -> LinearSegmentedColormap:
    return LinearSegmentedColormap.from_list("palette", colors)  # a name is required


def _draw_shade(ax: Axes, panel: Panel, width: int) -> None:
    """Draw the colors of a panel with their color bar, whose label leaves out what the title says.

    `width`: characters in a row of the label. Pad and fraction of the bar are parts of the panel's width.
    """
    shade: Any = panel.shade
    drawn = _cells(ax, shade) if isinstance(shade, HeatMap) else _strokes(ax, shade)
    label = shade.label.removeprefix(panel.title).removeprefix(", ")
    figure: Any = ax.get_figure()
    figure.colorbar(drawn, ax=ax, label=fill(label, width), pad=0.015, fraction=0.06, aspect=14)


def _cells(ax: Axes, shade: HeatMap) -> Any:
    """Draw a heat map as cells of one color each, or as a smooth map if it has isolines."""
    if shade.isolines:
        return _smooth(ax, shade)
    z = np.ma.masked_invalid(shade.z)  # NaN stays blank
    x, y = _edges(shade.x), _edges(shade.y)
    color_range = Normalize(shade.minimum, shade.largest)
    return ax.pcolormesh(x, y, z, cmap=_color_map(shade.colors), norm=color_range, rasterized=True)


def _smooth(ax: Axes, shade: HeatMap) -> Any:
    """Draw a heat map whose colors change smoothly, with its isolines; small values are transparent."""
    x, y = _edges(shade.x), _edges(shade.y)
    drawn = ax.imshow(
        shade.z,
        extent=(x[0], x[-1], y[0], y[-1]),
        cmap=_color_map().with_extremes(under=(1.0, 1.0, 1.0, 0.0)),  # a transparent white
        norm=Normalize(BLANK * shade.largest, shade.largest),
        origin="lower",
        aspect="auto",
        zorder=1,
        interpolation="bilinear",
        interpolation_stage="data",
    )
    lines = ax.contour(shade.x, shade.y, shade.z, shade.isolines, colors="white", linewidths=0.7)
    ax.clabel(lines, fontsize=7, fmt=lambda value: f"{value:g}")
    return drawn


def _edges(middles: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    """Return the edges (n + 1,) of cells: half way between their middles (n,), and as far outside the ends.

    A single cell is one unit wide.
    """
    if middles.size == 1:
        return np.array([middles[0] - 0.5, middles[0] + 0.5])
    half = 0.5 * np.diff(middles)
    return np.concatenate([[middles[0] - half[0]], middles[:-1] + half, [middles[-1] + half[-1]]])


def _strokes(ax: Axes, shade: Strokes) -> Any:
    """Draw strokes in the order of their values, the largest on top, strokes without a value below all."""
    order = np.argsort(shade.value, kind="stable")
    ends = np.stack([shade.x[order], shade.y[order]], axis=-1)  # (strokes, 2 ends, x and y)
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


def _draw(ax: Axes, line: Line) -> Any:
    """Draw a line with its area and its band, and return the curve for the legend."""
    # 0.8: a line is a little thinner on the sheet, in points, than on a page, in pixels.
    stroke: dict[str, Any] = {"color": line.color, "ls": _DASH[line.dash], "lw": line.width * 0.8}
    if line.markers:
        stroke |= {"marker": "o", "ms": 6}
    (handle,) = ax.plot(line.x, line.y, solid_capstyle="butt", **stroke)
    if line.filled:  # zorder 0.4: below grid and reference lines
        ax.fill(line.x, line.y, color=line.color, alpha=_TINT, lw=0, zorder=0.4)
    if line.has_band:
        ax.fill_between(line.x, line.y - line.band, line.y + line.band, color=line.color, alpha=0.2, lw=0)
    return handle


def _draw_bars(ax: Axes, bars: Bars) -> Any:
    """Draw all bars as one artist: a spectrum of a hunting cycle has thousands."""
    left, right = bars.x - 0.5 * bars.width, bars.x + 0.5 * bars.width
    base, top = np.broadcast_arrays(bars.base, bars.top)
    # x and y of the four corners of every bar, in turn: (bars, 8) to (bars, 4, 2)
    corners = np.stack([left, base, left, top, right, top, right, base], axis=-1).reshape(-1, 4, 2)
    look: dict[str, Any] = {"facecolor": bars.color, "alpha": 0.35 if bars.veiled else 1.0, "lw": 0}
    drawn = ax.add_collection(PolyCollection(list(corners), **look))
    drawn.sticky_edges.y.extend(np.unique(base).tolist())  # no margin below the bars
    ax.update_datalim(corners.reshape(-1, 2))
    ax.autoscale_view()
    return drawn


def _label_lines(ax: Axes, panel: Panel) -> None:
    """Write the labels of lines to the right of the panel, each with a leader to the end of its line."""
    look: dict[str, Any] = {"va": "center", "fontsize": 8, "linespacing": 1.05, "annotation_clip": False}
    for label in line_labels(panel, _LABEL_ROW):
        end, middle = (1.0, label.end), (1.0 + _LEADER, label.middle)
        leader = {"arrowstyle": "-", "color": label.color, "lw": 1.2}
        leader |= {"relpos": (0, 0.5), "shrinkA": 1, "shrinkB": 0}
        ax.annotate(label.text, end, middle, xycoords="axes fraction", arrowprops=leader, **look)


def _finish(ax: Axes, panel: Panel) -> None:
    """Set scales, limits and ticks of a panel, and write its labels, references, notes and title."""
    _scale(ax, panel.x, "x")
    _scale(ax, panel.y, "y")
    if any(line.label for line in panel.lines):
        ax.set_ylim(vertical_limits(panel))
        _label_lines(ax, panel)
    if counts(panel, "x"):
        ax.xaxis.set_major_locator(MaxNLocator(integer=True))
    if counts(panel, "y"):
        ax.yaxis.set_major_locator(MaxNLocator(integer=True))
    for reference in panel.references:
        _refer(ax, reference, boxed=panel.shade is not None)
    for note in panel.notes:
        _write_note(ax, note, boxed=panel.shade is not None)
    if panel.title:
        ax.set_title(panel.title, loc="left", fontsize=10, fontweight="bold")
    ax.grid(color=palette.GRID, lw=0.6)
    ax.spines[["top", "right"]].set_visible(False)
    ax.set_axisbelow(True)
    if panel.equal:
        ax.set_aspect("equal")


def _write_note(ax: Axes, note: Note, *, boxed: bool) -> None:
    """Write a note at its point or at the tail of its leader, in a white box where colors lie under it."""
    if note.tail is not None:
        leader = {"arrowstyle": "-", "color": note.color, "lw": 1.2}
        leader |= {"relpos": (0, 0.5), "shrinkA": 0, "shrinkB": 0}
        box: dict[str, Any] = {"bbox": _BOX if boxed else None, "va": "center", "fontsize": 8}
        ax.annotate(note.text, (note.x, note.y), note.tail, arrowprops=leader, **box)
        return
    right = -5 if note.left else 5  # points
    above = 4 + _NOTE_ROW * note.row
    if note.row < 0:
        above -= 8  # a note below its point keeps clear of it
    look: dict[str, Any] = {"ha": "right" if note.left else "left", "bbox": _BOX if boxed else None}
    place = (note.x, note.y), (right, above)
    ax.annotate(note.text, *place, textcoords="offset points", fontsize=8, **look)


def _scale(ax: Axes, axis: Axis, name: str) -> None:
    """Set limits, label, scale and ticks of the axis with the `name` "x" or "y"."""
    # matplotlib keeps the smallest positive value of the data; it is infinite if there is none
    empty = axis.scale == "log" and not np.isfinite(getattr(ax.dataLim, f"minpos{name}"))
    limits = axis.limits or (_DECADE if empty else None)
    if limits:
        ax.set(**{f"{name}lim": limits})
    ax.set(**{f"{name}label": axis.label, f"{name}scale": axis.scale})
    drawn = getattr(ax, f"{name}axis")
    if axis.names:
        # long names in a row would overlap: one word a line
        crowded = name == "x" and sum(len(text) for _, text in axis.names) > _HALF_LABEL
        texts = [text.replace(" ", "\n") if crowded else text for _, text in axis.names]
        drawn.set_ticks([value for value, _ in axis.names], labels=texts)
        drawn.set_minor_locator(NullLocator())
        return
    if axis.scale == "linear":
        drawn.set_major_formatter(ScalarFormatter(useOffset=False))
        return
    low, high = getattr(ax, f"get_{name}lim")()
    if high <= _NARROW * low:  # over so few decades, powers of ten would be one or two ticks, or none
        drawn.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        drawn.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        drawn.set_minor_formatter(NullFormatter())


def _refer(ax: Axes, reference: Reference, *, boxed: bool) -> None:
    """Draw a reference line with its label, in a white box where colors lie under it."""
    text = f" {reference.label}"
    zorder = 2.5 if boxed else 0.5  # above colors and lines, else below them
    stroke: dict[str, Any] = {"color": palette.MUTED, "ls": "--", "lw": 0.8, "zorder": zorder}
    value = reference.value
    if reference.direction == "vertical":
        ax.axvline(value, **stroke)
        written = ax.text(value, 0.98, text, ha="left", va="top", transform=ax.get_xaxis_transform())
    else:
        ax.axhline(value, **stroke)
        anchor = "center" if reference.at == 0.5 else "right"  # the middle of the width, or its end
        across = ax.get_yaxis_transform()
        written = ax.text(reference.at, value, text, ha=anchor, va="bottom", transform=across)
    written.set(fontsize=8, color=palette.MUTED)
    if boxed:
        written.set(color=palette.INK, bbox=_BOX)
