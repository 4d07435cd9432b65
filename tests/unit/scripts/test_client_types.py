"""The types of the client's processes are those of the registry, and name no other process."""

from __future__ import annotations

import ast
import importlib.util
from pathlib import Path

from lineofaction.client.processes import Processes
from lineofaction.gearbox.registry import STUDIES

ROOT = Path(__file__).parents[3]
STUB = (ROOT / "lineofaction" / "client" / "processes.pyi").read_text("utf-8")


def test_the_types_are_current() -> None:
    spec = importlib.util.spec_from_file_location("client_types", ROOT / "scripts" / "client_types.py")
    assert spec is not None and spec.loader is not None
    script = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(script)
    again = "python scripts/client_types.py lineofaction/client/processes.pyi"
    assert script.stub() == STUB, f"write them anew: {again}"


def test_every_process_and_no_other_has_types() -> None:
    (declared,) = (node for node in ast.parse(STUB).body if isinstance(node, ast.ClassDef))
    methods = {node.name: node for node in declared.body if isinstance(node, ast.FunctionDef)}
    assert set(methods) == {name for name in vars(Processes) if not name.startswith("_")}
    for study in STUDIES.values():
        named = {argument.arg for argument in methods[study.package].args.kwonlyargs}
        assert named == (set() if study.from_file else set(study.inputs.model_fields))
