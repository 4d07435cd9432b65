"""Effects on the page: one table, whichever model decided about them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

from lineofaction.report.drawing.figure import Table
from lineofaction.report.drawing.page import Part, Section

_HEAD = ("effect", "in", "simulated", "without it", "because")


@dataclass(frozen=True)
class EffectRow:
    """An effect: its name, what it acts in, whether it is simulated, its influence in words, and why."""

    name: str
    place: str
    on: bool
    without: str
    because: str

    @property
    def cells(self) -> tuple[str, ...]:
        """Return the row of the table."""
        on = "yes" if self.on else "no"
        return self.name, self.place, on, self.without, self.because


def effect_table(caption: str, rows: Iterable[EffectRow]) -> Table:
    """Tabulate effects."""
    return Table(caption, _HEAD, tuple(row.cells for row in rows))


def effects_section(text: str, rows: Iterable[EffectRow], folded: tuple[Table, ...] = ()) -> Section:
    """Show effects under a sentence on their influences."""
    return Section("Effects", text, tables=(effect_table("Effects", rows),), folded=folded, part=Part.EFFECTS)


def one_effects_section(sections: Sequence[Section]) -> tuple[Section, ...]:
    """Return sections with those of effects as one: their rows in one table, in the order of the sections."""
    effects = [section for section in sections if section.part is Part.EFFECTS]
    others = tuple(section for section in sections if section.part is not Part.EFFECTS)
    if len(effects) < 2:
        return tuple(sections)
    rows = tuple(row for section in effects for table in section.tables for row in table.rows)
    text = " ".join(section.text for section in effects if section.text)
    table = replace(effects[0].tables[0], rows=rows)
    folded = tuple(table for section in effects for table in section.folded)
    return (*others, replace(effects[0], text=text, tables=(table,), folded=folded))
