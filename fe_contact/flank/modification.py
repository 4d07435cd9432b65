"""Flank modifications (ISO 21771-1, clause 7; ISO 1328-1 for the slopes) of one gear, all together.

All amounts are material removed, in m, normal to the involute in the transverse plane (along the line of
action).
"""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from functools import cached_property, reduce
from operator import or_
from typing import TYPE_CHECKING, Any, TypeVar, dataclass_transform

import numpy as np
from numpy.typing import ArrayLike

from bounds import Direction, Kind, declarations, described
from bounds.brief import concise
from fe_contact.flank.along_face import AlongFace
from fe_contact.flank.along_profile import AlongProfile
from fe_contact.flank.over_flank import OverFlank
from fe_contact.flank.part import FlankPart, ReliefStart, involute
from fe_contact.flank.tooth import Tooth
from fe_contact.types import FloatArray

if TYPE_CHECKING:
    from collections.abc import Iterable

    class _Figures(AlongProfile, AlongFace, OverFlank):
        """The fields that `_of_all_parts` gives a class."""
else:
    _Figures = object

PARTS: tuple[type[FlankPart], ...] = (*AlongProfile.__bases__, *AlongFace.__bases__, *OverFlank.__bases__)
"""All kinds of modification, the bases of three classes, in the order of their figures."""
Flank = TypeVar("Flank")
_DEFAULTS = {kind: (kind(), {entry.name: entry.default for entry in fields(kind)}) for kind in PARTS}
"""All parts at their defaults, which most parts of most flanks have, with their fields."""


@dataclass_transform(frozen_default=True, kw_only_default=True)
def _of_all_parts(kind: type[Flank]) -> type[Flank]:
    """Make a dataclass with the fields of all parts, which declare them."""
    for part in PARTS:
        for entry in fields(part):
            kind.__annotations__[entry.name] = entry.type
            setattr(kind, entry.name, field(default=entry.default, metadata=entry.metadata))
    return dataclass(frozen=True, kw_only=True)(kind)


@concise
@described
@_of_all_parts
class FlankModification(_Figures):
    """Intended departures of one gear's flanks from the involute helicoid: the sum of all its parts.

    Every part declares its fields, in m and rad, with their bounds; all are 0 by default and then neutral.
    """

    def __post_init__(self) -> None:
        _ = self.parts  # each checks its own fields

    @cached_property
    def parts(self) -> tuple[FlankPart, ...]:
        """The modifications one by one."""
        parts = []
        for kind, (plain, default) in _DEFAULTS.items():
            values = {name: getattr(self, name) for name in default}
            parts.append(plain if values == default else kind(**values))
        return tuple(parts)

    @cached_property
    def varies(self) -> Direction:
        """Directions along which the flank differs from the involute helicoid."""
        return reduce(or_, (part.varies for part in self.parts), Direction.NONE)

    @property
    def neutral(self) -> bool:
        """Whether nothing is removed anywhere."""
        return not self.varies

    @cached_property
    def only_removes(self) -> bool:
        """Whether material is added nowhere, as slopes and measured flanks may."""
        return not any(getattr(self, name) for name in fields_of(Kind.DEVIATION, Kind.SURFACE))

    @property
    def varies_along_profile(self) -> bool:
        """Whether the modification depends on the roll length, at any place of the face."""
        return Direction.PROFILE in self.varies

    @property
    def varies_along_face(self) -> bool:
        """Whether the modification depends on the face position, at any roll length."""
        return Direction.FACE in self.varies

    @cached_property
    def along_profile(self) -> FlankModification:
        """The parts that are the same all over the face."""
        return _together(part for part in self.parts if Direction.FACE not in part.varies)

    @cached_property
    def along_face(self) -> FlankModification:
        """The parts that differ over the face; a twist and a free form vary along the profile, too."""
        return _together(part for part in self.parts if Direction.FACE in part.varies)

    def part_with(self, figure: str) -> FlankModification:
        """Return the part that has a figure, without the others."""
        return _together(part for part in self.parts if figure in _DEFAULTS[type(part)][1])

    def check_fits(self, gear: Tooth) -> None:
        """Raise `InputError` if a part does not fit the gear.

        Examples are a relief longer than the involute or half the face, a grid beside the flank, and an edge
        that leaves no tip.
        """
        for part in self.parts:
            part.check_fits(gear)

    def tip_form_roll_length(self, gear: Tooth) -> float:
        """Return the roll length in m at which the usable flank of `gear` ends and its tip's edge begins."""
        ends = (float(start.roll_length) for start in self.relief_starts(gear) if start.ends_flank)
        return next(ends, gear.tip_roll_length)

    def material_removed(
        self, gear: Tooth, roll_length: ArrayLike, face_position: ArrayLike = 0.0
    ) -> FloatArray:
        """Return the material removed normal to the involute, in the transverse plane.

        Parameters
        ----------
        gear : Gear or RingGear
            The gear the modification belongs to.
        roll_length : array_like
            Roll lengths in m; outside the involute its end value is taken.
        face_position : array_like, optional
            Distance from mid-face in m, broadcast against `roll_length`.

        Returns
        -------
        array
            m, >= 0 except where a slope or twist adds material; exactly zero for a neutral modification.
        """
        roll, face = np.broadcast_arrays(np.asarray(roll_length, float), np.asarray(face_position, float))
        if self.neutral:
            return np.zeros(roll.shape)
        low, high = involute(gear)
        return self.removed(gear, np.minimum(np.maximum(roll, low), high), face)

    def removed(self, gear: Tooth, roll_length: FloatArray, face_position: FloatArray) -> FloatArray:
        """Return the sum over the parts, m: those of the profile, those of the face, then those of both.

        The fixed order of the sum fixes its rounding.
        """
        removed = np.zeros(roll_length.shape)
        for direction in (Direction.PROFILE, Direction.FACE):
            along = (part for part in self._acting if part.along is direction)
            removed += sum(part.removed(gear, roll_length, face_position) for part in along)
        for part in self._acting:
            if part.along not in (Direction.PROFILE, Direction.FACE):
                removed += part.removed(gear, roll_length, face_position)
        return removed

    def relief_starts(self, gear: Tooth, face_position: FloatArray | float = 0.0) -> tuple[ReliefStart, ...]:
        """Return where reliefs, and the tip's edge if it is not sharp, begin along the profile.

        Starts that vary over the face are at the face positions (n,), m from mid-face.
        """
        return tuple(start for part in self._acting for start in part.relief_starts(gear, face_position))

    @cached_property
    def _acting(self) -> tuple[FlankPart, ...]:
        """The parts that remove or add anything."""
        return tuple(part for part in self.parts if part.varies)


FLANK_FIELDS = declarations(FlankModification)
"""Declaration of every figure of a flank, by its name."""


def fields_of(*kinds: Kind) -> tuple[str, ...]:
    """Return the fields of a modification that are of one of these kinds."""
    return tuple(name for name, declaration in FLANK_FIELDS.items() if declaration.kind in kinds)


def _together(parts: Iterable[FlankPart]) -> FlankModification:
    values: dict[str, Any] = {}
    for part in parts:
        _, default = _DEFAULTS[type(part)]
        values |= {name: getattr(part, name) for name in default}
    return FlankModification(**values)


UNMODIFIED = FlankModification()
