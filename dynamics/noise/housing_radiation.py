"""Radiation resistance of a reduced housing over its coordinates and a range of frequencies."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from typing import cast

import numpy as np
from numpy.typing import ArrayLike

from dynamics.acoustics import Air, ModalResistance, OuterHull, RadiationModel, outer_hull, resistance
from dynamics.acoustics.equivalent_radiated_power import EquivalentRadiatedPower
from dynamics.acoustics.hull import ComplexArray
from dynamics.checks import positive
from dynamics.errors import InputError
from dynamics.housing_modes.reduced_housing import ReducedHousing
from dynamics.noise.coarse_hull import RadiatingHull, radiating_hull
from dynamics.noise.knots import Knots, constant_knots, knots_between
from dynamics.results.array_file import ArrayFile, Stored
from dynamics.types import FloatArray, Json

BAND = 10.0**0.05
"""Half a third octave: the range grows to edges of bands."""
ROUNDED_DOWN = 1.0 - 1e-12
"""Of a limit in Hz whose wavenumber must not be above that of the limit."""

STORED = {
    "frequency": Stored(("frequency",), "Hz", "frequency"),
    "matrix": Stored(("frequency", "coordinate", "coordinate"), "kg s-1", "radiation resistance"),
    "surface": Stored(("coordinate", "coordinate"), "m2", "integral of products of normal motions"),
}


@dataclass(frozen=True)
class HousingRadiation(ModalResistance, ArrayFile):
    """Radiation resistance over the coordinates of a reduced housing.

    Attributes
    ----------
    surface : (r, r) array
        Integral over the hull of the products of normal displacements, m^2: half its quadratic form of
        velocities is the integral of the mean square in time.
    area : float
        Of the outer hull with its caps, m^2.
    impedance : float
        rho c of the air, Pa s/m.
    model_name : str
        Of the radiation model.
    facts : dict
        Plain JSON: `resolved_frequency` in Hz, above which panels move as parts of a plane (ERP),
        `interpolation_error` in dB, `inner_area` and `cap_area` in m^2, `panels` (most), `seconds`.
    """

    SCHEMA = "lineofaction housing radiation"
    ARRAYS = STORED

    surface: FloatArray = field(default_factory=lambda: np.empty((0, 0)))
    area: float = 0.0
    impedance: float = 0.0
    model_name: str = ""
    facts: Json = field(default_factory=dict)

    def hull_at(self, outer: OuterHull, frequency: float, sound_speed: float) -> RadiatingHull | None:
        """Return the panels at a computed frequency, Hz; None above those that the mesh resolves."""
        low, high = float(self.frequency[0]), float(self.frequency[-1])
        for first, last in _octaves(low, min(high, self.facts["resolved_frequency"])):
            if first <= frequency <= last:
                return radiating_hull(outer, last, sound_speed)
        return None

    def efficiency(self, power: FloatArray, velocity: ComplexArray) -> FloatArray:
        """Return the radiation efficiency of powers (B,) in W of velocities (B, r), 0 where nothing moves."""
        flow = np.sum(velocity.conj() * (velocity @ self.surface), axis=1).real
        return np.asarray(power / np.maximum(0.5 * self.impedance * flow, 1e-300))


def housing_radiation(
    housing: ReducedHousing,
    model: RadiationModel,
    frequencies: ArrayLike,
    air: Air | None = None,
    progress: Callable[[float], None] | None = None,
) -> HousingRadiation:
    """Return the radiation resistance of a housing from the lowest to the highest of some frequencies.

    Frequencies at which it is computed lie closer until the power of every mode is interpolated within about
    0.1 dB (`knots`). Panels are as coarse as each octave allows. Above the frequency that the mesh
    resolves (six edges of a panel in a wavelength) equivalent radiated power takes the model's place.

    Parameters
    ----------
    housing : ReducedHousing
        With a surface.
    model : RadiationModel
    frequencies : array
        Hz, above zero; the range grows outwards to the edges of third octaves.
    air : Air, optional
    progress : callable, optional
        Called with the fraction done.

    Raises
    ------
    InputError
        The housing has no surface, a frequency is not above zero, or what the model refuses.
    """
    air, asked = air or Air(), np.asarray(frequencies, dtype=float)
    if not asked.size:
        raise InputError("frequencies", [], "at least one frequency")
    low, high = positive("frequencies", float(asked.min())) / BAND, float(asked.max()) * BAND
    began = time.process_time()
    outer = outer_hull(housing)
    resolved = 0.0 if isinstance(model, EquivalentRadiatedPower) else resolved_frequency(outer, air)
    done = progress or (lambda _fraction: None)

    def reached(frequency: float) -> None:
        done(((frequency - low) / (high - low)) ** 2)

    parts, most = _resolved_parts(outer, model, air, (low, min(high, resolved)), housing.modes[1], reached)
    if high > resolved:
        first = max(low, float(np.nextafter(resolved, np.inf)))
        parts.append(constant_knots(first, high, cast(ComplexArray, air.impedance * outer.surface)))
    facts: Json = {
        "resolved_frequency": resolved,
        "interpolation_error": 0.25 * max(part.error for part in parts),
        "inner_area": outer.inner_area,
        "cap_area": outer.cap_area,
        "panels": most or len(outer.hull.triangles),
        "seconds": time.process_time() - began,
    }
    return HousingRadiation(
        np.concatenate([part.frequency for part in parts]),
        np.concatenate([part.matrix for part in parts]),
        outer.surface,
        outer.hull.area,
        air.impedance,
        model.model_name,
        facts,
    )


def _resolved_parts(
    outer: OuterHull,
    model: RadiationModel,
    air: Air,
    band: tuple[float, float],
    modes: FloatArray,
    reached: Callable[[float], None],
) -> tuple[list[Knots], int]:
    """Return the knots of each octave of a band, Hz, and the most panels of one."""
    parts, most = [], 0
    for first, last in _octaves(*band):
        hull = radiating_hull(outer, last, air.sound_speed)
        parts.append(knots_between(first, last, partial(_resistance, model, hull, air), modes))
        most = max(most, len(hull.hull.triangles))
        reached(last)
    return parts, most


def _octaves(low: float, high: float) -> list[tuple[float, float]]:
    """Return ranges of at most an octave from `low` to `high`, each a bit above the one before.

    Each has its own panels: the highest are too many for the lowest.
    """
    if low >= high:
        return []
    ends = np.geomspace(low, high, max(int(np.ceil(np.log2(high / low))), 1) + 1).tolist()
    starts = [low, *(float(np.nextafter(end, np.inf)) for end in ends[1:-1])]
    return list(zip(starts, ends[1:], strict=True))


def _resistance(model: RadiationModel, hull: RadiatingHull, air: Air, frequency: float) -> ComplexArray:
    """Return the resistance of the coordinates at a frequency, (r, r)."""
    return resistance(model, hull.hull, frequency, cast(ComplexArray, hull.shapes), air)


def resolved_frequency(outer: OuterHull, air: Air) -> float:
    """Return the frequency up to which the panels resolve the wavelength, Hz."""
    return outer.hull.highest_wavenumber * air.sound_speed / (2.0 * np.pi) * ROUNDED_DOWN
