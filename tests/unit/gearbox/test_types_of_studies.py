"""The types of the client's processes and of Python's functions are those of the studies of their names."""

from __future__ import annotations

import ast
from pathlib import Path

from lineofaction.client.processes import Processes
from lineofaction.gearbox.registry import STUDIES, Study

ROOT = Path(__file__).parents[3]
BY_SUBJECT = {"case": "_of_case", "scene": "_of_scene", "case or scene": "_of_either"}
FROM_FILE = {"optimize": "_case_and_file", "study": "_scene_and_file", "deflect": "_scene_perhaps_file"}


def declared(file: str) -> dict[str, ast.expr | None]:
    """Return what the names are made of that only a type checker sees."""
    found: dict[str, ast.expr | None] = {}
    tree = ast.parse((ROOT / file).read_text("utf-8"))
    for node in (part for block in ast.walk(tree) if isinstance(block, ast.If) for part in block.body):
        if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
            found[node.target.id] = node.value
        if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name):
            found[node.targets[0].id] = node.value
    return found


def called(study: Study) -> str:
    """Return how the type of a process is written."""
    work = study.package.upper()
    if study.from_file:
        return f"_as({work}, {FROM_FILE[study.package]})"
    return f"{BY_SUBJECT[study.subject]}({work}, {work}.inputs)"


def test_every_process_has_the_type_of_its_study() -> None:
    types = declared("lineofaction/client/processes.py")
    assert {name for name in types if name.islower()} == {n for n in vars(Processes) if not n.startswith("_")}
    for study in STUDIES.values():
        assert ast.unparse(types[study.package] or ast.Pass()) == called(study)
        assert FROM_FILE.get(study.package, "").endswith("perhaps_file") == study.bare


def test_every_function_has_the_type_of_its_study() -> None:
    types = declared("lineofaction/gearbox/workbench.py")
    for study in STUDIES.values():
        assert ast.unparse(types[study.package] or ast.Pass()) == f"_function({study.package.upper()})"
