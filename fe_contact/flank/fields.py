"""Declarations of the figures of flank modifications: depths in m, lengths in m, laws by name."""

from __future__ import annotations

from typing import Any

from bounds import Declared, Direction, Kind, between, declared, one_of
from fe_contact.flank.relief_shape import SHAPES

_DEEPEST = 1e-3  # m; catches micrometers given as meters
_LONGEST = 10.0  # m; what a gear has room for depends on the gear


def amount(along: Direction, description: str, example: float, *, later: bool = False) -> Any:
    """Return the field of material removed in m, >= 0."""
    bound = between(0.0, _DEEPEST)
    return declared(0.0, Declared(Kind.AMOUNT, "m", bound, description, example, along, later=later))


def slope(along: Direction, description: str, example: float) -> Any:
    """Return the field of a difference of material removed in m, of either sign."""
    bound = between(-_DEEPEST, _DEEPEST)
    return declared(0.0, Declared(Kind.SLOPE, "m", bound, description, example, along))


def length(along: Direction, description: str, example: float, *, later: bool = False) -> Any:
    """Return the field ``x_length`` of the length in m over which the amount ``x`` acts."""
    bound = between(0.0, _LONGEST)
    return declared(0.0, Declared(Kind.LENGTH, "m", bound, description, example, along, later=later))


def shape(along: Direction, description: str, *, later: bool = False) -> Any:
    """Return the field ``x_shape`` of the law of a relief over its length."""
    bound = one_of(tuple(SHAPES))
    return declared("linear", Declared(Kind.SHAPE, "", bound, description, "linear", along, later=later))
