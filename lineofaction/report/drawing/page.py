"""The page: one HTML file that needs no network, with its plots, tables and players of sound."""

from __future__ import annotations

import base64
import json
import re
from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum
from html import escape
from importlib.resources import files
from typing import Any

from lineofaction.report.drawing.figure import Figure, Sound, Table, numbers
from lineofaction.report.drawing.interactive import plotly_figure

Json = dict[str, Any]
SCRIPT, STYLE_SHEET = "player.js", "player.css"
"""The page of the service has the same."""
# In this page players stand in the document: the script joins them to their plot once that is drawn.
_JOINED = """
for (const group of document.querySelectorAll(".player")) {
  const sound = JSON.parse(group.querySelector("script").textContent);
  joined(group, group.closest("figure").querySelector(".plot"), sound);
}
"""


def player(figure: Figure) -> str:
    """Return the players of a plot's sound; in place of files that are too large a sentence."""
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
    about = json.dumps(sound_json(figure.sound), allow_nan=False).replace("<", "\\u003c")
    script = f'<script type="application/json">{about}</script>'
    return f'<div class="player" role="group" aria-label="{title}">{tracks}{caption}{script}</div>'


def sound_json(sound: Sound) -> Json:
    """Return what the script needs of a sound."""
    tracks = [
        {"name": one.name, "query": one.query, "time": numbers(one.time), "along": numbers(one.along)}
        for one in sound.tracks
    ]
    return {"caption": sound.caption, "tracks": tracks}


def _player_script() -> str:
    """Return the script that joins players and plots, as a module."""
    return f'<script type="module">{_text(SCRIPT)}{_JOINED}</script>'


def _player_style() -> str:
    """Return the style sheet of players and cursor."""
    return _text(STYLE_SHEET)


def _text(name: str) -> str:
    return (files(__package__) / name).read_text("utf-8")


# Figures and tables as one HTML page that needs nothing but itself.


# The page's style sheet: one column of text measure, tables that read, and a print form.


STYLE = """
:root { --ink: #1b1f24; --muted: #59636e; --rule: #dde1e6; --paper: #ffffff; --wash: #f6f7f9;
  --link: #0b5394; }
* { box-sizing: border-box; }
html { font: 16px/1.55 system-ui, -apple-system, "Segoe UI", "Liberation Sans", sans-serif; color: var(--ink);
  background: var(--paper); -webkit-text-size-adjust: 100%; }
body { max-width: 66rem; margin: 0 auto; padding: 2rem 1.25rem 4rem; }
h1 { font-size: 1.9rem; line-height: 1.2; margin: 0 0 .4rem; letter-spacing: -.01em; }
h2 { font-size: 1.3rem; line-height: 1.3; margin: 3rem 0 .5rem; padding-top: .8rem;
  border-top: 2px solid var(--ink); }
h3 { font-size: 1.05rem; margin: 2rem 0 .4rem; }
p { max-width: 44rem; margin: .4rem 0 .8rem; }
a { color: var(--link); }
a:focus-visible, summary:focus-visible { outline: 3px solid #e69f00; outline-offset: 2px; }
.lead { color: var(--muted); font-size: 1.05rem; }
.skip { position: absolute; left: -100rem; }
.skip:focus { left: 1rem; top: .5rem; background: var(--paper); padding: .5rem; }
nav ol { columns: 2; padding-left: 1.3rem; margin: .3rem 0; }
.headline { display: flex; flex-wrap: wrap; gap: 1rem 2.5rem; margin: 1.6rem 0; padding: 0; }
.headline div { margin: 0; }
.headline dt { color: var(--muted); font-size: .85rem; }
.headline dd { margin: 0; font-size: 1.5rem; font-weight: 600; font-variant-numeric: tabular-nums; }
.headline small { font-size: .85rem; font-weight: 400; color: var(--muted); }
.alarm { border-left: 5px solid #d55e00; background: #fff4ec; padding: .7rem 1rem; max-width: none; }
figure { margin: 1.2rem 0 2.2rem; }
figcaption { max-width: 44rem; color: var(--muted); font-size: .92rem; }
.plot { width: 100%; }
/* the bar of buttons stands above a legend, not on it */
.plot:has(.legend) { margin-top: 30px; }
.plot:has(.legend) .modebar-container { top: -30px !important; }
.player { margin: .6rem 0; }
.player p { color: var(--muted); font-size: .92rem; }
.still { display: none; max-width: 100%; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; font-size: .92rem; font-variant-numeric: tabular-nums;
  margin: .5rem 0 1.2rem; }
caption { text-align: left; font-weight: 600; padding: .3rem 0; }
th, td { text-align: left; vertical-align: top; padding: .28rem 1.1rem .28rem 0;
  border-bottom: 1px solid var(--rule); }
thead th { border-bottom: 1.5px solid var(--ink); white-space: nowrap; }
tbody th { font-weight: 500; }
th.n, td.n { text-align: right; white-space: nowrap; }
thead th.n { white-space: normal; }
details { margin: .3rem 0 1rem; }
summary { cursor: pointer; color: var(--link); font-size: .92rem; padding: .2rem 0; }
footer { margin-top: 4rem; color: var(--muted); font-size: .88rem; border-top: 1px solid var(--rule);
  padding-top: .8rem; }
@media (max-width: 40rem) { nav ol { columns: 1; } }
@media print {
  html { font-size: 10.5pt; }
  body { max-width: none; padding: 0; }
  nav, .skip, summary, .modebar { display: none !important; }
  h2 { break-after: avoid; }
  figure, tr { break-inside: avoid; }
  .plot, .player label, .player fieldset { display: none; }
  .still { display: block; }
  a { color: inherit; text-decoration: none; }
}
"""


