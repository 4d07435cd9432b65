"""A number of a component that a field of the scene takes, or that the account refuses."""

from __future__ import annotations

from bounds import Bound, Declared
from lineofaction.gearbox.from_rexs.part import Part


def bounded_number(part: Part, item: str, words: str, field: Declared) -> float | None:
    """Return a number in SI; None where the file gives none, or one out of the bounds of `field`.

    Raises
    ------
    BadInput
        As of `Part.number`.
    """
    value, attribute = part.number(item, words), part.attribute(item)
    if value is None or attribute is None or not isinstance(field.bound, Bound) or field.bound.holds(value):
        return value
    part.say(item, "refused", f"{attribute.value} {attribute.unit} is not {field.bound} {field.unit}")
    return None
