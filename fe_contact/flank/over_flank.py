"""Modifications over the whole flank: twist, ground crowning, triangular relief (ISO 21771-1), a free form.

A triangular relief removes material from the corners where lines of contact begin and end. It is a tip or
root relief whose start is a line of contact instead of a circle: deepest at that corner of the flank which
lines of contact reach first or last, and the same along every line of contact. Lines of contact are those of
equal l + z tan(beta_b), roll length l and face position z.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np

from bounds import Declared, Direction, Kind, Quantity, Text, declared, inside
from fe_contact.errors import InputError
from fe_contact.flank.flank_grid import FlankGrid
from fe_contact.flank.part import FlankPart, Polynomial, ReliefStart, involute
from fe_contact.flank.relief import ProfileRelief, amount, length, shape, slope
from fe_contact.flank.relief_shape import Shape
from fe_contact.flank.tooth import Tooth
from fe_contact.types import FloatArray

_FLANK = Direction.PROFILE | Direction.FACE
_DEEPEST = 0.5
"""Largest depth of a free form, in normal modules."""
SURFACE = Declared(
    Kind.SURFACE,
    "",
    None,
    "Free-form flank: material removed in addition to the amounts above",
    FlankGrid((4e-3, 20e-3), (-12.5e-3, 12.5e-3), ((0.0, 0.0), (5e-6, 7e-6))),
    along=_FLANK,
    part=FlankGrid,
)


@dataclass(frozen=True, kw_only=True)
class _FlankTwist(Polynomial):
    """Twist; the profile slope grows by four times the amount from one end of the face to the other."""

    flank_twist: float = slope(
        _FLANK,
        "Twist at the corners of the flank; > 0 removes at the tip where z is positive and at the opposite "
        "corner, adds at the other two",
        5e-6,
    )
    powers: ClassVar[tuple[int, int]] = (1, 1)


@dataclass(frozen=True, kw_only=True)
class _GroundHelixCrowning(FlankPart):
    """Helix crowning with the natural twist of generating grinding.

    At the position Z along the face the worm touches the flank on the whole profile, at the face positions
    z = Z + (l - l_m) tan(beta_b), with the roll length l_m of its middle. There its infeed at Z acts.
    """

    ground_helix_crowning: float = amount(
        _FLANK,
        "Helix crowning as generating grinding makes it by infeed along the face, with its natural twist; of "
        "external gears",
        5e-6,
        omit_default=True,
    )

    def check_fits(self, gear: Tooth) -> None:
        """Raise `InputError` for a ring gear, which no worm grinds."""
        if self.ground_helix_crowning and gear.sign < 0:
            remedy = "Give it a helix crowning and a twist."
            name = "modification.ground_helix_crowning"
            raise InputError(name, self.ground_helix_crowning, "0 for a ring gear", remedy)

    def removed(self, gear: Tooth, roll_length: FloatArray, face_position: FloatArray) -> FloatArray:
        """See `FlankPart.removed`."""
        middle = 0.5 * (gear.form_roll_length + gear.tip_roll_length)
        worm = face_position - (roll_length - middle) * math.tan(gear.base_helix_angle)  # Z
        return np.asarray(self.ground_helix_crowning * (2.0 * worm / gear.face_width) ** 2)


@dataclass(frozen=True, kw_only=True)
class _CornerRelief(ProfileRelief):
    """A triangular relief. At the end of the face with the corner it is a relief over the profile."""

    def check_fits(self, gear: Tooth) -> None:
        """Raise `InputError` if the relief is longer than the involute, or the gear is a spur gear."""
        super().check_fits(gear)
        if self._amount and not gear.base_helix_angle:
            remedy = "Lines of contact of a spur gear run along the face: give it a tip or root relief."
            raise InputError(f"modification.{self._name}", self._amount, "0 for a spur gear", remedy)

    def removed(self, gear: Tooth, roll_length: FloatArray, face_position: FloatArray) -> FloatArray:
        """See `FlankPart.removed`."""
        return super().removed(gear, roll_length - self._inset(gear, face_position), face_position)

    def relief_starts(self, gear: Tooth, face_position: FloatArray | float = 0.0) -> tuple[ReliefStart, ...]:
        """See `FlankPart.relief_starts`; beyond the end of the triangle jump and bend are zero."""
        start, end = self._span(gear)
        inset = self._inset(gear, np.asarray(face_position))
        inside_triangle = np.abs(inset) < abs(end - start)
        begin = self._begins(gear, np.clip(start + inset, *involute(gear)), end - start)
        jump, bend = (np.where(inside_triangle, value, 0.0) for value in (begin.jump, begin.bend))
        return (ReliefStart(begin.roll_length, begin.towards_tip, jump, bend),)

    def _inset(self, gear: Tooth, face_position: FloatArray) -> FloatArray:
        """Return the shift of the start along the roll length, m, against that at the corner's end."""
        start, end = self._span(gear)
        lead = math.tan(gear.base_helix_angle)
        corner = math.copysign(0.5 * gear.face_width, lead * (end - start))
        return np.asarray((corner - face_position) * lead)


