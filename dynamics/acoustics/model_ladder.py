"""The radiation models side by side for one vibration: level, error against the finest, cost."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from dynamics.acoustics.air import Air
from dynamics.acoustics.boundary_elements import BoundaryElements
from dynamics.acoustics.elemental_radiators import ElementalRadiators
from dynamics.acoustics.equivalent_radiated_power import EquivalentRadiatedPower
from dynamics.acoustics.hull import ComplexArray, Hull
from dynamics.acoustics.levels import sound_power_level
from dynamics.acoustics.radiation import RadiationModel, mean_square_velocity, sound_power
from dynamics.checks import positive
from dynamics.errors import DynamicsError
from host import MissingExtra
from model_studies.progress import Progress, silent
from model_studies.variants import run_variants

MODELS: tuple[RadiationModel, ...] = (
    EquivalentRadiatedPower(),
    ElementalRadiators(),
    ElementalRadiators(baffled=True),
    BoundaryElements(),
)
"""From coarse to fine."""


@dataclass(frozen=True)
class ModelResult:
    """What a radiation model says of a vibration.

    Attributes
    ----------
    power : float
        W.
    efficiency : float
        Radiation efficiency, 1.
    cpu_seconds : float
        CPU time in this process.
    """

    power: float
    efficiency: float
    cpu_seconds: float

    @property
    def level(self) -> float:
        """Return the sound power level, dB re 1e-12 W."""
        return float(sound_power_level(self.power))


@dataclass(frozen=True)
class ModelLadder:
    """Results by the model's name, from coarse to fine, and why others have none."""

    results: Mapping[str, ModelResult]
    left_out: Mapping[str, str]

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
) -> ModelLadder:
    """Compute the sound power of a vibration (T,) in m/s at a frequency in Hz by several models.

    A model that refuses the hull or the frequency, or whose extra is not installed, is left out.

    Raises
    ------
    InputError
        Nothing moves.
    """
    moving = positive("normal_velocity", mean_square_velocity(hull, normal_velocity), "Nothing moves.")
    plane = air.impedance * hull.area * moving

    def compute(model: RadiationModel) -> ModelResult:
        began = time.process_time()
        power = sound_power(model, hull, frequency, normal_velocity, air)
        return ModelResult(power, power / plane, time.process_time() - began)

    by_name = {model.model_name: model for model in models}
    results, left_out = run_variants("models", by_name, compute, (DynamicsError, MissingExtra), progress)
    return ModelLadder(results, left_out)
