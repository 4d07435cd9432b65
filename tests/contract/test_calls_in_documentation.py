"""Documentation: what it shows in Python can be called so, and its pages are readable as text too."""

import ast
import inspect
import re
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest
from repository import ROOT

import lineofaction as loa
from fe_contact import analyze
from fe_contact.keywords import TableKeywords

PAGES = sorted(
    page
    for page in (ROOT / "README.md", *(ROOT / "docs").rglob("*.md"))
    if re.search(
        r"```python\n.*?^(from (fe_contact|dynamics|service)|import lineofaction)",
        page.read_text("utf-8"),
        re.M | re.S,
    )
)


def examples(page: Path) -> Iterator[ast.Module]:
    """Return the blocks in Python that import something; sketches of signatures do not."""
    for block in re.findall(r"```python\n(.*?)```", page.read_text("utf-8"), re.DOTALL):
        if "import " in block:
            yield ast.parse(block)


def imported(example: ast.Module) -> dict[str, Any]:
    """Import what an example imports of the project; names of ``loa`` under ``loa.NAME``."""
    return {f"loa.{name}": getattr(loa, name) for name in loa.__all__} | {
        alias.asname or alias.name: getattr(import_module(node.module), alias.name)
        for node in ast.walk(example)
        if isinstance(node, ast.ImportFrom) and node.module
        if node.module.partition(".")[0]
        in ("fe_contact", "dynamics", "lineofaction", "service", "verification")
        for alias in node.names
    }


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_every_call_fits_its_signature(page):
    for example in examples(page):
        names = imported(example)
        for call in (node for node in ast.walk(example) if isinstance(node, ast.Call)):
            if (name := ast.unparse(call.func)) in names:
                keywords = {one.arg: None for one in call.keywords if one.arg}
                inspect.signature(names[name]).bind(*call.args, **keywords)
                if getattr(names[name], "__name__", "") == "analyze":
                    known = {*TableKeywords.__annotations__, *inspect.signature(analyze).parameters}
                    assert keywords.keys() <= known


def test_pages_with_examples_are_found():
    assert {"README.md", "flank-results.md", "studies.md", "accuracy.md"} <= {page.name for page in PAGES}


ALL_PAGES = [*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md")]
LINE, CELL = 120, 240


@pytest.mark.parametrize("page", ALL_PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_lines_and_cells_are_short(page):
    lines = page.read_text("utf-8").splitlines()
    rows = [line for line in lines if line.startswith("|")]
    assert [line for line in lines if len(line) > LINE and line not in rows] == []
    assert [cell for row in rows for cell in row.split("|") if len(cell) > CELL] == []


SITE = [
    page for page in ALL_PAGES if page.parent.name in ("docs", "how-to", "theory", "tutorials", "reference")
]


@pytest.mark.parametrize("page", SITE, ids=lambda page: str(page.relative_to(ROOT)))
def test_a_formula_is_closed_in_its_item(page):
    """A line that begins with a minus inside a formula is an item of a list to Markdown."""
    prose = re.sub(
        r"^```.*?^```|\$\$.*?\$\$|`[^`\n]*`|^    .*?$", "", page.read_text("utf-8"), flags=re.M | re.S
    )
    items = re.split(r"\n\n|\n(?= *(?:[-+*]|\d+\.) )", prose)
    assert [item for item in items if item.count("$") % 2] == []


def test_pages_are_found():
    assert len(ALL_PAGES) > 80
