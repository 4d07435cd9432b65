"""Teeth of one gear within the tolerances of a class: run-out, wobble, pitches, single flanks."""

from __future__ import annotations

import cmath
import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from fe_contact.geometry import ParallelAxes, PitchDeviation, RunOut, ToothFlank, Toothing
from fe_contact.geometry.flank_tolerances import (
    cumulative_pitch_tolerance,
    run_out_tolerance,
    single_pitch_tolerance,
)
from fe_contact.microgeometry.tolerances import (
    ACCUMULATED,
    COMMON,
    OF_A_CLASS,
    PROCESS_SPREAD,
    Distribution,
    Finishing,
    spread_within,
)
from fe_contact.microgeometry.variables import ACROSS_FACE
from fe_contact.types import ComplexArray, FloatArray

RUN_OUT, WOBBLE, PITCH, FLANK = "run_out", "wobble", "pitch_deviation", "tooth_flanks."
OF_AXIS = (RUN_OUT, WOBBLE)
"""Deviations of the axis of the teeth; they repeat once a revolution."""
WOBBLE_SHARE = 0.5
"""Assumed share of wobble in the variance of helix slopes from tooth to tooth; no measurement supports it."""


@dataclass(frozen=True)
class PitchBounds:
    """Bounds of the pitches of a gear in a class; they include the pitches that the eccentricity makes."""

    single: float
    cumulative: float
    """`single`, `cumulative`: Single pitch deviation f_pT and cumulative pitch deviation F_pT, m, on the
    reference circle.
    """
    eccentricity: float
    """Largest eccentricity that keeps both pitch deviations and the run-out F_rT, m."""
    cosine: float
    """Cosine of the transverse pressure angle: an eccentricity moves teeth by 1 / cosine of it."""
    accumulated: float = 0.0
    """Share of the accumulated deviation in the square of a single pitch. 0: each tooth is displaced by
    itself. 1: each pitch deviates by itself, and the following teeth keep the displacement.
    """

    @classmethod
    def of(cls, gear: Toothing, tolerance_class: int, accumulated: float = 0.0) -> PitchBounds:
        """Return the bounds of a gear in a class of ISO 1328-1:2013."""
        single = single_pitch_tolerance(gear, tolerance_class)
        cumulative = cumulative_pitch_tolerance(gear, tolerance_class)
        cosine = math.cos(gear.transverse_pressure_angle)
        by_pitches = 0.5 * cosine * min(single / math.sin(math.pi / gear.teeth), cumulative)
        largest = min(0.5 * run_out_tolerance(gear, tolerance_class), by_pitches)
        return cls(single, cumulative, largest, cosine, accumulated)

    def places(self, deviation: FloatArray) -> FloatArray:
        """Return displacements of teeth (..., z), m, with accumulated pitch deviations.

        With a the share of the accumulated deviation, harmonic j of the displacements over the z teeth is
        multiplied by the root of 1 - a + a / (2 sin^2(pi j / z)). That leaves the mean square of a single
        pitch as it is, and makes that of the difference of neighbors the same at every tooth.
        """
        if not self.accumulated:
            return deviation
        teeth = deviation.shape[-1]
        pitch = 2.0 * np.sin(math.pi * np.arange(1, teeth // 2 + 1) / teeth) ** 2
        gain = np.sqrt(1.0 - self.accumulated + self.accumulated / pitch)
        lines = np.fft.rfft(deviation, axis=-1) * np.concatenate([[1.0], gain])
        return np.asarray(np.fft.irfft(lines, teeth, axis=-1))

    def bounded(self, eccentricity: float | FloatArray, deviation: FloatArray) -> FloatArray:
        """Return displacements of teeth (..., z), m, scaled down where they exceed a bound.

        A bound applies to the sum of the displacements and those by the eccentricity.
        """
        by_eccentricity = 2.0 * np.asarray(eccentricity)[..., None] / self.cosine  # range over a revolution
        single = np.abs(deviation - np.roll(deviation, 1, axis=-1)).max(axis=-1, keepdims=True)
        cumulative = np.ptp(deviation, axis=-1, keepdims=True)
        single_limit = self.single - by_eccentricity * math.sin(math.pi / deviation.shape[-1])
        cumulative_limit = self.cumulative - by_eccentricity
        tiny = np.finfo(float).tiny  # a gear without deviations has nothing to scale
        share = np.minimum(
            single_limit / np.maximum(single, tiny), cumulative_limit / np.maximum(cumulative, tiny)
        )
        return np.asarray(deviation * np.clip(share, 0.0, 1.0))


@dataclass(frozen=True)
class ToothTolerances:
    """Largest differences between the teeth of one gear."""

    gear: str
    teeth: int
    widths: Mapping[str, float]
    """Half widths in m by name. ``run_out``: the eccentricity. ``wobble``: the largest helix slope over a
    revolution. ``pitch_deviation``: the displacement of each tooth. ``tooth_flanks.profile_slope`` and
    others: the part of a tolerance by which single teeth differ.
    """
    distribution: Distribution = "normal"
    """Distribution of the deviations, as in `Tolerances`. A normal distribution of eccentricity and wobble
    holds in both directions.
    """
    pitches: PitchBounds | None = None
    """Bounds to which the displacements of all teeth are scaled; None: they have no common bound."""

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the deviations, ``gear.quantity``, in the order of the widths."""
        return tuple(f"{self.gear}.{name}" for name in self.widths)

    @property
    def dimensions(self) -> int:
        """Number of random numbers that a gear takes."""
        of_axis = sum(name in self.widths for name in OF_AXIS)
        return 2 * of_axis + (len(self.widths) - of_axis) * self.teeth

    def drawn(self, count: int, seed: int, after: int = 0) -> DrawnTeeth:
        """Draw gears from a scrambled Sobol' sequence.

        The first `after` dimensions of the sequence belong to other deviations. A larger sample of the same
        seed begins with the smaller one.
        """
        from scipy.stats import qmc  # noqa: PLC0415 (start-up time)

        axis_names = [name for name in OF_AXIS if name in self.widths]
        tooth_names = [name for name in self.widths if name not in OF_AXIS]
        sequence = qmc.Sobol(after + self.dimensions, rng=seed)
        # the length of a sequence is a power of two
        uniform = sequence.random_base2(max(count - 1, 1).bit_length())[:count, after:]
        first_of_teeth = 2 * len(axis_names)  # amount and angle of each deviation of the axis come first
        tooth_uniform = uniform[:, first_of_teeth:].reshape(count, len(tooth_names), self.teeth)
        by_axis = {
            name: self._amounts(name, uniform[:, 2 * k]) * np.exp(2j * math.pi * uniform[:, 2 * k + 1])
            for k, name in enumerate(axis_names)
        }
        by_tooth = {
            name: spread_within(self.widths[name], tooth_uniform[:, k], self.distribution)
            for k, name in enumerate(tooth_names)
        }
        return DrawnTeeth(by_axis, by_tooth, self.pitches)

    def _amounts(self, name: str, uniform: FloatArray) -> FloatArray:
        """Return amounts of a deviation of the axis from numbers in [0, 1).

        Normal in both directions is a Rayleigh distribution of the amount, cut off at the width.
        """
        limit = self.widths[name]
        if self.distribution == "uniform":
            return np.asarray(limit * uniform)
        below_limit = 1.0 - math.exp(-0.5 * PROCESS_SPREAD**2)  # probability without the cut
        return np.asarray(limit / PROCESS_SPREAD * np.sqrt(-2.0 * np.log1p(-below_limit * uniform)))


@dataclass(frozen=True)
class DrawnTeeth:
    """N gears of z teeth each."""

    by_axis: Mapping[str, ComplexArray]
    """Eccentricity and wobble by name: complex numbers of their amount in m and their angle, as of `RunOut`.
    Shape (N,) each.
    """
    by_tooth: Mapping[str, FloatArray]
    """Pitch deviations on the reference circle and deviations of single flanks by name, m; > 0 is material in
    excess. They are as drawn; those of `made` are scaled to the class. Shape (N, z) each.
    """
    pitches: PitchBounds | None = None
    """Bounds of the pitches, as in `ToothTolerances`."""

    @cached_property
    def made(self) -> Mapping[str, FloatArray]:
        """`by_tooth` with accumulated pitches, scaled so that pitches and eccentricity keep the class."""
        if self.pitches is None:
            return self.by_tooth
        pitch_deviation = self.pitches.bounded(
            np.abs(self.by_axis[RUN_OUT]), self.pitches.places(self.by_tooth[PITCH])
        )
        return {**self.by_tooth, PITCH: pitch_deviation}

    def amount(self, name: str) -> Any:
        """Return one deviation of all gears, as drawn."""
        return (self.by_axis if name in OF_AXIS else self.by_tooth)[name]

    def changed(self, name: str, amount: Any) -> DrawnTeeth:
        """Return the gears with other amounts of one deviation."""
        if name in OF_AXIS:
            return replace(self, by_axis={**self.by_axis, name: amount})
        return replace(self, by_tooth={**self.by_tooth, name: amount})

    def fields(self, index: int) -> dict[str, Any]:
        """Return the fields of one of the gears."""
        vectors = (complex(self.by_axis[name][index]) if name in self.by_axis else 0j for name in OF_AXIS)
        axis = [part for vector in vectors for part in cmath.polar(vector)]  # amount and angle of each
        by_name = {name: values[index].tolist() for name, values in self.made.items()}
        pitch = by_name.pop(PITCH, ())
        deviations = {name.removeprefix(FLANK): values for name, values in by_name.items()}
        flanks = tuple(
            ToothFlank(tooth, **dict(zip(deviations, amounts, strict=True)))
            for tooth, amounts in enumerate(zip(*deviations.values(), strict=True), start=1)
        )
        return {
            "run_out": RunOut(*axis),
            "pitch_deviation": PitchDeviation(tuple(pitch)),
            "tooth_flanks": flanks,
        }


def iso1328_tooth_tolerances(
    pair: ParallelAxes,
    gear: str,
    tolerance_class: int,
    *,
    across_face: bool = True,
    distribution: Distribution = "normal",
    finishing: Finishing = "any",
) -> ToothTolerances:
    """Return the tolerances of the differences between the teeth of one gear by ISO 1328-1:2013.

    Pitches: the eccentricity is at most half the run-out F_rT, and the displacement of a single tooth at most
    half of f_pT. Following teeth keep the share `ACCUMULATED` of the square of a pitch deviation. Where
    pitches and eccentricity together exceed f_pT or F_pT, all displacements are scaled (`PitchBounds`).

    Flanks: all teeth have a part c of the tolerance of a slope or form in common (`COMMON`). Single teeth
    differ by the root of 1 - c^2 of the tolerance. Of the square of that difference of helix slopes, wobble,
    which varies once per revolution, has the share `WOBBLE_SHARE`, and single flanks have the rest.
    """
    toothing: Toothing = getattr(pair, gear)
    flanks = {
        FLANK + quantity: math.sqrt(1.0 - part**2) * tolerance(toothing, tolerance_class)
        for (quantity, tolerance), part in zip(OF_A_CLASS.items(), COMMON[finishing], strict=True)
        if part < 1.0 and (across_face or quantity not in ACROSS_FACE)
    }
    pitches = PitchBounds.of(toothing, tolerance_class, ACCUMULATED[finishing])
    widths = {RUN_OUT: pitches.eccentricity}
    if (slope := FLANK + "helix_slope") in flanks:
        widths[WOBBLE] = math.sqrt(WOBBLE_SHARE) * flanks[slope]
        flanks[slope] *= math.sqrt(1.0 - WOBBLE_SHARE)
    widths |= {PITCH: 0.5 * pitches.single, **flanks}
    return ToothTolerances(gear, toothing.teeth, widths, distribution, pitches)
