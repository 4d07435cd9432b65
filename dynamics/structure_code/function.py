"""A function that is written out: its source by Python's grammar, its names as known values and variables."""

from __future__ import annotations

import ast
import inspect
import textwrap
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import cache
from typing import Any

from dynamics.structure_code.arithmetic import Scalar, Value

SOURCE = "__source__"
"""Attribute with the text of a function that no file has."""


def python_of(function: Any) -> Any:
    """Return the function in Python of a compiled one."""
    return getattr(function, "py_func", None) or inspect.unwrap(function)


@cache
def tree_of(function: Any) -> ast.FunctionDef:
    """Return the definition of a function in Python."""
    text = getattr(function, SOURCE, None) or textwrap.dedent(inspect.getsource(function))
    node = ast.parse(text).body[0]
    assert isinstance(node, ast.FunctionDef)
    return node


@cache
def assigned_in(node: ast.AST) -> frozenset[str]:
    """Return the names that a statement assigns."""
    names = (name for name in ast.walk(node) if isinstance(name, ast.Name))
    return frozenset(name.id for name in names if isinstance(name.ctx, ast.Store))


@cache
def reads_in(node: ast.AST) -> Counter[str]:
    """Return the number of reads of each name in a statement."""
    changed = (child.target for child in ast.walk(node) if isinstance(child, ast.AugAssign))
    names = [child for child in ast.walk(node) if isinstance(child, ast.Name)]
    read = [child for child in names if isinstance(child.ctx, ast.Load)]
    return Counter(child.id for child in (*read, *changed) if isinstance(child, ast.Name))


@cache
def has_in(node: ast.AST, kind: type[ast.AST]) -> bool:
    """Return whether a statement holds a node of a kind."""
    return any(isinstance(child, kind) for child in ast.walk(node))


@cache
def is_plain(node: ast.For) -> bool:
    """Return whether a loop calls nothing but conversions, and decides nothing."""
    calls = (ast.unparse(child.func) for child in ast.walk(node) if isinstance(child, ast.Call))
    decides = any(has_in(node, kind) for kind in (ast.If, ast.While, ast.Continue, ast.Return))
    nested = any(has_in(child, ast.For) for child in node.body)
    return not decides and not nested and set(calls) <= {"range", "np.uint64"}


@cache
def reading(target: ast.expr) -> ast.expr:
    """Return the expression that reads what an assignment in place writes."""
    return ast.parse(ast.unparse(target), mode="eval").body


@dataclass(frozen=True)
class Slot:
    """Memory of a number."""

    ir: Any
    type: Any


@dataclass(frozen=True)
class Variable:
    """A name whose value is known at run time alone: a slot, or a tuple of slots."""

    slots: Any


def is_number(value: Any) -> bool:
    """Return whether a value is a number or a tuple of numbers."""
    return all(map(is_number, value)) if isinstance(value, tuple) else isinstance(value, Scalar | Value)


@dataclass
class Frame:
    """One call."""

    names: dict[str, Any]
    globals: dict[str, Any]
    """`names`, `globals`: Values of its local and global names."""
    sums: bool
    """Whether the compiler may choose the order of its sums."""
    tree: ast.AST
    """Syntax tree of the function."""
    local_names: list[frozenset[str]] = field(default_factory=list)
    """Names that are assigned and read within one branch or loop alone: a set for each branch and loop around
    the current statement that is decided when it runs.
    """
    results: Any = None
    """Place where a `return` within such a branch or loop leaves its values."""
    done: Any = None
    """Block that follows after such a `return`."""
    loops: list[tuple[Any, Any]] = field(default_factory=list)
    """Blocks to which `continue` and `break` lead, for each loop; None: the loop is unrolled."""


def alike(value: tuple[Any, ...], items: Iterable[Any]) -> Any:
    """Return a tuple of the kind of another, named or not."""
    make = getattr(type(value), "_make", tuple)
    return make(items)
