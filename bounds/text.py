"""Text of messages, whose numbers stay numbers until somebody reads it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Literal, Protocol, Self, runtime_checkable

from bounds.unit import DIGITS, Unit


@dataclass(frozen=True)
class Reader:
    """A caller from Python, who knows the libraries' names and SI; others derive from it.

    `field`: the field that the message is about, by its name in the library; empty for none.
    """

    field: str = ""
    knows_si: ClassVar[bool] = True

    def at(self, field: str) -> Self:
        """Return the same reader of a message about `field`."""
        return type(self)(field)

    @property
    def name(self) -> str:
        """The reader's name of the field."""
        return self.field

    def field_unit(self, unit: str) -> Unit:
        """Return the unit of the field itself, whose SI unit is `unit` (empty: not to be written)."""
        return Unit(unit)

    def unit(self, value: float, unit: str) -> Unit:
        """Return the unit in which a `value` in the SI unit `unit` is written inside words."""
        return Unit(unit)

    def field_value(self, value: Any) -> Any:
        """Return a value of the field, in its unit."""
        return value.worded(self) if isinstance(value, _Worded) else value


@runtime_checkable
class _Worded(Protocol):
    """Anything that can be put into words for a reader."""

    def worded(self, reader: Reader) -> str:
        """Return the text in the reader's units and names."""


Wording = str | _Worded
"""Words without numbers that carry a unit, or anything that can be put into words."""


@dataclass(frozen=True)
class Quantity:
    """A number inside a message."""

    value: float
    """Value in SI."""
    unit: str = ""
    """Symbol of the SI unit, e.g. ``"m"``, ``"N/m^3"``; empty for a pure number."""
    digits: int = DIGITS
    """Significant digits to write."""
    side: Literal["", "low", "high"] = ""
    """"low" and "high": a limit, rounded to the side that is accepted when it is typed."""

    def worded(self, reader: Reader) -> str:
        """Return the number in the reader's unit."""
        unit = reader.unit(self.value, self.unit)
        if self.side:
            return unit.low(self.value) if self.side == "low" else unit.high(self.value)
        return unit.after(f"{self.value / unit.factor:.{self.digits}g}")


@dataclass(frozen=True)
class FieldName:
    """The name of another field inside a message, by its name in the library."""

    name: str

    def worded(self, reader: Reader) -> str:
        """Return the reader's name of it."""
        return reader.at(self.name).name


@dataclass(frozen=True)
class SiNote:
    """A remark on SI units, such as "In m: 25 mm is 0.025."; readers with other units do not see it."""

    text: str

    def worded(self, reader: Reader) -> str:
        """Return the remark, or nothing."""
        return self.text if reader.knows_si else ""


@dataclass(frozen=True)
class Text:
    """Words and quantities in a row.

    `parts`: plain words, `Quantity`, `SiNote`, `Bound`, another `Text` or a whole `RefusedValue`.
    """

    parts: tuple[Wording, ...] = ()

    @classmethod
    def of(cls, *parts: Wording) -> Text:
        """Return the text of `parts`, one after the other without space between them."""
        return cls(parts)

    def worded(self, reader: Reader) -> str:
        """Return the text in the reader's units and names."""
        return "".join(part if isinstance(part, str) else part.worded(reader) for part in self.parts)

    def __str__(self) -> str:
        return self.worded(Reader())


NOTHING = Text()
