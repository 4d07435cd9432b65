"""Modifications along the face (ISO 21771-1): crowning, slope and end relief.

The datum face (I) is the end of negative face positions, the non-datum face (II) that of positive ones.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from bounds import Direction
from fe_contact.flank.part import Polynomial
from fe_contact.flank.relief import FaceRelief, amount, length, shape, slope
from fe_contact.flank.relief_shape import Shape
from fe_contact.flank.tooth import Tooth
from fe_contact.types import FloatArray

_FACE = Direction.FACE


@dataclass(frozen=True, kw_only=True)
class _OneSidedRelief(FaceRelief):
    """Relief at one end of the face: `_side` is the sign of the face positions there."""

    _side: ClassVar[int]

    def _outwards(self, face_position: FloatArray) -> FloatArray:
        return self._side * face_position


@dataclass(frozen=True, kw_only=True)
class _HelixCrowning(Polynomial):
    helix_crowning: float = amount(_FACE, "Lead crowning at both ends of the face", 5e-6)
    powers: ClassVar[tuple[int, int]] = (0, 2)


@dataclass(frozen=True, kw_only=True)
class _HelixCrowningDatumFace(_OneSidedRelief):
    """Parabola from the highest point of the face to the datum face."""

    _side: ClassVar[int] = -1

    helix_crowning_datum_face: float = amount(
        _FACE, "Lead crowning at the datum face alone, besides that at both ends", 5e-6, omit_default=True
    )
    helix_crowning_datum_face_length: float = length(
        _FACE, "Length of the crowning to the datum face, from its highest point", 15e-3, omit_default=True
    )


@dataclass(frozen=True, kw_only=True)
class _HelixCrowningNonDatumFace(_OneSidedRelief):
    """Parabola from the highest point of the face to the non-datum face."""

    _side: ClassVar[int] = 1

    helix_crowning_non_datum_face: float = amount(
        _FACE, "Lead crowning at the non-datum face alone, besides that at both ends", 5e-6, omit_default=True
    )
    helix_crowning_non_datum_face_length: float = length(
        _FACE,
        "Length of the crowning to the non-datum face, from its highest point",
        10e-3,
        omit_default=True,
    )


@dataclass(frozen=True, kw_only=True)
class _HelixSlope(Polynomial):
    helix_slope: float = slope(
        _FACE,
        "Helix slope over the face width; > 0 removes half at the end of positive z, adds half at the other",
        5e-6,
    )
    powers: ClassVar[tuple[int, int]] = (0, 1)
    weight: ClassVar[float] = 0.5  # from -1 to 1 over the face: half the figure at either end


@dataclass(frozen=True, kw_only=True)
class _HelixForm(Polynomial):
    """Form deviation f_fbeta that all teeth share: a parabola whose mean line over the face is zero."""

    helix_form: float = slope(
        _FACE,
        "Helix form of all teeth, a parabola of this height; > 0 removes two thirds at both ends of the "
        "face, adds a third in its middle; < 0: hollow",
        2e-6,
        omit_default=True,
    )
    powers: ClassVar[tuple[int, int]] = (0, 2)
    mean: ClassVar[float] = 1.0 / 3.0


@dataclass(frozen=True, kw_only=True)
class _EndRelief(FaceRelief):
    """Relief over the same length at either end of the face."""

    end_relief: float = amount(_FACE, "End relief at both faces", 10e-6)
    end_relief_length: float = length(_FACE, "Length of the end relief along the face", 2e-3)
    end_relief_shape: Shape = shape(_FACE, "End relief over its length")

    def _outwards(self, face_position: FloatArray) -> FloatArray:
        return np.abs(face_position)

    def _room(self, gear: Tooth) -> float:
        return 0.5 * gear.face_width


@dataclass(frozen=True, kw_only=True)
class _EndReliefDatumFace(_OneSidedRelief):
    _side: ClassVar[int] = -1

    end_relief_datum_face: float = amount(
        _FACE, "End relief at the datum face, the end of negative face positions", 10e-6, omit_default=True
    )
    end_relief_datum_face_length: float = length(
        _FACE, "Length of the end relief at the datum face", 2e-3, omit_default=True
    )
    end_relief_datum_face_shape: Shape = shape(
        _FACE, "End relief at the datum face over its length", omit_default=True
    )


@dataclass(frozen=True, kw_only=True)
class _EndReliefNonDatumFace(_OneSidedRelief):
    _side: ClassVar[int] = 1

    end_relief_non_datum_face: float = amount(
        _FACE,
        "End relief at the non-datum face, the end of positive face positions",
        10e-6,
        omit_default=True,
    )
    end_relief_non_datum_face_length: float = length(
        _FACE, "Length of the end relief at the non-datum face", 2e-3, omit_default=True
    )
    end_relief_non_datum_face_shape: Shape = shape(
        _FACE, "End relief at the non-datum face over its length", omit_default=True
    )


class AlongFace(
    _HelixCrowning,
    _HelixCrowningDatumFace,
    _HelixCrowningNonDatumFace,
    _HelixSlope,
    _HelixForm,
    _EndRelief,
    _EndReliefDatumFace,
    _EndReliefNonDatumFace,
):
    """All modifications along the face, in the order of their figures."""
