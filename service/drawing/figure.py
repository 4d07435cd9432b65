"""The content of a plot: one description for plotly and matplotlib."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
Dash = Literal["solid", "dash", "dot"]


@dataclass(frozen=True)
class Axis:
    """An axis: its label with the unit, its scale, and its limits where the data should not decide.

    `names` stand at values in place of numbers.
    """

    label: str
    scale: Literal["linear", "log"] = "linear"
    limits: tuple[float, float] | None = None
    names: tuple[tuple[float, str], ...] = ()


@dataclass(frozen=True)
class Line:
    """A curve, or points if `width` is 0. NaN breaks it. `x` and `y` have the shape (n,).

    `band` is the half-height of an error band about it, one number or (n,); 0 or NaN: none.
    """

    name: str
    x: FloatArray
    y: FloatArray
    color: str
    dash: Dash = "solid"
    width: float = 1.8
    markers: bool = False
    band: float | FloatArray = 0.0

    @property
    def has_band(self) -> bool:
        """Whether an error band is drawn."""
        return bool(np.any(np.asarray(self.band) > 0.0))


@dataclass(frozen=True)
class Reference:
    """A straight line across a panel at one value, with a short label beside it.

    The label of a horizontal line is centered at the fraction `at` of the width, or ends there if it is above
    one half.
    """

    label: str
    value: float
    direction: Literal["horizontal", "vertical"] = "vertical"
    at: float = 0.5


@dataclass(frozen=True)
class Note:
    """A short text above right of a point, moved up by text heights (`row`), or to its left."""

    x: float
    y: float
    text: str
    row: int = 0
    left: bool = False


@dataclass(frozen=True)
class HeatMap:
    """Cells colored by a value; NaN stays blank.

    `x` (n,) and `y` (m,) are the middles of the cells, `z` (m, n); colors run from `least` to `largest`;
    `label` has the unit after its last comma.
    """

    x: FloatArray
    y: FloatArray
    z: FloatArray
    label: str
    largest: float
    least: float = 0.0


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
    """One pair of axes with its curves, or with values as colors; `title` tells it from its neighbors."""

    x: Axis
    y: Axis
    lines: tuple[Line, ...] = ()
    references: tuple[Reference, ...] = ()
    title: str = ""
    shade: HeatMap | Strokes | None = None
    notes: tuple[Note, ...] = ()


@dataclass(frozen=True)
class Surface:
    """A surface z(y, x): `x` (n,), `y` (m,), `z` (m, n)."""

    x: FloatArray
    y: FloatArray
    z: FloatArray
    axes: tuple[Axis, Axis, Axis]


@dataclass(frozen=True)
class Table:
    """Numbers in words: what a screen reader, a printout or a spreadsheet takes instead of a plot."""

    caption: str
    head: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]


@dataclass(frozen=True)
class Figure:
    """A plot of one or more panels, or of one surface.

    Attributes
    ----------
    key : str
        Name of the image file and anchor of the page.
    title, caption : str
        What is shown, and how to read it (signs, conventions).
    alternative : str
        The finding in words, for those who do not see the plot.
    content : tuple of Panel, or Surface
        Panels are stacked from top to bottom.
    table : Table or None
        The main numbers behind the plot.
    """

    key: str
    title: str
    caption: str
    alternative: str
    content: tuple[Panel, ...] | Surface
    table: Table | None = None


def legend_names(panels: Sequence[Panel]) -> list[str]:
    """Return the names that a legend lists: of lines that neither notes nor axes of their panel name."""
    named = [
        {note.text for note in panel.notes} | {name for axis in (panel.x, panel.y) for _, name in axis.names}
        for panel in panels
    ]
    return list(
        dict.fromkeys(
            line.name
            for panel, notes in zip(panels, named, strict=True)
            for line in panel.lines
            if line.name not in notes
        )
    )


def repeats_below(panels: Sequence[Panel], index: int) -> bool:
    """Whether the next panel has the same horizontal axis, so that one label serves both."""
    return index + 1 < len(panels) and panels[index + 1].x == panels[index].x


def unit_of(label: str) -> str:
    """Return the unit of a label, which stands after its last comma."""
    return label.rpartition(",")[2].strip()


def number(value: float, digits: int = 4) -> str:
    """Write `value` with `digits` significant digits, without an exponent where that is readable."""
    if not np.isfinite(value):
        return "none"
    if value == 0.0:
        return "0"
    size = int(np.floor(np.log10(abs(value))))
    return f"{value:.{digits - 1}e}" if not -4 <= size < 7 else f"{value:.{max(digits - 1 - size, 0)}f}"


def thousands(values: Sequence[float]) -> tuple[str, ...]:
    """Label loads: whole numbers without a decimal point, others with up to four digits."""
    return tuple(f"{v:.0f}" if float(v).is_integer() else f"{v:.4g}" for v in values)


def numbers(values: FloatArray) -> list[float | None]:
    """Numbers for JSON: seven digits, NaN as null (a gap)."""
    return [float(f"{v:.7g}") if np.isfinite(v) else None for v in values]
