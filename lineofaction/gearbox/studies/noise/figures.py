"""Figures of a radiated sound in the units of the boundary."""

from __future__ import annotations

from typing import Any

import numpy as np

from dynamics.acoustics import a_weighting, sound_power_level
from dynamics.noise import LoudPoint, RadiatedSound, loudest
from lineofaction.gearbox.studies.bearing_forces import LINEAR
from lineofaction.gearbox.studies.equilibrium import equilibrium_figures
from lineofaction.gearbox.studies.housing_costs import cost_figures, reduction_figures
from lineofaction.gearbox.units import MM, RPM

Json = dict[str, Any]


def facts(sound: RadiatedSound) -> Json:
    """Return levels (lists by order, then by speed), third octaves and the loudest points."""
    orders, about = sound.orders, sound.facts
    center, bands = orders.third_octaves()
    return {
        "leading_shaft": about["leading_shaft"],
        "speed_rpm": (sound.speed / RPM).tolist(),
        "order": sound.order.tolist(),
        "frequency_hz": orders.frequency.tolist(),
        "level_db": orders.level.tolist(),
        "level_db_a": orders.weighted_level.tolist(),
        "total_level_db": orders.total_level.tolist(),
        "total_level_db_a": orders.total_weighted_level.tolist(),
        "third_octave_hz": center.tolist(),
        "third_octave_db": sound_power_level(bands).tolist(),
        "radiation_efficiency": sound.efficiency.T.tolist(),
        "bearings": {name: _bearing(sound, index) for index, name in enumerate(sound.bearing)},
        "loudest": [
            _point(point, regions) for point, regions in zip(loudest(sound), about["regions"], strict=True)
        ],
        "housings": {name: _housing(about, name) for name in sound.housing},
        "natural_frequency_hz": sound.natural_frequency.tolist(),
        "parting_rpm": (sound.speed[~sound.in_contact] / RPM).tolist(),
        "equilibrium": None if about["equilibrium"] is None else equilibrium_figures(about["equilibrium"]),
        "forces": about.get("forces", LINEAR),
        "over_time": about.get("over_time"),
        "band": about["band"],
        "sensitivities": about["sensitivities"],
        "sensitivities_left_out": about["sensitivities_left_out"],
        "cpu_seconds": about["seconds"],
        "reduction_cost": reduction_figures(about),
        "effect_ledger": about["effect_ledger"],
    }


def _bearing(sound: RadiatedSound, bearing: int) -> Json:
    """Return the levels by the force of a bearing alone, and of what is left without it."""
    weighting = a_weighting(sound.frequency)
    alone, without = sound.bearing_alone[bearing], sound.without_bearing[bearing]
    return {
        "alone_db_a": (sound_power_level(np.maximum(alone, 0.0)) + weighting).T.tolist(),
        "without_db_a": (sound_power_level(without) + weighting).T.tolist(),
    }


def _housing(about: Json, name: str) -> Json:
    """Return what is known of the radiation of a housing."""
    radiation, compared = about["radiation"][name], about["models"][name]
    return {
        "radiation": radiation["model_name"],
        "outer_area_m2": radiation["area"],
        "inner_area_m2": radiation["inner_area"],
        "cap_area_m2": radiation["cap_area"],
        "panels": radiation["panels"],
        "resolved_hz": radiation["resolved_frequency"],
        "valid_hz": radiation["valid_frequency"],
        "interpolation_error_db": radiation["interpolation_error"],
        "models_db": compared.get("level", {}),
        "model_error_db": compared.get("error", {}),
        "models_left_out": compared.get("left_out", {}),
        "models_cpu_seconds": compared.get("seconds", {}),
        "models_error_band_db": compared.get("error_band", {}),
        "models_predicted": {
            model: {"cpu_seconds": cost["seconds"], "bytes": cost["bytes"]}
            for model, cost in compared.get("predicted", {}).items()
        },
        "radiation_cost": cost_figures(radiation.get("cost")),
    }


def _region(region: Json) -> Json:
    """Return a region of a housing."""
    return {
        "housing": region["housing"],
        "facing": region["facing"],
        "points": region["points"],
        "normal": region["normal"],
        "center_mm": [value / MM for value in region["center"]],
        "area_m2": region["area"],
        "power_w": region["power"],
        "share": region["share"],
    }


def _point(point: LoudPoint, regions: list[Json]) -> Json:
    """Return a loudest point."""
    return {
        "order": point.order,
        "speed_rpm": point.speed / RPM,
        "frequency_hz": point.frequency,
        "level_db": point.level,
        "level_db_a": point.weighted_level,
        "radiation_efficiency": point.efficiency,
        "housing": point.mode_housing,
        "mode": point.mode,
        "natural_frequency_hz": point.natural_frequency,
        "mode_share": point.mode_share,
        "bearing": point.bearing,
        "bearing_alone_db_a": point.bearing_level,
        "without_bearing_db_a": point.level_without_bearing,
        "in_contact": point.in_contact,
        "regions": [_region(region) for region in regions],
    }
