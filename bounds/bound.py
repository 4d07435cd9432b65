"""Bounds as data: the ends of a range in SI, or a choice of names."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

from annotated_types import Interval

from bounds.text import NOTHING, Reader, Text, Wording

LIMIT_SLACK = 1e-12
"""Relative rounding of a computed limit, which its printed form does not show."""
MAX_BYTES = 8e9
"""Of the arrays that a computation holds at once; what would take more is refused before it begins."""


@dataclass(frozen=True)
class Bound:
    """The range of values that a field accepts.

    Its ends are written with seven digits, rounded to the side that is accepted, in the unit of the field;
    where they are one, that value is written with twelve.
    """

    low: float | None = None
    high: float | None = None
    """`low`, `high`: Ends in SI; None is no end."""
    low_open: bool = False
    high_open: bool = False
    """`low_open`, `high_open`: Whether the end itself is refused."""
    integer: bool = False
    """Whether only integers are accepted."""
    unit: str = ""
    """Symbol of the field's SI unit if it is to be written, e.g. ``"m"``."""
    low_name: str = ""
    high_name: str = ""
    """`low_name`, `high_name`: What an end is, written before it, e.g. ``"the bore diameter"``."""
    note: Text = NOTHING
    """What follows, e.g. ``", where the fillet ends"``."""

    @classmethod
    def of(cls, ends: Interval, *, integer: bool = False, unit: str = "") -> Bound:
        """Return the bound of a static range."""
        low, high = (ends.ge if ends.gt is None else ends.gt), (ends.le if ends.lt is None else ends.lt)
        return cls(low, high, ends.gt is not None, ends.lt is not None, integer, unit)  # type: ignore[arg-type]

    def holds(self, value: float) -> bool:
        """Whether a finite number is accepted; an end that belongs to the range is so but for rounding."""
        low, high = self.low, self.high
        above = low is None or (value > low if self.low_open else value >= low - LIMIT_SLACK * abs(low))
        return above and (
            high is None or (value < high if self.high_open else value <= high + LIMIT_SLACK * abs(high))
        )

    def worded(self, reader: Reader) -> str:
        """Return the bound, to be read after "must be"."""
        unit = reader.field_unit(self.unit)
        if self.low is not None and self.low == self.high:
            return f"{unit.exact(self.low)}{self.note.worded(reader)}"
        low = "" if self.low is None else f"{self.low_name} {unit.low(self.low)}".lstrip()
        high = "" if self.high is None else f"{self.high_name} {unit.high(self.high)}".lstrip()
        kind = "an integer " if self.integer else ""
        return f"{kind}{self._range(low, high)}{self.note.worded(reader)}"

    def _range(self, low: str, high: str) -> str:
        """Say between which ends."""
        if low and high and not self.low_open:
            return f"from {low} to {'below ' if self.high_open else ''}{high}"
        sides = (
            f"{'above' if self.low_open else 'at least'} {low}" if low else "",
            f"{'below' if self.high_open else 'at most'} {high}" if high else "",
        )
        return " and ".join(side for side in sides if side)

    def __str__(self) -> str:
        return self.worded(Reader())


@dataclass(frozen=True)
class Choice:
    """A choice of names."""

    names: tuple[str, ...]

    def worded(self, reader: Reader) -> str:
        """Return the names in quotes."""
        names = ", ".join(f'"{name}"' for name in self.names)
        return f"one of {names}" if names else "absent"

    def __str__(self) -> str:
        return self.worded(Reader())


def above(low: float, unit: str = "", name: str = "", note: Wording = "") -> Bound:
    """Return the bound above `low`, which is the quantity called `name`."""
    return Bound(low=low, low_open=True, unit=unit, low_name=name, note=Text.of(note))


def at_least(low: float, unit: str = "", name: str = "", note: Wording = "") -> Bound:
    """Return the bound from `low`, which is the quantity called `name`."""
    return Bound(low=low, unit=unit, low_name=name, note=Text.of(note))


def below(high: float, unit: str = "", name: str = "", note: Wording = "") -> Bound:
    """Return the bound below `high`, which is the quantity called `name`."""
    return Bound(high=high, high_open=True, unit=unit, high_name=name, note=Text.of(note))


def at_most(high: float, unit: str = "", name: str = "", note: Wording = "") -> Bound:
    """Return the bound up to `high`, which is the quantity called `name`."""
    return Bound(high=high, unit=unit, high_name=name, note=Text.of(note))


def from_to(low: float, high: float, unit: str = "", high_name: str = "", note: Wording = "") -> Bound:
    """Return the bound from `low` to `high`, both accepted; `high` is the quantity called `high_name`."""
    return Bound(low=low, high=high, unit=unit, high_name=high_name, note=Text.of(note))


def exactly(value: float, note: Wording = "") -> Bound:
    """Return the bound that only `value` meets."""
    return Bound(low=value, high=value, note=Text.of(note))


def one_of(names: Collection[str]) -> Choice:
    """Return the choice of `names`."""
    return Choice(tuple(names))


def between(low: float, high: float) -> Interval:
    """Return the range from `low` to `high`, both accepted."""
    return Interval(ge=low, le=high)


def up_to(high: float) -> Interval:
    """Return the range above 0 up to `high`."""
    return Interval(gt=0.0, le=high)


integers = between
"""The range of a count."""