@dataclass(frozen=True, kw_only=True)
class _TriangularTipRelief(_CornerRelief):
    _at_tip: ClassVar[bool] = True

    triangular_tip_relief: float = amount(
        _FLANK,
        "Triangular tip relief at the corner of the tip which lines of contact reach first or last",
        15e-6,
        omit_default=True,
    )
    triangular_tip_relief_length: float = length(
        _FLANK,
        "Length of the triangular tip relief along the radius at its end of the face",
        1e-3,
        omit_default=True,
    )
    triangular_tip_relief_shape: Shape = shape(
        _FLANK, "Triangular tip relief over its length", omit_default=True
    )


@dataclass(frozen=True, kw_only=True)
class _TriangularRootRelief(_CornerRelief):
    _at_tip: ClassVar[bool] = False

    triangular_root_relief: float = amount(
        _FLANK,
        "Triangular root relief at the corner of the root which lines of contact reach first or last",
        15e-6,
        omit_default=True,
    )
    triangular_root_relief_length: float = length(
        _FLANK,
        "Length of the triangular root relief along the radius at its end of the face",
        1e-3,
        omit_default=True,
    )
    triangular_root_relief_shape: Shape = shape(
        _FLANK, "Triangular root relief over its length", omit_default=True
    )


@dataclass(frozen=True, kw_only=True)
class _FreeForm(FlankPart):
    flank_grid: FlankGrid | None = declared(None, SURFACE)

    @cached_property
    def varies(self) -> Direction:
        """Directions: the profile if anything is removed, the face if any row differs along it."""
        if self.flank_grid is None or self.flank_grid.neutral:
            return Direction.NONE
        across = Direction.FACE if self.flank_grid.varies_along_face else Direction.NONE
        return Direction.PROFILE | across

    def check_fits(self, gear: Tooth) -> None:
        """Raise `InputError` if the grid lies outside the flank."""
        if self.flank_grid is not None:
            with inside("modification"):
                check_reach(self.flank_grid, gear)

    def removed(self, gear: Tooth, roll_length: FloatArray, face_position: FloatArray) -> FloatArray:
        """See `FlankPart.removed`."""
        assert self.flank_grid is not None
        return self.flank_grid.material_removed(roll_length, face_position)


def check_reach(grid: FlankGrid, gear: Tooth) -> None:
    """Raise `InputError` for a grid outside the flank or too deep, by a wrong unit or origin."""
    half = 0.5 * gear.face_width
    for axis, (low, high) in {"roll_length": involute(gear), "face_position": (-half, half)}.items():
        nodes = getattr(grid, axis)
        if nodes[-1] <= low or nodes[0] >= high:
            ends = Quantity(low, "m", digits=6), " to ", Quantity(high, "m", digits=6)
            bound = Text.of("a range that reaches into the flank, which spans ", *ends)
            remedy = "Is the unit or the origin another one?"
            raise InputError(f"flank_grid.{axis}", [nodes[0], nodes[-1]], bound, remedy)
    removed, largest = np.array(grid.removed), _DEEPEST * gear.normal_module
    i, j = np.unravel_index(np.abs(removed).argmax(), removed.shape)
    if abs(removed[i, j]) > largest:
        bound = Text.of("at most half the module in size, ", Quantity(largest, "m", digits=6))
        remedy = "Is the unit another one, or is the point beside the tooth?"
        raise InputError(f"flank_grid.removed[{i}][{j}]", float(removed[i, j]), bound, remedy)


class OverFlank(_FlankTwist, _GroundHelixCrowning, _TriangularTipRelief, _TriangularRootRelief, _FreeForm):
    """All modifications over the whole flank. The order of the bases is the order of their fields."""
