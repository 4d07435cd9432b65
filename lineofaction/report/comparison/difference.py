"""A difference of two results with its error, and whether it is shown."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from fe_contact.types import Estimate
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import Table, number

COLORS = (palette.BLUE, palette.VERMILLION)
"""Of the first result and of the second."""


@dataclass(frozen=True)
class Difference:
    """One number of two results.

    Attributes
    ----------
    name, where : str
        What, and at which load or speed.
    first, second : Estimate
        In the unit in which they are written.
    """

    name: str
    where: str
    first: Estimate
    second: Estimate

    @property
    def value(self) -> float:
        """Second less first."""
        return self.second.value - self.first.value

    @property
    def error(self) -> float:
        """Root of the sum of both errors squared: each holds on its own. NaN where one is not stated."""
        return math.hypot(self.first.error, self.second.error)

    @property
    def is_shown(self) -> bool:
        """Whether the difference is larger than its error."""
        return abs(self.value) > self.error

    @property
    def finding(self) -> str:
        """The conclusion in words."""
        if math.isnan(self.error):
            return "no error stated"
        if not self.is_shown:
            return "not shown to differ"
        return "the second is larger" if self.value > 0.0 else "the second is smaller"

    def __str__(self) -> str:
        """Write the difference with its error and what follows."""
        return f"{self.written}: {self.finding}"

    @property
    def written(self) -> str:
        """The difference with its error, both to the last digit that counts."""
        unit = self.first.unit
        if math.isnan(self.error):
            return f"{number(self.value, 3)} {unit}"
        digits = _decimals(self.error or self.value)
        return f"{self.value:+.{digits}f} ± {self.error:.{digits}f} {unit}"


def differences_table(differences: Sequence[Difference], names: Sequence[str]) -> Table:
    """Tabulate differences, each with what follows from it."""
    rows = tuple(
        (one.name, one.where, _estimate(one.first), _estimate(one.second), one.written, one.finding)
        for one in differences
    )
    head = ("quantity", "at", *names, "second less first", "finding")
    return Table("Differences with their errors", head, rows)


def changed_fields(cases: Mapping[str, Mapping[str, Any]]) -> Table:
    """Tabulate the fields of two cases or scenes, by their names, that are not equal."""
    flat = [dict(_flat(case)) for case in cases.values()]
    fields = dict.fromkeys(field for case in flat for field in case)
    rows = tuple(
        (field, *(_text(case.get(field)) for case in flat))
        for field in fields
        if any(case.get(field) != flat[0].get(field) for case in flat)
    )
    return Table("Fields that differ", ("field", *cases), rows)


def _flat(content: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    """Yield every value with its path; lists of numbers stay whole."""
    if isinstance(content, Mapping):
        for key, value in content.items():
            yield from _flat(value, f"{path}.{key}" if path else str(key))
    elif isinstance(content, list) and any(isinstance(value, Mapping | list) for value in content):
        for index, value in enumerate(content):
            name = value.get("name", index) if isinstance(value, Mapping) else index
            yield from _flat(value, f"{path}[{name}]")
    else:
        yield path, content


def _text(value: Any) -> str:
    """Write a value of a field; one that is not there is left out."""
    if isinstance(value, float):
        return f"{value:g}"
    return "" if value is None else str(value)


def _estimate(value: Estimate) -> str:
    """Write a number with its error."""
    if math.isnan(value.error):
        return f"{number(value.value, 4)} {value.unit}"
    digits = _decimals(value.error or value.value)
    return f"{value.value:.{digits}f} ± {value.error:.{digits}f} {value.unit}"


def _decimals(error: float) -> int:
    if error == 0.0 or not math.isfinite(error):
        return 3
    return max(1 - math.floor(math.log10(abs(error))), 0)
