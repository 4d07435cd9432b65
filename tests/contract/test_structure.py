"""The structure of the house: no import points up, the picture is drawn from it, and budgets hold."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest
import structure

ROOT = Path(__file__).parents[2]

BUDGETS = {
    ("fe_contact",): (50_000, 940),
    ("dynamics",): (46_044, 920),
    ("lineofaction.gearbox",): (29_300, 600),
    ("lineofaction.report",): (13_400, 250),
    ("service",): (15_300, 361),
    ("lineofaction.client",): (2_944, 55),
    ("lineofaction.cli",): (6_050, 88),
    ("lineofaction.hardcases",): (3_841, 35),
    ("bounds", "host", "model_studies"): (4_549, 157),
}
"""Lines and public names (functions and classes at the top of a file) at most; who raises one says why."""
PAGE = 8_280
"""Lines of scripts, style and markup of the page at most: docs/decisions/0011-page-without-framework.md."""
MOST_FILES = 918
LONGEST = 600
WRITTEN = (".js", ".css", ".html")
MOST_PRIVATE = 225
"""Imports of names with an underscore by tests, at most: the number may only fall."""


@pytest.mark.parametrize("houses", BUDGETS, ids=" ".join)
def test_a_house_keeps_its_budget(houses: tuple[str, ...]) -> None:
    texts = [file.read_text("utf-8") for house in houses for file in structure.files_of(house)]
    lines = sum(text.count("\n") for text in texts)
    names = sum(public_names(text) for text in texts)
    most_lines, most_names = BUDGETS[houses]
    assert (lines <= most_lines, names <= most_names) == (True, True), (lines, names)


def test_the_page_keeps_its_budget() -> None:
    written = [file for file in (ROOT / "service" / "page" / "static").iterdir() if file.suffix in WRITTEN]
    sizes = {file.name: file.read_text("utf-8").count("\n") for file in written}
    assert len(sizes) > 50 and sum(sizes.values()) <= PAGE, sum(sizes.values())
    assert {name for name, size in sizes.items() if size > LONGEST} == set()


def test_files_are_few_and_none_is_long() -> None:
    files = [file for house in structure.HOUSES for file in structure.files_of(house)]
    assert len(files) <= MOST_FILES
    sizes = {str(file.relative_to(ROOT)): file.read_text("utf-8").count("\n") for file in files}
    assert {name for name, size in sizes.items() if size > LONGEST} == set()


def test_tests_import_fewer_and_fewer_private_names() -> None:
    imported = (name for file in (ROOT / "tests").rglob("*.py") for name in structure.imported(file))
    private = [name for name in imported if name.rpartition(".")[2].startswith("_")]
    assert len(private) <= MOST_PRIVATE, private


@pytest.mark.law
def test_every_house_is_on_a_floor_and_no_import_points_up() -> None:
    packages = {path.parent.name for path in ROOT.glob("*/py.typed")} - {"lineofaction"}
    packages |= {f"lineofaction.{path.parent.name}" for path in (ROOT / "lineofaction").glob("*/__init__.py")}
    assert packages == set(structure.HOUSES)
    assert structure.upward() == []


@pytest.mark.law
def test_the_picture_is_drawn_from_the_imports() -> None:
    drawn = (ROOT / "docs" / "images" / "structure.svg").read_text("utf-8")
    assert drawn == structure.drawing(), "python scripts/structure.py docs/images/structure.svg"


def public_names(text: str) -> int:
    """Count functions and classes at the top of a file without an underscore."""
    kinds = (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)
    return sum(isinstance(node, kinds) and not node.name.startswith("_") for node in ast.parse(text).body)
