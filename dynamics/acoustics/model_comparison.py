"""The radiation models side by side for one vibration: level, error, cost predicted and measured.

Models differ in what they neglect. `ka` is the wavenumber times the radius of the sphere with the hull's
volume. Shapes: T panels, M shapes of vibration.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from dynamics.acoustics.air import BLOCK as WAVES
from dynamics.acoustics.air import Air, mutual_pressure, mutual_resistance, order_of, order_of_waves
from dynamics.acoustics.boundary_elements import BoundaryElements
from dynamics.acoustics.hull import Hull
from dynamics.acoustics.levels import sound_power_level
from dynamics.acoustics.radiation import (
    EquivalentRadiatedPower,
    RadiationModel,
    mean_square_velocity,
    sound_power,
)
from dynamics.checks import positive
from dynamics.errors import DynamicsError
from dynamics.types import ComplexArray, FloatArray
from dynamics.work_cost import Cost, WorkCost, WorkMeter, announce, on_this_host
from host import MissingExtra
from model_studies.progress import Progress, silent
from model_studies.variants import reason_of_failure
from model_studies.workers import InProcess

BLOCK = 512  # panels whose mutual resistances are held at a time
PAIR, PAIR_SHAPE = 48e-9, 0.1e-9
"""CPU seconds for a pair of panels: for its resistance, and in addition for each shape; measured."""
WAVE, WAVE_SHAPE = 11e-9, 0.065e-9
"""CPU seconds for a panel and a plane wave: for its phase, and in addition for each shape.

Measured on hulls of 720 to 13 520 panels.
"""
ERROR_KA, MONOPOLE_ERRORS = (1.5, 2.5), ((-7.0, -9.0), (2.0, 1.0))
"""Values of ka, and the least and the largest error of monopoles at them, dB.

Measured on spheres, a box and modes of five gear cases.
"""
BAFFLE_GAIN = 3.0
"""Level of the Rayleigh integral above that of monopoles, dB: half the solid angle has twice the power."""
WAVES_IN_MEMORY = 4
"""Arrays of the phases of a block of plane waves that are in memory at once."""
ARRAYS_OF_PAIRS = 6.0
"""Arrays of a block of pairs in memory at once: three components of the distances, and their squares."""
ARRAYS_OF_SHAPES = 3.0
"""Arrays of all shapes on all panels that are in memory at once."""

WORK = "radiation by {}"
"""Name of a model at one frequency in the log of runs."""


@dataclass(frozen=True)
class ElementalRadiators:
    """Panels smaller than the wavelength; mutual resistance by sin(kr)/(kr) of their distance."""

    baffled: bool = False
    """True: every panel lies in the same rigid plane (Rayleigh integral, exact for it). False: every panel is
    a monopole in free space; the hull neither scatters nor shadows. Below ka = 0.5 the power of a vibration
    that changes the volume is right, that of a rigid-body oscillation 3.5 dB low; see `multipoles`.
    """

    @property
    def model_name(self) -> str:
        """Return the name by which results are listed."""
        return "rayleigh_integral" if self.baffled else "monopoles"

    @property
    def solid_angle(self) -> float:
        """Return the solid angle into which each panel radiates, sr."""
        return 2.0 * np.pi if self.baffled else 4.0 * np.pi

    def resistance(self, hull: Hull, frequency: float, shapes: ComplexArray, air: Air) -> ComplexArray:
        """Return rho c k^2 / (2 pi or 4 pi) Q^H [sin(kr)/(kr)] Q with the volume velocities Q = S v_n.

        Raises `InputError`: the panels are too large for the wavelength.
        """
        wavenumber = self._resolved(hull, frequency, air)
        volume_velocity = hull.areas[:, None] * shapes
        if self._by_waves(hull, wavenumber):
            total = mutual_resistance(hull.centers, volume_velocity, wavenumber)
        else:
            total = volume_velocity.conj().T @ _by_pairs(hull, volume_velocity, wavenumber)
        return np.asarray(self._factor(wavenumber, air) * 0.5 * (total + total.conj().T))

    def cost(self, panels: int, ka: float, shapes: int) -> Cost:
        """Predict the cost: by plane waves or pairs of panels, whichever `resistance` takes."""
        waves = 2 * order_of(ka) ** 2
        if self.baffled or waves >= panels:
            seconds = (PAIR + PAIR_SHAPE * shapes) * panels**2
            return Cost(seconds, 8.0 * panels * (ARRAYS_OF_PAIRS * BLOCK + ARRAYS_OF_SHAPES * shapes))
        seconds = (WAVE + WAVE_SHAPE * shapes) * waves * panels
        return Cost(seconds, 8.0 * (WAVES_IN_MEMORY * WAVES + ARRAYS_OF_SHAPES * panels * shapes))

    def error_band(self, ka: float) -> tuple[float, float]:
        """Return the least and largest error, dB, that monopoles had on spheres, boxes and gear cases.

        The band does not hold at interior resonances, where monopoles have no power: a pulsating sphere has
        one near ka = pi.
        """
        low, high = (float(np.interp(ka, ERROR_KA, values)) for values in MONOPOLE_ERRORS)
        return (low + BAFFLE_GAIN, high + BAFFLE_GAIN) if self.baffled else (low, high)

    def panel_power(
        self, hull: Hull, frequency: float, normal_velocity: ComplexArray, air: Air
    ) -> FloatArray:
        """Return the power (T,), W, that each panel radiates in the pressure of all panels.

        Raises `InputError`: the panels are too large for the wavelength.
        """
        wavenumber = self._resolved(hull, frequency, air)
        flow = (hull.areas * normal_velocity)[:, None]
        if self._by_waves(hull, wavenumber):
            pressure = mutual_pressure(hull.centers, flow, wavenumber)
        else:
            pressure = _by_pairs(hull, flow, wavenumber)
        return np.asarray(0.5 * self._factor(wavenumber, air) * (flow.conj() * pressure)[:, 0].real)

    def _resolved(self, hull: Hull, frequency: float, air: Air) -> float:
        """Return the wavenumber, 1/m, whose waves the panels resolve."""
        wavenumber = 2.0 * np.pi * frequency / air.sound_speed
        hull.require_resolved(wavenumber, air.sound_speed)
        return wavenumber

    def _by_waves(self, hull: Hull, wavenumber: float) -> bool:
        """Whether plane waves take less than pairs of panels."""
        return not self.baffled and 2 * order_of_waves(hull.centers, wavenumber) ** 2 < len(hull.triangles)

    def _factor(self, wavenumber: float, air: Air) -> float:
        """Return rho c k^2 over the solid angle, kg/(s m^4)."""
        return float(air.impedance * wavenumber**2 / self.solid_angle)


def _by_pairs(hull: Hull, volume_velocity: ComplexArray, wavenumber: float) -> ComplexArray:
    """Return [sin(kr)/(kr)] Q of all panels, (T, M)."""
    total = np.zeros(volume_velocity.shape, dtype=volume_velocity.dtype)
    for first in range(0, len(volume_velocity), BLOCK):
        block = slice(first, first + BLOCK)
        squares = np.sum((hull.centers[block][:, None] - hull.centers) ** 2, axis=2)
        total[block] = np.sinc(wavenumber / np.pi * np.sqrt(squares)) @ volume_velocity
    return total


MODELS: tuple[RadiationModel, ...] = (
    EquivalentRadiatedPower(),
    ElementalRadiators(),
    ElementalRadiators(baffled=True),
    BoundaryElements(),
)
"""Radiation models from coarse to fine."""


@dataclass(frozen=True)
class _ModelResult:
    """Sound power of a vibration by one radiation model."""

    power: float
    """Sound power, W."""
    efficiency: float
    """Radiation efficiency, 1."""
    cost: WorkCost
    """Predicted and measured cost."""

    @property
    def level(self) -> float:
        """Return the sound power level, dB re 1e-12 W."""
        return float(sound_power_level(self.power))


@dataclass(frozen=True)
class ModelComparison:
    """Results by the model's name, from coarse to fine, and why others have none."""

    results: Mapping[str, _ModelResult]
    omitted: Mapping[str, str]
    predicted: Mapping[str, Cost]
    """Cost of every model at this frequency on this host, also of those that were not requested."""
    error_band: Mapping[str, tuple[float, float]]
    """Bounds of the error of each level, dB: lower and upper; a negative error is a level that is too low."""

    @property
    def errors(self) -> dict[str, float]:
        """Return the levels less that of the finest result, dB; 0 for itself, whose error is its mesh."""
        finest = list(self.results.values())[-1].level
        return {name: result.level - finest for name, result in self.results.items()}


