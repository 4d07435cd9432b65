"""The housings of a scene that radiate, each with its radiation over the frequencies of a response."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from dynamics.acoustics import BoundaryElements, ElementalRadiators, EquivalentRadiatedPower, PanelModel
from dynamics.acoustics.recording import LOWEST
from dynamics.housings.reduced_housing import ReducedHousing, SurfaceHousing
from dynamics.noise.estimated_radiation import NAME as ESTIMATE
from dynamics.noise.estimated_radiation import EstimatedRadiation, estimated_radiation
from dynamics.noise.exact_lines import BUDGET, CorrectedRadiation, corrected_radiation
from dynamics.noise.housing_radiation import HousingRadiation, cached_radiation
from dynamics.noise.radiated_sound import RadiatedSound, radiated_sound
from dynamics.results import RunResult
from dynamics.types import FloatArray
from dynamics.vibration import BearingHarmonics
from model_studies.progress import Progress, silent
from model_studies.workers import InProcess, Workers

PLANE, MONOPOLES = EquivalentRadiatedPower(), ElementalRadiators()
MODELS: dict[str, PanelModel] = {
    ESTIMATE: MONOPOLES,
    **{model.model_name: model for model in (PLANE, MONOPOLES)},
}
"""The panel model that is computed for a radiation, by the name of the radiation."""


@dataclass(frozen=True)
class Radiation:
    """Choice of the radiation model of housings, and of the workers that compute it."""

    name: str = ESTIMATE
    """One of `MODELS`."""
    boundary_elements: bool = True
    """Whether boundary elements correct the loudest lines of the estimate."""
    cache: Path | None = None
    """Directory of cached results; None: neither read nor written."""
    progress: Progress = silent
    workers: Workers = field(default_factory=InProcess)

    @property
    def model(self) -> PanelModel:
        """Return the panel model."""
        return MODELS[self.name]


@dataclass(frozen=True)
class SoundingHousing:
    """A housing that radiates."""

    name: str
    body: ReducedHousing
    bearings: tuple[str, ...]
    """Bearings of the housing, in the order of its seats."""
    plain: HousingRadiation
    """Radiation without the lines that boundary elements correct."""
    corrected: CorrectedRadiation | None
    """Radiation with these lines; None: boundary elements do not correct it."""

    @property
    def radiation(self) -> HousingRadiation:
        """Return the most exact radiation."""
        return self.plain if self.corrected is None else self.corrected.radiation

    def sound(self, response: BearingHarmonics) -> RadiatedSound:
        """Return the sound power under the bearing forces of a response."""
        return radiated_sound(response, self.body, self.bearings, self.radiation, self.name)


def sounding_housings(
    response: BearingHarmonics,
    surfaces: Sequence[SurfaceHousing],
    radiation: Radiation,
    run: RunResult | None = None,
) -> tuple[SoundingHousing, ...]:
    """Return housings with their radiation; the budget of boundary elements is divided among them.

    `run`: a run whose sound over time the radiation must cover too. Raises `InputError` as
    `housing_radiation`.
    """
    hertz, budget = _frequencies(response, run), BUDGET / max(len(surfaces), 1)
    model = BoundaryElements(progress=radiation.progress, workers=radiation.workers)
    housings = []
    for surface in surfaces:
        body, bearings = surface.body, surface.bearings
        plain = _plain_radiation(body, hertz, radiation)
        corrected = None
        if isinstance(plain, EstimatedRadiation) and radiation.boundary_elements:
            corrected = corrected_radiation(response, body, bearings, plain, model, radiation.cache, budget)
        housings.append(SoundingHousing(surface.name, body, bearings, plain, corrected))
    return tuple(housings)


def _frequencies(response: BearingHarmonics, run: RunResult | None) -> FloatArray:
    """Return the frequencies that the radiation must cover, Hz.

    They are those of the orders, and the ends of the bands of the left-out orders and of a run's output.
    """
    hertz = response.frequency
    if response.floor is not None:
        hertz = np.append(hertz.ravel(), response.floor.frequency[[0, -1]])
    if run is not None:
        hertz = np.append(hertz.ravel(), [LOWEST, float(run.receipt["sampling"]["pass_frequency"])])
    return hertz


def _plain_radiation(body: ReducedHousing, hertz: FloatArray, radiation: Radiation) -> HousingRadiation:
    panels = cached_radiation(
        body,
        radiation.model,
        hertz.ravel(),
        cache=radiation.cache,
        progress=radiation.progress,
        workers=radiation.workers,
    )
    return estimated_radiation(body, panels) if radiation.name == ESTIMATE else panels
