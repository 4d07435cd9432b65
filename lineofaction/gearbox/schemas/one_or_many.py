"""Fields that take one value for all, or a list with one for each."""

from __future__ import annotations

from pydantic import Discriminator, Tag

ONE, MANY = Tag("[one]"), Tag("[many]")
"""Marks of the two types; names in brackets are left out of what a fault is called."""


def _shape(value: object) -> str:
    """Tell one value from a list of them."""
    return (MANY if isinstance(value, list | tuple) else ONE).tag


ONE_OR_MANY = Discriminator(_shape)
"""Chooses the type by the value, so that a fault is that of the type that was meant."""
