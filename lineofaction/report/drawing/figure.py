"""The content of a plot: one description for plotly and matplotlib."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal, TypeVar

import numpy as np
from numpy.typing import NDArray

from bounds import engineering
from lineofaction.report.drawing import palette

FloatArray = NDArray[np.float64]
Dash = Literal["solid", "dash", "dot"]
_Entry = TypeVar("_Entry")
BLANK = 0.01
"""Part of the largest value of a map with isolines below which it has no color."""

DRAWING_WIDTH, TALLEST = 3.3, 2.0
"""Width of a panel over its usual height, and the height of the tallest drawing over that."""
_SLIM = 1.5  # height of a drawing over the usual one from which on half the width does
_SHORT = 12  # most characters of a line's label in a panel of half the width
_FEW_MARKS = 4  # most references and notes of a figure of half the width
_MAX_INTEGER = 30  # an axis of whole numbers up to here has no ticks between them
_FEW_ORDERS = 4.0  # an axis of fewer orders, with fractions of them, has ticks between


@dataclass(frozen=True)
class Axis:
    """An axis: its label with the unit, its scale, and its limits where the data should not decide.

    `names` stand at values in place of numbers.
    """

    label: str
    scale: Literal["linear", "log"] = "linear"
    limits: tuple[float, float] | None = None
    names: tuple[tuple[float, str], ...] = ()

    def __post_init__(self) -> None:
        """Drop limits that contain no data, as for a spectrum of zeros."""
        low, high = self.limits or (0.0, 0.0)
        if not (low < high and self.shows(low) and self.shows(high)):
            object.__setattr__(self, "limits", None)

    @classmethod
    def over(cls, label: str, values: FloatArray) -> Axis:
        """Return the axis that ends at the first and at the last of values (n,)."""
        return cls(label, limits=(float(values[0]), float(values[-1])))

    @classmethod
    def of_names(cls, names: Sequence[str], label: str = "", beyond: float = -0.4) -> Axis:
        """Return the axis with names at 0, 1, 2 and so on, which ends at their number and `beyond`."""
        at = tuple((float(k), name) for k, name in enumerate(names))
        return cls(label, limits=(-0.6, len(at) + beyond), names=at)

    def shows(self, value: float) -> bool:
        """Whether a value has a place on it."""
        return bool(np.isfinite(value)) and (self.scale == "linear" or value > 0.0)

    def fraction(self, values: FloatArray, ends: tuple[float, float]) -> FloatArray:
        """Return the place of values on an axis with these ends: 0 at the first, 1 at the last."""
        low, high = ends
        if self.scale == "log":
            values, low, high = np.log10(values), float(np.log10(low)), float(np.log10(high))
        return np.asarray((values - low) / max(high - low, 1e-12))


@dataclass(frozen=True)
class Line:
    """A curve, or points if `width` is 0. NaN breaks it. `x` and `y` have the shape (n,).

    `band` is the half-height of an error band about it, one number or (n,); 0 or NaN: none. `label` stands
    at its right end, in place of `name` in the legend; its rows are parted by line feeds. `filled`: a closed
    outline, tinted within.
    """

    name: str
    x: FloatArray
    y: FloatArray
    color: str
    dash: Dash = "solid"
    width: float = 1.8
    markers: bool = False
    band: float | FloatArray = 0.0
    label: str = ""
    filled: bool = False

    @property
    def has_band(self) -> bool:
        """Whether an error band is drawn."""
        return bool(np.any(np.asarray(self.band) > 0.0))


@dataclass(frozen=True)
class Bars:
    """Upright bars about `x` (n,), each `width` wide, from `base` (one number or (n,)) up to `top` (n,).

    NaN leaves one out. What is `veiled` covers what lies below it and lets it be seen.
    """

    name: str
    x: FloatArray
    top: FloatArray
    base: float | FloatArray
    width: float
    color: str
    veiled: bool = False


@dataclass(frozen=True)
class Reference:
    """A straight line across a panel at one value, with a short label at its end.

    The label of a horizontal line is centered at the fraction `at` of the width, or ends there if it is above
    one half.
    """

    label: str
    value: float
    direction: Literal["horizontal", "vertical"] = "vertical"
    at: float = 0.5


@dataclass(frozen=True)
class Note:
    """A short text above right of a point, moved up by text heights (`row`), or to its left.

    `tail`: values on the axes at which the text begins, at half its height, in place of row and side; a
    leader of the note's `color` goes from there to the point.
    """

    x: float
    y: float
    text: str
    row: int = 0
    left: bool = False
    tail: tuple[float, float] | None = None
    color: str = palette.MUTED


@dataclass(frozen=True)
class HeatMap:
    """Cells colored by a value; NaN stays blank.

    `x` (n,) and `y` (m,) are the middles of the cells, `z` (m, n); colors run from `minimum` to `largest`;
    `label` has the unit after its last comma. With `isolines`, values at which curves are drawn, `x` and `y`
    are evenly spaced, colors change smoothly from cell to cell, and what is below `BLANK` of the largest is
    left blank.
    """

    x: FloatArray
    y: FloatArray
    z: FloatArray
    label: str
    largest: float
    minimum: float = 0.0
    isolines: tuple[float, ...] = ()

    @classmethod
    def spanning(cls, x: FloatArray, y: FloatArray, z: FloatArray, label: str) -> HeatMap:
        """Return the map whose colors run from the least to the largest value, widened if all are equal."""
        known = z[np.isfinite(z)]
        minimum, largest = (float(known.min()), float(known.max())) if known.size else (0.0, 1.0)
        return cls(x, y, z, label, largest if largest > minimum else minimum + 1.0, minimum)

    @property
    def colors(self) -> tuple[str, ...]:
        """Return the palette from the least to the largest: ordered, or of either sign about 0."""
        return palette.SIGNED if self.minimum == -self.largest < 0.0 else palette.CIVIDIS


@dataclass(frozen=True)
class Strokes:
    """Straight strokes colored and widened by a value.

    `x` and `y` (n, 2) are their ends, `value` (n,); where it is 0 the stroke is thin and gray. Colors run
    from 0 to `largest`; `label` has the unit after its last comma.
    """

    x: FloatArray
    y: FloatArray
    value: FloatArray
    label: str
    largest: float


@dataclass(frozen=True)
class Panel:
    """One pair of axes with its curves, or with values as colors; `title` tells it from its neighbors.

    `equal`: one unit is as long in both directions, as in a drawing.
    """

    x: Axis
    y: Axis
    lines: tuple[Line, ...] = ()
    references: tuple[Reference, ...] = ()
    title: str = ""
    shade: HeatMap | Strokes | None = None
    notes: tuple[Note, ...] = ()
    bars: tuple[Bars, ...] = ()
    equal: bool = False

    def __post_init__(self) -> None:
        """Leave out references and notes that have no place on the axes."""
        on = {"vertical": self.x, "horizontal": self.y}
        references = tuple(one for one in self.references if on[one.direction].shows(one.value))
        notes = tuple(one for one in self.notes if self.x.shows(one.x) and self.y.shows(one.y))
        object.__setattr__(self, "references", references)
        object.__setattr__(self, "notes", notes)


@dataclass(frozen=True)
class Table:
    """A table of numbers as text, the alternative to a plot for screen readers, print and spreadsheets."""

    caption: str
    head: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]

    @classmethod
    def of(
        cls, caption: str, entries: Iterable[_Entry], columns: Mapping[str, Callable[[_Entry], str]]
    ) -> Table:
        """Return a table with a row for each entry; a column is a head and the function of its cells."""
        rows = tuple(tuple(write(entry) for write in columns.values()) for entry in entries)
        return cls(caption, tuple(columns), rows)


@dataclass(frozen=True)
class Track:
    """A sound of a plot, with its place on the horizontal axis of the first panel as it plays.

    `time` (n,), s, increases; `along` (n,) are values on the axis. `query` names it to the service's path of
    the sound of a result. `mesh_frequency` (n,), Hz, is that of mesh order 1; None: no mesh is heard alone.
    """

    name: str
    time: FloatArray
    along: FloatArray
    query: dict[str, str]
    mesh_frequency: FloatArray | None = None


@dataclass(frozen=True)
class Sound:
    """Sound of a plot: the caption names its quantity, and parts that the sound leaves out.

    `files` are WAV, one for each track, all of one full scale; none if they would be too large for a page.
    """

    caption: str
    tracks: tuple[Track, ...]
    files: tuple[bytes, ...]


@dataclass(frozen=True)
class Figure:
    """A plot of one or more panels, from top to bottom.

    `key` names the image file and the anchor of the page; `caption` says how to read it (signs, conventions);
    `alternative` is the finding in words: the first sentences under the plot, and what stands for it where it
    is not seen. `table` holds its main numbers. `picture` draws as a PNG file what no panels hold; it is a
    picture on every page.
    """

    key: str
    title: str
    caption: str
    alternative: str
    content: tuple[Panel, ...]
    table: Table | None = None
    sound: Sound | None = None
    picture: Callable[[], bytes] | None = None


def category_lines(
    x: FloatArray,
    names: Sequence[str],
    curves: Iterable[FloatArray],
    width: float = 1.4,
    dash: Dash = "solid",
) -> tuple[Line, ...]:
    """Draw curves (n,) over `x`, each in the color of a category."""
    return tuple(
        Line(name, x, values, palette.category(index), dash, width)
        for index, (name, values) in enumerate(zip(names, curves, strict=True))
    )


def ordered_lines(
    x: FloatArray,
    names: Sequence[str],
    curves: Iterable[FloatArray],
    bands: Iterable[FloatArray] | None = None,
    *,
    labeled: bool = True,
) -> tuple[Line, ...]:
    """Return curves (n,) over `x`, dark for the first, with names at their ends; with bands also points."""
    count, points = len(names), bands is not None
    sizes: Iterable[FloatArray | float] = [0.0] * count if bands is None else bands
    return tuple(
        Line(name, x, y, palette.ordered(k, count), markers=points, band=band, label=name if labeled else "")
        for k, (name, y, band) in enumerate(zip(names, curves, sizes, strict=True))
    )


def step_line(name: str, edges: FloatArray, values: FloatArray, color: str) -> Line:
    """Draw values (n,) of bands between their edges (n + 1,)."""
    return Line(name, np.repeat(edges, 2)[1:-1], np.repeat(values, 2), color)


def ripple_panel(x: Axis, lines: tuple[Line, ...], title: str = "") -> Panel:
    """Draw peak-to-peak in µm with error bands, from zero."""
    top = 1.05 * max(float(np.nanmax(line.y + np.nan_to_num(line.band))) for line in lines)
    return Panel(x, Axis("peak to peak, µm", limits=(0.0, top)), lines, title=title)


def shaded_levels(x: FloatArray, y: FloatArray, level: FloatArray, label: str, depth: float) -> HeatMap:
    """Color levels (m, n) in dB down to `depth` below the largest; lower ones are left blank."""
    maximum = float(level.max())
    return HeatMap(x, y, np.where(level < maximum - depth, np.nan, level), label, maximum, maximum - depth)


def largest(sizes: FloatArray, count: int) -> list[int]:
    """Return the indices of the largest of sizes (n,), in their order."""
    return sorted(np.argsort(-sizes, kind="stable")[:count].tolist())


def panel_height(panel: Panel, columns: int = 1) -> float:
    """Return the height of a panel over the usual one; a drawing is as tall as it needs to fill the width.

    `columns` panels share the width.
    """
    if not panel.equal:
        return 1.0
    across, along = (_extent(panel, axis) for axis in ("x", "y"))
    return min(max(DRAWING_WIDTH / columns * along / max(across, 1e-12), 1.0), TALLEST)


def _extent(panel: Panel, axis: Literal["x", "y"]) -> float:
    drawn_axis: Axis = getattr(panel, axis)
    values = drawn_axis.limits or np.concatenate([getattr(line, axis) for line in panel.lines])
    return float(np.nanmax(values) - np.nanmin(values))


def legend_names(panels: Sequence[Panel]) -> list[str]:
    """Return the names in a legend: names without a label, note or axis in their panel."""
    named = [
        {note.text for note in panel.notes}
        | {name for axis in (panel.x, panel.y) for _, name in axis.names}
        | {line.name for line in panel.lines if line.label}
        for panel in panels
    ]
    return list(
        dict.fromkeys(
            name
            for panel, notes in zip(panels, named, strict=True)
            for name in [line.name for line in panel.lines] + [bars.name for bars in panel.bars]
            if name not in notes
        )
    )


def _few_marks(shade: HeatMap | Strokes | None) -> bool:
    return shade is None or (isinstance(shade, HeatMap) and not shade.isolines)


def half_figures(figures: Sequence[Figure]) -> set[str]:
    """Return the keys of the figures of a section that are printed on half the width.

    These are figures of one plain panel, and one of two panels, which are then stacked, beside such a figure.
    """
    keys: set[str] = set()
    index = 0
    while index < len(figures):
        pair = figures[index : index + 2]
        panels = [len(figure.content) for figure in pair]
        if len(pair) == 2 and 1 in panels and all(map(_fits_half, pair)):
            keys |= {figure.key for figure in pair}
            index += 1
        elif panels[0] == 1 and _fits_half(pair[0]):
            keys.add(pair[0].key)
        index += 1
    return keys


def _fits_half(figure: Figure) -> bool:
    """Whether a figure is legible at half the width of a page: at most two plain panels, few labels."""
    if figure.picture is not None or not 1 <= len(figure.content) <= 2:
        return False
    for panel in figure.content:
        labels = max((len(row) for line in panel.lines for row in line.label.split("\n")), default=0)
        if panel.equal or not _few_marks(panel.shade) or labels > _SHORT:
            return False
        if len(panel.references) + len(panel.notes) > _FEW_MARKS:
            return False
        if any(note.tail for note in panel.notes):
            return False
    return True


def panel_rows(panels: Sequence[Panel], across: int) -> list[list[int]]:
    """Return panels by rows of at most `across`; strokes, isolines, wide drawings, long labels are alone."""
    rows: list[list[int]] = []
    is_shared = False
    for index, panel in enumerate(panels):
        labels = max((len(row) for line in panel.lines for row in line.label.split("\n")), default=0)
        slim = panel_height(panel) > _SLIM if panel.equal else _few_marks(panel.shade)
        narrow = slim and labels <= _SHORT
        if narrow and is_shared and len(rows[-1]) < across:
            rows[-1].append(index)
        else:
            rows.append([index])
        is_shared = narrow
    return rows


def counts(panel: Panel, name: Literal["x", "y"]) -> bool:
    """Whether an axis has ticks at whole numbers alone: of many orders, or of few values that are whole."""
    axis: Axis = getattr(panel, name)
    if axis.scale == "log" or axis.names:
        return False
    coordinates = [getattr(line, name) for line in panel.lines]
    coordinates += [bars.x for bars in panel.bars if name == "x"]
    values = np.concatenate([np.ravel(part) for part in coordinates]) if coordinates else np.empty(0)
    values = values[np.isfinite(values)]
    span, is_integer = float(np.ptp(values)) if values.size else 0.0, bool(np.all(values == np.round(values)))
    if re.search(r"\borders?\b", axis.label):
        return is_integer or span > _FEW_ORDERS
    return name == "x" and bool(panel.lines) and is_integer and span <= _MAX_INTEGER


def repeats_below(panels: Sequence[Panel], index: int) -> bool:
    """Whether the next panel has the same horizontal axis, so that one label serves both."""
    return index + 1 < len(panels) and panels[index + 1].x == panels[index].x


def unit_of(label: str) -> str:
    """Return the unit of a label, which stands after its last comma."""
    return label.rpartition(",")[2].strip()


def number(value: float, digits: int = 4) -> str:
    """Write `value` with `digits` significant digits, zeros at the end too where it has no exponent."""
    if not np.isfinite(value):
        return "none"
    if value == 0.0:
        return "0"
    size = int(np.floor(np.log10(abs(value))))
    plain = -4 <= size < 7
    return f"{value:.{max(digits - 1 - size, 0)}f}" if plain else engineering(value, digits)


def um(length: float, digits: int = 4) -> str:
    """Write a length in m as a number in µm."""
    return number(1e6 * float(length), digits)


def thousands(values: Sequence[float]) -> tuple[str, ...]:
    """Label loads: whole numbers without a decimal point, others with up to four digits."""
    return tuple(f"{v:.0f}" if float(v).is_integer() or v >= 1e4 else f"{v:.4g}" for v in values)


def numbers(values: FloatArray) -> list[float | None]:
    """Numbers for JSON: seven digits, NaN as null (a gap)."""
    return [float(f"{v:.7g}") if np.isfinite(v) else None for v in values]
