"""Design variables: figures of the flank modifications that may be chosen, each between bounds.

A figure is one quantity of the modification of one gear, named ``gear.quantity``.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import reduce

from bounds import Direction, Kind, SiNote, Text, above, at_least
from fe_contact.effects import Effect, named
from fe_contact.errors import InputError, finite
from fe_contact.flank.modification import FLANK_FIELDS, fields_of
from fe_contact.geometry import ParallelAxes
from model_studies import in_unit

GEARS = ("pinion", "wheel")
QUANTITIES = fields_of(Kind.AMOUNT, Kind.DEVIATION, Kind.LENGTH)
"""Fields of `FlankModification` that can be varied."""
SLOPES, LENGTHS = fields_of(Kind.DEVIATION), fields_of(Kind.LENGTH)
"""`SLOPES`, `LENGTHS`: Quantities that may be negative, and lengths along the flank. All other quantities are
depths of removed material, at least 0.
"""
ACROSS_FACE = tuple(name for name in QUANTITIES if Direction.FACE in FLANK_FIELDS[name].along)


@dataclass(frozen=True)
class DesignVariable:
    """One quantity of one gear's modification, free between bounds."""

    name: str
    """``gear.quantity``, such as ``"pinion.tip_relief"``: a gear of `GEARS` and a field of
    `FlankModification` among `QUANTITIES`.
    """
    low: float = field(metadata=in_unit("m"))
    high: float = field(metadata=in_unit("m"))
    """`low`, `high`: Bounds in m, low < high."""

    def __post_init__(self) -> None:
        gear_and_quantity(f"variables.{self.name}", self.name)
        where, quantity = f"variables.{self.name}", self.quantity
        finite(f"{where}.low", self.low)
        finite(f"{where}.high", self.high)
        if quantity in LENGTHS and self.low <= 0.0:
            bound = above(0.0, note=", as it is a length")
            raise InputError(f"{where}.low", self.low, bound, SiNote("0.0005 is 0.5 mm."))
        if quantity not in SLOPES and self.low < 0.0:
            raise InputError(f"{where}.low", self.low, at_least(0.0, note=", as it is material removed"))
        if self.high <= self.low:
            raise InputError(f"{where}.high", self.high, above(self.low, name="the lower bound"))

    @property
    def gear(self) -> str:
        """One of `GEARS`."""
        return self.name.partition(".")[0]

    @property
    def quantity(self) -> str:
        """Field of the modification."""
        return self.name.partition(".")[2]

    @property
    def acting(self) -> float:
        """A value at which the variable acts: the middle of its bounds, or the upper one if that is zero."""
        return 0.5 * (self.low + self.high) or self.high


def gear_and_quantity(field: str, name: str) -> tuple[str, str]:
    """Split ``gear.quantity``.

    Raises `InputError`: `name` is not of this form; the error is that of `field`.
    """
    gear, _, quantity = name.partition(".")
    if gear not in GEARS or quantity not in QUANTITIES:
        bound = f"one of {' and '.join(GEARS)}, a dot, and one of {', '.join(QUANTITIES)}"
        raise InputError(field, name, bound, 'For example "pinion.tip_relief".')
    return gear, quantity


def effect_of(name: str, registry: Sequence[Effect]) -> str:
    """Return the name of the effect by which a figure acts: modifications along the face, or the profile."""
    return named(registry, "face" if name.partition(".")[2] in ACROSS_FACE else "profile")


def check_variables(pair: ParallelAxes, variables: Sequence[DesignVariable]) -> None:
    """Check the variables of a search against the gears and against each other.

    Raises `InputError`: there is no variable, a variable stands twice, a relief has no length, or the
    modifications at the bounds do not fit the gears.
    """
    names = [variable.name for variable in variables]
    if not names:
        raise InputError("variables", names, "at least one", 'For example "pinion.tip_relief".')
    for name in names:
        if names.count(name) > 1:
            raise InputError("variables", name, "given once")
    for variable in variables:
        length = f"{variable.quantity}_length"
        if lacks_length(pair, variable.name) and f"{variable.gear}.{length}" not in names:
            remedy = f"Give {variable.gear}.{length} a value in the case, or make it a variable."
            raise InputError(f"variables.{variable.name}", "free", "beside the length of that relief", remedy)
    for end in ("low", "high"):
        at_end = {variable.name: float(getattr(variable, end)) for variable in variables}
        try:
            modified(pair, at_end)
        except InputError as error:
            raise InputError(f"variables ({end})", at_end, Text.of("bounds with ", error)) from None


def lacks_length(pair: ParallelAxes, relief: str) -> bool:
    """Whether ``gear.quantity`` is a relief that has no length yet."""
    gear, _, quantity = relief.partition(".")
    # None: a modification without a field for this length, which needs none
    return bool(getattr(getattr(pair, gear).modification, f"{quantity}_length", None) == 0.0)


def figure(pair: ParallelAxes, name: str) -> float:
    """Return ``gear.quantity`` of the pair's own modifications, m."""
    gear, _, quantity = name.partition(".")
    return float(getattr(getattr(pair, gear).modification, quantity))


def modified(pair: ParallelAxes, values: Mapping[str, float]) -> ParallelAxes:
    """Return the pair with other figures of its modifications.

    `values`: ``gear.quantity`` to m. Raises `InputError`: no such modification fits the gear.
    """
    return reduce(lambda changed, gear: _with_gear(changed, gear, values), GEARS, pair)


def _with_gear(pair: ParallelAxes, name: str, values: Mapping[str, float]) -> ParallelAxes:
    changes = {key.partition(".")[2]: float(value) for key, value in values.items() if key.startswith(name)}
    if not changes:
        return pair
    gear = getattr(pair, name)
    try:
        changed = replace(gear, modification=replace(gear.modification, **changes))
    except InputError as error:
        raise error.within(name) from None
    return replace(pair, **{name: changed})
