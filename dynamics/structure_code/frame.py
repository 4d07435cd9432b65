"""Names of a function that is written out: known values, and variables."""

from __future__ import annotations

import ast
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

from dynamics.structure_code.arithmetic import Scalar, Value


@dataclass(frozen=True)
class Slot:
    """Memory of a number."""

    ir: Any
    type: Any


@dataclass(frozen=True)
class Variable:
    """A name whose value is known when it runs: a slot, or a tuple of such."""

    slots: Any


def is_number(value: Any) -> bool:
    """Return whether a value is a number or a tuple of numbers."""
    return all(map(is_number, value)) if isinstance(value, tuple) else isinstance(value, Scalar | Value)


@dataclass
class Frame:
    """One call.

    Attributes
    ----------
    names, globals : dict
        What its names stand for.
    sums : bool
        Whether the compiler may choose the order of its sums.
    tree : node
        The function.
    own : list of sets
        Of each branch and loop around the current statement that is decided when it runs, the names that are
        assigned and read within it alone.
    results : Slot, tuple or None
        Where a `return` within one of these leaves its values.
    done : block or None
        Where it goes on after such a `return`.
    loops : list of pairs of blocks
        Where `continue` and `break` lead; None: the loop is unrolled.
    """

    names: dict[str, Any]
    globals: dict[str, Any]
    sums: bool
    tree: ast.AST
    own: list[frozenset[str]] = field(default_factory=list)
    results: Any = None
    done: Any = None
    loops: list[tuple[Any, Any]] = field(default_factory=list)


def alike(value: tuple[Any, ...], items: Iterable[Any]) -> Any:
    """Return a tuple of the kind of another, named or not."""
    make = getattr(type(value), "_make", tuple)
    return make(items)
