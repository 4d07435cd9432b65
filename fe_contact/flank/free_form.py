"""A free-form flank as a modification: a grid of material removed besides everything else."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from bounds import Declared, Direction, Kind, Quantity, Text, declared
from fe_contact.errors import InputError
from fe_contact.flank.part import FlankPart, Tooth, involute
from fe_contact.types import FloatArray

if TYPE_CHECKING:
    from fe_contact.flank.flank_grid import FlankGrid

_SURFACE = Declared(
    Kind.SURFACE,
    "",
    None,
    "Free-form flank, removed besides the amounts",
    along=Direction.PROFILE | Direction.FACE,
)


@dataclass(frozen=True, kw_only=True)
class FreeForm(FlankPart):
    """A free-form flank, if there is one."""

    flank_grid: FlankGrid | None = declared(None, _SURFACE)

    @cached_property
    def varies(self) -> Direction:
        """Along the profile if anything is removed, along the face if any row differs along it."""
        if self.flank_grid is None or self.flank_grid.neutral:
            return Direction.NONE
        across = Direction.FACE if self.flank_grid.varies_along_face else Direction.NONE
        return Direction.PROFILE | across

    def check_fits(self, gear: Tooth) -> None:
        """Raise `InputError` if the grid lies beside the flank."""
        if self.flank_grid is None:
            return
        half = 0.5 * gear.face_width
        _check_reach("roll_length", self.flank_grid.roll_length, *involute(gear))
        _check_reach("face_position", self.flank_grid.face_position, -half, half)

    def removed(self, gear: Tooth, roll_length: FloatArray, face_position: FloatArray) -> FloatArray:
        """See `FlankPart.removed`."""
        assert self.flank_grid is not None
        return self.flank_grid.material_removed(roll_length, face_position)


def _check_reach(axis: str, nodes: tuple[float, ...], low: float, high: float) -> None:
    """Refuse an axis of a grid that lies beside the flank: a wrong unit or origin."""
    if nodes[-1] <= low or nodes[0] >= high:
        ends = Quantity(low, "m", digits=6), " to ", Quantity(high, "m", digits=6)
        bound = Text.of("a range that reaches into the flank, which spans ", *ends)
        advice = "Is the unit or the origin another one?"
        raise InputError(f"modification.flank_grid.{axis}", [nodes[0], nodes[-1]], bound, advice)
