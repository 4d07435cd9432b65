"""A relief towards one end of the flank: from zero where it starts to its amount at the end of its length."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from bounds import Declared, Direction, Kind, SiNote, at_most, between, declarations, declared, one_of
from fe_contact.errors import InputError, within
from fe_contact.flank.part import FlankPart, ReliefStart
from fe_contact.flank.relief_shape import SHAPES, ReliefShape
from fe_contact.flank.tooth import Tooth
from fe_contact.types import FloatArray

_DEEPEST = 1e-3  # m; catches micrometers given as meters
_LONGEST = 10.0  # m; what a gear has room for depends on the gear
_LENGTHS = SiNote("Lengths are in m: 1 mm is 0.001.")


def amount(along: Direction, description: str, example: float, **options: Any) -> Any:
    """Return the field of material removed in m, >= 0."""
    bound = between(0.0, _DEEPEST)
    return declared(0.0, Declared(Kind.AMOUNT, "m", bound, description, example, along, **options))


def slope(along: Direction, description: str, example: float, **options: Any) -> Any:
    """Return the field of a difference of material removed in m, of either sign."""
    bound = between(-_DEEPEST, _DEEPEST)
    return declared(0.0, Declared(Kind.DEVIATION, "m", bound, description, example, along, **options))


def length(along: Direction, description: str, example: float, **options: Any) -> Any:
    """Return the field ``x_length`` of the length in m over which the amount ``x`` acts."""
    bound = between(0.0, _LONGEST)
    return declared(0.0, Declared(Kind.LENGTH, "m", bound, description, example, along, **options))


def shape(along: Direction, description: str, **options: Any) -> Any:
    """Return the field ``x_shape`` of the law of a relief over its length."""
    bound = one_of(tuple(SHAPES))
    return declared("linear", Declared(Kind.SHAPE, "", bound, description, "linear", along, **options))


@dataclass(frozen=True, kw_only=True)
class _Relief(FlankPart):
    """Amount, length and shape, declared in this order; a crowning has no shape and is a parabola.

    Raises `InputError`: an arc of a circle that is deeper than long.
    """

    def __post_init__(self) -> None:
        super().__post_init__()
        if self._shape is SHAPES["circular"] and self._amount > self._length:
            bound = at_most(self._length, "m", "the length of the arc")
            raise InputError(self._name, self._amount, bound, "A circular relief is at most as deep as long.")

    @cached_property
    def _name(self) -> str:
        return next(iter(declarations(type(self))))

    @property
    def _amount(self) -> float:
        return float(getattr(self, self._name))

    @property
    def _length(self) -> float:
        return float(getattr(self, f"{self._name}_length"))

    @property
    def _shape(self) -> ReliefShape:
        return SHAPES[getattr(self, f"{self._name}_shape", "parabolic")]

    def _check_length(self, room: float) -> None:
        """Raise `InputError` if it is longer than the room in m that there is for it."""
        within(f"modification.{self._name}_length", self._length, 0.0, room, _LENGTHS)

    def _depth(self, fraction: FloatArray, length: float) -> FloatArray:
        return np.asarray(self._amount * self._shape(fraction, self._amount / abs(length)))


@dataclass(frozen=True, kw_only=True)
class ProfileRelief(_Relief):
    """A relief from a radius to one end of the involute."""

    _at_tip: ClassVar[bool]

    def check_fits(self, gear: Tooth) -> None:
        """Raise `InputError` if it is longer than the involute."""
        self._check_length(abs(gear.tip_radius - gear.form_radius))

    def removed(self, gear: Tooth, roll_length: FloatArray, face_position: FloatArray) -> FloatArray:
        """See `FlankPart.removed`."""
        start, end = self._span(gear)
        return self._depth((roll_length - start) / (end - start), end - start)

    def relief_starts(self, gear: Tooth, face_position: FloatArray | float = 0.0) -> tuple[ReliefStart, ...]:
        """See `FlankPart.relief_starts`."""
        start, end = self._span(gear)
        return (self._begins(gear, start, end - start),)

    def _span(self, gear: Tooth) -> tuple[float, float]:
        """Return the roll lengths in m from which and to which it runs."""
        radius, inwards = (gear.tip_radius, -1) if self._at_tip else (gear.form_radius, 1)
        end = gear.tip_roll_length if self._at_tip else gear.form_roll_length
        return gear.roll_length(radius + inwards * gear.sign * self._length), end

    def _begins(self, gear: Tooth, start: FloatArray | float, length: float) -> ReliefStart:
        """Return where it begins; over a roll length in m, < 0 if that falls.

        The fraction u of its length grows with the arc d as du/dd = r_b/(l |length|), and l l' = +-r_b.
        """
        amount, shape = self._amount, self._shape
        slope = gear.base_radius / (start * abs(length))
        bend = amount * shape.bend(amount / abs(length)) * slope**2
        if shape.slope:
            bend = bend - amount * shape.slope * gear.base_radius**2 / (start**3 * length)
        return ReliefStart(start, self._at_tip, amount * shape.slope * slope, bend)


@dataclass(frozen=True, kw_only=True)
class FaceRelief(_Relief):
    """A relief over a part of the face, to one end or both."""

    def _outwards(self, face_position: FloatArray) -> FloatArray:
        raise NotImplementedError

    def _room(self, gear: Tooth) -> float:
        """Return how long it may be, m."""
        return gear.face_width

    def check_fits(self, gear: Tooth) -> None:
        """Raise `InputError` if it is longer than the face has room."""
        self._check_length(self._room(gear))

    def removed(self, gear: Tooth, roll_length: FloatArray, face_position: FloatArray) -> FloatArray:
        """See `FlankPart.removed`."""
        from_start = (self._outwards(face_position) - 0.5 * gear.face_width) / self._length + 1.0
        return self._depth(from_start, self._length)
