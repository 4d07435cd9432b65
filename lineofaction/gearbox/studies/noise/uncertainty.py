"""Bands of the levels of a scene, and what 1 dB costs where."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from pathlib import Path

from bounds.types import Json
from dynamics.acoustics import Range
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
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.schemas.studied import RANGES, NoiseRanges
from lineofaction.gearbox.studies.computation import Means
from lineofaction.gearbox.studies.figures import figures_of
from lineofaction.gearbox.studies.noise import Inputs, SensitivityFigures, SoundBandFigures
from lineofaction.gearbox.studies.study.scenes import VariedScene, places_of

GEARS = ("pinion", "wheel")
AMOUNTS = ("tip_relief_um", "profile_crowning_um", "helix_crowning_um")
STEP = 2.0
"""um; a tolerance of class 5 is about as much."""


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
    facts: Json = {"band": None, "sensitivities": [], "sensitivities_left_out": {}}
    began = cpu_seconds()
    with boundary_errors():
        if inputs.band:
            band = _band_of(model, sound.speed, inputs.orders, inputs, means)
            stated = [
                about["error_band"][inputs.radiation] for about in sound.facts["models"].values() if about
            ]
            below, above = (
                max((sign * of[end] for of in stated), default=0.0) for end, sign in ((1, 1.0), (0, -1.0))
            )
            band = band.with_error("radiation_model", below, above)
            facts["band"] = figures_of(SoundBandFigures, band)
        if inputs.sensitivities:
            rows, left_out = _sensitivities_of(subject, model, sound.speed, inputs.orders, means)
            facts["sensitivities"] = [figures_of(SensitivityFigures, row) for row in rows]
            facts["sensitivities_left_out"] = left_out
    if inputs.band or inputs.sensitivities:
        facts["seconds"] = {**sound.facts["seconds"], "uncertainty": cpu_seconds() - began}
    return facts


def _band_of(
    model: SoundModel, speed: FloatArray, orders: int, ranges: NoiseRanges, means: Means
) -> SoundBand:
    """Return the bands over the ranges."""
    factors = {name: getattr(ranges, name) for name in RANGES}
    spans = {name: Range(low, 1.0, high) for name, (low, high) in factors.items()}
    return sound_band(model, speed, orders, spans, progress=means.report)


def _sensitivities_of(
    subject: TabledScene, model: SoundModel, speed: FloatArray, orders: int, means: Means
) -> tuple[tuple[Sensitivity, ...], dict[str, str]]:
    """Return what steps of damping, stiffness and flanks change, and why others have no result."""

    def scenes(flank: DesignFigure) -> Callable[[float], Scene]:
        varied = _flank_scenes(subject, flank.name, means.home)
        return lambda value: varied.scene({flank.name: value})

    flanks = _flank_figures(subject.inputs)
    return sound_sensitivities(model, speed, orders, flanks, scenes, means.report)


def _flank_figures(scene: SceneInput) -> Iterator[DesignFigure]:
    """Yield the figures of all meshes with a case; tip relief only where it has a length."""
    for mesh in scene.meshes:
        for gear in GEARS if mesh.case is not None else ():
            assert mesh.case is not None
            flank = getattr(mesh.case.pair, gear)
            for amount in AMOUNTS:
                if amount != "tip_relief_um" or flank.tip_relief_length_mm > 0.0:
                    path = f"meshes.{mesh.name}.case.pair.{gear}.{amount}"
                    yield DesignFigure(path, "um", float(getattr(flank, amount)), STEP)


def _flank_scenes(subject: TabledScene, path: str, home: Path) -> VariedScene:
    """Return the scene by a figure of its flanks: its table is solved again on the same compliance."""
    places = {path: places_of(subject.inputs, "sensitivities", path)}
    return VariedScene(subject.inputs.model_dump_json(), subject.databases, places, str(home))
