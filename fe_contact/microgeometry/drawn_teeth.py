"""Teeth of one gear within the tolerances of a class: run-out, pitches, slopes and forms of single flanks."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from fe_contact.geometry import ParallelAxes, PitchDeviation, RunOut, ToothFlank, Toothing
from fe_contact.geometry.flank_tolerances import run_out_tolerance, single_pitch_tolerance
from fe_contact.microgeometry.tolerances import (
    COMMON,
    OF_A_CLASS,
    PROCESS_SPREAD,
    Distribution,
    Finishing,
    spread_within,
)
from fe_contact.microgeometry.variables import ACROSS_FACE
from fe_contact.types import FloatArray

RUN_OUT, PITCH, FLANK = "run_out", "pitch_deviation", "tooth_flanks."


@dataclass(frozen=True)
class ToothTolerances:
    """By how much the teeth of one gear differ at most.

    Attributes
    ----------
    gear : {"pinion", "wheel"}
    teeth : int
    widths : mapping
        Half widths in m: ``run_out``, the eccentricity; ``pitch_deviation``, the place of each tooth;
        ``tooth_flanks.profile_slope`` and the like, the part of a tolerance that teeth have not in common.
    distribution : {"normal", "uniform"}
        As of `Tolerances`. A normal eccentricity is so in both directions.
    """

    gear: str
    teeth: int
    widths: Mapping[str, float]
    distribution: Distribution = "normal"

    @property
    def names(self) -> tuple[str, ...]:
        """``gear.what`` in the order of the widths."""
        return tuple(f"{self.gear}.{name}" for name in self.widths)

    def drawn(self, count: int, seed: int) -> DrawnTeeth:
        """Draw gears; a larger sample of the same seed begins with a smaller one."""
        of_teeth = [name for name in self.widths if name != RUN_OUT]
        uniform = np.random.default_rng(seed).random((count, 2 + len(of_teeth) * self.teeth))
        each = uniform[:, 2:].reshape(count, len(of_teeth), self.teeth)
        by_tooth = {
            name: spread_within(self.widths[name], each[:, k], self.distribution)
            for k, name in enumerate(of_teeth)
        }
        return DrawnTeeth(self._eccentricity(uniform[:, 0]), 2.0 * math.pi * uniform[:, 1], by_tooth)

    def _eccentricity(self, uniform: FloatArray) -> FloatArray:
        limit = self.widths[RUN_OUT]
        if self.distribution == "uniform":
            return np.asarray(limit * uniform)
        below = 1.0 - math.exp(-0.5 * PROCESS_SPREAD**2)
        return np.asarray(limit / PROCESS_SPREAD * np.sqrt(-2.0 * np.log1p(-below * uniform)))


@dataclass(frozen=True)
class DrawnTeeth:
    """N gears of z teeth each.

    Attributes
    ----------
    eccentricity, angle : ndarray, shape (N,)
        m and rad, as of `RunOut`.
    by_tooth : mapping of str to ndarray, shape (N, z)
        Pitch deviations on the reference circle and deviations of single flanks, m; > 0 is material in
        excess.
    """

    eccentricity: FloatArray
    angle: FloatArray
    by_tooth: Mapping[str, FloatArray]

    def fields(self, index: int) -> dict[str, Any]:
        """Return the fields of one of the gears."""
        own = {name: values[index].tolist() for name, values in self.by_tooth.items()}
        pitch = own.pop(PITCH, ())
        figures = {name.removeprefix(FLANK): values for name, values in own.items()}
        flanks = tuple(
            ToothFlank(tooth, **dict(zip(figures, amounts, strict=True)))
            for tooth, amounts in enumerate(zip(*figures.values(), strict=True), start=1)
        )
        return {
            "run_out": RunOut(float(self.eccentricity[index]), float(self.angle[index])),
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
    """Return what of the teeth of one gear differs by ISO 1328-1:2013.

    The eccentricity is at most half the run-out F_rT. A tooth is at most half of f_pT out of its place, so
    that no pitch is out by more than f_pT. Of a slope or form of which all teeth have the part c in common,
    the rest is the root of 1 - c^2 of the tolerance (`COMMON`).
    """
    own: Toothing = getattr(pair, gear)
    widths = {
        RUN_OUT: 0.5 * run_out_tolerance(own, tolerance_class),
        PITCH: 0.5 * single_pitch_tolerance(own, tolerance_class),
    }
    for (quantity, tolerance), part in zip(OF_A_CLASS.items(), COMMON[finishing], strict=True):
        if part < 1.0 and (across_face or quantity not in ACROSS_FACE):
            widths[FLANK + quantity] = math.sqrt(1.0 - part**2) * tolerance(own, tolerance_class)
    return ToothTolerances(gear, own.teeth, widths, distribution)