# The JavaScript of plotly, from its wheel.


def _plotly_script() -> str:
    """Return plotly.js, whole and minified; of the Python package nothing else is loaded."""
    return (files("plotly") / "package_data" / "plotly.min.js").read_text("utf-8")


class Part(IntEnum):
    """Parts of a report, in their order."""

    RESULTS = 1
    EFFECTS = 2
    ACCURACY = 3
    INPUT = 4
    RECEIPT = 5


@dataclass(frozen=True)
class Section:
    """A heading with the figures and tables under it.

    `text` introduces them in a sentence; `folded` tables are shown when requested, and in print; `part` is
    where in a report it belongs.
    """

    title: str
    text: str = ""
    figures: tuple[Figure, ...] = ()
    tables: tuple[Table, ...] = ()
    folded: tuple[Table, ...] = ()
    part: Part = Part.RESULTS


@dataclass(frozen=True)
class Headline:
    """A main result: what, its value and its error or remark."""

    name: str
    value: str
    remark: str = ""


@dataclass(frozen=True)
class Page:
    """All of a report; `alarms` are what the reader must know before any number."""

    title: str
    lead: str
    headlines: tuple[Headline, ...]
    sections: tuple[Section, ...]
    alarms: tuple[str, ...] = ()


# Each plot stands beside its still image, which prints and which takes over where the browser cannot draw.
_SCRIPT = """
const drawn = [];
for (const node of document.querySelectorAll(".plot")) {
  const figure = JSON.parse(document.getElementById(node.dataset.figure).textContent);
  const config = {responsive: true, displaylogo: false, modeBarButtonsToRemove: ["lasso2d", "select2d"]};
  const fall = () => { node.hidden = true; node.nextElementSibling.style.display = "block"; };
  drawn.push(Plotly.newPlot(node, figure.data, figure.layout, config).catch(fall));
}
addEventListener("beforeprint", () => {
  for (const folded of document.querySelectorAll("details")) folded.open = true;
});
Promise.all(drawn).then(() => { document.documentElement.dataset.drawn = "yes"; });
"""


def html(page: Page, images: dict[str, bytes]) -> str:
    """Write `page`; `images` are the PNG bytes of every figure by its key."""
    body = "\n".join(_section(section, index, images) for index, section in enumerate(page.sections, start=1))
    heard = any(figure.sound for section in page.sections for figure in section.figures)
    style = STYLE + _player_style() if heard else STYLE
    return "\n".join(
        [
            '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">',
            '<meta name="viewport" content="width=device-width, initial-scale=1">',
            f'<title>{escape(page.title)}</title>\n<link rel="icon" href="data:,">\n<style>{style}</style>',
            "<noscript><style>.plot { display: none; } .still { display: block; }</style></noscript>",
            f"<script>{_plotly_script()}</script>\n</head>\n<body>",
            '<a class="skip" href="#main">Skip to the results</a>',
            _header(page),
            f'<main id="main">\n{body}\n</main>',
            "<footer>Written by lineofaction. This page needs no network.</footer>",
            f"<script>{_SCRIPT}</script>",
            _player_script() if heard else "",
            "</body>\n</html>\n",
        ]
    )


