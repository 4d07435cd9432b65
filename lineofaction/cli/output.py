"""Output of the verbs on standard output: JSON or tables."""

from __future__ import annotations

import csv
import io
import json
import os
import re
import sys
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

from rich.console import Console, Group
from rich.highlighter import RegexHighlighter
from rich.text import Text
from rich.theme import Theme

from lineofaction.cli.verb_warnings import in_lines, warnings_so_far
from lineofaction.gearbox.problems import BadInput

if TYPE_CHECKING:
    from lineofaction.report.drawing.figure import Table as Drawn
    from lineofaction.report.drawing.page import Headline

Report = Callable[[str, float], None]

_MAX_HEADLINES = 2
EMPHASIS = "bold"
"""Style of the line that states the result."""
_THEME = Theme({"loa.error": "cyan", "loa.beside": "bright_black"})
_WIDEST = 24  # characters of a text before it wraps
_GAP = 2  # characters between two columns of a table
_INDENT = "  "  # of lines below a row
_MAX_LINES = 2  # of a text in the last column; a longer text stands below its row
_FIGURE = re.compile(r"([+-]?\d+)((?:\.\d+)?(?: ?[^\d.e±].*?)?)( ?±.*)?")
"""Pattern of a number: the part before the decimal point, the decimals with the unit, and the error."""


def print_json(answer: dict[str, Any]) -> None:
    """Print one JSON object with the warnings of the verb; ValueError: a number is NaN or infinite."""
    sys.stdout.write(json.dumps({**answer, "warnings": warnings_so_far()}, allow_nan=False) + "\n")
    sys.stdout.flush()


class _Marks(RegexHighlighter):
    """Highlighter of printed lines: errors after ± in cyan, notes at the end of an answer in grey."""

    base_style = "loa."
    highlights: ClassVar[list[str]] = [
        r"(?P<error>± ?[\d.]+(e-?\d+)?)",
        r"(?P<beside>^ .*: below .*, their error$|^next: .*|^written to .*)",
    ]


class _Terminal(Console):
    """Breaks sentences between words."""

    def print(self, *objects: Any, soft_wrap: bool | None = None, **options: Any) -> None:
        broken = (in_lines(text, self.file) for text in objects) if soft_wrap else objects
        super().print(*broken, soft_wrap=soft_wrap, **options)


def console() -> Console:
    """Return the console of standard output: styles on a terminal alone, where NO_COLOR is not set.

    Text stays as it is; piped, it is as wide as its tables need.
    """
    plain: Any = {"markup": False, "emoji": False}
    if sys.stdout.isatty():
        return _Terminal(highlighter=_Marks(), theme=_THEME, **plain)
    plain["highlight"] = False
    columns = os.environ.get("COLUMNS", "")
    return Console(
        width=int(columns) if columns.isdecimal() and int(columns) else 200, no_color=True, **plain
    )


@dataclass(frozen=True)
class _Column:
    """A column of a table, of text or of numbers."""

    head: str
    cells: Sequence[str]
    text: bool

    @property
    def full_width(self) -> int:
        """Width in which nothing wraps."""
        return max(len(line) for part in (self.head, *self.cells) for line in part.split("\n"))

    def minimum(self, widest: int) -> int:
        """Return the width in which no word of the head and no cell is cut; a wider text may wrap."""
        parts = (self.head, *self.cells) if self.text else (self.head,)
        longest = max(len(word) for part in parts for word in in_lines(part, 1).split("\n"))
        content = replace(self, head="").full_width
        return max(longest, min(content, widest) if self.text else content)

    def lines(self, part: str, width: int) -> list[str]:
        """Return the head or a cell as lines of a width."""
        side = str.ljust if self.text else str.rjust
        return [side(line, width) for line in in_lines(part, width).split("\n")]


_Block = list[tuple[_Column, int]]
"""Columns beside each other, with their widths."""


def table(
    columns: Sequence[str], rows: Sequence[Sequence[str]], title: str = "", text_columns: Sequence[str] = ()
) -> Group:
    """Return a table of numbers, one decimal point below another; columns of `text_columns` are aligned left.

    A table wider than the terminal is divided into blocks below each other. Each repeats the leading columns
    of text, or the first column. A long text in the last column stands below its row.
    """
    width, laid_out = console().width, list[_Column]()
    for k, name in enumerate(columns):
        cells, text = [row[k] for row in rows], name in text_columns
        laid_out.append(_Column(name, cells if text else aligned(cells), text))
    below = laid_out.pop() if _is_long(laid_out, width) else None
    lines: list[Text | str] = [Text(title, "italic")] if title else []
    blocks = _blocks(laid_out, width)
    for block in blocks:
        foot = below if block is blocks[-1] else None
        # heads are filled from the bottom, so that their last lines stand above the cells
        head = _side_by_side([column.lines(column.head, wide)[::-1] for column, wide in block])[::-1]
        head += [] if foot is None else [f"{_INDENT}{foot.head}"]
        lines += [*([] if block is blocks[0] else [""]), *(Text(line, "bold") for line in head)]
        for row in range(len(rows)):
            lines += _side_by_side([column.lines(column.cells[row], wide) for column, wide in block])
            if foot is not None:
                wrapped = in_lines(foot.cells[row], width - len(_INDENT))
                lines += (f"{_INDENT}{line}" for line in wrapped.split("\n"))
    return Group(*lines)


