"""The objective of a design: expected peak-to-peak, or one harmonic, over the loads; and limits to keep."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from bounds import Bound, SiNote, above, at_least
from fe_contact.errors import InputError, finite, integer, positive
from fe_contact.types import FloatArray, Json

MAX_HARMONIC = 20
"""Highest harmonic that curves have."""
Rows = tuple[FloatArray, FloatArray]
"""Values (R,) and their derivatives (R, d)."""


PHASES = 64
"""Phases of a harmonic at which its curve is taken: their extremes are within 0.12 % of its own."""


class Objective(Protocol):
    """One number of the expected peak-to-peak STE at all loads, or of the peak-to-peak of parts of it."""

    @property
    def harmonic(self) -> int | None:
        """The mesh harmonic whose amplitude counts in place of the peak-to-peak; None: all of the curve."""

    def counted(self, ste: FloatArray, position: FloatArray) -> FloatArray:
        """Return the curves (S, R, L, ...) whose peak-to-peak counts.

        `ste` (S, period x P, L, ...) are curves, m, at positions (P,) of one base pitch after the other.
        """

    def check(self, loads: int) -> None:
        """Raise `InputError` if it is not for that many loads."""

    def of(self, expected: FloatArray) -> float:
        """Return the number in m of the expectations (L,) in m."""

    def rows(self, loads: int) -> FloatArray:
        """Return weights (R, L) of that many loads: the number is the largest of the R weighted sums."""

    def to_json(self) -> Json:
        """Return plain JSON."""


class _WholeCurve:
    """An objective of the whole curve."""

    @property
    def harmonic(self) -> int | None:
        """None: all of the curve."""
        return None

    def counted(self, ste: FloatArray, position: FloatArray) -> FloatArray:
        """Return the curves as they are."""
        return ste


@dataclass(frozen=True)
class WeightedMean(_WholeCurve):
    """Mean over the loads; `weights` (L,) >= 0 need not sum to 1, none are equal ones."""

    weights: tuple[float, ...] = ()

    def check(self, loads: int) -> None:
        """Refuse another number of weights, negative ones, and nothing but zeros."""
        if not self.weights:
            return
        for index, weight in enumerate(self.weights):
            if finite(f"objective.weights[{index}]", weight) < 0.0:
                raise InputError(f"objective.weights[{index}]", weight, at_least(0.0))
        if len(self.weights) != loads or sum(self.weights) == 0.0:
            bound = f"{loads} numbers, one for each torque, not all 0"
            raise InputError("objective.weights", list(self.weights), bound)

    def of(self, expected: FloatArray) -> float:
        """Return the mean."""
        return float(np.average(expected, weights=self.weights or None))

    def rows(self, loads: int) -> FloatArray:
        """Return one row."""
        weights = np.array(self.weights or (1.0,) * loads)
        return np.asarray(weights[None] / weights.sum())

    def to_json(self) -> Json:
        """Return plain JSON."""
        return {"objective": "weighted_mean", "weights": list(self.weights)}


@dataclass(frozen=True)
class Worst(_WholeCurve):
    """The load with the largest expectation."""

    def check(self, loads: int) -> None:
        """Every number of loads will do."""

    def of(self, expected: FloatArray) -> float:
        """Return the largest."""
        return float(expected.max())

    def rows(self, loads: int) -> FloatArray:
        """Return a row for each load."""
        return np.eye(loads)

    def to_json(self) -> Json:
        """Return plain JSON."""
        return {"objective": "worst"}


@dataclass(frozen=True)
class HarmonicAmplitude:
    """Amplitude of one mesh harmonic, over the loads as another objective takes their peak-to-peak."""

    harmonic: int
    """Multiple of the mesh frequency, from 1."""
    over_loads: WeightedMean | Worst = WeightedMean()

    def check(self, loads: int) -> None:
        """Refuse a harmonic that the positions of a search do not resolve."""
        integer("objective.harmonic", self.harmonic, 1, MAX_HARMONIC)
        self.over_loads.check(loads)

    def of(self, expected: FloatArray) -> float:
        """Return the number of the expected amplitudes."""
        return self.over_loads.of(expected)

    def rows(self, loads: int) -> FloatArray:
        """Return the weights of the loads."""
        return self.over_loads.rows(loads)

    def counted(self, ste: FloatArray, position: FloatArray) -> FloatArray:
        """Return half the harmonic's own curve at `PHASES`: its peak-to-peak is the amplitude.

        With c = 2 / period times the integral of ste(x) exp(-2 pi i n x), the curve is Re(c exp(i phi)) / 2.
        """
        periods = ste.shape[1] // position.size
        places = (position + np.arange(periods)[:, None]).ravel()
        ahead = np.append(places[1:], places[0] + periods) - places
        weight = (ahead + np.roll(ahead, 1)) / periods  # twice the trapezoidal rule
        phase = 2.0 * np.pi * np.arange(PHASES) / PHASES
        turned = np.cos(phase[:, None] - 2.0 * np.pi * self.harmonic * places)
        rows = 0.5 * turned * weight
        rows -= rows.sum(axis=1, keepdims=True) * weight / weight.sum()  # unevenly spaced rows see no mean
        return np.moveaxis(np.tensordot(rows, ste, (1, 1)), 0, 1)

    def to_json(self) -> Json:
        """Return plain JSON."""
        return {**self.over_loads.to_json(), "harmonic": self.harmonic}


@dataclass(frozen=True)
class Limits:
    """Limits of a design at every load and every node of the scatter; None: no limit."""

    max_pressure: float | None = None
    """Largest Hertzian pressure, Pa."""
    face_load_factor: float | None = None
    """K_Hbeta of the mean over a mesh cycle, > 1 (ISO 6336-1)."""
    edge_load_share: float | None = None
    """Largest part of the load that tip edges carry at any position; 0 forbids their contact."""
    peak_to_peak: float | None = None
    """Largest peak-to-peak of the transmission error, m."""
    root_stress: float | None = None
    """Largest principal stress in the tension roots of both gears, Pa."""

    def __post_init__(self) -> None:
        if self.max_pressure is not None:
            positive("limits.max_pressure", self.max_pressure, SiNote("In Pa: 1500 MPa is 1.5e9."))
        if (
            self.face_load_factor is not None
            and finite("limits.face_load_factor", self.face_load_factor) <= 1
        ):
            raise InputError("limits.face_load_factor", self.face_load_factor, above(1.0))
        if (
            self.edge_load_share is not None
            and not 0.0 <= finite("limits.edge_load_share", self.edge_load_share) < 1.0
        ):
            bound = Bound(0.0, 1.0, high_open=True)
            raise InputError("limits.edge_load_share", self.edge_load_share, bound)
        if self.peak_to_peak is not None:
            positive("limits.peak_to_peak", self.peak_to_peak, SiNote("In m: 1 µm is 1e-6."))
        if self.root_stress is not None:
            positive("limits.root_stress", self.root_stress, SiNote("In Pa: 400 MPa is 4e8."))

    def to_json(self) -> Json:
        """Return plain JSON."""
        return {
            "max_pressure_pa": self.max_pressure,
            "face_load_factor": self.face_load_factor,
            "edge_load_share": self.edge_load_share,
            "peak_to_peak_m": self.peak_to_peak,
            "root_stress_pa": self.root_stress,
        }


NO_LIMITS = Limits()
