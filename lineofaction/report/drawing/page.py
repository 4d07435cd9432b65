"""The page: one HTML file that needs no network, with its plots, tables and players of sound."""

from __future__ import annotations

import base64
import gzip
import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from enum import IntEnum
from functools import cache
from html import escape
from importlib.resources import files
from typing import Any

from lineofaction.report.drawing.figure import Figure, Sound, Table, half_figures, numbers
from lineofaction.report.drawing.interactive import plotly_figure

Json = dict[str, Any]
SCRIPT, STYLE_SHEET = "player.js", "player.css"
"""Names of the player's files, which the page of the service shares."""
_ROWS_OF_A_PAGE = 40
"""Most rows of a table that is not divided between printed pages."""
_HALF_OF_A_PAGE, _BROKEN_TO_HALF, _ACROSS_A_PAGE = 64, 96, 110
"""Widths of tables in characters: the largest beside which another table fits, whole or with broken cells,
and the largest on a page."""
_SHORT = 24
"""Most characters of a cell that stays on one line where the table fits."""
# In this page players stand in the document: the script joins them to their plot once that is drawn.
_JOINED = """
if (document.getElementById("library")) await drawn;
for (const group of document.querySelectorAll(".player")) {
  const sound = JSON.parse(group.querySelector("script").textContent);
  joined(group, group.closest("figure").querySelector(".plot"), sound);
}
"""


def _player(figure: Figure) -> str:
    """Return the players of a plot's sound, or a sentence where its files are too large for the page."""
    if figure.sound is None:
        return ""
    files = figure.sound.files
    caption = f"<p>{escape(figure.sound.caption)}</p>"
    if not files:
        return f"{caption}<p>Too long for this page: write it to a file by loa listen.</p>"
    tracks = "".join(
        f'<label>{escape(track.name)} <audio controls preload="metadata" '
        f'src="data:audio/wav;base64,{base64.b64encode(file).decode("ascii")}"></audio></label>'
        for track, file in zip(figure.sound.tracks, files, strict=True)
    )
    title = escape(f"Sound: {figure.title}", quote=True)
    content = json.dumps(sound_json(figure.sound), allow_nan=False).replace("<", "\\u003c")
    script = f'<script type="application/json">{content}</script>'
    return f'<div class="player" role="group" aria-label="{title}">{tracks}{caption}{script}</div>'


def sound_json(sound: Sound) -> Json:
    """Return the data of a sound for the script of the page."""
    tracks = [
        {
            "name": track.name,
            "query": track.query,
            "time": numbers(track.time),
            "along": numbers(track.along),
            "mesh_hz": None if track.mesh_frequency is None else numbers(track.mesh_frequency),
        }
        for track in sound.tracks
    ]
    return {"caption": sound.caption, "tracks": tracks}


def _text(name: str, package: str = __package__) -> str:
    return (files(package) / name).read_text("utf-8")


class Part(IntEnum):
    """Parts of a report, in their order."""

    RESULTS = 1
    EFFECTS = 2
    ACCURACY = 3
    INPUT = 4
    RECEIPT = 5


@dataclass(frozen=True)
class Section:
    """A heading with the figures and tables under it."""

    title: str
    text: str = ""
    """Sentence before the figures and tables."""
    figures: tuple[Figure, ...] = ()
    tables: tuple[Table, ...] = ()
    folded: tuple[Table, ...] = ()
    """Tables that are closed until the reader opens them; a print shows them."""
    part: Part = Part.RESULTS
    """Part of a report that the section belongs to."""


@dataclass(frozen=True)
class Headline:
    """A main result: its name, its value, and its error or remark."""

    name: str
    value: str
    remark: str = ""


@dataclass(frozen=True)
class TitleBlock:
    """The title block of a report."""

    rows: tuple[tuple[str, str], ...]
    """Names and texts of its fields."""
    verdicts: tuple[str, ...] = ()
    """Sentences on requirements that are met or not."""
    corner: str = ""
    """Text in the upper corner of every printed page."""


@dataclass(frozen=True)
class Page:
    """The contents of a report."""

    title: str
    lead: str
    headlines: tuple[Headline, ...]
    sections: tuple[Section, ...]
    alarms: tuple[str, ...] = ()
    """Warnings to be read before any number."""
    block: TitleBlock | None = None
    records: Mapping[str, Any] = field(default_factory=dict)
    """Inputs, figures and versions behind the results, by the names of their files."""


