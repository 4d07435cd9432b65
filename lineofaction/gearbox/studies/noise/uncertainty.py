"""Bands of the levels of a scene, and what 1 dB costs where."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from dynamics.acoustics import LevelBand, Range
from dynamics.noise import (
    DesignFigure,
    HousingRadiation,
    RadiatedSound,
    Sensitivity,
    SoundBand,
    SoundModel,
    sound_band,
    sound_sensitivities,
)
from dynamics.scene import Scene
from dynamics.types import FloatArray
from host import cpu_seconds
from lineofaction.gearbox.convert.case import boundary_errors
from lineofaction.gearbox.convert.scene import TabledScene
from lineofaction.gearbox.schemas.studied import RANGES, NoiseRanges
from lineofaction.gearbox.studies.computation import Means
from lineofaction.gearbox.studies.noise import Inputs
from lineofaction.gearbox.studies.noise.flank_figures import flank_figures, flank_scenes
from lineofaction.gearbox.units import RPM

Json = dict[str, Any]


def uncertainty(
    subject: TabledScene,
    sound: RadiatedSound,
    radiation: Mapping[str, HousingRadiation],
    inputs: Inputs,
    means: Means,
) -> Json:
    """Return the facts `band`, `sensitivities`, `sensitivities_left_out` and the CPU time, as requested."""
    housings = {name: subject.housings[name] for name in radiation}
    model = SoundModel(subject.scene, housings, radiation)
    told: Json = {"band": None, "sensitivities": [], "sensitivities_left_out": {}}
    began = cpu_seconds()
    with boundary_errors():
        if inputs.band:
            band = band_of(model, sound.speed, inputs.orders, inputs, means)
            missed = _between_models(sound.facts["models"])
            told["band"] = band_json(band.with_error("radiation_model", missed, missed))
        if inputs.sensitivities:
            rows, left_out = sensitivities_of(subject, model, sound.speed, inputs.orders, means)
            told["sensitivities"] = [sensitivity_json(row) for row in rows]
            told["sensitivities_left_out"] = left_out
    if inputs.band or inputs.sensitivities:
        told["seconds"] = {**sound.facts["seconds"], "uncertainty": cpu_seconds() - began}
    return told


def _between_models(compared: Mapping[str, Json]) -> float:
    """Return how far radiation models lie apart where a housing is loudest, dB, the most of all housings."""
    levels = [list(about["level"].values()) for about in compared.values() if about.get("level")]
    return max((max(of) - min(of) for of in levels), default=0.0)


def band_of(
    model: SoundModel, speed: FloatArray, orders: int, ranges: NoiseRanges, means: Means
) -> SoundBand:
    """Return the bands over the ranges."""
    factors = {name: getattr(ranges, name) for name in RANGES}
    spans = {name: Range(low, 1.0, high) for name, (low, high) in factors.items()}
    return sound_band(model, speed, orders, spans, progress=means.report)


def sensitivities_of(
    subject: TabledScene, model: SoundModel, speed: FloatArray, orders: int, means: Means
) -> tuple[tuple[Sensitivity, ...], dict[str, str]]:
    """Return what steps of damping, stiffness and flanks change, and why others have no result."""

    def scenes(flank: DesignFigure) -> Callable[[float], Scene]:
        varied = flank_scenes(subject, flank.name, means.home)
        return lambda value: varied.scene({flank.name: value})

    flanks = flank_figures(subject.inputs)
    return sound_sensitivities(model, speed, orders, flanks, scenes, means.report)


def band_json(band: SoundBand) -> Json:
    """Return bands in the units of the boundary."""
    return {
        "largest_total": _level_json(band.largest_total),
        "orders": [
            {
                "order": float(order),
                "largest": _level_json(largest),
                "speed_rpm": float(speed) / RPM,
                "there": _level_json(there),
            }
            for order, largest, speed, there in zip(
                band.order, band.largest, band.loudest_speed, band.there, strict=True
            )
        ],
        "total_low_db_a": [each.low for each in band.total],
        "total_high_db_a": [each.high for each in band.total],
    }


def _level_json(band: LevelBand) -> Json:
    return {
        "level_db_a": band.nominal,
        "low_db_a": band.low,
        "high_db_a": band.high,
        "below_db": dict(band.below),
        "above_db": dict(band.above),
    }


def sensitivity_json(row: Sensitivity) -> Json:
    """Return a sensitivity; what is without end is None."""
    return {
        "figure": row.figure.name,
        "unit": row.figure.unit,
        "value": row.figure.value,
        "step": row.figure.step,
        "change_db": row.change,
        "change_of_two_steps_db": row.change_of_two,
        "slope_db": row.slope,
        "for_one_db_less": _finite(row.for_one_db_less),
        "linear_range": _finite(row.linear_range),
        "linear": row.linear,
    }


def _finite(value: float) -> float | None:
    """Return a number, None for none."""
    return value if np.isfinite(value) else None
