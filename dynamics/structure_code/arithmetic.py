"""Arithmetic of loops written out as instructions of LLVM.

Operations on numbers that are known beforehand are done at once; on others an instruction is written.
Operations, their order and their rounding are those of the ordinary compiled loops.
"""

from __future__ import annotations

import ast
import math
import operator
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from llvmlite import ir

from dynamics.kernels.tuple_addresses import WORD

FLOAT, FLAG, BYTE = ir.DoubleType(), ir.IntType(1), ir.IntType(8)
TYPES: dict[type, Any] = {float: FLOAT, int: WORD, bool: FLAG}
Scalar = bool | int | float
# the function of known numbers, then the instructions on floats and on integers; empty: there is none
_BINARY: dict[type, tuple[Callable[..., Any], str, str]] = {
    ast.Add: (operator.add, "fadd", "add"),
    ast.Sub: (operator.sub, "fsub", "sub"),
    ast.Mult: (operator.mul, "fmul", "mul"),
    ast.Div: (lambda a, b: float(np.float64(a) / np.float64(b)), "fdiv", ""),
    ast.FloorDiv: (operator.floordiv, "", "floor"),
    ast.Mod: (operator.mod, "", "mod"),
    ast.Pow: (operator.pow, "", ""),
    ast.BitAnd: (operator.and_, "", "and_"),
}
_UNARY: dict[type, Callable[[Any], Any]] = {
    ast.USub: operator.neg,
    ast.UAdd: operator.pos,
    ast.Not: operator.not_,
}
_COMPARE: dict[type, tuple[Callable[[Any, Any], Any], str]] = {
    ast.Lt: (operator.lt, "<"),
    ast.LtE: (operator.le, "<="),
    ast.Gt: (operator.gt, ">"),
    ast.GtE: (operator.ge, ">="),
    ast.Eq: (operator.eq, "=="),
    ast.NotEq: (operator.ne, "!="),
}


class Unsupported(Exception):
    """A construct of the function has no written-out form for a structure."""


@dataclass(frozen=True)
class Value:
    """A number that is known when the loop runs."""

    ir: Any


