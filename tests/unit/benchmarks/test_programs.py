"""Programs that benchmarks keep as texts, for processes of their own, import what there is."""

import ast
import re
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path

BENCHMARKS = Path(__file__).parents[3] / "benchmarks"
OURS = "fe_contact|dynamics|lineofaction|service|bounds|host|model_studies"
IMPORT = re.compile(rf"^from ((?:{OURS})(?:\.\w+)*) import ([\w, ]+)$", re.MULTILINE)


def imports() -> Iterator[tuple[str, str, str]]:
    for file in sorted(BENCHMARKS.glob("*.py")):
        for node in ast.walk(ast.parse(file.read_text("utf-8"))):
            text = node.value if isinstance(node, ast.Constant) and isinstance(node.value, str) else ""
            for module, names in IMPORT.findall(text):
                yield from ((file.name, module, name) for name in names.split(", "))


def test_programs_import_what_there_is():
    stated = list(imports())
    assert len(stated) > 20
    missing = [(file, module, name) for file, module, name in stated if not _there(module, name)]
    assert missing == []


def _there(module: str, name: str) -> bool:
    try:
        return hasattr(import_module(module), name)
    except ModuleNotFoundError:
        return False
