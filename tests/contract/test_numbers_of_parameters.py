"""Callers pass few parameters, and no module imports itself through others."""

import ast
import re
from collections.abc import Collection, Iterator
from graphlib import TopologicalSorter
from pathlib import Path

import pytest
from repository import ROOT

MAX, MAX_EXPORTED = 10, 8
Function = ast.FunctionDef | ast.AsyncFunctionDef


def functions(file: Path) -> Iterator[Function]:
    return (node for node in ast.walk(ast.parse(file.read_text("utf-8"))) if isinstance(node, Function))


def parameters(function: Function) -> int:
    taken = function.args
    named = [one.arg for one in (*taken.posonlyargs, *taken.args, *taken.kwonlyargs)]
    return len(named[named[:1] in (["self"], ["cls"]) :]) + bool(taken.vararg) + bool(taken.kwarg)


def exported(package: Path) -> set[str]:
    names: set[str] = set()
    for file in package.rglob("__init__.py"):
        for node in ast.parse(file.read_text("utf-8")).body:
            if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "__all__":
                names |= set(ast.literal_eval(node.value))
    return names


@pytest.mark.parametrize(
    "package", ["host", "bounds", "model_studies", "fe_contact", "dynamics", "verification"]
)
def test_no_function_takes_many_parameters(package):
    public = exported(ROOT / package)
    found = {
        f"{file.relative_to(ROOT)}: {one.name}": parameters(one)
        for file in (ROOT / package).rglob("*.py")
        for one in functions(file)
        if parameters(one) > (MAX_EXPORTED if one.name in public else MAX)
    }
    assert found == {}


def test_self_is_no_parameter_and_a_splat_is_one():
    text = "def one(self, a, /, b, *c, d=0, **e): ...\ndef other(a, *, self): ..."
    assert [parameters(one) for one in ast.parse(text).body if isinstance(one, Function)] == [5, 2]


PACKAGES = (
    "host",
    "bounds",
    "model_studies",
    "fe_contact",
    "dynamics",
    "lineofaction",
    "service",
    "verification",
)


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


def above_definitions(text: str) -> str:
    """Return a module up to its first definition: ruff (E402) holds that no import of a module follows."""
    return re.split(r"^(?:def|class|async|@)\b", text, maxsplit=1, flags=re.MULTILINE)[0]


@pytest.mark.law
def test_imports_have_no_cycle():
    paths = {module_name(path): path for kind in PACKAGES for path in (ROOT / kind).rglob("*.py")}
    assert len(paths) > 700  # all of them were looked at
    trees = ((name, ast.parse(above_definitions(path.read_text()))) for name, path in paths.items())
    arrows = {name: set(imported(tree, paths)) & set(paths) for name, tree in trees}
    TopologicalSorter(arrows).prepare()  # raises CycleError, which names the cycle