def html(page: Page, images: dict[str, bytes], *, still: bool = False) -> str:
    """Return a page as HTML.

    `images` are the PNG bytes of every figure by its key. With `still`, the page shows these images in place
    of interactive plots; without it, a browser without scripts does.
    """
    body = "\n".join(
        _section(section, index, images, still=still) for index, section in enumerate(page.sections, start=1)
    )
    has_sound = any(figure.sound for section in page.sections for figure in section.figures)
    style = _margins(page) + _text("page.css") + (_text(STYLE_SHEET) if has_sound else "")
    library = "" if still else f'<script type="text/plain" id="library">{_library()}</script>\n'
    plot_script = "" if still else f"<script>\n{_text('page.js')}</script>"
    images_shown = "<style>.still { display: block; } figure:has(.still) h3 { display: none; }</style>"
    no_plots = "<style>.plot { display: none; }</style>"
    display = images_shown if still else f"<noscript>{images_shown}{no_plots}</noscript>"
    return "\n".join(
        [
            '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">',
            '<meta name="viewport" content="width=device-width, initial-scale=1">',
            f'<title>{escape(page.title)}</title>\n<link rel="icon" href="data:,">\n<style>{style}</style>',
            f"{display}\n{library}</head>\n<body>",
            '<a class="skip" href="#main">Skip to the results</a>',
            _header(page),
            f'<main id="main">\n{body}\n</main>',
            "<footer>Written by lineofaction. This page needs no network.</footer>",
            plot_script,
            f'<script type="module">{_text(SCRIPT)}{_JOINED}</script>' if has_sound else "",
            "</body>\n</html>\n",
        ]
    )


@cache
def _library() -> str:
    """Return the library of plots as base64 of gzip: 2 in place of 5 MB, which browsers unpack themselves."""
    packed = gzip.compress(_text("package_data/plotly.min.js", "plotly").encode(), mtime=0)
    return base64.b64encode(packed).decode("ascii")


def _margins(page: Page) -> str:
    """Return the margin texts of every printed page, without its number."""
    corner = page.block.corner if page.block else ""
    texts = {"top-left": page.title, "top-right": corner, "bottom-left": "lineofaction"}
    plain = {corner_name: re.sub(r"[^\w .,:;()/+-]", " ", text) for corner_name, text in texts.items()}
    boxes = " ".join(f'@{corner_name} {{ content: "{text}"; }}' for corner_name, text in plain.items())
    return f"\n@page {{ {boxes} }}\n"


def _block(block: TitleBlock | None) -> str:
    if block is None:
        return ""
    rows = "".join(f"<div><dt>{escape(name)}</dt><dd>{escape(text)}</dd></div>" for name, text in block.rows)
    verdicts = "".join(f'<p class="verdict"><strong>{escape(text)}</strong></p>' for text in block.verdicts)
    return f'<dl class="block">{rows}</dl>\n{verdicts}'


def _header(page: Page) -> str:
    alarms = "".join(
        f'<p class="alarm" role="alert"><strong>{escape(text)}</strong></p>' for text in page.alarms
    )
    results = "".join(
        f"<div><dt>{escape(h.name)}</dt><dd>{escape(h.value)} <small>{escape(h.remark)}</small></dd></div>"
        for h in page.headlines
    )
    entries = "".join(
        f'<li><a href="#part-{i}">{escape(section.title)}</a></li>'
        for i, section in enumerate(page.sections, start=1)
    )
    lead = f'<p class="lead">{escape(page.lead)}</p>\n{_block(page.block)}'
    return (
        f"<header>\n<h1>{escape(page.title)}</h1>\n{lead}{alarms}"
        f'<dl class="headline">{results}</dl>\n<nav aria-label="Contents"><ol>{entries}</ol></nav>\n</header>'
    )


def _section(section: Section, index: int, images: dict[str, bytes], *, still: bool) -> str:
    text = f"<p>{escape(section.text)}</p>" if section.text else ""
    half = half_figures(section.figures)
    figures = "\n".join(
        _figure(figure, images[figure.key], still=still, half=figure.key in half)
        for figure in section.figures
    )
    open_tables = (_table(table, below=section.title) for table in section.tables)
    tables = "\n".join([*open_tables, *map(_folded, section.folded)])
    title = escape(section.title)
    is_screen_only = section.part is Part.RECEIPT or not (section.figures or section.tables)
    print_class = ' class="unprinted"' if is_screen_only else ""
    head = f'<section{print_class} aria-labelledby="part-{index}">\n<h2 id="part-{index}">{title}</h2>'
    return f"{head}\n{text}{figures}{tables}</section>"


