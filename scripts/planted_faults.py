"""Plant faults in the product, one at a time, and see which tests find them.

Usage: planted_faults.py COUNT SEED OUTPUT.csv [BUDGET]   in a tree that may be written to and has no changes.

A fault is drawn by seed: a house by its size, a file, a place of it, and one of the kinds below. The
tests that reach the file by imports, then those that rest on its house, run nearest first until one fails:
those of every change ("day"), then the slow ones that rest on the house ("house"), then the slow ones of
others ("night"). BUDGET is the CPU time (s) that each of the three has; "time" says that one of them ended
by it, so nothing is known. What no test finds is listed too: it may change nothing. Faults that OUTPUT.csv
has already are not planted again.
"""

from __future__ import annotations

import ast
import csv
import random
import resource
import signal
import subprocess
import sys
from collections import deque
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import NamedTuple

import structure

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT / "tests" / "fakes"))
from suite_selection import SLOW, read_costs, rests_on  # noqa: E402

OPERATORS: dict[type[ast.AST], tuple[str, str, str]] = {
    ast.Add: ("sign", "+", "-"), ast.Sub: ("sign", "-", "+"),
    ast.Mult: ("factor", "*", "/"), ast.Div: ("factor", "/", "*"),
    ast.Lt: ("bound", "<", "<="), ast.LtE: ("bound", "<=", "<"),
    ast.Gt: ("bound", ">", ">="), ast.GtE: ("bound", ">=", ">"),
    ast.Eq: ("condition", "==", "!="), ast.NotEq: ("condition", "!=", "=="),
    ast.And: ("condition", "and", "or"), ast.Or: ("condition", "or", "and"),
}  # fmt: skip
USAGE_ERROR, NO_TEST_RAN = 4, 5
"""Exit codes of pytest: a test that is none, or a conftest that cannot be imported; no test selected."""
LOCKS = ("lock", "writing", "flock", "exclusive")


class Fault(NamedTuple):
    """One edit: `before`, at a line and column of a file, becomes `after`."""

    house: str
    file: str
    line: int
    column: int
    kind: str
    before: str
    after: str


def drawn(count: int, seed: int) -> list[Fault]:
    """Return faults over all houses, as many in each as it has lines."""
    rng = random.Random(seed)
    files = [(house, file) for house in structure.HOUSES for file in structure.files_of(house)]
    weights = [file.stat().st_size for _, file in files]
    faults: list[Fault] = []
    while len(faults) < count:
        house, file = rng.choices(files, weights)[0]
        by_kind: dict[str, list[Fault]] = {}
        for fault in _possible(house, file):
            by_kind.setdefault(fault.kind, []).append(fault)
        if by_kind:
            faults.append(rng.choice(by_kind[rng.choice(sorted(by_kind))]))
    return faults


def _possible(house: str, file: Path) -> Iterator[Fault]:
    text = file.read_text("utf-8")
    lines = text.splitlines()
    name = file.relative_to(ROOT).as_posix()
    for function in ast.walk(ast.parse(text)):
        if not isinstance(function, ast.FunctionDef):
            continue
        for node in (part for statement in function.body for part in ast.walk(statement)):
            for start, end, kind, old, new in _edits(node):
                if start[0] == end[0] and lines[start[0] - 1].isascii():
                    before = lines[start[0] - 1][start[1] : end[1]]
                    after = before.replace(old, new, 1) if old else new
                    yield Fault(house, name, start[0], start[1], kind, before, after)


Place = tuple[int, int]


def _edits(node: ast.AST) -> Iterator[tuple[Place, Place, str, str, str]]:
    """Yield start, end and kind of each fault a node can have, what is replaced (all, if "") and by what."""
    match node:
        case ast.BinOp(left=left, op=op, right=right) if type(op) in OPERATORS and not _is_text(left, right):
            yield _end(left), _start(right), *OPERATORS[type(op)]
        case ast.Compare(left=left, ops=[op], comparators=[right]) if type(op) in OPERATORS:
            yield _end(left), _start(right), *OPERATORS[type(op)]
        case ast.BoolOp(op=op, values=[left, right]):
            yield _end(left), _start(right), *OPERATORS[type(op)]
        case ast.UnaryOp(op=ast.USub() | ast.Not(), operand=operand):
            yield (
                _start(node),
                _start(operand),
                "sign" if isinstance(node.op, ast.USub) else "condition",
                "",
                "",
            )
        case ast.Subscript(slice=ast.Constant(value=int(value)) as index):
            yield _start(index), _end(index), "index", "", str(value + 1 if value >= 0 else value - 1)
        case ast.keyword(arg="axis", value=ast.Constant(value=int(value)) as axis):
            yield _start(axis), _end(axis), "axis", "", "1" if value == 0 else "0"
        case ast.Constant(value=float(value)) if value not in (0.0, 1.0):
            yield _start(node), _end(node), "factor", "", repr(2.0 * value)
        case ast.If(test=test, body=[ast.Raise() | ast.Return()]):
            yield _start(test), _end(test), "refusal", "", "False"
        case ast.With(items=[ast.withitem(context_expr=ast.Call() as call, optional_vars=None)]) if any(
            lock in ast.unparse(call) for lock in LOCKS
        ):
            yield _start(call), _end(call), "lock", "", '__import__("contextlib").nullcontext()'


def _is_text(*nodes: ast.expr) -> bool:
    return any(isinstance(node, ast.JoinedStr | ast.Constant) and not _is_number(node) for node in nodes)


def _is_number(node: ast.expr) -> bool:
    return isinstance(node, ast.Constant) and isinstance(node.value, int | float)


