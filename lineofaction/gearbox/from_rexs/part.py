"""A component as an import reads it: each value that is asked for is entered as taken."""

from __future__ import annotations

from dataclasses import dataclass

from lineofaction.gearbox.from_rexs.account import Account, Fate
from lineofaction.gearbox.rexs import Attribute, Component, quantities, quantity


@dataclass(frozen=True)
class Part:
    """A component with the account of the import.

    A value read is taken, in the words of the reader; `say` corrects the entry afterwards: derived,
    defaulted, ignored or refused.
    """

    component: Component
    account: Account

    @property
    def id(self) -> int:
        """Id of the component."""
        return self.component.id

    @property
    def type(self) -> str:
        """Type of the component."""
        return self.component.type

    @property
    def place(self) -> str:
        """Where the component stands in the file."""
        return self.account.place(self.component)

    @property
    def name(self) -> str:
        """Name in the file, or type and id."""
        return self.component.name or f"{self.type} {self.id}"

    def number(self, item: str, words: str) -> float | None:
        """Return a number in SI, None where the file gives none.

        Raises
        ------
        BadInput
            It is no number, is given twice, or its unit belongs to another quantity.
        """
        value = quantity(self.component, item, self.place)
        if value is not None:
            self.say(item, "taken", words)
        return value

    def numbers(self, item: str, words: str) -> tuple[float, ...] | None:
        """Return an array of numbers in SI, None where the file gives none.

        Raises
        ------
        BadInput
            As of `number`.
        """
        values = quantities(self.component, item, self.place)
        if values is not None:
            self.say(item, "taken", words)
        return values

    def vector(self, item: str, words: str) -> tuple[float, ...] | None:
        """Return an array of numbers in SI, None where the file gives none, or no array.

        One writer's JSON has ``false`` in place of vectors: such a value is refused in the account.

        Raises
        ------
        BadInput
            As of `number`.
        """
        attribute = self.component.attribute(item)
        if attribute is not None and attribute.value is not None and not isinstance(attribute.value, tuple):
            self.say(item, "refused", f"{attribute.value} is no vector")
            return None
        return self.numbers(item, words)

    def text(self, item: str, words: str) -> str | None:
        """Return a word or a name, None where the file gives none."""
        attribute = self.component.attribute(item)
        if attribute is None or attribute.value is None:
            return None
        self.say(item, "taken", words)
        return str(attribute.value)

    def attribute(self, item: str) -> Attribute | None:
        """Return an attribute as it stands, without an entry in the account."""
        return self.component.attribute(item)

    def say(self, item: str, fate: Fate, words: str) -> None:
        """State what becomes of an attribute that the component has or lacks; "" is the component."""
        self.account.say(self.component, item, fate, words)
