"""Write the tables of declared fields in docs/case-file.md from the declarations.

Usage: case_file_page.py PAGE
"""

from __future__ import annotations

import re
import sys
from dataclasses import MISSING
from pathlib import Path

from bounds import Choice
from fe_contact.geometry import Gear, GearPair, RingGear
from service.convert.vocabulary import DECLARED
from service.schemas.case import OF_PAIR
from service.schemas.declared import Figure, figures
from service.schemas.gear import of_gear
from service.schemas.wheel import RING

TABLES = {kind: figures(kind) for kind in DECLARED} | {GearPair: OF_PAIR, Gear: of_gear(Gear), RingGear: RING}
BY_NAME = {f"{kind.__module__.partition('.')[0]}.{kind.__name__}": own for kind, own in TABLES.items()}
TABLE = re.compile(r"(<!-- fields of ([\w.]+) -->\n)(.*?)(<!-- end of fields -->)", re.DOTALL)
HEAD = "| field | meaning | accepted | default |\n|---|---|---|---|\n"


def page(text: str) -> str:
    """Return the page with its tables anew."""
    return TABLE.sub(lambda found: f"{found[1]}{table(BY_NAME[found[2]], found[3])}{found[4]}", text)


def table(declared: tuple[Figure, ...], before: str = "") -> str:
    """Return the table of declared fields, after the rows of others that it had before."""
    own = {f"| `{figure.field}`" for figure in declared}
    lines = before.splitlines(keepends=True)
    others = [line for line in lines if line.startswith("| `") and line.partition(" | ")[0] not in own]
    return HEAD + "".join((*others, *(f"{row(figure)}\n" for figure in declared)))


def row(figure: Figure) -> str:
    """Return the row of a field."""
    cells = (
        f"`{figure.field}`",
        figure.what.description,
        accepted(figure),
        written(figure),
    )
    return f"| {' | '.join(cells)} |"


def accepted(figure: Figure) -> str:
    """Say what is accepted."""
    bound, limits = figure.what.bound, figure.limits
    if bound is None:
        return "`true`, `false`"
    if isinstance(bound, Choice):
        return ", ".join(f'`"{name}"`' for name in bound.names)
    low = f"above {limits['gt']:.7g}, up" if "gt" in limits else f"{limits['ge']:.7g}"
    return f"{low} to {limits['le']:.7g}"


def written(figure: Figure) -> str:
    """Write a default as a case file has it."""
    if figure.default is MISSING:
        return "required"
    if figure.default is None:
        return "left out"
    default = figure.own(figure.default)
    if isinstance(default, bool):
        return f"`{str(default).lower()}`"
    return f'`"{default}"`' if isinstance(default, str) else f"{default:.7g}"


if __name__ == "__main__":
    file = Path(sys.argv[1])
    file.write_text(page(file.read_text("utf-8")), "utf-8")
