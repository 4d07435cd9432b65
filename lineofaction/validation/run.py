"""Run of a validation case: compute ours, set it beside theirs."""

from __future__ import annotations

import inspect
import tempfile
import tomllib
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from importlib import import_module
from pathlib import Path
from typing import Any

from bounds import PlausibilityWarning
from host import cpu_seconds
from lineofaction.gearbox.convert.case import gear_pair
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas import Case, validated
from lineofaction.validation.case import TREE, Compared, ValidationCase
from lineofaction.validation.comparison import Comparison, last_digit

NO_DATA = "not run: data not found"

Verb = Callable[[Sequence[str]], Mapping[str, Any]]
"""Runs a verb of `loa` and returns its JSON."""


@dataclass(frozen=True)
class Outcome:
    """A case and its comparisons, or why there are none."""

    case: ValidationCase
    comparisons: tuple[Comparison, ...] = ()
    reason: str = ""
    """Why the case has no comparisons: without its data it is not run, and never counts as agreement."""
    cpu_seconds: float = 0.0

    @property
    def unexplained(self) -> tuple[Comparison, ...]:
        """Comparisons that differ by no stated cause."""
        return tuple(row for row in self.comparisons if not row.agrees and not row.why)

    @property
    def failed(self) -> bool:
        """Whether the computation failed, or a difference has no stated cause."""
        return bool(self.unexplained) or bool(self.reason and self.reason != NO_DATA)

    def to_json(self) -> dict[str, Any]:
        """Return plain JSON."""
        case = self.case
        head = {name: getattr(case, name) for name in ("name", "title", "source", "licence", "measured")}
        computed = {"computed_by": case.function or f"loa {case.verb}", "assumed": list(case.assumed)}
        rows = [row.to_json() for row in self.comparisons]
        ending = {"reason": self.reason, "cpu_seconds": self.cpu_seconds}
        return head | computed | {"comparisons": rows} | ending


def run_case(case: ValidationCase, verb: Verb) -> Outcome:
    """Compute a case; a failure is its outcome, not an exception."""
    begin = cpu_seconds()
    if case.data and case.data_file is None:
        return Outcome(case, reason=NO_DATA)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", PlausibilityWarning)
            answer = _by_verb(case, verb) if case.verb else _by_function(case)
        rows = tuple(_rows(case, answer))
    except Exception as error:  # noqa: BLE001 (the other cases go on; this one says how it failed)
        return Outcome(case, reason=f"{type(error).__name__}: {error}", cpu_seconds=cpu_seconds() - begin)
    return Outcome(case, rows, cpu_seconds=cpu_seconds() - begin)


def _by_verb(case: ValidationCase, verb: Verb) -> Any:
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / f"{case.name}.toml"
        file.write_text(case.case, encoding="utf-8")
        arguments = [str(file) if word == "CASE" else word for word in case.verb.split()]
        # words that name a file of the tree become its path
        return verb([str(TREE / word) if (TREE / word).is_file() else word for word in arguments])


def _by_function(case: ValidationCase) -> Any:
    module, _, name = case.function.partition(":")
    function = getattr(import_module(module), name, None)
    if not (inspect.isfunction(function) and function.__module__.startswith(module)):
        raise BadInput.of("function", case.function, f"a function that {module} defines")
    arguments = dict(case.arguments)
    if case.case:
        text = tomllib.loads(case.case)
        arguments[next(iter(inspect.signature(function).parameters))] = gear_pair(validated(Case, text))
    if case.data:
        arguments["data"] = case.data_file
    return function(**arguments)


def _rows(case: ValidationCase, answer: Any) -> Iterator[Comparison]:
    if not case.compared:
        yield from (replace(row, why=row.why or case.causes.get(row.quantity, "")) for row in answer)
    for compared in case.compared:
        yield _row(compared, answer)


def _row(compared: Compared, answer: Any) -> Comparison:
    leaf = _at(answer, compared.key)
    value, error = getattr(leaf, "value", leaf), getattr(leaf, "error", 0.0)
    if compared.error_key:
        error = _at(answer, compared.error_key)
    stated = last_digit(compared.value) if compared.error is None else compared.error
    ours = float(value) * compared.factor, float(error) * abs(compared.factor)
    return Comparison(compared.quantity, compared.unit, float(compared.value), stated, *ours, compared.why)


def _at(answer: Any, key: str) -> Any:
    """Follow names and indices into mappings, lists and records."""
    for part in key.split("."):
        if isinstance(answer, Mapping):
            answer = answer[part]
        else:
            answer = answer[int(part)] if part.lstrip("-").isdecimal() else getattr(answer, part)
    return answer
