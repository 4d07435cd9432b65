"""Gap by deviations that turn with a gear: run-out and wobble, waves, flanks of single teeth."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import numpy as np

from fe_contact.contact.model import MeetingTeeth
from fe_contact.flank.extent import Extent
from fe_contact.geometry import ParallelAxes, RunOut, ToothFlank, Toothing, Wave
from fe_contact.geometry.tooth_flank import tooth_surfaces
from fe_contact.geometry.tooth_surfaces import ToothSurfaces
from fe_contact.types import FloatArray, IntArray
from host.loops import inner, njit

_IN_WAVE = 8
"""Parts of a wave between the nodes of a profile."""

_TERMS = tuple((-1.0) ** k * math.pi ** (2 * k + 1) / math.factorial(2 * k + 1) for k in range(10))
"""Taylor series of the sine of pi times a number up to one half: its remainder is below 1e-13."""


@dataclass(frozen=True)
class TurningGap:
    """Gap along the line of action by the deviations that turn with one gear, m."""

    gear: int
    """0 is the pinion, 1 the wheel."""
    teeth: int
    """Number of teeth of the gear."""
    base_radius: float
    """Base radius of the gear, m."""
    period: int
    """Base pitches after which the gap repeats."""
    roll_angle: float
    """Angle by which the gear turns while it rolls over a whole flank, rad."""
    run_out: RunOut
    waves: tuple[Wave, ...]
    flanks: tuple[ToothFlank, ...]
    largest: float
    """Bound of the gap, m."""
    surfaces: ToothSurfaces | None = field(default=None, compare=False, repr=False)
    """The flanks of single teeth as arrays, if there are any."""

    @classmethod
    def of(cls, index: int, gear: Toothing, period: int) -> TurningGap:
        """Return the gap of a gear, 0 the pinion, 1 the wheel."""
        flanks = gear.tooth_flanks
        waves = sum(wave.amplitude for wave in gear.waves)
        deviation = max((flank.largest for flank in flanks), default=0.0)
        return cls(
            gear=index,
            teeth=gear.teeth,
            base_radius=gear.base_radius,
            period=period,
            roll_angle=abs(gear.tip_roll_length - gear.form_roll_length) / gear.base_radius,
            run_out=gear.run_out,
            waves=gear.waves,
            flanks=flanks,
            largest=gear.run_out.eccentricity + 0.5 * gear.run_out.wobble + waves + deviation,
            surfaces=tooth_surfaces(gear, flanks) if flanks else None,
        )

    def __call__(self, teeth: MeetingTeeth) -> FloatArray:
        """Return the gap of pairs of teeth at touching points: that of the gear turned until they touch."""
        pair = teeth.pair
        gear, roll, face = self._toothing(pair), self._roll(teeth.roll_1, teeth.roll_2), teeth.face
        if self.gear == 1:
            face = face - pair.axial_offset
        shape = np.broadcast_shapes(teeth.meeting.shape, roll.shape, face.shape)
        meeting = np.broadcast_to(teeth.meeting, shape).ravel()
        roll, face = (np.broadcast_to(values, shape).ravel() for values in (roll, face))
        gap = np.zeros(meeting.size)
        if self._harmonics.size:
            _take_harmonics(gap, self._harmonics, self._turning(pair, gear), meeting, roll, face)
        if self.surfaces is not None:
            gap -= self.surfaces.excess(self.tooth(meeting), roll, face)
        return gap.reshape(shape)

    @cached_property
    def extents(self) -> Extent:
        """Bounds of the gaps that turn with the gear, and of the flanks of its teeth, arrays (T,)."""
        out, radius = self.run_out.eccentricity + 0.5 * self.run_out.wobble, self.base_radius
        waves = sum(wave.amplitude for wave in self.waves)
        amplitude, along, order = self._harmonics[:, :3].T
        height = amplitude + 0.5 * along
        steep = float(height @ order)
        turning = Extent(
            low=-out - waves,
            high=out + waves,
            slope=steep / radius,
            spread=float(height @ np.minimum(order * self.roll_angle, 2.0)),
            bend=float(height @ order**2) / radius**2,
            rotation_bound=steep * radius,
        )
        count = 0 if self.surfaces is None else len(self.surfaces.amounts)
        flanks = Extent() if self.surfaces is None else self.surfaces.extents
        designed = self.teeth - count
        of_teeth = (np.pad(np.zeros(count) + values, (0, designed)) for values in vars(flanks).values())
        return turning + Extent(*of_teeth)

    def tooth(self, meeting: IntArray) -> IntArray:
        """Return which teeth meet, the first is 0."""
        tooth = _teeth_of(np.ravel(meeting), self.period, self.teeth)
        return tooth.reshape(np.shape(meeting))

    def nodes(self, pair: ParallelAxes, tooth: int) -> FloatArray:
        """Return roll lengths of the gear in m, between two of which its profile turns back once at most."""
        gear = self._toothing(pair)
        waves = float(self._harmonics[:, 2].max(initial=0.0)) * self.roll_angle / (2.0 * math.pi)
        ends = sorted((gear.form_roll_length, gear.tip_roll_length))
        nodes = np.linspace(ends[0], ends[1], math.ceil(_IN_WAVE * max(waves, 1.0)) + 1)
        if self.surfaces is None or tooth >= len(self.surfaces.nodes):
            return nodes
        return np.concatenate([nodes, self.surfaces.nodes[tooth]])

    def _toothing(self, pair: ParallelAxes) -> Toothing:
        return (pair.pinion, pair.wheel)[self.gear]

    def _roll(self, roll_1: FloatArray, roll_2: FloatArray) -> FloatArray:
        return roll_2 if self.gear else roll_1

    @cached_property
    def _harmonics(self) -> FloatArray:
        """Amplitude in m, the same per face width, order, waves over the face, inclination and phase, (H, 6).

        Over the face a harmonic advances by an angle, 2 pi times its waves; or, at inclination -1, by what
        makes its crests lie along the axis.
        """
        out, waves = self.run_out, [wave for wave in self.waves if wave.amplitude]
        rows = [
            (out.eccentricity, 0.0, 1.0, 0.0, 0.0, out.eccentricity_angle),
            (0.0, out.wobble, 1.0, 0.0, 0.0, out.wobble_angle),
        ]
        rows = [row for row in rows if row[0] or row[1]]
        for wave in waves:
            over_face = (0.0, 0.0) if wave.face_waves is None else (wave.face_waves, -1.0)
            rows.append((wave.amplitude, 0.0, float(wave.order), *over_face, wave.phase))
        return np.array(rows).reshape(-1, 6)

    def _turning(self, pair: ParallelAxes, gear: Toothing) -> Turning:
        at_pitch_point = pair.path_of_contact.pitch_point
        if self.gear == 1:
            at_pitch_point = float(pair.mating_roll_length(at_pitch_point))
        sense = 1.0 if self.gear == 0 else -gear.sign
        per_circle = 0.5 / (math.pi * gear.base_radius)
        shift = pair.axial_offset if self.gear == 1 else 0.0
        lead = math.tan(pair.base_helix_angle) * per_circle
        return Turning(
            self.period, gear.teeth, at_pitch_point, sense * per_circle, shift, lead, gear.face_width
        )


class Turning(NamedTuple):
    """Turn of a gear in revolutions, counted from the contact of a tooth at the pitch point in mid-face."""

    period: int
    teeth: int
    """`period`, `teeth`: Base pitches after which the teeth of the gear repeat, and their number."""
    pitch_point: float
    """Roll length at the pitch point, m."""
    per_roll: float
    """`per_roll`, `per_face`: Revolutions over roll length, and over distance from the pinion's mid-face;
    1/m.
    """
    axial_offset: float
    """Distance of the gear's mid-face from the pinion's, m."""
    per_face: float
    face_width: float
    """Face width of the gear, m."""


@njit(cache=True, error_model="numpy")
def _teeth_of(meeting: IntArray, period: int, teeth: int) -> IntArray:
    """Return which teeth (k,) meet; divisions are slow, and most candidates in turn are of one pair."""
    tooth = np.empty(meeting.size, dtype=np.int64)
    for k in range(meeting.size):
        if k and meeting[k] == meeting[k - 1]:
            tooth[k] = tooth[k - 1]
        else:
            tooth[k] = meeting[k] % period % teeth
    return tooth


@njit(cache=True, error_model="numpy")
def _take_harmonics(
    gap: FloatArray,
    harmonics: FloatArray,
    turning: Turning,
    meeting: IntArray,
    roll: FloatArray,
    face: FloatArray,
) -> None:
    """Take harmonics (H, 6) of the turn of a gear off a gap at points (k,); `face` from its mid-face, m."""
    inclined = turning.per_face * turning.face_width
    revolutions, along = np.empty(gap.size), np.empty(gap.size)
    for k in range(gap.size):
        along[k] = face[k] / turning.face_width
        tooth = float(meeting[k] % turning.period) / turning.teeth
        rolled = (roll[k] - turning.pitch_point) * turning.per_roll
        revolutions[k] = tooth + rolled + (face[k] + turning.axial_offset) * turning.per_face
    for h in range(len(harmonics)):
        amplitude, over_face, order, waves, inclination, phase = harmonics[h]
        advance, late = waves + inclination * order * inclined, phase / (2.0 * math.pi)
        for k in range(gap.size):
            angle = order * revolutions[k] + advance * along[k] - late
            gap[k] -= (amplitude + over_face * along[k]) * _cosine(angle)


@inner(error_model="numpy")
def _cosine(turns: float) -> float:
    """Return the cosine of an angle in revolutions to 1e-13, in a quarter of the time of the library's."""
    part = turns - math.floor(turns + 0.5)
    square, sine = part * part, 0.0
    for k in range(10):
        sine = sine * square + _TERMS[9 - k]
    sine *= part
    return 1.0 - 2.0 * sine * sine