class Arithmetic:
    """A writer of operations at the end of `b`, in `module`; operands are numbers of Python or `Value`."""

    b: Any
    module: Any

    def type_of(self, value: Any) -> Any:
        """Return the type of a number."""
        if isinstance(value, Value):
            return value.ir.type
        return FLAG if isinstance(value, bool) else WORD if isinstance(value, int) else FLOAT

    def cast(self, value: Any, kind: Any) -> Any:
        """Return an instruction's operand of a type."""
        if not isinstance(value, Value):
            if kind is FLOAT:
                return FLOAT(float(value))
            if not isinstance(value, bool | int):
                raise Unsupported(f"{value} as an integer")
            return kind(int(value))
        ir_type = value.ir.type
        if ir_type == kind:
            return value.ir
        if kind is FLOAT:
            return self.b.uitofp(value.ir, FLOAT) if ir_type == FLAG else self.b.sitofp(value.ir, FLOAT)
        if ir_type == FLAG and kind is WORD:
            return self.b.zext(value.ir, WORD)
        raise Unsupported("a number changes its type")

    def binary(self, op: ast.operator, left: Any, right: Any) -> Any:
        """Return sum, difference, product, quotient, remainder or power."""
        known, of_floats, of_integers = _BINARY[type(op)]
        if not isinstance(left, Value) and not isinstance(right, Value):
            return known(left, right)
        if isinstance(op, ast.Pow):
            return self._power(left, right)
        floats = FLOAT in (self.type_of(left), self.type_of(right)) or not of_integers
        kind, name = (FLOAT, of_floats) if floats else (WORD, of_integers)
        if not name:
            raise Unsupported("a remainder of floats")
        operands = self.cast(left, kind), self.cast(right, kind)
        if name in ("floor", "mod"):
            return self._divided(name, *operands)
        flags = {} if floats or name == "and_" else {"flags": ["nsw"]}
        return Value(getattr(self.b, name)(*operands, **flags))

    def _divided(self, name: str, left: Any, right: Any) -> Value:
        """Return quotient or remainder of integers as Python rounds them: down."""
        b = self.b
        quotient, rest = b.sdiv(left, right), b.srem(left, right)
        below = b.and_(b.icmp_signed("!=", rest, WORD(0)), b.icmp_signed("<", b.xor(rest, right), WORD(0)))
        if name == "mod":
            return Value(b.select(below, b.add(rest, right), rest))
        return Value(b.sub(quotient, b.zext(below, WORD)))

    def _power(self, base: Any, exponent: Any) -> Any:
        if isinstance(exponent, Value) or exponent not in (2, 3):
            return self.intrinsic("pow", base, exponent)
        square = self.binary(ast.Mult(), base, base)
        return square if exponent == 2 else self.binary(ast.Mult(), square, base)

    def unary(self, op: ast.unaryop, value: Any) -> Any:
        """Return a number with its sign changed, or the negation of a truth value."""
        if not isinstance(value, Value):
            return _UNARY[type(op)](value)
        if isinstance(op, ast.Not):
            return Value(self.b.not_(self.flag(value)))
        if isinstance(op, ast.USub):
            return Value(self.b.fneg(value.ir) if value.ir.type is FLOAT else self.b.neg(value.ir))
        return value

    def pair(self, op: ast.cmpop, left: Any, right: Any) -> Any:
        """Return the comparison of two; one with NaN holds for `!=` alone."""
        if isinstance(op, ast.In | ast.NotIn):
            return (left in right) is isinstance(op, ast.In)
        if isinstance(op, ast.Is | ast.IsNot):
            return (left is right) is isinstance(op, ast.Is)
        known, sign = _COMPARE[type(op)]
        if not isinstance(left, Value) and not isinstance(right, Value):
            return known(left, right)
        if FLOAT in (self.type_of(left), self.type_of(right)):
            compare = self.b.fcmp_unordered if sign == "!=" else self.b.fcmp_ordered
            return Value(compare(sign, self.cast(left, FLOAT), self.cast(right, FLOAT)))
        return Value(self.b.icmp_signed(sign, self.cast(left, WORD), self.cast(right, WORD)))

    def truth(self, value: Any) -> Any:
        """Return whether a number is not 0."""
        if not isinstance(value, Value):
            return bool(value)
        return value if value.ir.type == FLAG else self.pair(ast.NotEq(), value, 0)

    def flag(self, value: Any) -> Any:
        """Return the truth of a value as the operand of a branch."""
        value = self.truth(value)
        return value.ir if isinstance(value, Value) else FLAG(int(value))

    def intrinsic(self, name: str, *values: Any) -> Value:
        """Return a function of floats that the processor or the C library has."""
        floats = [self.cast(value, FLOAT) for value in values]
        module = self.module.module
        function = module.globals.get(name) or ir.Function(
            module, ir.FunctionType(FLOAT, [FLOAT] * len(values)), name
        )
        return Value(self.b.call(function, floats))

    def extreme(self, sign: str, *values: Any) -> Any:
        """Return the largest (`>`) or least (`<`) value; a later one wins where the comparison holds."""
        result = values[0]
        for value in values[1:]:
            if not isinstance(result, Value) and not isinstance(value, Value):
                result = max(result, value) if sign == ">" else min(result, value)
                continue
            kind = FLOAT if FLOAT in (self.type_of(result), self.type_of(value)) else WORD
            a, v = self.cast(result, kind), self.cast(value, kind)
            wins = self.b.fcmp_ordered(sign, v, a) if kind is FLOAT else self.b.icmp_signed(sign, v, a)
            result = Value(self.b.select(wins, v, a))
        return result


def _integer(writer: Arithmetic, value: Value) -> Value:
    if value.ir.type is FLOAT:
        return Value(writer.b.fptosi(value.ir, WORD))
    return value if value.ir.type is WORD else Value(writer.cast(value, WORD))


def _absolute(writer: Arithmetic, value: Value) -> Value:
    if value.ir.type is FLOAT:
        return writer.intrinsic("llvm.fabs.f64", value)
    negative = writer.b.icmp_signed("<", value.ir, WORD(0))
    return Value(writer.b.select(negative, writer.b.neg(value.ir), value.ir))


def _finite(writer: Arithmetic, value: Value) -> Value:
    size = writer.intrinsic("llvm.fabs.f64", value)
    return Value(writer.b.fcmp_ordered("<", size.ir, FLOAT(math.inf)))


CALLS: dict[Any, Callable[..., Any]] = {
    float: lambda w, v: Value(w.cast(v, FLOAT)),
    int: _integer,
    bool: lambda w, v: w.truth(v),
    np.uint64: lambda w, v: v,
    abs: _absolute,
    min: lambda w, *v: w.extreme("<", *v),
    max: lambda w, *v: w.extreme(">", *v),
    math.floor: lambda w, v: w.intrinsic("llvm.floor.f64", v),
    math.sqrt: lambda w, v: w.intrinsic("llvm.sqrt.f64", v),
    math.copysign: lambda w, *v: w.intrinsic("llvm.copysign.f64", *v),
    math.isfinite: _finite,
    math.sin: lambda w, v: w.intrinsic("sin", v),
    math.cos: lambda w, v: w.intrinsic("cos", v),
    math.log2: lambda w, v: w.intrinsic("log2", v),
}
"""Functions that loops call on numbers."""
