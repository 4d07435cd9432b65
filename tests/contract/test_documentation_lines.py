"""Pages are readable as text too: no long lines, no pages inside cells, no script from elsewhere."""

from __future__ import annotations

from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PAGES = [*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md")]
LINE, CELL = 120, 240


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_lines_and_cells_are_short(page: Path) -> None:
    lines = page.read_text("utf-8").splitlines()
    rows = [line for line in lines if line.startswith("|")]
    assert [line for line in lines if len(line) > LINE and line not in rows] == []
    assert [cell for row in rows for cell in row.split("|") if len(cell) > CELL] == []


def test_pages_are_found() -> None:
    assert len(PAGES) > 80
