"""Sound power of all housings of a scene under one set of bearing forces, and bounds of its error.

Radiation models have errors of known bounds: monopoles neglect scattering, equivalent radiated power neglects
interference. Axis letters: S speeds, or windows of a run; H orders. A point is a speed and an order.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from dynamics.housings.reduced_housing import SurfaceHousing
from dynamics.noise.estimated_radiation import MIN, EstimatedRadiation
from dynamics.noise.housing_radiation import HousingRadiation
from dynamics.noise.model_levels import ModelLevels, model_levels
from dynamics.noise.panel_sound import PanelSound, Region, panel_sound, regions
from dynamics.noise.radiated_sound import LoudPoint, RadiatedSound, loudest
from dynamics.noise.sound_over_time import BLOCK, SoundOverTime, sound_over_time
from dynamics.noise.sounding_housing import Radiation, SoundingHousing, sounding_housings
from dynamics.results import RunResult
from dynamics.types import FloatArray
from dynamics.vibration import BearingHarmonics


@dataclass(frozen=True)
class HousingRegion:
    """A region of a housing at a loud point, and its share of the power of all housings there."""

    housing: str
    region: Region
    share: float


@dataclass(frozen=True)
class SceneSound:
    """Sound power of all housings of a scene."""

    power: RadiatedSound
    """Sound power of all housings together, with the panels of the loudest point."""
    housings: tuple[SoundingHousing, ...]
    models: Mapping[str, ModelLevels | None]
    """Levels by further radiation models, by housing; None for a housing that is silent."""
    regions: tuple[tuple[HousingRegion, ...], ...]
    """Regions of the housings at each of the `loudest` points, those of the largest power first."""
    error: FloatArray
    """Bounds of the error of the levels by the radiation models, dB: lower and upper; a negative error is a
    level that is too low. Shape (2, S, H).
    """
    over_time: SoundOverTime | None
    """Sound power over the run that the forces belong to; None: there is no run, or it is shorter than a
    block.
    """

    @property
    def radiation(self) -> dict[str, HousingRadiation]:
        """The radiation by the most exact model, by housing."""
        return {housing.name: housing.radiation for housing in self.housings}


def scene_sound(
    response: BearingHarmonics,
    surfaces: Sequence[SurfaceHousing],
    radiation: Radiation,
    run: RunResult | None = None,
) -> SceneSound:
    """Return the sound of the housings of a scene under bearing forces.

    Raises `InputError` as `radiated_sound`.

    Parameters
    ----------
    response : BearingHarmonics
        Bearing forces of the linear response or of the run, in the frame of the meshes of the housings.
    surfaces : sequence of SurfaceHousing
        Housings with their surfaces, at least one.
    run : RunResult, optional
        Run whose sound over time is computed too.
    """
    housings = sounding_housings(response, surfaces, radiation, run)
    sounds = [housing.sound(response) for housing in housings]
    models = {
        housing.name: model_levels(response, housing, sound, radiation)
        for housing, sound in zip(housings, sounds, strict=True)
    }
    power = RadiatedSound.of_all(sounds)
    points = loudest(power)
    panels = [_panels(response, housings, point, radiation) for point in points]
    if panels:  # those of all housings at the loudest point, as one surface
        joined = PanelSound.of_all(panels[0])
        nodes, corners = joined.hull.nodes, joined.hull.triangles
        power = replace(power, panel_node=nodes, panel_corner=corners, panel_power=joined.power)
    return SceneSound(
        power=power,
        housings=housings,
        models=models,
        regions=tuple(
            _regions(housings, point_panels, power, point)
            for point_panels, point in zip(panels, points, strict=True)
        ),
        error=joined_error(housings, sounds, models),
        over_time=None if run is None else _over_time(run, housings),
    )


def _panels(
    response: BearingHarmonics, housings: Sequence[SoundingHousing], point: LoudPoint, radiation: Radiation
) -> list[PanelSound]:
    """Return the sound of the panels of each housing at a point."""
    at = point.speed_index, point.order_index
    return [
        panel_sound(response, housing.body, housing.bearings, housing.radiation, at, radiation.model)
        for housing in housings
    ]


def _regions(
    housings: Sequence[SoundingHousing],
    panels: Sequence[PanelSound],
    power: RadiatedSound,
    point: LoudPoint,
) -> tuple[HousingRegion, ...]:
    total = float(power.power[point.speed_index, point.order_index])
    rows = [
        HousingRegion(housing.name, region, region.power / total)
        for housing, sound in zip(housings, panels, strict=True)
        for region in regions(sound, housing.body.points)
    ]
    return tuple(sorted(rows, key=lambda row: -row.region.power))


def joined_error(
    housings: Sequence[SoundingHousing],
    sounds: Sequence[RadiatedSound],
    models: Mapping[str, ModelLevels | None],
) -> FloatArray:
    """Return the lower and the upper bound of the error of the levels of all housings, (2, S, H), dB.

    A negative error is a level that is too low. At a bound all housings have the errors of their radiation
    models to the same side.
    """
    power, true = np.zeros(sounds[0].power.shape), np.zeros((2, *sounds[0].power.shape))
    for housing, sound in zip(housings, sounds, strict=True):
        radiation, compared = housing.radiation, models[housing.name]
        if isinstance(radiation, EstimatedRadiation):
            error = radiation.off(sound.frequency, sound.mode_alone)
        else:
            # a model without a band of its error counts as exact
            bands = {} if compared is None else compared.error_band
            band = bands.get(radiation.model_name, (0.0, 0.0))
            error = np.broadcast_to(np.reshape(band, (2, 1, 1)), true.shape)
        power = power + sound.power
        true = true + sound.power * 10.0 ** (-error / 10.0)  # power without the error of the level
    return np.asarray(-10.0 * np.log10(np.maximum(true, MIN) / np.maximum(power, MIN)))


def _over_time(run: RunResult, housings: Sequence[SoundingHousing]) -> SoundOverTime | None:
    """Return the sound power over a run; None: the run is shorter than a block."""
    if run.time.size < BLOCK * run.sample_rate:
        return None
    sounds = [sound_over_time(run, housing.body, housing.bearings, housing.radiation) for housing in housings]
    return SoundOverTime.of_all(sounds)
