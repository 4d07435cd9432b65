"""No module of ours imports itself by way of others, for its types neither."""

from __future__ import annotations

import ast
from collections.abc import Collection, Iterator
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PACKAGES = ("host", "bounds", "model_studies", "fe_contact", "dynamics", "lineofaction", "service")


def module_name(path: Path) -> str:
    return ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")


def imported(tree: ast.AST, modules: Collection[str]) -> Iterator[str]:
    """What is imported as a module loads or its types are checked, not when a function is called."""
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, "imports are absolute"
            names = ((f"{node.module}.{alias.name}", str(node.module)) for alias in node.names)
            yield from (whole if whole in modules else package for whole, package in names)
        elif not isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            yield from imported(node, modules)


@pytest.mark.law
def test_imports_have_no_cycle() -> None:
    paths = {module_name(path): path for kind in PACKAGES for path in (ROOT / kind).rglob("*.py")}
    assert len(paths) > 700  # all of them were looked at
    trees = ((name, ast.parse(path.read_text())) for name, path in paths.items())
    arrows = {name: set(imported(tree, paths)) & set(paths) for name, tree in trees}
    TopologicalSorter(arrows).prepare()  # raises CycleError, which names the cycle
