"""The structure of the house: no import points up, the picture is drawn from it, and no file is long."""

import ast
from collections import Counter
from importlib import import_module
from pathlib import Path

import line_growth
import pytest
import structure
from repository import ROOT

import host
from lineofaction.gearbox import schemas

LONGEST = 600
WRITTEN = (".js", ".css", ".html")
MAX_PRIVATE = 60
"""Imports of names with an underscore by tests, at most: the number may only fall."""
WITHOUT_SUBJECT = {
    *(
        "Of",
        "That",
        "Those",
        "Where",
        "What",
        "How",
        "By",
        "At",
        "On",
        "In",
        "With",
        "For",
        "From",
        "To",
        "As",
    ),
    *("If", "Which", "And", "Its", "Their", "It"),
}
"""First words of texts that leave out what they describe."""
DEFINITIONS = (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)


def test_no_file_is_long():
    page = (ROOT / "service" / "page" / "static").iterdir()
    files = [file for house in structure.HOUSES for file in structure.files_of(house)]
    files += [file for file in page if file.suffix in WRITTEN]
    sizes = {str(file.relative_to(ROOT)): file.read_text("utf-8").count("\n") for file in files}
    assert len(sizes) > 900
    assert {name for name, size in sizes.items() if size > LONGEST} == set()


def test_growth_is_told_by_subject():
    changes = [("dynamics/meshes", 150, 20), ("service/live", 3, 200), ("host/files.py", 1, 1)]
    today = Counter({"dynamics/meshes": 400, "service/live": 100, "bounds": 7})
    told = line_growth.table(today, iter(changes))
    assert told.split("\n") == [
        "    507 lines, +154 -221",
        "    400 dynamics/meshes  +150 -20",
        "    100 service/live  +3 -200",
    ]
    names = ("lineofaction/gearbox/schemas/scene.py", "lineofaction/gearbox/units.py", "host/files.py")
    subjects = [line_growth.subject_of(Path(name)) for name in names]
    assert subjects == ["lineofaction/gearbox/schemas", "lineofaction/gearbox/units.py", "host/files.py"]
    whole = sum(
        file.read_text("utf-8").count("\n")
        for house in structure.HOUSES
        for file in structure.files_of(house)
    )
    assert line_growth.lines_of_today().total() == whole


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


def test_the_description_of_a_field_stands_below_it():
    files = (file for house in structure.HOUSES for file in structure.files_of(house))
    assert [name for file in files for name in described_twice(file)] == []


def fragments(code: str) -> list[str]:
    """Return texts of modules, classes, functions and fields that begin with no noun or verb of their own."""
    bodies = (getattr(node, "body", None) for node in ast.walk(ast.parse(code)))
    statements = (node for body in bodies if isinstance(body, list) for node in body)
    texts = (
        node.value.value.strip()
        for node in statements
        if isinstance(node, ast.Expr)
        and isinstance(node.value, ast.Constant)
        and isinstance(node.value.value, str)
    )
    return [text.partition("\n")[0] for text in texts if text.partition(" ")[0] in WITHOUT_SUBJECT]


def test_a_text_begins_with_its_subject():
    """What is described stands first: a text below a field is read without the field beside it."""
    assert fragments('WIDTH = 3\n"""Of the face, mm."""\n') == ["Of the face, mm."]
    assert fragments('WIDTH = 3\n"""Width of the face, mm."""\n') == []
    files = (file for house in structure.HOUSES for file in structure.files_of(house))
    found = {str(file.relative_to(ROOT)): fragments(file.read_text("utf-8")) for file in files}
    assert {file: texts for file, texts in found.items() if texts} == {}


def second_heads(code: str) -> list[str]:
    """Return comments that stand alone at the margin below the first definition: a second subject."""
    lines = code.split("\n")
    first = next((node.lineno for node in ast.parse(code).body if isinstance(node, DEFINITIONS)), len(lines))
    heads, above = [], "\n"
    for number, line in enumerate(lines, 1):
        begins = line.startswith("#") and not above
        if begins and number > first and _block_stands_alone(lines[number:]):
            heads.append(line)
        above = line
    return heads


