"""Functions take objects, not long lists of parameters."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
MOST, MOST_EXPORTED = 10, 8
WRAPPERS = {"analyze"}
"""In keywords, as the README shows them."""
Function = ast.FunctionDef | ast.AsyncFunctionDef


def functions(file: Path) -> Iterator[Function]:
    return (node for node in ast.walk(ast.parse(file.read_text("utf-8"))) if isinstance(node, Function))


def parameters(function: Function) -> int:
    """Count what a caller may pass."""
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


@pytest.mark.parametrize("package", ["host", "bounds", "model_studies", "fe_contact", "dynamics"])
def test_no_function_takes_many_parameters(package: str) -> None:
    public = exported(ROOT / package) - WRAPPERS
    found = {
        f"{file.relative_to(ROOT)}: {one.name}": parameters(one)
        for file in (ROOT / package).rglob("*.py")
        for one in functions(file)
        if one.name not in WRAPPERS and parameters(one) > (MOST_EXPORTED if one.name in public else MOST)
    }
    assert found == {}


def test_self_is_no_parameter_and_a_splat_is_one() -> None:
    text = "def one(self, a, /, b, *c, d=0, **e): ...\ndef other(a, *, self): ..."
    assert [parameters(one) for one in ast.parse(text).body if isinstance(one, Function)] == [5, 2]
