"""Make docs/validation.md from the figures that the tests recorded.

Usage: validation_page.py RECORDS PAGE
"""

from __future__ import annotations

import json
import sys
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
figures, `./scripts/validation-page` writes them here. The tests named in the last column assert them.
"""


def page(records: Iterable[Record]) -> str:
    """Return the page: one table per kind of test, in the order of `KINDS`, others after them."""
    order = [*KINDS]
    by_kind = sorted(records, key=lambda r: (_rank(order, r["kind"]), r["kind"], r["test"], r["name"]))
    parts = [INTRODUCTION]
    for kind, group in groupby(by_kind, key=lambda r: str(r["kind"])):
        rows = [_row(record) for record in group]
        head = "| what | measured | unit | target | source | test |\n|---|---:|---|---|---|---|"
        parts.append(f"## {KINDS.get(kind, kind.capitalize())}\n\n{head}\n" + "\n".join(rows) + "\n")
    return "\n".join(parts)


def _rank(order: list[str], kind: str) -> int:
    """Place of a kind of test on the page."""
    return order.index(kind) if kind in order else len(order)


def _row(record: Record) -> str:
    """One figure as a row; a bar inside a cell would end it."""
    target = record["target"]
    goal = target if isinstance(target, str) else f"{target:.6g}"
    test = str(record["test"]).partition("::")[0]
    cells = (record["name"], f"{record['value']:.4g}", record["unit"], goal, record["source"], f"`{test}`")
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
