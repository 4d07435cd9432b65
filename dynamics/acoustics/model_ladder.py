"""The radiation models side by side for one vibration: level, error, cost predicted and measured."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from dynamics.acoustics.air import Air
from dynamics.acoustics.boundary_elements import BoundaryElements
from dynamics.acoustics.elemental_radiators import ElementalRadiators
from dynamics.acoustics.equivalent_radiated_power import EquivalentRadiatedPower
from dynamics.acoustics.hull import ComplexArray, Hull
from dynamics.acoustics.levels import sound_power_level
from dynamics.acoustics.radiation import RadiationModel, mean_square_velocity, sound_power
from dynamics.checks import positive
from dynamics.errors import DynamicsError
from dynamics.work_cost import Cost, WorkCost, announce, measured, on_this_host
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


WORK = "radiation by {}"
"""Name of a model at one frequency in the log of runs."""


@dataclass(frozen=True)
class ModelResult:
    """What a radiation model says of a vibration.

    Attributes
    ----------
    power : float
        W.
    efficiency : float
        Radiation efficiency, 1.
    cost : WorkCost
        Predicted and measured.
    """

    power: float
    efficiency: float
    cost: WorkCost

    @property
    def level(self) -> float:
        """Return the sound power level, dB re 1e-12 W."""
        return float(sound_power_level(self.power))


@dataclass(frozen=True)
class ModelLadder:
    """Results by the model's name, from coarse to fine, and why others have none.

    Attributes
    ----------
    results : mapping of str to ModelResult
    left_out : mapping of str to str
    predicted : mapping of str to Cost
        Cost of every model at this frequency on this host, also of those that were not asked.
    error_band : mapping of str to (float, float)
        By how much the level of each may be off, dB, from and to; below 0: too quiet.
    """

    results: Mapping[str, ModelResult]
    left_out: Mapping[str, str]
    predicted: Mapping[str, Cost]
    error_band: Mapping[str, tuple[float, float]]

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
) -> ModelLadder:
    """Compute the sound power of a vibration (T,) in m/s at a frequency in Hz by several models.

    A model that refuses the hull or the frequency, or whose extra is not installed, is left out.

    Parameters
    ----------
    progress : callable
        Called as progress(stage, fraction); before a costly model with its predicted cost behind the stage.
    offered : sequence of RadiationModel, optional
        Of which cost and error are stated, too; they are not computed.
    cache : Path, optional
        Directory of what is known of the host, see `work_cost.on_this_host`.

    Raises
    ------
    InputError
        Nothing moves.
    """
    moving = positive("normal_velocity", mean_square_velocity(hull, normal_velocity), "Nothing moves.")
    plane, wavenumber = air.impedance * hull.area * moving, 2.0 * np.pi * frequency / air.sound_speed
    by_name = {model.model_name: model for model in models}
    ladder = {model.model_name: model for model in (*offered, *models)}
    panels, outer = len(hull.triangles), wavenumber * hull.outer_radius
    reference = {name: model.cost(panels, outer, 1) for name, model in ladder.items()}
    predicted = {name: on_this_host(WORK.format(name), cost, cache) for name, cost in reference.items()}

    def compute(model: RadiationModel) -> ModelResult:
        name = model.model_name
        announce(progress, name.replace("_", " "), f"{panels} panels", predicted[name])
        power, cost = measured(
            WORK.format(name),
            reference[name],
            cache,
            lambda: sound_power(model, hull, frequency, normal_velocity, air),
        )
        return ModelResult(power, power / plane, cost)

    results, left_out = run_variants("models", by_name, compute, (DynamicsError, MissingExtra), progress)
    ka = wavenumber * hull.equivalent_radius
    bands = {name: model.error_band(ka) for name, model in ladder.items()}
    return ModelLadder(results, left_out, predicted, bands)