def _figure(figure: Figure, image: bytes, *, still: bool, half: bool) -> str:
    """One plot with its caption, its still image and its numbers; a picture has no plot."""
    still, image_class = still or figure.picture is not None, "picture" if figure.picture else "still"
    alternative = escape(f"{figure.title}. {figure.alternative}", quote=True)
    numbers = _folded(figure.table, "Numbers") if figure.table else ""
    plot = f'<div class="plot" role="img" aria-label="{alternative}" data-figure="{figure.key}-data"></div>'
    data = ""
    if not still:
        data = f'<script type="application/json" id="{figure.key}-data">{_embedded(figure)}</script>\n'
    encoded = base64.b64encode(image).decode("ascii")
    width = " data-half" * half
    return (
        f'<figure id="{figure.key}">\n<h3>{escape(figure.title)}</h3>\n{"" if still else plot}'
        f'<img class="{image_class}"{width} alt="{alternative}" src="data:image/png;base64,{encoded}">\n'
        f"<figcaption><strong>{escape(figure.alternative)}</strong> {escape(figure.caption)}</figcaption>\n"
        f"{_player(figure)}{numbers}{data}</figure>"
    )


def _embedded(figure: Figure) -> str:
    """Return the plot as JSON without "<", which could close the script element around it."""
    text = json.dumps(plotly_figure(figure), separators=(",", ":"), allow_nan=False)
    return text.replace("<", "\\u003c")


def _folded(table: Table, name: str = "") -> str:
    return f"<details><summary>{escape(name or table.caption)}</summary>{_table(table)}</details>"


def _table(table: Table, below: str = "") -> str:
    """Write a table; its first column names the row, columns of numbers stand to the right.

    `below`: the heading that it stands below; a caption with the same words is left out.
    """
    numeric = numeric_columns(table)
    marks = [' class="n"' if right else "" for right in numeric]
    head = "".join(
        f'<th scope="col"{m}>{escape(cell)}</th>' for m, cell in zip(marks, table.head, strict=True)
    )
    name = escape(table.caption, quote=True)
    short = " short" if len(table.rows) <= _ROWS_OF_A_PAGE else ""
    # the head of a column of numbers may break between its words, other cells count in full
    heads = (
        max(cell.split(), key=len, default="") if n else cell
        for n, cell in zip(numeric, table.head, strict=True)
    )
    width = sum(max(map(len, column)) for column in zip(heads, *table.rows, strict=True))
    fits = width <= _ACROSS_A_PAGE
    rows = "".join(_row(row, marks, unbroken=fits) for row in table.rows)
    if short and width <= _HALF_OF_A_PAGE:
        short += " narrow"
    elif short and len(table.head) == 2 and width <= _BROKEN_TO_HALF:
        short += " paired"  # names and values
    caption = "" if table.caption == below else f"<caption>{escape(table.caption)}</caption>"
    return (
        f'<div class="scroll{short}" tabindex="0" role="region" aria-label="{name}">'
        f"<table>\n{caption}\n<thead><tr>{head}</tr></thead>\n"
        f"<tbody>{rows}</tbody></table></div>"
    )


def _row(row: Sequence[str], marks: Sequence[str], *, unbroken: bool) -> str:
    """Return a row; with `unbroken`, its short cells stay on one line."""
    attrs = [
        mark or ' class="w"' * (unbroken and len(cell) <= _SHORT)
        for mark, cell in zip(marks, row, strict=True)
    ]
    cells = "".join(f"<td{m}>{escape(cell)}</td>" for m, cell in zip(attrs[1:], row[1:], strict=True))
    return f'<tr><th scope="row"{attrs[0]}>{escape(row[0])}</th>{cells}</tr>'


def numeric_columns(table: Table) -> list[bool]:
    """Return whether each column has only numbers, which stand to the right."""
    columns = list(zip(*table.rows, strict=True)) or [("text",)] * len(table.head)
    return [all(map(is_number, column)) for column in columns]


def is_number(text: str) -> bool:
    """Whether a cell holds a number, alone or with unit or error; empty cells count for either."""
    return re.fullmatch(r"|-|(< )?[-+]?[\d.]+(e[-+]?\d+)?( (N m|µm|%|± .*))?", text) is not None
