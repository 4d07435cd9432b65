"""Write the lists of declared fields in docs/case-file.md from the declarations.

Usage: case_file_page.py PAGE
"""

from __future__ import annotations

import re
import sys
from dataclasses import MISSING
from pathlib import Path
from textwrap import fill

from bounds import Choice
from fe_contact.geometry import Gear, GearPair, RingGear
from lineofaction.gearbox.convert.errors import DECLARED
from lineofaction.gearbox.schemas.case import OF_PAIR, RING
from lineofaction.gearbox.schemas.declared import Figure, figures
from lineofaction.gearbox.schemas.gear import of_gear

LISTS = {kind: figures(kind) for kind in DECLARED} | {GearPair: OF_PAIR, Gear: of_gear(Gear), RingGear: RING}
BY_NAME = {f"{kind.__module__.partition('.')[0]}.{kind.__name__}": own for kind, own in LISTS.items()}
LIST = re.compile(r"(<!-- fields of ([\w.]+) -->\n\n)(.*?)(\n\n<!-- end of fields -->)", re.DOTALL)
LINE = 120


def page(text: str) -> str:
    """Return the page with its lists anew."""
    return LIST.sub(lambda found: f"{found[1]}{definitions(BY_NAME[found[2]], found[3])}{found[4]}", text)


def definitions(declared: tuple[Figure, ...], before: str = "") -> str:
    """Return the list of declared fields, after the entries of others that it had before."""
    own = {f"`{figure.field}`" for figure in declared}
    others = [entry for entry in before.split("\n\n") if entry and entry.partition("\n")[0] not in own]
    return "\n\n".join((*others, *map(definition, declared)))


def definition(figure: Figure) -> str:
    """Return the entry of a field: its name; what it means, accepts and is if left out."""
    text = f"{figure.what.description}. {accepted(figure)}; {default(figure)}."
    lines = fill(text, LINE, initial_indent=": ", subsequent_indent="  ", break_on_hyphens=False)
    return f"`{figure.field}`\n{lines}"


def accepted(figure: Figure) -> str:
    """Say what is accepted."""
    bound, limits = figure.what.bound, figure.limits
    if bound is None:
        return "`true` or `false`"
    if isinstance(bound, Choice):
        return ", ".join(f'`"{name}"`' for name in bound.names)
    if limits.gt is not None:
        return f"Above {limits.gt:.7g}, at most {limits.le:.7g}"
    return f"{limits.ge:.7g} to {limits.le:.7g}"


def default(figure: Figure) -> str:
    """Say what the field is if it is left out, as a case file has it."""
    if figure.default is MISSING:
        return "required"
    if figure.default is None:
        return "optional"
    value = figure.own(figure.default)
    if isinstance(value, bool):
        return f"default `{str(value).lower()}`"
    return f'default `"{value}"`' if isinstance(value, str) else f"default {value:.7g}"


if __name__ == "__main__":
    file = Path(sys.argv[1])
    file.write_text(page(file.read_text("utf-8")), "utf-8")
