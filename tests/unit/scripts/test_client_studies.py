"""The types of the client's methods of studies are those of the registry, and name no other method."""

from __future__ import annotations

import ast
import importlib.util
from pathlib import Path

from service.client.studies import Studies
from service.registry import FORMER, STUDIES

ROOT = Path(__file__).parents[3]
STUB = (ROOT / "service" / "client" / "studies.pyi").read_text("utf-8")


def test_the_types_are_current() -> None:
    spec = importlib.util.spec_from_file_location("client_studies", ROOT / "scripts" / "client_studies.py")
    assert spec is not None and spec.loader is not None
    script = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(script)
    again = "python scripts/client_studies.py service/client/studies.pyi"
    assert script.stub() == STUB, f"write them anew: {again}"


def test_every_method_and_no_other_has_types() -> None:
    (declared,) = (node for node in ast.parse(STUB).body if isinstance(node, ast.ClassDef))
    methods = {node.name: node for node in declared.body if isinstance(node, ast.FunctionDef)}
    assert set(methods) == {name for name in vars(Studies) if not name.startswith("_")} - FORMER.keys()
    for study in STUDIES.values():
        for name in (study.package, f"{study.package}_file"):
            named = {argument.arg for argument in methods[name].args.kwonlyargs}
            assert named == (set() if study.from_file else set(study.inputs.model_fields))
