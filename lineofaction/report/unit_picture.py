"""A picture of the gear unit of a result, with the names of its shafts and gears."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from hashlib import sha256
from io import BytesIO
from textwrap import shorten
from typing import NamedTuple

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure as Sheet
from matplotlib.lines import Line2D

from bounds.types import Json
from lineofaction.gearbox.studies.bodies import BEARING, HOUSING, PINION, SHAFT, WHEEL, Body, Hull
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.bodies import Camera, Rendered, rendered
from lineofaction.report.drawing.figure import Figure
from lineofaction.report.drawing.image import drawable
from lineofaction.report.drawing.page import Page, Section

SIZE = (1000, 560)
"""Pixels across and down."""
ABOVE, EDGE = 14.0, 6.0
"""Margins in pixels: `ABOVE` above and below the unit, `EDGE` beside the columns of names."""
COLORS = {
    SHAFT: (0.62, 0.64, 0.67),
    BEARING: (0.42, 0.46, 0.52),
    PINION: (0.58, 0.70, 0.82),
    WHEEL: (0.82, 0.66, 0.52),
    HOUSING: (0.50, 0.55, 0.60),
}
"""Colors of bodies by kind, the same as on the page of the service."""
DPI, TYPE = 100, 8.5
"""Dots per inch of the picture, and size of its type in points."""
CHARACTER, ROW, LONGEST = 7.4, 16.0, 24
"""Width of a character and height of a row of names in pixels; the most characters of a name."""
AWAY = 24.0
"""Pixels from the unit to names."""
INNER = 0.05
"""A line to a part ends this share of the part's pixels away from its outermost column."""
GAP = 2.0
"""Pixels between a name and its line."""
TITLE = "The gear unit"
CAPTION = (
    "To scale: shafts by their sections, gears as discs of their face width and tip diameter, bearings as "
    "rings; what drives is blue, what is driven brown. Diameters of shafts without sections, and of bearings "
    "without a line of a catalog, are assumed. "
)
HOUSED = "The rest is seen through the housing, which is coarse."
UNHOUSED = "The housing is not drawn."


def with_picture(page: Page, unit: Sequence[Json] | None) -> Page:
    """Return a page that begins with the picture of a unit, or the page itself if `unit` is None."""
    return replace(page, sections=(*picture_sections(unit), *page.sections))


def picture_sections(unit: Sequence[Json] | None) -> tuple[Section, ...]:
    """Return the section with the picture of the bodies that a result states; no section if it has none."""
    written = [part for part in unit or () if part["kind"] != HOUSING]
    bodies = tuple(body for body in map(Body.of, written) if body.rings)
    if not bodies:
        return ()
    surfaces = [part for part in unit or () if part["kind"] == HOUSING]
    figure = Figure(
        key=f"unit_{sha256(repr((bodies, surfaces)).encode()).hexdigest()[:8]}",
        title=TITLE,
        caption=CAPTION + (HOUSED if surfaces else UNHOUSED),
        alternative=_alternative(bodies),
        content=(),
        picture=partial(unit_png, bodies, tuple(map(Hull.of, surfaces))),
    )
    return (Section("Unit", figures=(figure,)),)


def one_picture(sections: Sequence[Section]) -> tuple[Section, ...]:
    """Return sections with the picture of each unit once, before all else."""
    pictures = {section.figures[0].key: section for section in sections if is_picture(section)}
    return (*pictures.values(), *(section for section in sections if not is_picture(section)))


def is_picture(section: Section) -> bool:
    """Whether a section is the picture of a unit."""
    return any(figure.picture is not None for figure in section.figures)


def _alternative(bodies: Sequence[Body]) -> str:
    """Return a text with the numbers and names of shafts, gears and bearings."""
    counts = []
    for word, kinds in (("shaft", (SHAFT,)), ("gear", (PINION, WHEEL)), ("bearing", (BEARING,))):
        count = sum(body.kind in kinds for body in bodies)
        if count:
            counts.append(f"{count} {word}{'' if count == 1 else 's'}")
    *more, last = counts
    shafts = ", ".join(body.name for body in bodies if body.kind == SHAFT)
    gears = ", ".join(body.name for body in bodies if body.kind in (PINION, WHEEL))
    said = f"{', '.join(more)} and {last}" if more else last
    return f"{said}. Shafts: {shafts}." + (f" Gears: {gears}." if gears else "")