def _start(node: ast.expr) -> Place:
    return node.lineno, node.col_offset


def _end(node: ast.expr) -> Place:
    return node.end_lineno or node.lineno, node.end_col_offset or 0


@cache
def _modules() -> dict[str, Path]:
    found = {}
    for house in structure.HOUSES:
        for file in structure.files_of(house):
            parts = file.relative_to(ROOT).with_suffix("").parts
            found[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = file
    return found


@cache
def _imports(file: Path) -> frozenset[Path]:
    """Return the files of the product that a file imports."""
    names = {part for name in structure.imported(file) for part in (name, name.rpartition(".")[0])}
    return frozenset(_modules()[name] for name in names if name in _modules())


def distances(file: Path) -> dict[Path, int]:
    """Return how many imports a test file is away from each file of the product."""
    away: dict[Path, int] = {}
    waiting = deque((path, 0) for path in rests_on(file)[0])
    while waiting:
        path, steps = waiting.popleft()
        for other in _imports(path):
            if other not in away:
                away[other] = steps + 1
                waiting.append((other, steps + 1))
    return away


def suites(fault: Fault, tests: dict[Path, dict[Path, int]]) -> dict[str, list[str]]:
    """Return the pytest arguments of day, house and night: files, or single tests, nearest first."""
    target = ROOT / fault.file
    near = sorted(
        (_far(file) + away.get(target, _BY_PROCESS), str(file), file)
        for file, away in tests.items()
        if target in away or fault.house in rests_on(file)[1]
    )
    slow = [_tests_of(name) for name, seconds in read_costs().items() if seconds > SLOW]
    of_house: list[str] = []
    of_others: list[str] = []
    for _, _, file in near:
        own = [test for test in slow if ROOT / test.partition("::")[0] == file]
        (of_house if fault.house in rests_on(file)[1] else of_others).extend(own)
    return {"day": [str(file) for _, _, file in near], "house": of_house, "night": of_others}


def _tests_of(name: str) -> str:
    """Return a test that is on record; of a fixture its file."""
    file, _, own = name.partition("::")
    return name if own.startswith("test_") else file


_BY_PROCESS = 99
"""Imports to what a test reaches by a process of its own alone, as a service or a reader of files: last."""


def _far(file: Path) -> int:
    """Return what tests of whole services count for in imports: they answer last."""
    return 9 if file.relative_to(ROOT / "tests").parts[0] in ("api", "browser", "flow") else 0


def first_failure(arguments: list[str], budget: float, *options: str) -> str:
    """Return the first test that fails, or "" and how it ended: some files, then more, then all others."""
    for some in filter(None, (arguments[:20], arguments[20:100], arguments[100:])):
        command = [
            sys.executable,
            "-m",
            "pytest",
            "-x",
            "-q",
            "-n",
            "0",
            "-p",
            "no:cacheprovider",
            *options,
            *some,
        ]
        limit = max(int(budget), 1)
        before = _seconds_of_children()
        done = subprocess.run(
            command,
            cwd=ROOT,
            capture_output=True,
            text=True,
            check=False,
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (limit, limit + 5)),  # noqa: B023
        )
        budget -= _seconds_of_children() - before
        if done.returncode in (-signal.SIGXCPU, -signal.SIGKILL):
            return "time"
        if done.returncode == USAGE_ERROR and "not found: " in done.stderr:
            raise SystemExit(f"the record names a test that is none: {done.stderr.strip()[-300:]}")
        if done.returncode not in (0, NO_TEST_RAN):
            ends = [
                line.split()[1] for line in done.stdout.splitlines() if line.startswith(("FAILED ", "ERROR "))
            ]
            return ends[0] if ends else f"exit {done.returncode}"
    return ""


def _seconds_of_children() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def plant(fault: Fault) -> str:
    """Write the fault into its file; return the file's text before."""
    path = ROOT / fault.file
    text = path.read_text("utf-8")
    lines = text.splitlines(keepends=True)
    row = lines[fault.line - 1]
    stop = fault.column + len(fault.before)
    lines[fault.line - 1] = row[: fault.column] + fault.after + row[stop:]
    path.write_text("".join(lines), "utf-8")
    return text


def _planted(output: Path) -> set[tuple[str, ...]]:
    """Return the faults that a file of results has."""
    if not output.exists():
        return set()
    with output.open(encoding="utf-8", newline="") as stream:
        return {tuple(row[: len(Fault._fields)]) for row in csv.reader(stream)}


def main() -> None:
    """Plant, test, restore; a row of the output each."""
    count, seed, output = int(sys.argv[1]), int(sys.argv[2]), Path(sys.argv[3])
    budget = float(sys.argv[4]) if len(sys.argv) > 4 else 600.0
    tests = {file: distances(file) for file in (ROOT / "tests").rglob("test_*.py")}
    known = _planted(output)
    with output.open("a", encoding="utf-8", newline="") as stream:
        rows = csv.writer(stream, lineterminator="\n")
        if not known:
            rows.writerow((*Fault._fields, "suite", "test"))
        for fault in drawn(count, seed):
            if tuple(map(str, fault)) in known:
                continue
            before = plant(fault)
            suite, test, late = "", "", ""
            try:
                for suite, arguments in suites(fault, tests).items():
                    test = first_failure(arguments, budget, *(("--day",) if suite == "day" else ()))
                    if test not in ("", "time"):
                        break
                    late = late or test
            finally:
                (ROOT / fault.file).write_text(before, "utf-8")
            rows.writerow((*fault, suite if test else "none", test or late))
            stream.flush()


if __name__ == "__main__":
    main()
