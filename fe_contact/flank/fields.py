"""Declarations of the figures of flank modifications: depths in m, lengths in m, laws by name."""

from __future__ import annotations

from typing import Any, Literal

from bounds import Declared, Direction, Kind, between, declared, one_of

Shape = Literal["linear", "parabolic"]
SHAPES: tuple[Shape, ...] = ("linear", "parabolic")
_DEEPEST = 1e-3  # m; catches micrometers given as meters
_LONGEST = 10.0  # m; what a gear has room for depends on the gear


def amount(along: Direction, description: str, example: float) -> Any:
    """Return the field of material removed in m, >= 0."""
    bound = between(0.0, _DEEPEST)
    return declared(0.0, Declared(Kind.AMOUNT, "m", bound, description, example, along))


def slope(along: Direction, description: str, example: float) -> Any:
    """Return the field of a difference of material removed in m, of either sign."""
    bound = between(-_DEEPEST, _DEEPEST)
    return declared(0.0, Declared(Kind.SLOPE, "m", bound, description, example, along))


def length(along: Direction, description: str, example: float) -> Any:
    """Return the field ``x_length`` of the length in m over which the amount ``x`` acts."""
    return declared(0.0, Declared(Kind.LENGTH, "m", between(0.0, _LONGEST), description, example, along))


def shape(along: Direction, description: str) -> Any:
    """Return the field of the law of a relief over its length."""
    return declared("linear", Declared(Kind.SHAPE, "", one_of(SHAPES), description, "linear", along))