def _side_by_side(cells: Sequence[list[str]]) -> list[str]:
    """Return the lines of a row of cells, each cell a list of lines."""
    high = max(map(len, cells))
    filled = [[*lines, *[" " * len(lines[0])] * (high - len(lines))] for lines in cells]
    return [(" " * _GAP).join(parts).rstrip() for parts in zip(*filled, strict=True)]


def _is_long(columns: Sequence[_Column], width: int) -> bool:
    """Whether the last column is a text that would wrap into many lines beside the others."""
    *others, last = columns
    left = width - sum(column.full_width + _GAP for column in others)
    return bool(others) and last.text and last.full_width > max(_WIDEST, _MAX_LINES * left)


def aligned(cells: Sequence[str]) -> list[str]:
    """Return cells of a column, one decimal point and one error below another, units at their numbers."""
    figures = [_FIGURE.fullmatch(cell) for cell in cells]
    parts = [figure.groups("") for figure in figures if figure]
    decimals, error = (max((len(part[k]) for part in parts), default=0) for k in (1, 2))
    return [
        figure[1] + figure[2].ljust(decimals) + (figure[3] or "").ljust(error) if figure else cell
        for cell, figure in zip(cells, figures, strict=True)
    ]


def _blocks(columns: Sequence[_Column], width: int) -> list[_Block]:
    """Return the columns of each block: the keys, and as many others as there is room for.

    A text wraps where that saves a block, or where nothing else fits.
    """
    keys = max(1, next((k for k, column in enumerate(columns) if not column.text), 1))
    tried = [
        _divided_blocks([(column, column.minimum(widest)) for column in columns], keys, width)
        for widest in (width, _WIDEST)
    ]
    # first the division that exceeds the width least, then the one of fewest blocks
    blocks = min(tried, key=lambda blocks: (max(0, *(_wide(block) - width for block in blocks)), len(blocks)))
    return [_grown(block, width) for block in blocks]


def _divided_blocks(columns: _Block, keys: int, width: int) -> list[_Block]:
    blocks = [columns[:keys]]
    for column in columns[keys:]:
        if _wide([*blocks[-1], column]) > width and len(blocks[-1]) > keys:
            blocks.append(columns[:keys])
        blocks[-1].append(column)
    return blocks


def _wide(block: _Block) -> int:
    return sum(wide + _GAP for _, wide in block) - _GAP


def _grown(block: _Block, width: int) -> _Block:
    """Return the columns as wide as they are whole, as far as there is room."""
    room = max(width - _wide(block), 0)
    columns = []
    for column, wide in block:
        more = min(max(column.full_width - wide, 0), room)
        columns.append((column, wide + more))
        room -= more
    return columns


def print_headlines(headlines: Sequence[Headline]) -> None:
    """Begin with the main results, a line each and two at most."""
    out = console()
    for headline in headlines[:_MAX_HEADLINES]:
        band = headline.remark if headline.remark.startswith("±") else f"({headline.remark})"
        line = f"{headline.name}: {headline.value} {band}".removesuffix(" ()")
        out.print(line, soft_wrap=True, style=EMPHASIS)


def print_parts(parts: Iterable[Drawn | str]) -> None:
    """Print tables, their columns of words to the left, and lines."""
    from lineofaction.report.drawing.page import numeric_columns  # noqa: PLC0415 (start-up time)

    out = console()
    for part in parts:
        if isinstance(part, str):
            out.print(part, soft_wrap=True)
        else:
            text_columns = [
                name for name, right in zip(part.head, numeric_columns(part), strict=True) if not right
            ]
            out.print(table(part.head, part.rows, part.caption, text_columns))


def print_written(files: Sequence[Path]) -> None:
    """End a verb with the files that were written."""
    if files:
        console().print(f"written to {', '.join(map(str, files))}", soft_wrap=True)


def csv_text(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table as CSV."""
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows((head, *rows))
    return text.getvalue()


def output_of(output: Path | None, project: Path | None, name: str) -> Path:
    """Return the named output, else the file of a name in the project of the input.

    Raises `BadInput`: neither.
    """
    if output is None and project is None:
        raise BadInput.of("output", None, "a file to write", "Give one with -o, or name a folder to work in.")
    return output or (project or Path()) / name


def check_writable(output: Path) -> None:
    """Refuse an output that cannot be written, before the work is done rather than after it.

    Raises `BadInput`: its folder does not exist, or it is a folder itself.
    """
    if not output.parent.is_dir():
        raise BadInput.of("output", str(output), "in a folder that exists", "Make the folder first.")
    if output.is_dir():
        raise BadInput.of("output", str(output), "a file", "Add a file name.")


def check_netcdf_output(output: Path) -> None:
    """Refuse an output that cannot be written, or whose name promises something else than netCDF.

    Raises `BadInput`: not writable, or another ending than those of netCDF.
    """
    check_writable(output)
    if output.suffix not in ("", ".nc", ".nc4"):
        remedy = "Write the netCDF file; `loa report FILE.nc -o PAGE.html` draws it."
        raise BadInput.of("output", str(output), "a file ending in .nc", remedy)
