"""Modules and their names that stand in texts are there: what is loaded on demand, started, or referred to.

A text is not followed by a rename as an import is, nor seen by the checker of types: a request that needs it
answers 500.
"""

import ast
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest
from repository import ROOT

from lineofaction.cli.commands import FAMILIES
from lineofaction.cli.verbs import Later

PACKAGES = (
    "bounds",
    "dynamics",
    "fe_contact",
    "host",
    "lineofaction",
    "model_studies",
    "service",
    "verification",
)
BESIDE = ("Dockerfile", "compose.yaml", "deploy", "pyproject.toml", "scripts")
NAME = re.compile(
    rf"(?:[\"'`]|-m )((?:{'|'.join(PACKAGES)})(?:\.[A-Za-z_]\w*)+)(?::([A-Za-z_]\w*))?(?=[\"'`]|\s|$)"
)
"""In quotes, or behind ``python -m``; ``module:function`` is called, ``module.name`` is referred to."""
OTHERS = (
    "lineofaction.gearbox.studies.NAME",
    "service.id",
    "service.lock",
    "service.log",
    "service.name",
    "service.sqlite3",
)
"""Any study, files of a data directory, an attribute of OpenTelemetry."""


@cache
def defined(module: str) -> set[str] | None:
    """Return what a module defines or imports, None without it; "*" if it answers for any name."""
    place = ROOT.joinpath(*module.split("."))
    file = place / "__init__.py" if place.is_dir() else place.with_suffix(".py")
    if not file.is_file():
        return set() if place.is_dir() else None
    names: set[str] = set()
    for node in of_module(ast.parse(file.read_bytes()).body):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
            names.add("*" if node.name == "__getattr__" else node.name)
        elif isinstance(node, ast.Import | ast.ImportFrom):
            names |= {(alias.asname or alias.name).partition(".")[0] for alias in node.names}
        else:
            names |= {part.id for part in ast.walk(node) if isinstance(part, ast.Name)}
    return names


def of_module(body: list[ast.stmt]) -> Iterator[ast.stmt]:
    for node in body:
        yield from of_module([*node.body, *node.orelse]) if isinstance(node, ast.If) else [node]


def is_there(text: str, called: str = "") -> bool:
    """Whether a text names a module, or a name in one, and this has the name that is `called`."""
    if (names := defined(text)) is not None:
        return not called or called in names or "*" in names
    module, _, name = text.rpartition(".")
    return bool(module) and not called and is_there(module, name)


def stale(content: str) -> Iterator[str]:
    for found in NAME.finditer(content):
        if not is_there(found[1], found[2] or "") and found[1] not in OTHERS:
            yield found[0]


def texts() -> Iterator[Path]:
    """Yield the files of the packages, and those that build, start and deploy them."""
    for place in (*PACKAGES, *BESIDE):
        found = (ROOT / place, *ROOT.joinpath(place).rglob("*"))
        yield from (file for file in found if file.is_file() and file.suffix in ("", ".py", ".toml", ".yaml"))


@pytest.mark.law
def test_what_texts_name_is_there():
    files = {file: file.read_text("utf-8") for file in texts()}
    assert sum(bool(NAME.search(content)) for content in files.values()) > 50
    found = {str(file.relative_to(ROOT)): list(stale(content)) for file, content in files.items()}
    assert {file: names for file, names in found.items() if names} == {}


@pytest.mark.parametrize(
    "text",
    [
        'on_demand("service.worker.preparations:prepare_analysis")',
        'on_demand("service.worker.preparation:prepare_analyze")',
        'WORK = "service.reading.children"',
        "see `service.worker.process.no_such_thing`",
        'CMD ["python", "-m", "service.serve"]',
        "python -m service.serve",
        'loa = "lineofaction.cli:run"',
    ],
)
def test_a_name_that_is_gone_is_found(text):
    assert len(list(stale(text))) == 1


def test_modules_that_verbs_load_later_are_those_that_the_types_name():
    """A verb of `loa` would end with a traceback; the checker of types reads the imports beside the texts."""
    for family in FAMILIES:
        tree = ast.parse(Path(str(family.__file__)).read_bytes())
        imports = [node for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)]
        typed = {
            alias.asname or alias.name: f"{node.module}.{alias.name}"
            for node in imports
            for alias in node.names
        }
        later = {name: part for name, part in vars(family).items() if isinstance(part, Later)}
        assert {name: vars(part)["_module"] for name, part in later.items()} == {
            name: typed[name] for name in later
        }
        assert later and all(defined(typed[name]) is not None for name in later)
