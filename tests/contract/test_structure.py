"""The structure of the house: no import points up, the picture is drawn from it, and no file is long."""

from __future__ import annotations

import ast
from collections import Counter
from pathlib import Path

import growth
import pytest
import structure

ROOT = Path(__file__).parents[2]

LONGEST = 600
WRITTEN = (".js", ".css", ".html")
MOST_PRIVATE = 60
"""Imports of names with an underscore by tests, at most: the number may only fall."""


def test_no_file_is_long() -> None:
    page = (ROOT / "service" / "page" / "static").iterdir()
    files = [file for house in structure.HOUSES for file in structure.files_of(house)]
    files += [file for file in page if file.suffix in WRITTEN]
    sizes = {str(file.relative_to(ROOT)): file.read_text("utf-8").count("\n") for file in files}
    assert len(sizes) > 900
    assert {name for name, size in sizes.items() if size > LONGEST} == set()


def test_growth_is_told_by_subject() -> None:
    changes = [("dynamics/meshes", 150, 20), ("service/live", 3, 200), ("host/files.py", 1, 1)]
    told = growth.table(Counter({"dynamics/meshes": 400, "service/live": 100, "bounds": 7}), iter(changes))
    assert told.split("\n") == [
        "    507 lines, +154 -221",
        "    400 dynamics/meshes  +150 -20",
        "    100 service/live  +3 -200",
    ]
    names = ("lineofaction/gearbox/schemas/scene.py", "lineofaction/gearbox/units.py", "host/files.py")
    subjects = [growth.subject_of(Path(name)) for name in names]
    assert subjects == ["lineofaction/gearbox/schemas", "lineofaction/gearbox/units.py", "host/files.py"]
    whole = sum(
        file.read_text("utf-8").count("\n")
        for house in structure.HOUSES
        for file in structure.files_of(house)
    )
    assert growth.lines_of_today().total() == whole


def described_twice(file: Path) -> list[str]:
    """Return classes whose docstring lists a field of theirs: its description stands below the field."""
    found = []
    for node in ast.walk(ast.parse(file.read_text("utf-8"))):
        if not isinstance(node, ast.ClassDef):
            continue
        listed = (ast.get_docstring(node) or "").partition("Attributes\n----------\n")[2]
        entries = [line.split(" : ")[0] for line in listed.split("\n") if " : " in line]
        names = {name for entry in entries for name in entry.split(", ")}
        fields = [part.target for part in node.body if isinstance(part, ast.AnnAssign)]
        if names and names <= {field.id for field in fields if isinstance(field, ast.Name)}:
            found.append(f"{file.name}: {node.name}")
    return found


def test_the_description_of_a_field_stands_below_it() -> None:
    files = (file for house in structure.HOUSES for file in structure.files_of(house))
    assert [name for file in files for name in described_twice(file)] == []


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