def compare_models(
    hull: Hull,
    frequency: float,
    normal_velocity: ComplexArray,
    air: Air,
    models: Sequence[RadiationModel] = MODELS,
    progress: Progress = silent,
    offered: Sequence[RadiationModel] = (),
    cache: Path | None = None,
) -> ModelComparison:
    """Compute the sound power of a vibration (T,) in m/s at a frequency in Hz by several models.

    A model that refuses the hull or the frequency, or whose extra is not installed, is left out. Raises
    `InputError`: the velocity is 0 everywhere.

    Parameters
    ----------
    progress : callable
        Called as progress(stage, fraction); before a costly model with its predicted cost behind the stage.
    offered : sequence of RadiationModel, optional
        Further models whose cost and error are stated; they are not computed.
    cache : Path, optional
        Directory of the host's measured speeds, see `work_cost.on_this_host`.
    """
    moving = positive("normal_velocity", mean_square_velocity(hull, normal_velocity), "Nothing moves.")
    # the power of as large a plane wave with the same mean square velocity: efficiency 1
    plane, wavenumber = air.impedance * hull.area * moving, 2.0 * np.pi * frequency / air.sound_speed
    by_name = {model.model_name: model for model in models}
    listed = {model.model_name: model for model in (*offered, *models)}
    # the number of plane waves, and with it the cost, follows from the outermost panel
    panels, outer = len(hull.triangles), wavenumber * hull.outer_radius
    reference = {name: model.cost(panels, outer, 1) for name, model in listed.items()}
    predicted = {name: on_this_host(WORK.format(name), cost, cache) for name, cost in reference.items()}
    results: dict[str, _ModelResult] = {}
    omitted: dict[str, str] = {}
    for count, (name, model) in enumerate(by_name.items()):
        progress("models", count / len(by_name))
        with reason_of_failure(omitted, name, (DynamicsError, MissingExtra)):
            announce(progress, name.replace("_", " "), f"{panels} panels", predicted[name])
            workers = getattr(model, "workers", InProcess())
            meter = WorkMeter.at_start(WORK.format(name), reference[name], cache, workers)
            power = sound_power(model, hull, frequency, normal_velocity, air)
            results[name] = _ModelResult(power, power / plane, meter.finish())
    progress("models", 1.0)
    ka = wavenumber * hull.equivalent_radius
    bands = {name: model.error_band(ka) for name, model in listed.items()}
    return ModelComparison(results, omitted, predicted, bands)
