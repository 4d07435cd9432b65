"""Make the page of validation from the figures that the tests recorded.

Usage: validation_page.py RECORDS PAGE
"""

from __future__ import annotations

import json
import re
import sys
import textwrap
from collections.abc import Iterable
from itertools import groupby
from pathlib import Path
from typing import Any

Record = dict[str, Any]

KINDS = {
    "validation": "Against published and independently computed results",
    "verification": "Against exact solutions",
    "properties": "Laws over random cases",
    "stability": "Hard cases",
    "unit": "Parts",
}
INTRODUCTION = """# Validation

What the tests measured, beside what they ask for. This page is generated: `./scripts/test` records the
figures, `./scripts/validation-page` writes them here. The tests named above each table assert them.
"""


def page(records: Iterable[Record]) -> str:
    """Return the page: kinds in the order of `KINDS`, others after them; a table per test and source."""
    parts = [INTRODUCTION]
    for kind, of_kind in groupby(sorted(records, key=_place), key=lambda record: str(record["kind"])):
        parts.append(f"## {KINDS.get(kind, kind.capitalize())}\n")
        for (file, source), group in groupby(of_kind, key=_origin):
            rows = "\n".join(_row(record) for record in group)
            head = "| what | measured | target | unit |\n|---|---:|---:|---|"
            origin = textwrap.fill(
                f"{source} (`{file}`)", 120, break_long_words=False, break_on_hyphens=False
            )
            parts.append(f"{origin}\n\n{head}\n{rows}\n")
    return "\n".join(parts)


def _place(record: Record) -> tuple[object, ...]:
    """Order on the page; numbers inside names count as numbers."""
    order = [*KINDS]
    kind = str(record["kind"])
    rank = order.index(kind) if kind in order else len(order)
    pieces = re.split(r"(\d+\.?\d*)", str(record["name"]))
    name = tuple((float(piece), "") if k % 2 else (0.0, piece) for k, piece in enumerate(pieces))
    return rank, kind, *_origin(record), name


def _origin(record: Record) -> tuple[str, str]:
    """File of the test and source of the target."""
    return str(record["test"]).partition("::")[0], str(record["source"])


def _row(record: Record) -> str:
    """One figure as a row; a bar inside a cell would end it."""
    target = record["target"]
    goal = target if isinstance(target, str) else f"{target:.6g}"
    unit = "" if record["unit"] in ("1", "-") else record["unit"]
    cells = (record["name"], f"{record['value']:.6g}", goal, unit)
    return "| " + " | ".join(str(cell).replace("|", "\\|") for cell in cells) + " |"


def main(arguments: list[str]) -> int:
    """Read the records and write the page."""
    folder, target = Path(arguments[0]), Path(arguments[1])
    records = [json.loads(path.read_text(encoding="utf-8")) for path in sorted(folder.glob("*.json"))]
    if not records:
        sys.stderr.write(f"no figures in {folder}: run ./scripts/test first\n")
        return 1
    target.write_text(page(records), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
