"""Functions of compiled loops, read as Python and written out statement by statement.

Branches and loops that known numbers decide are decided here: loops over them are unrolled. A loop whose
passes all do the same with numbers stays a loop. Other branches and loops are decided when the code runs; the
names that they assign become variables.
"""

from __future__ import annotations

import ast
import builtins
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import numpy as np
from llvmlite import ir

from dynamics.kernels.compiled_routine import Routine
from dynamics.kernels.tuple_addresses import WORD
from dynamics.structure_code.arithmetic import CALLS, FLAG, FLOAT, TYPES, Scalar, Unsupported, Value
from dynamics.structure_code.arrays import ITEMS, Array, ArrayAccess, Group
from dynamics.structure_code.function import (
    Frame,
    Slot,
    Variable,
    alike,
    assigned_in,
    has_in,
    is_number,
    is_plain,
    python_of,
    reading,
    reads_in,
    tree_of,
)

FEW, MANY = 4, 16
"""Passes up to which a loop is always unrolled, and above which a plain loop (`is_plain`) is never."""


class Statements(ArrayAccess):
    """Writes one function. Methods have the names of the nodes of Python's grammar that they write.

    Methods for statements return whether control has left them for good.
    """

    def __init__(self, module: Any, function: Any) -> None:
        self.module, self.function = module, function
        self.entry = ir.IRBuilder(function.append_basic_block("entry"))
        self.b = ir.IRBuilder(function.append_basic_block("body"))
        self.first = self.b.block
        self.read = {}
        self.frame = Frame({}, {}, False, ast.Pass())

    def finish(self) -> None:
        """Join the code that reads constants once to the rest."""
        self.entry.branch(self.first)

    def inline(self, function: Any, values: Sequence[Any]) -> Any:
        """Write the body of a function for these arguments, and return its result."""
        python = python_of(function)
        tree = tree_of(python)
        names = dict(zip([argument.arg for argument in tree.args.args], values, strict=True))
        options = getattr(function, "targetoptions", {})
        frame = Frame(names, python.__globals__, bool(options.get("fastmath")), tree)
        outer, self.frame = self.frame, frame
        result: list[Any] = []
        ended = self._body(tree.body, result)
        if frame.done is not None:
            if result or not ended:
                self._deliver(result[0] if result else None)
            self.b.position_at_end(frame.done)
            result = [self._loaded(frame.results)]
        self.frame = outer
        return result[0] if result else None

    def _deliver(self, value: Any) -> None:
        frame = self.frame
        if frame.results is None:
            frame.results = self._slots(value)
        self._keep(value, frame.results)
        self.b.branch(frame.done)

    def _slots(self, value: Any) -> Any:
        """Return variables for a number, for the items of a tuple, or for nothing."""
        if isinstance(value, tuple):
            return alike(value, map(self._slots, value))
        return None if value is None else self._slot(self.type_of(value))

    def _keep(self, value: Any, slots: Any) -> None:
        if isinstance(slots, tuple):
            for part, slot in zip(value, slots, strict=True):
                self._keep(part, slot)
        elif slots is not None:
            self.b.store(self.cast(value, slots.type), slots.ir)

    def _loaded(self, slots: Any) -> Any:
        if isinstance(slots, tuple):
            return alike(slots, map(self._loaded, slots))
        return None if slots is None else Value(self.b.load(slots.ir))

    def _blocks(self, count: int) -> list[Any]:
        return [self.function.append_basic_block() for _ in range(count)]

    # Statements

    def _body(self, statements: Sequence[ast.stmt], result: list[Any]) -> bool:
        return any(self._statement(statement, result) for statement in statements)

    def _statement(self, node: ast.stmt, result: list[Any]) -> bool:
        write = getattr(self, f"_{type(node).__name__}", None)
        if write is None:
            raise Unsupported(ast.unparse(node))
        return bool(write(node, result))

    def _Pass(self, node: ast.Pass, result: list[Any]) -> bool:
        return False

    def _Expr(self, node: ast.Expr, result: list[Any]) -> bool:
        if not isinstance(node.value, ast.Constant):
            self.value(node.value)
        return False

    def _Assign(self, node: ast.Assign, result: list[Any]) -> bool:
        value = self.value(node.value)
        for target in node.targets:
            self._store(target, value)
        return False

    def _AnnAssign(self, node: ast.AnnAssign, result: list[Any]) -> bool:
        if node.value is not None:
            self._store(node.target, self.value(node.value))
        return False

    def _AugAssign(self, node: ast.AugAssign, result: list[Any]) -> bool:
        self._store(
            node.target, self.binary(node.op, self.value(reading(node.target)), self.value(node.value))
        )
        return False

    def _Continue(self, node: ast.Continue, result: list[Any]) -> bool:
        return self._jump(self.frame.loops[-1][0])

    def _Break(self, node: ast.Break, result: list[Any]) -> bool:
        return self._jump(self.frame.loops[-1][1])

    def _jump(self, target: Any) -> bool:
        if target is None:
            raise Unsupported("a loop that is unrolled ends when a number says so")
        self.b.branch(target)
        return True

    def _Return(self, node: ast.Return, result: list[Any]) -> bool:
        value = None if node.value is None else self.value(node.value)
        if not self.frame.local_names:
            result.append(value)
            return True
        if self.frame.done is None:
            self.frame.done = self.function.append_basic_block()
        self._deliver(value)
        return True

    def _store(self, target: ast.expr, value: Any) -> None:
        if isinstance(target, ast.Tuple):
            for element, part in zip(target.elts, value, strict=True):
                self._store(element, part)
        elif isinstance(target, ast.Name):
            self._bind(target.id, value)
        elif isinstance(target, ast.Subscript):
            array = self.value(target.value)
            where = self.element_pointer(array, self.value(target.slice))
            item = FLAG if array.item is ITEMS["?"] else array.item
            stored = self.cast(value, item)
            stored = self.b.store(stored if item is array.item else self.b.zext(stored, array.item), where)
            stored.set_metadata("tbaa", array.alias)
        else:
            raise Unsupported(ast.unparse(target))

    def _bind(self, name: str, value: Any) -> None:
        names, local_names = self.frame.names, self.frame.local_names
        # in a branch or loop that is decided when it runs, a name that is read outside of it is a variable
        if local_names and name not in local_names[-1] and not isinstance(names.get(name), Variable):
            self._vary(name, value)
        known = names.get(name)
        if isinstance(known, Variable):
            self._keep(value, known.slots)
        else:
            names[name] = value

    def _vary(self, name: str, value: Any) -> None:
        if not is_number(value):
            raise Unsupported(f"{name} stands for one array or another")
        self.frame.names[name] = Variable(self._slots(value))

    def _slot(self, kind: Any) -> Slot:
        return Slot(self.entry.alloca(kind), kind)

    @contextmanager
    def _undecided(self, *nodes: ast.stmt) -> Iterator[None]:
        """Make variables of the names that the statements assign, except those that only they read."""
        names, within = self.frame.names, sum(map(reads_in, nodes), Counter())
        assigned = frozenset().union(*map(assigned_in, nodes))
        for name in sorted(assigned):
            value = names.get(name)
            if is_number(value):
                self._vary(name, value)
                self._bind(name, value)
        all_reads = reads_in(self.frame.tree)
        self.frame.local_names.append(
            frozenset(n for n in assigned if n not in names and all_reads[n] == within[n])
        )
        yield
        self._forget()
        self.frame.local_names.pop()

    def _forget(self) -> None:
        """Forget the values that a branch has given to its names."""
        for name in self.frame.local_names[-1]:
            self.frame.names.pop(name, None)

    def _If(self, node: ast.If, result: list[Any]) -> bool:
        test = self.truth(self.value(node.test))
        if not isinstance(test, Value):
            return self._body(node.body if test else node.orelse, result)
        reached = False
        with self._undecided(*node.body, *node.orelse):
            yes, no, after = self._blocks(3)
            self.b.cbranch(test.ir, yes, no)
            for block, statements in ((yes, node.body), (no, node.orelse)):
                self._forget()
                self.b.position_at_end(block)
                if not self._body(statements, result):
                    self.b.branch(after)
                    reached = True
            self.b.position_at_end(after)
        if not reached:
            self.b.unreachable()
        return not reached

    def _While(self, node: ast.While, result: list[Any]) -> bool:
        while not isinstance(test := self.truth(self.value(node.test)), Value):
            if not test:
                return False
            self.frame.loops.append((None, None))
            ended = self._body(node.body, result)
            self.frame.loops.pop()
            if ended:
                return True
        with self._undecided(*node.body):
            head, inside, after = self._blocks(3)
            self.b.branch(head)
            self.b.position_at_end(head)
            self.b.cbranch(self.flag(self.value(node.test)), inside, after)
            self.b.position_at_end(inside)
            self._pass(node.body, head, after, result)
            self.b.position_at_end(after)
        return False

    def _pass(self, body: Sequence[ast.stmt], further: Any, after: Any, result: list[Any]) -> None:
        self.frame.loops.append((further, after))
        if not self._body(body, result):
            self.b.branch(further)
        self.frame.loops.pop()

    def _For(self, node: ast.For, result: list[Any]) -> bool:
        if isinstance(node.iter, ast.Tuple):
            return self._unrolled(node, [self.value(value) for value in node.iter.elts], result)
        if not (isinstance(node.iter, ast.Call) and ast.unparse(node.iter.func) == "range"):
            raise Unsupported(f"a loop over {ast.unparse(node.iter)}")
        bounds = [self.value(value) for value in node.iter.args]
        start, stop, step = (0, bounds[0], 1) if len(bounds) == 1 else (*bounds, 1)[:3]
        known = not isinstance(start, Value) and not isinstance(stop, Value)
        if known and start >= stop:
            return False
        if self.frame.sums:
            raise Unsupported("sums whose order the compiler chooses")
        passes = 0 if not known or has_in(node, ast.Break) else stop - start  # 0: cannot be unrolled
        is_long = passes > MANY and is_plain(node)
        if 0 < passes <= FEW or (passes and not self._even(node) and not is_long):
            return self._unrolled(node, range(start, stop, step), result)
        return self._loop(node, start, stop, step, result)

    def _unrolled(self, node: ast.For, values: Sequence[Any], result: list[Any]) -> bool:
        assert isinstance(node.target, ast.Name)
        for value in values:
            self.frame.names[node.target.id] = value
            further = self._blocks(1)[0] if has_in(node, ast.Continue) else None
            self.frame.loops.append((further, None))
            ended = self._body(node.body, result)
            self.frame.loops.pop()
            if further is not None:
                if not ended:
                    self.b.branch(further)
                self.b.position_at_end(further)
            elif ended:
                return True
        return False

    def _loop(self, node: ast.For, start: Any, stop: Any, step: int, result: list[Any]) -> bool:
        assert isinstance(node.target, ast.Name)
        index, end = self._slot(WORD), self.cast(stop, WORD)
        self.b.store(self.cast(start, WORD), index.ir)
        with self._undecided(*node.body):
            head, inside, further, after = self._blocks(4)
            self.b.branch(head)
            self.b.position_at_end(head)
            self.b.cbranch(self.b.icmp_signed("<", self.b.load(index.ir), end), inside, after)
            self.b.position_at_end(inside)
            self.frame.names[node.target.id] = Value(self.b.load(index.ir))
            self._pass(node.body, further, after, result)
            self.b.position_at_end(further)
            self.b.store(self.b.add(self.b.load(index.ir), WORD(step), flags=["nsw"]), index.ir)
            self.b.branch(head)
            self.b.position_at_end(after)
        self.frame.names.pop(node.target.id)
        return False

    def _even(self, node: ast.For) -> bool:
        """Return whether each pass does the same with the next items of arrays of numbers."""
        assigned = assigned_in(node)
        for child in ast.walk(node):
            if isinstance(child, ast.If | ast.While | ast.Continue | ast.Return):
                return False
            if isinstance(child, ast.Call) and any(
                self._structured(part, assigned, any_array=True) for part in child.args
            ):
                return False
            if isinstance(child, ast.Subscript) and self._structured(child.value, assigned, any_array=False):
                return False
        return True

    def _structured(self, node: ast.expr, assigned: frozenset[str], any_array: bool) -> bool:
        """Return whether an expression is a tuple, or an array (any, or one of known items)."""
        if not isinstance(node, ast.Name | ast.Attribute):
            return not isinstance(node, ast.Constant | ast.BinOp | ast.UnaryOp | ast.Subscript | ast.Call)
        root: ast.expr = node
        while isinstance(root, ast.Attribute):
            root = root.value
        if not isinstance(root, ast.Name):
            return True
        if root.id in assigned:
            return False
        value = self.value(node)
        if isinstance(value, Array):
            return any_array or value.content is not None
        return not isinstance(value, Scalar | Value)

    # Expressions

    def value(self, node: ast.expr) -> Any:
        """Return the value of an expression."""
        self.module.count()
        read = getattr(self, f"_{type(node).__name__}", None)
        if read is None:
            raise Unsupported(ast.unparse(node))
        return read(node)

    def _Constant(self, node: ast.Constant) -> Any:
        return node.value

    def _Attribute(self, node: ast.Attribute) -> Any:
        return self.attribute(self.value(node.value), node.attr)

    def _Tuple(self, node: ast.Tuple) -> Any:
        return tuple(self.value(element) for element in node.elts)

    def _Subscript(self, node: ast.Subscript) -> Any:
        return self.item(self.value(node.value), self.value(node.slice))

    def _BinOp(self, node: ast.BinOp) -> Any:
        return self.binary(node.op, self.value(node.left), self.value(node.right))

    def _UnaryOp(self, node: ast.UnaryOp) -> Any:
        return self.unary(node.op, self.value(node.operand))

    def _BoolOp(self, node: ast.BoolOp) -> Any:
        return self._all_or_any(node.values, isinstance(node.op, ast.And))

    def _Name(self, node: ast.Name) -> Any:
        frame, name = self.frame, node.id
        if name in frame.names:
            value = frame.names[name]
            return self._loaded(value.slots) if isinstance(value, Variable) else value
        value = frame.globals[name] if name in frame.globals else getattr(builtins, name)
        if isinstance(value, np.ndarray):
            return Array(lambda: None, value.shape, ITEMS[value.dtype.char], None, value)
        return value

    def _Compare(self, node: ast.Compare) -> Any:
        if len(node.ops) == 1:
            return self.pair(node.ops[0], self.value(node.left), self.value(node.comparators[0]))
        links = [node.left, *node.comparators]
        chain = [ast.Compare(links[k], [op], [links[k + 1]]) for k, op in enumerate(node.ops)]
        return self._all_or_any(chain, all_of=True)

    def _all_or_any(self, nodes: Sequence[ast.expr], all_of: bool) -> Any:
        """Write `and` or `or` of expressions; a later expression is evaluated only if it decides."""
        value = self.truth(self.value(nodes[0]))
        if len(nodes) == 1:
            return value
        if not isinstance(value, Value):
            return value if value is not all_of else self._all_or_any(nodes[1:], all_of)
        slot = self._slot(FLAG)
        self.b.store(value.ir, slot.ir)
        further, after = self._blocks(2)
        self.b.cbranch(value.ir, *((further, after) if all_of else (after, further)))
        self.b.position_at_end(further)
        self.b.store(self.flag(self._all_or_any(nodes[1:], all_of)), slot.ir)
        self.b.branch(after)
        self.b.position_at_end(after)
        return Value(self.b.load(slot.ir))

    def _IfExp(self, node: ast.IfExp) -> Any:
        test = self.truth(self.value(node.test))
        if not isinstance(test, Value):
            return self.value(node.body if test else node.orelse)
        yes, no, after = self._blocks(3)
        self.b.cbranch(test.ir, yes, no)
        branches = []
        for block, branch in ((yes, node.body), (no, node.orelse)):
            self.b.position_at_end(block)
            value = self.value(branch)
            branches.append((value, self.b.block))
        kind = (
            FLOAT if FLOAT in (self.type_of(value) for value, _ in branches) else self.type_of(branches[0][0])
        )
        slot = self._slot(kind)
        for value, block in branches:
            self.b.position_at_end(block)
            self.b.store(self.cast(value, kind), slot.ir)
            self.b.branch(after)
        self.b.position_at_end(after)
        return Value(self.b.load(slot.ir))

    def _Call(self, node: ast.Call) -> Any:
        called = self.value(node.func)
        values = [self.value(argument) for argument in node.args]
        if isinstance(called, Routine):
            return self._routine(called, values)
        if hasattr(called, "py_func"):
            return self.inline(called, values)
        if isinstance(called, type) and issubclass(called, tuple):
            return called(
                *values, **{str(argument.arg): self.value(argument.value) for argument in node.keywords}
            )
        if called is np.uint64:
            return values[0]
        if not any(isinstance(argument, Value) for argument in values):
            return called(*values)
        if called not in CALLS:
            raise Unsupported(str(called))
        return CALLS[called](self, *values)

    def _routine(self, routine: Routine, values: Sequence[Any]) -> Any:
        """Call a function of its own: routines are called from several."""
        function = self.module.function(routine, values)
        kinds = (TYPES.get(hint) for hint in routine.arguments)
        passed = [
            value.pointer if isinstance(value, Group) else self.cast(value, kind)
            for value, kind in zip(values, kinds, strict=True)
        ]
        result = self.b.call(function, passed)
        kind = function.function_type.return_type
        if isinstance(kind, ir.LiteralStructType):
            return tuple(Value(self.b.extract_value(result, k)) for k in range(len(kind.elements)))
        return None if kind == ir.VoidType() else Value(result)