def unit_png(bodies: tuple[Body, ...], hulls: tuple[Hull, ...] = ()) -> bytes:
    """Draw bodies and the surfaces about them with names of shafts and gears; return the PNG file's bytes."""
    longest = max(len(_short(body.name)) for body in bodies if body.kind != BEARING)
    across = CHARACTER * longest + AWAY + EDGE
    picture = rendered(bodies, Camera.on(bodies, SIZE, (across, ABOVE), hulls), COLORS, hulls)
    sheet = Sheet(figsize=(SIZE[0] / DPI, SIZE[1] / DPI), dpi=DPI)
    FigureCanvasAgg(sheet)  # becomes the canvas of the sheet
    sheet.figimage(picture.color)
    columns = np.flatnonzero(np.any(picture.color < 1.0, axis=(0, 2)))  # columns that are not all white
    shafts = _points(bodies, picture, (SHAFT,), 0.0)
    gears = _points(bodies, picture, (PINION, WHEEL), 1.0)
    _write(sheet, shafts, float(columns[0]) - AWAY, "right")
    _write(sheet, gears, float(columns[-1]) + AWAY, "left")
    buffer = BytesIO()
    sheet.savefig(buffer, format="png", dpi=DPI, metadata={"Title": TITLE})
    return buffer.getvalue()


def _short(name: str) -> str:
    return drawable(shorten(name, LONGEST, placeholder="\N{HORIZONTAL ELLIPSIS}"))


class _Point(NamedTuple):
    """A name and the pixel of its body to which its line goes, counted from the upper left."""

    text: str
    column: float
    row: float


def _points(bodies: Sequence[Body], picture: Rendered, kinds: tuple[str, ...], side: float) -> list[_Point]:
    """Return the names of visible bodies of some kinds, from top to bottom.

    `side` is 0 for pixels near the left end of a body, 1 near its right end.
    """
    points = []
    for index, body in enumerate(bodies):
        rows, columns = np.nonzero(picture.body == index)
        if body.kind in kinds and rows.size:
            column = int(np.quantile(columns, INNER + (1.0 - 2.0 * INNER) * side, method="nearest"))
            in_column = rows[columns == column]
            points.append(_Point(_short(body.name), float(column), float(in_column[in_column.size // 2])))
    return sorted(points, key=lambda point: point.row)[: int(SIZE[1] / ROW) - 1]


def _write(sheet: Sheet, points: list[_Point], at: float, side: str) -> None:
    """Write names in a column, each with a line to its part.

    The names begin (`side` "left") or end ("right") at the pixel `at`, counted from the left.
    """
    width, height = SIZE
    middles = _spread_rows([point.row for point in points])
    for (text, column, row), middle in zip(points, middles, strict=True):
        end = at + (-GAP if side == "left" else GAP)
        # coordinates of a sheet: 0 to 1 from the lower left
        line = Line2D([end / width, column / width], [1.0 - middle / height, 1.0 - row / height])
        line.set(color=palette.INK, lw=0.6, marker="o", ms=2.4, markevery=[1])  # a dot at the part
        sheet.add_artist(line)
        name = sheet.text(at / width, 1.0 - middle / height, text, ha=side, va="center", fontsize=TYPE)
        name.set_color(palette.INK)


def _spread_rows(rows: Sequence[float]) -> list[float]:
    """Return the middles of names near increasing rows of pixels, at least `ROW` apart, in the picture."""
    low, high = 0.5 * ROW, SIZE[1] - 0.5 * ROW
    middles: list[float] = []
    for row in rows:  # downwards, then upwards where the last ones leave the picture
        middles.append(max(row, low if not middles else middles[-1] + ROW))
    for k in reversed(range(len(middles))):
        middles[k] = min(middles[k], high if k == len(middles) - 1 else middles[k + 1] - ROW)
    return middles
