"""Metadata in the file of a sound, in addition to its arrays, as plain JSON."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

import numpy as np

from bounds.types import Json
from dynamics.acoustics import sound_power_level
from dynamics.noise import HousingRegion, MicrophonePressure, ModelLevels, SceneSound, SoundOverTime
from lineofaction.gearbox.studies.figures import figures_of
from lineofaction.gearbox.studies.noise import (
    PressureFigures,
    SensitivityFigures,
    SoundBandFigures,
    SoundOverTimeFigures,
)
from lineofaction.gearbox.studies.noise.uncertainty import SoundUncertainty

RESPONSE = ("leading_shaft", "equilibrium", "effect_ledger", "forces", "lines_left_out")
"""Metadata that a sound copies from its response or run."""


def sound_metadata(sound: SceneSound, response: Json, scene: Json) -> Json:
    """Return the metadata of a sound: copies from its response and its scene, regions, models."""
    return {
        **sound.power.metadata,
        "regions": [[_region(region) for region in regions] for regions in sound.regions],
        **{name: response.get(name) for name in RESPONSE},
        "excitations": response.get("excitations", []),
        "over_time": _over_time(sound.over_time),
        **scene,
        "models": {name: _models(levels) for name, levels in sound.models.items()},
    }


def uncertainty_metadata(uncertainty: SoundUncertainty) -> Json:
    """Return bands and sensitivities of a sound; not requested, bands are None, sensitivities empty."""
    band = uncertainty.band and figures_of(
        SoundBandFigures,
        uncertainty.band,
        damping_source=uncertainty.damping.source,
        damping_range=uncertainty.damping.factors,
    )
    return {
        "band": band,
        "sensitivities": [figures_of(SensitivityFigures, row) for row in uncertainty.sensitivities],
        "sensitivities_left_out": dict(uncertainty.omitted),
    }


def pressure_metadata(pressure: MicrophonePressure) -> Json:
    """Return the sound pressure at a microphone."""
    return figures_of(PressureFigures, pressure)


def _region(region: HousingRegion) -> Json:
    panels = region.region
    return {
        "housing": region.housing,
        "facing": panels.facing,
        "points": list(panels.points),
        "area": panels.area,
        "power": panels.power,
        "normal": panels.normal.tolist(),
        "center": panels.center.tolist(),
        "share": region.share,
    }


def _over_time(sound: SoundOverTime | None) -> Json | None:
    if sound is None:
        return None
    levels = sound_power_level(sound.power.T)
    return figures_of(SoundOverTimeFigures, sound, third_octave_db=levels)


def _models(levels: ModelLevels | None) -> Json:
    """Return the models of a housing; nothing of a silent one."""
    if levels is None:
        return {}
    metadata: Json = {
        "order": levels.order,
        "speed": levels.speed,
        "level": dict(levels.level),
        "efficiency": dict(levels.efficiency),
        "seconds": dict(levels.seconds),
        "left_out": dict(levels.omitted),
        "error_band": _lists(levels.error_band),
        "predicted": {name: cost._asdict() for name, cost in levels.predicted.items()},
    }
    if levels.replaced is not None:
        metadata["replaced"] = np.asarray(levels.replaced).tolist()
    if levels.lines is not None:
        metadata["lines"] = [asdict(line) for line in levels.lines]
    return metadata | {"error": levels.error}


def _lists(bands: Mapping[str, tuple[float, float]]) -> dict[str, Any]:
    return {name: list(band) for name, band in bands.items()}
