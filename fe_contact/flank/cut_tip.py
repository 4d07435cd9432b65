"""A rounded or chamfered tip as a modification: it ends the usable flank at the tip form circle."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from bounds import Declared, Direction, Kind, between, declared
from fe_contact.errors import InputError
from fe_contact.flank.part import FlankPart, ReliefStart
from fe_contact.flank.tip_edge import (
    FLATTEST,
    STEEPEST,
    chamfer_start,
    check_chamfer,
    check_rounding,
    rounding_start,
)
from fe_contact.flank.tooth import Tooth
from fe_contact.types import FloatArray


def _edge(description: str, example: float) -> Declared:
    """Return the declaration of the size of an edge, m."""
    return Declared(Kind.EDGE, "m", between(0.0, 0.1), description, example, Direction.PROFILE)


_ROUNDING = "Radius of the rounded tip edge in the transverse plane, tangent to flank and tip circle"
_CHAMFER = "Radial height h_K of the tip chamfer: d_Fa = d_a - 2 h_K (a ring gear: +)"
_ANGLE = "Angle between flank and tip chamfer at the tip form point in the transverse plane"


@dataclass(frozen=True, kw_only=True)
class CutTip(FlankPart):
    """A rounding or a chamfer, or a sharp tip edge; amounts at the tip stay those at the tip circle."""

    tip_rounding: float = declared(0.0, _edge(_ROUNDING, 0.3e-3))
    tip_chamfer: float = declared(0.0, _edge(_CHAMFER, 0.4e-3))
    tip_chamfer_angle: float = declared(
        math.radians(30.0),
        Declared(
            Kind.ANGLE, "rad", between(FLATTEST, STEEPEST), _ANGLE, math.radians(30.0), Direction.PROFILE
        ),
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.tip_rounding and self.tip_chamfer:
            advice = "The tip has a rounding or a chamfer: give one of them."
            raise InputError("tip_chamfer", self.tip_chamfer, "0 where the tip has a rounding", advice)

    def check_fits(self, gear: Tooth) -> None:
        """Raise `InputError` if the edge leaves no involute or no tip."""
        if self.tip_rounding:
            check_rounding(gear, self.tip_rounding)
        if self.tip_chamfer:
            check_chamfer(gear, self.tip_chamfer, self.tip_chamfer_angle)

    def removed(self, gear: Tooth, roll_length: FloatArray, face_position: FloatArray) -> FloatArray:
        """See `FlankPart.removed`."""
        (edge,) = self.relief_starts(gear)
        start = edge.roll_length
        along = gear.sign * (roll_length - start) * (roll_length + start) / (2.0 * gear.base_radius)
        inside = np.maximum(along, 0.0)
        return np.asarray(inside * (edge.jump + 0.5 * edge.bend * inside))

    def relief_starts(self, gear: Tooth, face_position: FloatArray | float = 0.0) -> tuple[ReliefStart, ...]:
        """Return where the edge begins.

        The involute turns away from its tangent too, with the curvature 1/l; hollow in a ring gear.
        """
        if self.tip_rounding:
            start = rounding_start(gear, self.tip_rounding)
            return (ReliefStart(start, True, 0.0, 1.0 / self.tip_rounding - gear.sign / start, True),)
        start = chamfer_start(gear, self.tip_chamfer)
        return (ReliefStart(start, True, math.tan(self.tip_chamfer_angle), -gear.sign / start, True),)
