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
    """Bounds of pitches in a class, with the pitches that the eccentricity makes."""

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
        """Return places of teeth (..., z), m, with accumulated pitch deviations.

        Harmonic j of the teeth grows by the root of 1 - a + a / (2 sin^2(pi j / z)), a the part accumulated:
        the mean square of a single pitch stays, and that of neighbors' difference is the same at every tooth.
        """
        if not self.accumulated:
            return deviation
        teeth = deviation.shape[-1]
        pitch = 2.0 * np.sin(math.pi * np.arange(1, teeth // 2 + 1) / teeth) ** 2
        gain = np.sqrt(1.0 - self.accumulated + self.accumulated / pitch)
        lines = np.fft.rfft(deviation, axis=-1) * np.concatenate([[1.0], gain])
        return np.asarray(np.fft.irfft(lines, teeth, axis=-1))

    def bounded(self, eccentricity: float | FloatArray, deviation: FloatArray) -> FloatArray:
        """Return places of teeth (..., z), m, scaled where they and the eccentricity pass a bound."""
        arc = 2.0 * np.asarray(eccentricity)[..., None] / self.cosine
        step = np.abs(deviation - np.roll(deviation, 1, axis=-1)).max(axis=-1, keepdims=True)
        left = self.single - arc * math.sin(math.pi / deviation.shape[-1])
        total = np.ptp(deviation, axis=-1, keepdims=True)
        tiny = np.finfo(float).tiny
        share = np.minimum(left / np.maximum(step, tiny), (self.cumulative - arc) / np.maximum(total, tiny))
        return np.asarray(deviation * np.clip(share, 0.0, 1.0))


@dataclass(frozen=True)
class ToothTolerances:
    """Largest differences between the teeth of one gear."""

    gear: str
    teeth: int
    widths: Mapping[str, float]
    """Half widths in m: ``run_out``, the eccentricity; ``wobble``, the largest helix slope of a revolution;
    ``pitch_deviation``, the place of each tooth; ``tooth_flanks.profile_slope`` and the like, the part of a
    tolerance that teeth have not in common.
    """
    distribution: Distribution = "normal"
    """Distribution of the deviations, as in `Tolerances`. A normal distribution of eccentricity and wobble
    holds in both directions.
    """
    pitches: PitchBounds | None = None
    """Bounds to which the places of all teeth are scaled; None: the places have no common bound."""

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
        """Draw gears from a scrambled Sobol' sequence, of which `after` dimensions are others'.

        A larger sample of the same seed begins with a smaller one.
        """
        from scipy.stats import qmc  # noqa: PLC0415 (start-up time)

        of_axis = [name for name in OF_AXIS if name in self.widths]
        of_teeth = [name for name in self.widths if name not in OF_AXIS]
        of_both = 2 * len(of_axis)
        sequence = qmc.Sobol(after + self.dimensions, rng=seed)
        uniform = sequence.random_base2(max(count - 1, 1).bit_length())[:count, after:]
        of_tooth = uniform[:, of_both:].reshape(count, len(of_teeth), self.teeth)
        by_axis = {
            name: self._amounts(name, uniform[:, 2 * k]) * np.exp(2j * math.pi * uniform[:, 2 * k + 1])
            for k, name in enumerate(of_axis)
        }
        by_tooth = {
            name: spread_within(self.widths[name], of_tooth[:, k], self.distribution)
            for k, name in enumerate(of_teeth)
        }
        return DrawnTeeth(by_axis, by_tooth, self.pitches)

    def _amounts(self, name: str, uniform: FloatArray) -> FloatArray:
        limit = self.widths[name]
        if self.distribution == "uniform":
            return np.asarray(limit * uniform)
        below = 1.0 - math.exp(-0.5 * PROCESS_SPREAD**2)
        return np.asarray(limit / PROCESS_SPREAD * np.sqrt(-2.0 * np.log1p(-below * uniform)))


@dataclass(frozen=True)
class DrawnTeeth:
    """N gears of z teeth each."""

    by_axis: Mapping[str, ComplexArray]
    """Eccentricity and wobble in m, their angles as of `RunOut`: complex. Mapping of str to ndarray, shape
    (N,).
    """
    by_tooth: Mapping[str, FloatArray]
    """Pitch deviations on the reference circle and deviations of single flanks, m; > 0 is material in excess.
    They are as drawn; `made` is scaled to the class. Mapping of str to ndarray, shape (N, z).
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
        """Return the gears with one deviation drawn otherwise."""
        if name in OF_AXIS:
            return replace(self, by_axis={**self.by_axis, name: amount})
        return replace(self, by_tooth={**self.by_tooth, name: amount})

    def subset(self, rows: slice) -> DrawnTeeth:
        """Return some of the gears."""
        by_axis = {name: values[rows] for name, values in self.by_axis.items()}
        return replace(self, by_axis=by_axis, by_tooth={n: v[rows] for n, v in self.by_tooth.items()})

    def fields(self, index: int) -> dict[str, Any]:
        """Return the fields of one of the gears."""
        turning = (complex(self.by_axis[name][index]) if name in self.by_axis else 0j for name in OF_AXIS)
        axis = [figure for amount in turning for figure in cmath.polar(amount)]
        by_name = {name: values[index].tolist() for name, values in self.made.items()}
        pitch = by_name.pop(PITCH, ())
        figures = {name.removeprefix(FLANK): values for name, values in by_name.items()}
        flanks = tuple(
            ToothFlank(tooth, **dict(zip(figures, amounts, strict=True)))
            for tooth, amounts in enumerate(zip(*figures.values(), strict=True), start=1)
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
    """Return the differences between the teeth of one gear by ISO 1328-1:2013.

    The eccentricity is at most half the run-out F_rT, a tooth by itself at most half of f_pT out of its
    place. Of the square of a single pitch the teeth behind keep the part `ACCUMULATED`; all places are scaled
    where pitches and eccentricity together pass f_pT or F_pT (`PitchBounds`). Of a slope or
    form of which all teeth have the part c in common, the rest is the root of 1 - c^2 of the tolerance
    (`COMMON`). Wobble is a helix slope once per revolution: of the square of this rest it has the part
    `WOBBLE_SHARE`, single flanks have the others.
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
