"""The types of a study, of its function and of the client's process follow from its row of the registry."""

from __future__ import annotations

import ast
from inspect import signature
from pathlib import Path

import lineofaction as loa
from lineofaction.client import AsyncLineOfActionClient, AsyncProcess, LineOfActionClient, Process
from lineofaction.gearbox import registry
from lineofaction.gearbox.registry import STUDIES

TREE = ast.parse(Path(registry.__file__).read_text("utf-8"))


def test_every_row_has_the_types_of_its_own_work() -> None:
    """The names of its lambda are those of its package; only a type checker sees what they stand for."""
    works = {
        name.asname: node.module
        for node in ast.walk(TREE)
        if isinstance(node, ast.ImportFrom)
        for name in node.names
        if name.name == "RUN"
    }
    (studies,) = (node for node in TREE.body if isinstance(node, ast.ClassDef) and node.name == "Studies")
    named = {}
    for row in (node for node in studies.body if isinstance(node, ast.Assign)):
        (work,) = (node.body for node in ast.walk(row) if isinstance(node, ast.Lambda))
        named[ast.unparse(row.targets[0])] = works[ast.unparse(work)]
    assert named == {
        row.package: f"lineofaction.gearbox.studies.{row.package}.run" for row in STUDIES.values()
    }
    assert all(type(row.run).inputs is row.inputs for row in STUDIES.values())


def test_every_row_is_the_function_of_its_name() -> None:
    assert registry.__all__ == sorted(row.package for row in STUDIES.values())
    for row in STUDIES.values():
        assert getattr(loa, row.package) is getattr(registry, row.package) is row
        assert next(iter(signature(row).parameters)) == "subject"


def test_every_row_is_a_process_of_both_clients() -> None:
    blocking, awaited = LineOfActionClient(), AsyncLineOfActionClient()
    for row in STUDIES.values():
        assert isinstance(getattr(blocking, row.package), Process)
        assert isinstance(getattr(awaited, row.package), AsyncProcess)
        assert str(signature(blocking.process(row))) == str(signature(getattr(awaited, row.package)))
        assert row.package in dir(blocking) and row.package in dir(loa)
        assert (row.takes.subject == "case or scene") == (row.argument == "subject")


def test_what_a_file_of_inputs_is_called_and_whether_it_may_be_left_out_are_those_of_the_types() -> None:
    filed = {row.name: row.takes.bare for row in STUDIES.values() if row.takes.from_file}
    assert filed == {"optimize": False, "change": False, "deflect": True, "study": False}
