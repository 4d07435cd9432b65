"""Binding of the reports of a unit's parts: figures of several parts stand side by side, once."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import takewhile, zip_longest

from lineofaction.report.drawing.figure import Figure, Panel, Table
from lineofaction.report.drawing.page import Headline, Page, Part, Section
from lineofaction.report.drawing.tables import one_effects_section
from lineofaction.report.unit_picture import is_picture, one_picture

_SENTENCE = re.compile(r"(?<=[.:!]) (?=[A-Z])")
_LINKS = ("at", "of", "on", "in", "under", "the")
"""Words that are cut from the end of a title."""
_Parted = list[tuple[str, Section]]
"""Sections with one title, each with the name of the part it describes."""


def bound(pages: Mapping[str, Page]) -> Page:
    """Bind pages by the name of the part that they describe; the page of the whole unit has an empty name."""
    parts = [name for name in pages if name]
    if not parts:
        return pages[""]
    if len(pages) == 1:
        return next(iter(pages.values()))
    headlines: list[Headline] = []
    pictures: list[Section] = []
    by_title: dict[tuple[Part, str, str], _Parted] = {}
    for name, page in pages.items():
        headlines += [replace(part, name=_with_part(part.name, name)) for part in page.headlines]
        for section in page.sections:
            if is_picture(section):
                pictures.append(section)
                continue
            part_name = name if section.part is Part.EFFECTS else ""  # their tables become one
            by_title.setdefault((section.part, section.title, part_name), []).append((name, section))
    sections = [*one_picture(pictures)]
    sections += [_section(title, parted) for (_, title, _), parted in by_title.items()]
    ordered = sorted(one_effects_section(tuple(sections)), key=lambda section: section.part)
    return Page(
        f"Gear unit: {', '.join(parts)}",
        "; ".join(_named(name, page.lead) for name, page in pages.items() if page.lead),
        tuple(headlines),
        tuple(ordered),
        tuple(dict.fromkeys(_named(name, text) for name, page in pages.items() for text in page.alarms)),
        records={name: record for page in pages.values() for name, record in page.records.items()},
    )


def _named(part: str, text: str) -> str:
    return f"{part[0].upper()}{part[1:]}: {text}" if part and text else text


def _with_part(title: str, part: str) -> str:
    return f"{title}, {part}" if part else title


def _section(title: str, parted: _Parted) -> Section:
    """Return the section of a title: figures with one key are joined, each table names its part."""
    figures: dict[str, dict[str, Figure]] = {}
    for name, section in parted:
        for figure in section.figures:
            figures.setdefault(figure.key, {})[name] = figure
    tables = [_table(name, section, table) for name, section in parted for table in section.tables]
    folded = [_table(name, section, table) for name, section in parted for table in section.folded]
    text = _joined_text({name: section.text for name, section in parted})
    drawn = tuple(_figure(of_parts) for of_parts in figures.values())
    return Section(title, text, drawn, tuple(tables), tuple(folded), parted[0][1].part)


def _table(part: str, section: Section, table: Table) -> Table:
    """Name the part in the caption; a table of effects names it in its column of places."""
    if not part:
        return table
    if section.part is Part.EFFECTS and table in section.tables:
        rows = tuple((name, _with_part(where, part), *rest) for name, where, *rest in table.rows)
        return replace(table, rows=rows)
    return replace(table, caption=_with_part(table.caption, part))


def _figure(figures: Mapping[str, Figure]) -> Figure:
    """Join the figures of parts: panels side by side, common words of the titles, equal sentences once."""
    (first, figure), *others = figures.items()
    head = _head([part.title for part in figures.values()])
    panels = []
    for name, part in figures.items():
        suffix = part.title.removeprefix(head).strip() if others else ""
        panels.append([_panel(name, panel, suffix) for panel in part.content])
    side_by_side = [panel for row in zip_longest(*panels) for panel in row if panel is not None]
    tables = {name: part.table for name, part in figures.items() if part.table}
    return replace(
        figure,
        title=" ".join(_trimmed(head.split())) if others else _with_part(figure.title, first),
        caption=_joined_text({name: part.caption for name, part in figures.items()}),
        alternative=" ".join(_named(name, part.alternative) for name, part in figures.items()),
        content=tuple(side_by_side),
        table=None if figure.table is None else _joined_table(tables),
    )


def _panel(part: str, panel: Panel, suffix: str) -> Panel:
    title = ", ".join(filter(None, (suffix, panel.title[:1].lower() + panel.title[1:])))
    return replace(panel, title=": ".join(filter(None, (part, title)))) if part else panel


def _joined_table(tables: Mapping[str, Table]) -> Table:
    """Stack the rows of tables, each with its part; where heads differ, return the first table alone."""
    first = next(iter(tables.values()))
    if len(tables) == 1 or len({table.head for table in tables.values()}) > 1:
        return first
    rows = tuple((part, *row) for part, table in tables.items() for row in table.rows)
    return replace(first, head=("part", *first.head), rows=rows)


def _head(titles: Sequence[str]) -> str:
    """Return the words with which all titles begin."""
    columns = zip(*(title.split() for title in titles), strict=False)
    return " ".join(row[0] for row in takewhile(lambda row: len(set(row)) == 1, columns))


def _trimmed(title: list[str]) -> list[str]:
    while title[1:] and title[-1] in _LINKS:
        title = title[:-1]
    return [*title[:-1], *(word.rstrip(",;:") for word in title[-1:])]


def _joined_text(texts: Mapping[str, str]) -> str:
    """Join the texts of parts: first the sentences that all share, then the others by part."""
    sentences = {name: _SENTENCE.split(text) for name, text in texts.items() if text}
    if not sentences:
        return ""
    first = next(iter(sentences.values()))
    common = [line for line in first if all(line in part for part in sentences.values())]
    rest = {name: " ".join(line for line in part if line not in common) for name, part in sentences.items()}
    return " ".join([*common, *(_named(name, text) for name, text in rest.items() if text)])
