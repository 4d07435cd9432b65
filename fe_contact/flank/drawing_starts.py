"""Starts of reliefs as drawings state them (ISO 21771-1): by diameter, roll length or roll angle.

The point of a flank at the roll length l has the roll angle xi = tan(alpha_y) = l/r_b and the diameter
d_y = d_b sqrt(1 + xi^2).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from bounds import (
    Bound,
    Declared,
    Direction,
    FieldName,
    Kind,
    Text,
    between,
    declarations,
    declared,
    described,
)
from fe_contact.errors import InputError, declared_fields
from fe_contact.flank.part import SHORTEST
from fe_contact.flank.tooth import Tooth
from fe_contact.involute import radius_at_roll_length, roll_length_at_radius

_REMEDY = "A relief starts on the involute, before the end of the flank to which it runs."


@dataclass(frozen=True)
class _Way:
    """A coordinate that names a point of a flank, with its conversion to roll length and back."""

    text: str
    unit: str
    maximum: float
    """Largest value, in SI."""
    of_roll_length: Callable[[float, float], float]
    roll_length: Callable[[float, float], float]
    """`of_roll_length`, `roll_length`: Conversions at a base radius, m, to the named value and back."""


WAYS = {
    "start_diameter": _Way(
        "diameter",
        "m",
        20.0,
        lambda base, roll: 2.0 * radius_at_roll_length(base, roll),
        lambda base, diameter: roll_length_at_radius(base, max(base, 0.5 * diameter)),
    ),
    "start_roll_length": _Way("roll length", "m", 10.0, lambda _, roll: roll, lambda _, roll: roll),
    "start_roll_angle": _Way(
        "roll angle", "rad", 2.0 * math.pi, lambda base, roll: roll / base, lambda base, angle: base * angle
    ),
}


def _start(relief: str, way: str, example: float) -> Any:
    """Return the field of one way to state where a relief starts."""
    kind = WAYS[way]
    text = f"{kind.text.capitalize()} at which the {relief} starts, instead of its length"
    bound = between(0.0, kind.maximum)
    return declared(
        None, Declared(Kind.START, kind.unit, bound, text, example, Direction.PROFILE, omit_default=True)
    )


@described
@dataclass(frozen=True, kw_only=True)
class DrawingStarts:
    """Starts of the reliefs of a gear, each stated in one way or none.

    Raises `InputError`: a value out of its bound.
    """

    tip_relief_start_diameter: float | None = _start("tip relief", "start_diameter", 87e-3)
    tip_relief_start_roll_length: float | None = _start("tip relief", "start_roll_length", 21e-3)
    tip_relief_start_roll_angle: float | None = _start("tip relief", "start_roll_angle", math.radians(31.0))
    root_relief_start_diameter: float | None = _start("root relief", "start_diameter", 77e-3)
    root_relief_start_roll_length: float | None = _start("root relief", "start_roll_length", 9e-3)
    root_relief_start_roll_angle: float | None = _start("root relief", "start_roll_angle", math.radians(14.0))

    def __post_init__(self) -> None:
        declared_fields(self)

    def lengths(self, modification: Mapping[str, Any], gear: Callable[[], Tooth]) -> dict[str, float]:
        """Return the lengths of the reliefs whose start is stated, by their field of `FlankModification`, m.

        `modification` has the stated fields, in m; `gear` makes the gear, where one is needed.
        Raises `InputError`: a relief has both length and start, or two starts, or acts without any; a start
        is beside the involute.
        """
        starts = {relief: self._start_of(relief, modification) for relief in RELIEFS}
        return {
            f"{relief}_length": relief_length(gear(), f"{relief}_{way}", value)
            for relief, start in starts.items()
            for way, value in start.items()
        }

    def _start_of(self, relief: str, modification: Mapping[str, Any]) -> dict[str, float]:
        """Return the one way in which a start is stated, and its value; none where a length is."""
        by_field = {f"{relief}_{way}": way for way in WAYS}
        starts = {field: value for field in by_field if (value := getattr(self, field)) is not None}
        length, text = modification.get(f"{relief}_length", 0.0), relief.replace("_", " ")
        ways = [*([f"{relief}_length"] if length else []), *starts]
        if len(ways) > 1:
            bound = Text.of("left out beside ", FieldName(ways[0]))
            remedy = f"State once where the {text} starts."
            raise InputError(f"modification.{ways[1]}", starts[ways[1]], bound, remedy)
        if not ways and modification.get(relief, 0.0):
            names = tuple(part for field in by_field for part in (", ", FieldName(field)))
            bound = Text.of("above 0, or left out beside one of ", *names[1:])  # without the first comma
            raise InputError(
                f"modification.{relief}_length", length, bound, f"State where the {text} starts."
            )
        return {by_field[field]: value for field, value in starts.items()}


def relief_start(gear: Tooth, field: str, length: float) -> float:
    """Return the value of a field of `DrawingStarts`, SI, where a relief of a length, m, starts."""
    at_tip = field.startswith("tip")
    end, other = (gear.tip_radius, gear.form_radius) if at_tip else (gear.form_radius, gear.tip_radius)
    radius = end + math.copysign(min(length, abs(other - end)), other - end)
    way = WAYS[field.partition("_relief_")[2]]
    return way.of_roll_length(gear.base_radius, roll_length_at_radius(gear.base_radius, radius))


def relief_length(gear: Tooth, field: str, start: float) -> float:
    """Return the length along the radius, m, of a relief that starts where a field of `DrawingStarts` says.

    Raises `InputError`: the start is beside the involute.
    """
    at_tip = field.startswith("tip")
    way = WAYS[field.partition("_relief_")[2]]
    form, tip = (
        way.of_roll_length(gear.base_radius, roll) for roll in (gear.form_roll_length, gear.tip_roll_length)
    )
    names = {form: f"the form {way.text}", tip: f"the tip {way.text}"}
    low, high = sorted(names)
    end = tip if at_tip else form
    bound = Bound(
        low,
        high,
        low_open=end == low,  # a relief does not start at the end to which it runs
        high_open=end == high,
        low_name=names[low],
        high_name=names[high],
    )
    if not bound.holds(start):
        raise InputError(f"modification.{field}", start, bound, _REMEDY)
    radius = radius_at_roll_length(gear.base_radius, way.roll_length(gear.base_radius, start))
    length = abs(radius - (gear.tip_radius if at_tip else gear.form_radius))
    return min(max(length, SHORTEST), abs(gear.tip_radius - gear.form_radius))


RELIEFS = tuple(dict.fromkeys(field.partition("_start_")[0] for field in declarations(DrawingStarts)))
"""The amounts whose length may be stated by its start."""


def starts_of(relief: str) -> tuple[str, ...]:
    """Return the fields that state where a relief starts."""
    return tuple(f"{relief}_{way}" for way in WAYS)
