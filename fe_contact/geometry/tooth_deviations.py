"""Deviations that turn with a gear: run-out and wobble of its axis, waves left by its machining."""

from __future__ import annotations

import math
from collections.abc import Collection
from dataclasses import dataclass, replace

import numpy as np

from bounds import Declared, Kind, at_least, between, declared, described, integers, required
from fe_contact.errors import InputError, declared_fields
from fe_contact.geometry.tooth_flank import ToothFlank, flanks_period
from fe_contact.types import FloatArray

_UM = "µm"
_LARGEST = 1e-3  # m; larger deviations are micrometers stated as meters

_ECCENTRICITY = "Distance of the axis of the teeth from that of rotation: half the run-out of an inspection"
_TOWARDS = (
    "Angle by which the gear turns from position 0 until {} points to its mate along the line of action"
)
_WOBBLE = "Way by which the tilted axis of the teeth departs from that of rotation over the face width"

_FACE_WAVES = (
    "Waves over the face width along the axis, their phase growing towards +z; 0: crests along the axis; "
    "left out: crests lie along the contact lines"
)


def _amount(text: str, example: float) -> Declared:
    return Declared(Kind.LENGTH, "m", between(0.0, _LARGEST), text, example, written=_UM, omit_default=True)


def _angle(text: str) -> Declared:
    limit = 2.0 * math.pi
    return Declared(Kind.ANGLE, "rad", between(-limit, limit), text, 0.0, omit_default=True)


@described
@dataclass(frozen=True)
class RunOut:
    """The axis of the teeth is not the axis of rotation: it stands off and is tilted.

    Raises
    ------
    InputError
        A value out of its bounds.
    """

    eccentricity: float = declared(0.0, _amount(_ECCENTRICITY, 1e-5))
    eccentricity_angle: float = declared(0.0, _angle(_TOWARDS.format("the eccentricity")))
    wobble: float = declared(0.0, _amount(_WOBBLE, 4e-6))
    wobble_angle: float = declared(0.0, _angle(_TOWARDS.format("the end of larger z")))

    def __post_init__(self) -> None:
        declared_fields(self)

    @property
    def neutral(self) -> bool:
        """Whether the axes are one."""
        return not (self.eccentricity or self.wobble)

    @property
    def reversed(self) -> RunOut:
        """The same gear for the other sense of rotation."""
        return replace(self, eccentricity_angle=-self.eccentricity_angle, wobble_angle=-self.wobble_angle)

    def excess(self, turn: FloatArray, along: FloatArray) -> FloatArray:
        """Return how far flanks stand towards the mate, m, as the gear has turned by `turn` in rad.

        `along` is the distance from its mid-face over the face width. Both broadcast.
        """
        excess = self.eccentricity * np.cos(turn - self.eccentricity_angle)
        if self.wobble:
            excess = excess + self.wobble * along * np.cos(turn - self.wobble_angle)
        return np.asarray(excess)


NO_RUN_OUT = RunOut()


@described
@dataclass(frozen=True)
class Wave:
    """A wave on all loaded flanks of a gear, as a row of teeth passes under one tool: waviness.

    Raises
    ------
    InputError
        A value out of its bounds, or a wave that is the same everywhere.
    """

    order: int = required(
        Declared(Kind.COUNT, "", integers(0, 2000), "Waves in a revolution of the gear", 11)
    )
    amplitude: float = required(_amount("Amplitude: half of its height", 5e-7))
    phase: float = declared(0.0, _angle("Angle of the wave at which its first crest meets the mate"))
    face_waves: float | None = declared(
        None, Declared(Kind.RATIO, "", between(-100.0, 100.0), _FACE_WAVES, 0.0, omit_default=True)
    )

    def __post_init__(self) -> None:
        declared_fields(self)
        if not self.order and not self.face_waves:
            remedy = "State the number of waves over the face width, or an order."
            raise InputError("order", self.order, at_least(1), remedy)

    @property
    def reversed(self) -> Wave:
        """The same flank for the other sense of rotation."""
        face = None if self.face_waves is None else -self.face_waves
        return replace(self, phase=-self.phase, face_waves=face)

    def excess(self, turn: FloatArray, along: FloatArray, lead: float) -> FloatArray:
        """Return how far flanks stand towards the mate, m, as the gear has turned by `turn` in rad.

        Parameters
        ----------
        along : ndarray
            Distance from mid-face over the face width.
        lead : float
            Angle in rad by which the gear turns while a contact line runs over its face width.
        """
        # turn of the phase over the face, against crests along the contact lines
        inclined = 0.0 if self.face_waves is None else 2.0 * math.pi * self.face_waves - self.order * lead
        return np.asarray(self.amplitude * np.cos(self.order * turn + inclined * along - self.phase))


def deviations_period(
    run_out: RunOut, waves: Collection[Wave], flanks: Collection[ToothFlank], teeth: int
) -> int:
    """Return the number of teeth after which run-out, waves and flanks of teeth repeat."""
    orders = [wave.order for wave in waves if wave.amplitude] + ([] if run_out.neutral else [1])
    turning = teeth // math.gcd(teeth, *orders) if orders else 1
    return math.lcm(turning, flanks_period(flanks, teeth))