def _block_stands_alone(below: list[str]) -> bool:
    """Whether a blank line follows the rest of a comment."""
    return next((line for line in below if not line.startswith("#")), "x") == ""


def late_constants(code: str) -> list[str]:
    """Return constants below the first definition that could stand above it.

    One that reads a definition, directly or by another constant, has to stand below; so does a name that is
    bound twice.
    """
    body = ast.parse(code).body
    first = next((number for number, node in enumerate(body) if isinstance(node, DEFINITIONS)), len(body))
    bound = Counter(name for node in body for name in _bound_by(node))
    below = {
        name
        for node in body[first:]
        if not isinstance(node, ast.Assign | ast.AnnAssign)
        for name in _bound_by(node)
    }
    late = []
    for node in body[first:]:
        if isinstance(node, ast.Assign | ast.AnnAssign) and (names := _bound_by(node)):
            read = {part.id for part in ast.walk(node) if isinstance(part, ast.Name)} - names
            if read & below or any(bound[name] > 1 for name in names):
                below |= names
            else:
                late += sorted(names)
    return late


def _bound_by(node: ast.stmt) -> set[str]:
    """Return the names that a statement of a module binds: imports, definitions, constants."""
    if isinstance(node, DEFINITIONS):
        return {node.name}
    if isinstance(node, ast.Import | ast.ImportFrom):
        return {(alias.asname or alias.name).partition(".")[0] for alias in node.names}
    if isinstance(node, ast.TypeAlias if hasattr(ast, "TypeAlias") else ()):
        return {node.name.id}
    stored = (
        part for part in ast.walk(node) if isinstance(part, ast.Name) and isinstance(part.ctx, ast.Store)
    )
    return {part.id for part in stored}


def test_a_file_has_one_head():
    """Two subjects are two files."""
    code = "# of all\n\ndef f(): ...\n\n\n# a note on g\ndef g(): ...\n\n\n# More\n\n\ndef h(): ...\n"
    assert second_heads(code) == ["# More"]
    files = {
        file: second_heads(file.read_text("utf-8"))
        for house in structure.HOUSES
        for file in structure.files_of(house)
    }
    heads = [f"{file.relative_to(ROOT)}: {head}" for file, found in files.items() for head in found]
    assert heads == []


def test_constants_stand_above_the_first_definition():
    code = "A = 1\n\n\ndef f(): ...\n\n\nB = f()\nC = A\nD = B\nE: int = 2\n"
    assert late_constants(code) == ["C", "E"]
    files = {
        file: late_constants(file.read_text("utf-8"))
        for house in structure.HOUSES
        for file in structure.files_of(house)
    }
    assert {str(file.relative_to(ROOT)): names for file, names in files.items() if names} == {}


def test_tests_import_fewer_and_fewer_private_names():
    imported = (name for file in (ROOT / "tests").rglob("*.py") for name in structure.imported(file))
    private = [name for name in imported if name.rpartition(".")[2].startswith("_")]
    assert len(private) <= MAX_PRIVATE, private


@pytest.mark.law
def test_every_house_is_on_a_floor_and_no_import_points_up():
    packages = {path.parent.name for path in ROOT.glob("*/py.typed")} - {"lineofaction"}
    packages |= {f"lineofaction.{path.parent.name}" for path in (ROOT / "lineofaction").glob("*/__init__.py")}
    assert packages == set(structure.HOUSES)
    assert structure.upward() == []


@pytest.mark.law
def test_the_picture_is_drawn_from_the_imports():
    drawn = (ROOT / "docs" / "images" / "structure.svg").read_text("utf-8")
    assert drawn == structure.drawing(), "python scripts/structure.py docs/images/structure.svg"


def test_names_imported_on_first_use_are_there():
    """A table says by text where each stands: no checker of types reads it."""
    for package in (host, schemas):
        modules = {name: f"{package.__name__}.{module}" for name, module in package.HOMES.items()}
        missing = [name for name, module in modules.items() if not hasattr(import_module(module), name)]
        assert missing == []
