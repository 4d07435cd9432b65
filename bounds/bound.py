"""Bounds as data: the ends of a range in SI, or a choice of names.

A field's static range is declared as an `Interval`. A `Bound` is that range, or a computed one, with the text
of a message. The text is a `Text`, whose numbers stay numbers until it is written for a `Reader`: a caller
from Python or of a file, who has names for fields and units of his own (see `bounds.text`).
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

from annotated_types import Interval

from bounds.text import NOTHING, Reader, Text, Wording

LIMIT_SLACK = 1e-12
"""Relative rounding of a computed limit: too small to be seen in the limit as printed."""
MAX_BYTES = 8e9
"""Bytes of the arrays that a computation may hold at once; a larger one is refused before it begins."""


@dataclass(frozen=True)
class Bound:
    """The range of values that a field accepts.

    Its ends are written with seven digits in the unit of the field, rounded to the side that is accepted.
    Where both ends are the same value, that value is written with twelve digits.
    """

    low: float | None = None
    high: float | None = None
    """`low`, `high`: Ends in SI; None: the range has no end on that side."""
    low_open: bool = False
    high_open: bool = False
    """`low_open`, `high_open`: Whether the end itself is refused."""
    integer: bool = False
    """Whether only integers are accepted."""
    unit: str = ""
    """Symbol of the field's SI unit, e.g. ``"m"``; empty: no unit is written."""
    low_name: str = ""
    high_name: str = ""
    """`low_name`, `high_name`: Names of the ends, written before their values: ``"the bore diameter"``."""
    note: Text = NOTHING
    """Text that is written after the range, e.g. ``", where the fillet ends"``."""

    @classmethod
    def of(cls, ends: Interval, *, integer: bool = False, unit: str = "") -> Bound:
        """Return the bound of a static range; `gt` and `lt` are open ends, `ge` and `le` closed ones."""
        low_open, high_open = ends.gt is not None, ends.lt is not None
        return cls(
            low=ends.gt if low_open else ends.ge,  # type: ignore[arg-type]
            high=ends.lt if high_open else ends.le,  # type: ignore[arg-type]
            low_open=low_open,
            high_open=high_open,
            integer=integer,
            unit=unit,
        )

    def holds(self, value: float) -> bool:
        """Whether a finite number is accepted.

        An open end is refused exactly. A closed end is accepted with a rounding of `LIMIT_SLACK` beyond it.
        """
        return self._above_low(value) and self._below_high(value)

    def _above_low(self, value: float) -> bool:
        if self.low is None:
            return True
        return value > self.low if self.low_open else value >= self.low - LIMIT_SLACK * abs(self.low)

    def _below_high(self, value: float) -> bool:
        if self.high is None:
            return True
        return value < self.high if self.high_open else value <= self.high + LIMIT_SLACK * abs(self.high)

    def worded(self, reader: Reader) -> str:
        """Return the bound in words for a reader, to be read after "must be"."""
        unit = reader.field_unit(self.unit)
        if self.low is not None and self.low == self.high:
            return f"{unit.exact(self.low)}{self.note.worded(reader)}"
        low = "" if self.low is None else f"{self.low_name} {unit.low(self.low)}".lstrip()
        high = "" if self.high is None else f"{self.high_name} {unit.high(self.high)}".lstrip()
        kind = "an integer " if self.integer else ""
        return f"{kind}{self._range(low, high)}{self.note.worded(reader)}"

    def _range(self, low: str, high: str) -> str:
        """Return the range in words; an end that is missing is an empty string."""
        if low and high and not self.low_open:
            return f"from {low} to {'below ' if self.high_open else ''}{high}"
        sides = []
        if low:
            sides.append(f"{'above' if self.low_open else 'at least'} {low}")
        if high:
            sides.append(f"{'below' if self.high_open else 'at most'} {high}")
        return " and ".join(sides)

    def __str__(self) -> str:
        return self.worded(Reader())


@dataclass(frozen=True)
class Choice:
    """A choice of names."""

    names: tuple[str, ...]

    def worded(self, reader: Reader) -> str:
        """Return the names in quotes; a choice without names says that the field must be absent."""
        names = ", ".join(f'"{name}"' for name in self.names)
        return f"one of {names}" if names else "absent"

    def __str__(self) -> str:
        return self.worded(Reader())


def above(low: float, unit: str = "", name: str = "", note: Wording = "") -> Bound:
    """Return the bound above `low`; `name` is written before the number, `note` after it."""
    return Bound(low=low, low_open=True, unit=unit, low_name=name, note=Text.of(note))


def at_least(low: float, unit: str = "", name: str = "", note: Wording = "") -> Bound:
    """Return the bound from `low` on; `name` is written before the number, `note` after it."""
    return Bound(low=low, unit=unit, low_name=name, note=Text.of(note))


def below(high: float, unit: str = "", name: str = "", note: Wording = "") -> Bound:
    """Return the bound below `high`; `name` is written before the number, `note` after it."""
    return Bound(high=high, high_open=True, unit=unit, high_name=name, note=Text.of(note))


def at_most(high: float, unit: str = "", name: str = "", note: Wording = "") -> Bound:
    """Return the bound up to `high`; `name` is written before the number, `note` after it."""
    return Bound(high=high, unit=unit, high_name=name, note=Text.of(note))


def from_to(low: float, high: float, unit: str = "", high_name: str = "", note: Wording = "") -> Bound:
    """Return the bound from `low` to `high`, both accepted; `high_name` is written before `high`."""
    return Bound(low=low, high=high, unit=unit, high_name=high_name, note=Text.of(note))


def exactly(value: float, note: Wording = "") -> Bound:
    """Return the bound that only `value` meets."""
    return Bound(low=value, high=value, note=Text.of(note))


def one_of(names: Collection[str]) -> Choice:
    """Return the choice of `names`."""
    return Choice(tuple(names))


def between(low: float, high: float) -> Interval:
    """Return the static range from `low` to `high`, both accepted, for the declaration of a field."""
    return Interval(ge=low, le=high)


def up_to(high: float) -> Interval:
    """Return the static range above 0 up to `high`, for the declaration of a field."""
    return Interval(gt=0.0, le=high)


integers = between
"""The static range of a count: the same as `between`, named for the declaration of an integer field."""
