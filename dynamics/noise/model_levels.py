"""Radiation models side by side where a housing is loudest: levels, stated errors, cost."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from dynamics.acoustics import Air, BoundaryElements, ModelComparison, outer_hull, sound_power_level
from dynamics.acoustics.model_comparison import WORK
from dynamics.noise.estimated_radiation import NAME as ESTIMATE
from dynamics.noise.estimated_radiation import EstimatedRadiation
from dynamics.noise.exact_lines import EXACT, FLAT, ExactLine, line_cost
from dynamics.noise.housing_radiation import resolved_frequency
from dynamics.noise.panel_sound import models_at
from dynamics.noise.radiated_sound import LoudPoint, RadiatedSound, loudest, radiated_sound
from dynamics.noise.sounding_housing import MONOPOLES, PLANE, Radiation, SoundingHousing
from dynamics.types import FloatArray
from dynamics.vibration import BearingHarmonics
from dynamics.work_cost import Cost, on_this_host


@dataclass(frozen=True)
class ModelLevels:
    """Results of the radiation models where a housing is loudest; mappings are by name of the model."""

    order: float
    speed: float
    """Speed of the leading drive, rad/s."""
    level: Mapping[str, float]
    """Sound power level of the models that are computed, from coarse to fine, dB."""
    efficiency: Mapping[str, float]
    """Radiation efficiency by the panel models."""
    seconds: Mapping[str, float]
    """CPU time of the models that are computed."""
    omitted: Mapping[str, str]
    """Reasons why the other models are not computed."""
    error_band: Mapping[str, tuple[float, float]]
    """Bounds of the error of the level of each model, computed or not, dB: lower and upper; a negative error
    is a level that is too low.
    """
    predicted: Mapping[str, Cost]
    """Cost of each model on this host, computed or not."""
    replaced: FloatArray | None = None
    """Natural frequencies at which monopoles are invalid for the mode, Hz; None: there is no estimate."""
    lines: tuple[ExactLine, ...] | None = None
    """Lines that boundary elements correct; None: they do not correct this housing."""

    @property
    def error(self) -> dict[str, float]:
        """Return the levels less that of the finest model, dB."""
        finest = list(self.level.values())[-1]
        return {name: level - finest for name, level in self.level.items()}


def model_levels(
    response: BearingHarmonics, housing: SoundingHousing, sound: RadiatedSound, radiation: Radiation
) -> ModelLevels | None:
    """Return the results of the models at the loudest point of a housing; None for a silent one.

    A point whose waves the mesh resolves is preferred: at others only one of the models holds. Raises
    `InputError` as `models_at`.
    """
    resolved = resolved_frequency(outer_hull(housing.body), Air())
    points = [point for point in loudest(sound) if point.frequency <= resolved] or loudest(sound, 1)
    if not points:
        return None
    point, name = points[0], BoundaryElements().model_name
    at = point.speed_index, point.order_index
    panels = models_at(
        response,
        housing.body,
        housing.bearings,
        at,
        (PLANE, MONOPOLES),
        radiation.progress,
        cache=radiation.cache,
    )
    results = panels.results.items()
    estimate = _estimate(response, housing, panels, at)
    exact = _exact_lines(housing, sound, point, radiation.cache)
    corrected = housing.corrected
    return ModelLevels(
        order=point.order,
        speed=point.speed,
        level={
            **{model: result.level for model, result in results},
            **estimate.level,
            **exact.level,
        },
        efficiency={model: result.efficiency for model, result in results},
        seconds={**{model: result.cost.seconds for model, result in results}, **exact.seconds},
        omitted={**panels.omitted, **exact.omitted},
        error_band={**panels.error_band, **estimate.error_band, name: (-EXACT, EXACT)},
        predicted={**panels.predicted, **estimate.predicted, **exact.predicted},
        replaced=estimate.replaced,
        lines=None if corrected is None else corrected.lines,
    )


@dataclass(frozen=True)
class _Estimate:
    """Columns that the estimate without boundary elements adds to the models; empty without an estimate."""

    level: Mapping[str, float]
    error_band: Mapping[str, tuple[float, float]]
    predicted: Mapping[str, Cost]
    replaced: FloatArray | None


def _estimate(
    response: BearingHarmonics, housing: SoundingHousing, panels: ModelComparison, at: tuple[int, int]
) -> _Estimate:
    plain = housing.plain
    if not isinstance(plain, EstimatedRadiation):
        return _Estimate({}, {}, {}, None)
    sound = radiated_sound(response, housing.body, housing.bearings, plain, housing.name)
    band = plain.error_band(float(sound.frequency[at]), sound.mode_alone[:, at[0], at[1]])
    return _Estimate(
        {ESTIMATE: float(sound_power_level(sound.power[at]))},
        {ESTIMATE: band},
        {ESTIMATE: panels.predicted[MONOPOLES.model_name]},  # the estimate is made of monopoles
        plain.replaced(sound.natural_frequency),
    )


@dataclass(frozen=True)
class _ExactLines:
    """Columns that boundary elements add to the models.

    Where no line is near the loudest point, they hold the cost alone.
    """

    predicted: Mapping[str, Cost]
    omitted: Mapping[str, str]
    level: Mapping[str, float]
    seconds: Mapping[str, float]


def _exact_lines(
    housing: SoundingHousing, sound: RadiatedSound, point: LoudPoint, cache: Path | None
) -> _ExactLines:
    hertz, name, corrected = point.frequency, BoundaryElements().model_name, housing.corrected
    predicted = {name: on_this_host(WORK.format(name), line_cost(housing.body, hertz), cache)}
    if corrected is None:
        return _ExactLines(predicted, {}, {}, {})
    omitted = {name: "; ".join(corrected.omitted)} if corrected.omitted else {}
    # a corrected line holds at frequencies within the ratio `FLAT` of its own
    near = [line for line in corrected.lines if max(line.frequency / hertz, hertz / line.frequency) <= FLAT]
    if not near:
        return _ExactLines(predicted, omitted, {}, {})
    level = float(sound_power_level(sound.power[point.speed_index, point.order_index]))
    return _ExactLines(predicted, omitted, {name: level}, {name: near[0].seconds})