def _header(page: Page) -> str:
    """Title, warnings, main results and contents."""
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
    return (
        f'<header>\n<h1>{escape(page.title)}</h1>\n<p class="lead">{escape(page.lead)}</p>\n{alarms}'
        f'<dl class="headline">{results}</dl>\n<nav aria-label="Contents"><ol>{entries}</ol></nav>\n</header>'
    )


def _section(section: Section, index: int, images: dict[str, bytes]) -> str:
    """One numbered part of the page."""
    text = f"<p>{escape(section.text)}</p>" if section.text else ""
    figures = "\n".join(_figure(figure, images[figure.key]) for figure in section.figures)
    tables = "\n".join([*map(_table, section.tables), *map(_folded, section.folded)])
    title = escape(section.title)
    head = f'<section aria-labelledby="part-{index}">\n<h2 id="part-{index}">{title}</h2>'
    return f"{head}\n{text}{figures}{tables}</section>"


def _figure(figure: Figure, image: bytes) -> str:
    """One plot with its caption, its still image and its numbers."""
    still = base64.b64encode(image).decode("ascii")
    alternative = escape(f"{figure.title}. {figure.alternative}", quote=True)
    numbers = _folded(figure.table, "Numbers") if figure.table else ""
    return (
        f'<figure id="{figure.key}">\n<h3>{escape(figure.title)}</h3>\n'
        f'<div class="plot" role="img" aria-label="{alternative}" data-figure="{figure.key}-data"></div>'
        f'<img class="still" alt="{alternative}" src="data:image/png;base64,{still}">\n'
        f"<figcaption><strong>{escape(figure.alternative)}</strong> {escape(figure.caption)}</figcaption>\n"
        f"{player(figure)}{numbers}"
        f'<script type="application/json" id="{figure.key}-data">{_embedded(figure)}</script>\n</figure>'
    )


def _embedded(figure: Figure) -> str:
    """JSON that cannot close the script element it stands in."""
    text = json.dumps(plotly_figure(figure), separators=(",", ":"), allow_nan=False)
    return text.replace("<", "\\u003c")


def _folded(table: Table, name: str = "") -> str:
    return f"<details><summary>{escape(name or table.caption)}</summary>{_table(table)}</details>"


def _table(table: Table) -> str:
    """Write a table; its first column names the row, columns of numbers stand to the right."""
    columns = list(zip(*table.rows, strict=True)) or [("text",)] * len(table.head)
    numeric = [all(map(_is_number, column)) for column in columns]
    marks = [' class="n"' if right else "" for right in numeric]
    head = "".join(
        f'<th scope="col"{m}>{escape(cell)}</th>' for m, cell in zip(marks, table.head, strict=True)
    )
    rows = "".join(_row(row, marks) for row in table.rows)
    return (
        f'<div class="scroll" tabindex="0" role="region" aria-label="{escape(table.caption, quote=True)}">'
        f"<table>\n<caption>{escape(table.caption)}</caption>\n<thead><tr>{head}</tr></thead>\n"
        f"<tbody>{rows}</tbody></table></div>"
    )


def _row(row: Sequence[str], marks: Sequence[str]) -> str:
    cells = "".join(f"<td{m}>{escape(cell)}</td>" for m, cell in zip(marks[1:], row[1:], strict=True))
    return f'<tr><th scope="row"{marks[0]}>{escape(row[0])}</th>{cells}</tr>'


def _is_number(text: str) -> bool:
    """Whether a cell holds a number, alone or with unit or error; empty cells count for either."""
    return re.fullmatch(r"|[-+]?[\d.]+(e[-+]?\d+)?( (N m|µm|%|± .*))?", text) is not None
