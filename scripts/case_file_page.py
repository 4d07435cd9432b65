"""Write the lists of declared fields in docs/case-file.md from the declarations.

Usage: case_file_page.py PAGE
"""

from __future__ import annotations

import re
import sys
from collections import Counter
from collections.abc import Mapping
from dataclasses import MISSING
from pathlib import Path
from textwrap import fill
from types import MappingProxyType

from bounds import Choice
from fe_contact.geometry import Gear, GearPair, RingGear
from lineofaction.gearbox.convert.boundary_names import DECLARED
from lineofaction.gearbox.schemas.case import OF_PAIR
from lineofaction.gearbox.schemas.declared import Figure, figures
from lineofaction.gearbox.schemas.driven_gear import RING
from lineofaction.gearbox.schemas.gear import of_gear

LISTS = {kind: figures(kind) for kind in DECLARED} | {GearPair: OF_PAIR, Gear: of_gear(Gear), RingGear: RING}
BY_NAME = {f"{kind.__module__.partition('.')[0]}.{kind.__name__}": own for kind, own in LISTS.items()}
LIST = re.compile(r"(<!-- fields of ([\w.]+) -->\n\n)(.*?)(\n\n<!-- end of fields -->)", re.DOTALL)
LINE = 120
TABLE = re.compile(r"^(?:#+ )?`(\[\[?[\w.]+\]\]?|\w+(?= = [\[{]))", re.MULTILINE)
USUAL, UNLESS, AS_OF = 5, "Unless stated:", "As of"


def page(text: str) -> str:
    """Return the page with renewed lists; a field that an earlier list describes is not described again."""
    said: dict[str, str] = {}

    def anew(found: re.Match[str]) -> str:
        table = TABLE.findall(text, 0, found.start())[-1]
        return f"{found[1]}{definitions(BY_NAME[found[2]], found[3], said, table)}{found[4]}"

    return LIST.sub(anew, text)


def definitions(
    declared: tuple[Figure, ...], before: str = "", said: dict[str, str] | None = None, table: str = ""
) -> str:
    """Return the list of declared fields, after the entries of others that it had before.

    Bounds and defaults of many fields of one unit are said once. An entry that was `said` of another table is
    not repeated; those of this one are added to them.
    """
    own = {figure.field for figure in declared}
    others = [entry for entry in before.split("\n\n") if entry and not _own(entry, own)]
    usual = _usual(declared)
    known: dict[str, list[str]] = {}
    shown = []
    for figure in declared:
        entry = definition(figure, usual)
        first = table if said is None else said.setdefault(entry, table)
        if first == table:
            shown.append(entry)
        else:
            known.setdefault(first, []).append(f"`{figure.field}`")
    as_before = [_filled(f"{AS_OF} `{first}`: {', '.join(fields)}.") for first, fields in known.items()]
    return "\n\n".join((*others, *_heading(usual), *shown, *as_before))


def _own(entry: str, fields: set[str]) -> bool:
    return entry.startswith((UNLESS, AS_OF)) or entry.partition("\n")[0].strip("`") in fields


def _usual(declared: tuple[Figure, ...]) -> dict[str, str]:
    """Return by the end of a name what at least USUAL fields with it accept and are by default."""
    counts = Counter((_end(figure), f"{accepted(figure)}; {default(figure)}") for figure in declared)
    maximum = {end: max(n for (own, _), n in counts.items() if own == end) for end, _ in counts}
    return {end: text for (end, text), count in counts.items() if count >= USUAL and count == maximum[end]}


def _end(figure: Figure) -> str:
    named = re.search(r"(_length)?_[a-z]+$", figure.field)
    return named[0] if named else figure.field


def _heading(usual: dict[str, str]) -> list[str]:
    text = ". ".join(f"`..{end}`: {text}" for end, text in usual.items())
    return [_filled(f"{UNLESS} {text}.")] if usual else []


def _filled(text: str) -> str:
    return fill(text, LINE, break_on_hyphens=False)


def definition(figure: Figure, usual: Mapping[str, str] = MappingProxyType({})) -> str:
    """Return the entry of a field: its name, meaning, bounds and default.

    Bounds that are `usual`, and a meaning that the name says, are left out.
    """
    bounds = f"{accepted(figure)}; {default(figure)}"
    meaning = "" if _is_named(figure) else f"{figure.what.description}. "
    text = f"{figure.what.description}." if usual.get(_end(figure)) == bounds else f"{meaning}{bounds}."
    lines = fill(text, LINE, initial_indent=": ", subsequent_indent="  ", break_on_hyphens=False)
    return f"`{figure.field}`\n{lines}"


def _is_named(figure: Figure) -> bool:
    """Whether every word of a field's description stands in its name."""
    words = figure.what.description.replace("'", "").lower().split()
    return set(words) <= set(figure.field.split("_"))


def accepted(figure: Figure) -> str:
    """Return the text of the accepted values: an interval, of a choice its names."""
    bound, limits = figure.what.bound, figure.limits
    if bound is None:
        return "`true` or `false`"
    if isinstance(bound, Choice):
        return ", ".join(f'`"{name}"`' for name in bound.names)
    if limits.gt is not None:
        return f"({limits.gt:.7g}, {limits.le:.7g}]"
    return f"[{limits.ge:.7g}, {limits.le:.7g}]"


def default(figure: Figure) -> str:
    """Return the text of the default, as a case file has it."""
    if figure.default is MISSING:
        return "required"
    if figure.default is None:
        return "optional"
    value = figure.boundary_value(figure.default)
    if isinstance(value, bool):
        return f"default `{str(value).lower()}`"
    return f'default `"{value}"`' if isinstance(value, str) else f"default {value:.7g}"


if __name__ == "__main__":
    file = Path(sys.argv[1])
    file.write_text(page(file.read_text("utf-8")), "utf-8")
