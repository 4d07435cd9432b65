"""Readers of messages: by which names and in which units they know the fields."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Protocol, Self, runtime_checkable

from bounds.unit import Unit


@dataclass(frozen=True)
class Reader:
    """A caller from Python, who knows the libraries' names and SI; others derive from it.

    Attributes
    ----------
    field : str
        The field that the message is about, by its name in the library; empty for none.
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

    def own_unit(self, unit: str) -> Unit:
        """Return the unit of the field itself, whose SI unit is `unit` (empty: not to be written)."""
        return Unit(unit)

    def unit(self, value: float, unit: str) -> Unit:
        """Return the unit in which a `value` in the SI unit `unit` is written inside words."""
        return Unit(unit)

    def shown(self, value: Any) -> Any:
        """Return a value of the field, in its unit."""
        return value.worded(self) if isinstance(value, Worded) else value


@runtime_checkable
class Worded(Protocol):
    """Anything that can be put into words for a reader."""

    def worded(self, reader: Reader) -> str:
        """Return it in the reader's units and names."""
        ...
