"""Sound power of the housings of a scene."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from types import MappingProxyType

import numpy as np

from bounds.types import Json
from dynamics.acoustics import (
    Air,
    BoundaryElements,
    ElementalRadiators,
    EquivalentRadiatedPower,
    PanelModel,
    RadiationModel,
    a_weighting,
    outer_hull,
    sound_power_level,
)
from dynamics.acoustics.recording import LOWEST
from dynamics.housings import ReducedHousing, write_surface
from dynamics.noise import (
    EstimatedRadiation,
    HousingRadiation,
    PanelSound,
    RadiatedSound,
    Region,
    SoundOverTime,
    estimated_radiation,
    kept_radiation,
    loudest,
    models_at,
    panel_sound,
    radiated_sound,
    regions,
    sound_over_time,
)
from dynamics.noise.estimated_radiation import NAME as ESTIMATE
from dynamics.noise.housing_radiation import resolved_frequency
from dynamics.noise.sound_over_time import BLOCK
from dynamics.results import RunResult
from dynamics.vibration import BearingHarmonics
from lineofaction.gearbox.convert.case import boundary_errors
from lineofaction.gearbox.convert.housings import FOLDER
from lineofaction.gearbox.convert.scene import TabledScene
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.studies.computation import Means, SceneStudy, array_file
from lineofaction.gearbox.studies.figures import figures_of
from lineofaction.gearbox.studies.housings import bearing_forces, no_surface, reduction_costs, require_surface
from lineofaction.gearbox.studies.noise import Inputs, NoiseFigures, SoundOverTimeFigures
from lineofaction.gearbox.studies.noise.uncertainty import uncertainty
from model_studies.workers import spent

PLANE, MONOPOLES = EquivalentRadiatedPower(), ElementalRadiators()
MODELS: dict[str, PanelModel] = {
    ESTIMATE: MONOPOLES,
    **{model.model_name: model for model in (PLANE, MONOPOLES)},
}
"""What is computed for a radiation."""


def _write_panels(sound: RadiatedSound, _scene: SceneInput, file: Path) -> None:
    """Write power and intensity of the panels at the loudest point for ParaView."""
    panels = sound.panels
    if panels is None:
        raise BadInput.of("output", str(file), "another ending than .vtu", "Nothing radiates.")
    fields = {"intensity": panels.intensity, "power": panels.power}
    write_surface(file, panels.hull.nodes, panels.hull.triangles, {}, fields)


class _NoiseStudy(SceneStudy[Inputs, NoiseFigures, RadiatedSound]):
    inputs, answer, file = Inputs, NoiseFigures, array_file(RadiatedSound)
    writers = MappingProxyType({".vtu": _write_panels})

    def check(self, subject: SceneInput, inputs: Inputs) -> None:
        """Refuse a scene without a housing that has a surface, and sensitivities of a run."""
        if inputs.run is not None and inputs.sensitivities:
            advice = "They vary the linear response: leave out the run."
            raise BadInput.of("sensitivities", True, "left out with a run", advice)
        require_surface(subject)

    def compute(self, subject: TabledScene, inputs: Inputs, means: Means) -> RadiatedSound:
        if means.run is not None:  # the band varies the linear response, and a run is what it is
            inputs = inputs.model_copy(update={"band": False})
        response = bearing_forces(subject, inputs, means)
        with boundary_errors():
            began = spent(means.workers)
            housings = [
                _SoundingHousing(part.name, body, part.bushings, _radiation(response, body, inputs, means))
                for part in subject.scene.housings
                if (body := subject.housings.get(part.name)) is not None and body.surface is not None
            ]
            if not housings:
                raise no_surface([part.name for part in subject.inputs.housings])
            sounds = [
                radiated_sound(response, own.body, own.bearings, own.radiation, own.name) for own in housings
            ]
            compared = {
                housing.name: _compared(response, housing, sound, inputs, means)
                for housing, sound in zip(housings, sounds, strict=True)
            }
            whole = _with_regions(RadiatedSound.of_all(sounds), response, housings, MODELS[inputs.radiation])
            radiation = {housing.name: housing.radiation for housing in housings}
            heard = None if means.run is None else _over_time(subject, means.run, radiation)
        about = response.facts
        seconds = {**about["seconds"], "sound": spent(means.workers) - began}
        own = {name: about.get(name) for name in ("leading_shaft", "equilibrium", "effect_ledger", "forces")}
        own["over_time"] = heard and figures_of(
            SoundOverTimeFigures, heard, third_octave_db=sound_power_level(heard.power.T)
        )
        own["reduction_cost"] = reduction_costs(subject)
        known = {**whole.facts, **own, "models": compared, "seconds": seconds}
        whole = replace(whole, facts=known)
        return replace(whole, facts={**known, **uncertainty(subject, whole, radiation, inputs, means)})

    def _derived(self, sound: RadiatedSound) -> Json:
        about = sound.facts
        center, bands = sound.orders.third_octaves()
        points = zip(loudest(sound), about["regions"], strict=True)
        return {
            "third_octave_hz": center,
            "third_octave_db": sound_power_level(bands),
            "radiation_efficiency": sound.efficiency.T,
            "bearings": {name: _bearing(sound, index) for index, name in enumerate(sound.bearing)},
            "loudest": [(point, {"regions": regions}) for point, regions in points],
            "housings": {name: _housing(about, name) for name in sound.housing},
            "parting": sound.speed[~sound.in_contact],
        }


def _bearing(sound: RadiatedSound, bearing: int) -> Json:
    """Return the levels by the force of a bearing alone, and of what is left without it."""
    weighting = a_weighting(sound.frequency)
    alone, without = sound.bearing_alone[bearing], sound.without_bearing[bearing]
    return {
        "alone": (sound_power_level(np.maximum(alone, 0.0)) + weighting).T,
        "without": (sound_power_level(without) + weighting).T,
    }


def _housing(about: Json, name: str) -> tuple[Json, Json]:
    """Return what is known of the radiation of a housing, and of the models that were compared."""
    radiation, compared = about["radiation"][name], about["models"][name]
    return radiation, {
        "models": compared.get("level", {}),
        "model_error": compared.get("error", {}),
        "models_left_out": compared.get("left_out", {}),
        "models_cpu_seconds": compared.get("seconds", {}),
        "models_error_band": compared.get("error_band", {}),
        "models_predicted": compared.get("predicted", {}),
        "radiation_cost": radiation.get("cost"),
    }


@dataclass(frozen=True)
class _SoundingHousing:
    """A housing that radiates: its name, its reduction, the bearings in its seats, its radiation."""

    name: str
    body: ReducedHousing
    bearings: tuple[str, ...]
    radiation: HousingRadiation


def _with_regions(
    sound: RadiatedSound, response: BearingHarmonics, housings: Sequence[_SoundingHousing], model: PanelModel
) -> RadiatedSound:
    by_point: list[list[Json]] = []
    for point in loudest(sound):
        at = point.speed_index, point.order_index
        panels = [panel_sound(response, own.body, own.bearings, own.radiation, at, model) for own in housings]
        if not by_point:
            joined = PanelSound.of_all(panels)
            nodes, corners = joined.hull.nodes, joined.hull.triangles
            sound = replace(sound, panel_node=nodes, panel_corner=corners, panel_power=joined.power)
        rows = [
            _region(housing.name, region, float(sound.power[at]))
            for housing, own in zip(housings, panels, strict=True)
            for region in regions(own, housing.body.points)
        ]
        by_point.append(sorted(rows, key=lambda row: -row["power"]))
    return replace(sound, facts={**sound.facts, "regions": by_point})


def _region(housing: str, region: Region, whole: float) -> Json:
    plain = {name: np.asarray(getattr(region, name)).tolist() for name in ("normal", "center")}
    own = {"facing": region.facing, "points": list(region.points), "area": region.area, "power": region.power}
    return {"housing": housing, **own, **plain, "share": region.power / whole}


def _over_time(
    subject: TabledScene, run: RunResult, radiation: Mapping[str, HousingRadiation]
) -> SoundOverTime | None:
    """Return the sound power of all housings over a run; None where it is shorter than a block."""
    if run.time.size < BLOCK * run.sample_rate:
        return None
    sounds = [
        sound_over_time(run, subject.housings[part.name], part.bushings, radiation[part.name])
        for part in subject.scene.housings
        if part.name in radiation
    ]
    return SoundOverTime.of_all(sounds)


def _radiation(
    response: BearingHarmonics, body: ReducedHousing, inputs: Inputs, means: Means
) -> HousingRadiation:
    """Return the radiation of a housing at the orders, and at the ends of what is heard of a run."""
    hertz = response.frequency
    if means.run is not None:
        ends = [LOWEST, float(means.run.receipt["sampling"]["pass_frequency"])]
        hertz = np.append(hertz.ravel(), ends)
    model, cache = MODELS[inputs.radiation], means.home / FOLDER
    own = kept_radiation(body, model, hertz, cache=cache, progress=means.report, workers=means.workers)
    return estimated_radiation(body, own) if inputs.radiation == ESTIMATE else own


def _compared(
    response: BearingHarmonics, housing: _SoundingHousing, sound: RadiatedSound, inputs: Inputs, means: Means
) -> Json:
    """Return what the radiation models say where a housing is loudest, nothing if it is silent.

    Error and cost are those of all models, computed or not. Points that the mesh resolves come first: the
    others are beyond all models but one.
    """
    resolved = resolved_frequency(outer_hull(housing.body), Air())
    points = [point for point in loudest(sound) if point.frequency <= resolved] or loudest(sound, 1)
    if not points:
        return {}
    ladder_of = (PLANE, MONOPOLES, BoundaryElements(progress=means.report, workers=means.workers))
    models: tuple[RadiationModel, ...] = ladder_of if inputs.boundary_elements else ladder_of[:-1]
    at, cache = (points[0].speed_index, points[0].order_index), means.home / FOLDER
    ladder = models_at(
        response,
        housing.body,
        housing.bearings,
        at,
        models,
        progress=means.report,
        offered=ladder_of,
        cache=cache,
    )
    compared = {
        "order": points[0].order,
        "speed": points[0].speed,
        "level": {name: result.level for name, result in ladder.results.items()},
        "error": ladder.errors,
        "efficiency": {name: result.efficiency for name, result in ladder.results.items()},
        "seconds": {name: result.cost.seconds for name, result in ladder.results.items()},
        "left_out": dict(ladder.left_out),
        "error_band": {name: list(band) for name, band in ladder.error_band.items()},
        "predicted": {name: cost._asdict() for name, cost in ladder.predicted.items()},
    }
    return compared | _of_estimate(housing.radiation, sound, at, compared)


def _of_estimate(
    radiation: HousingRadiation, sound: RadiatedSound, at: tuple[int, int], compared: Json
) -> Json:
    """Return what is compared with the estimate as a further model, nothing where there is none."""
    if not isinstance(radiation, EstimatedRadiation):
        return {}
    hertz = float(sound.frequency[at])
    off = radiation.error_band(hertz, sound.mode_alone[:, at[0], at[1]])
    estimate = {
        "level": float(sound_power_level(sound.power[at])),
        "error_band": list(off),
        "predicted": compared["predicted"][MONOPOLES.model_name],
    }
    of_all = {key: _before_finest(compared[key], value) for key, value in estimate.items()}
    finest = list(of_all["level"].values())[-1]
    errors = {name: own - finest for name, own in of_all["level"].items()}
    return {**of_all, "error": errors, "replaced": radiation.replaced(sound.natural_frequency).tolist()}


def _before_finest(by_model: Json, value: object) -> Json:
    """Return a mapping by model with that of the estimate behind the cheap ones."""
    finest = {name: own for name, own in by_model.items() if name == "boundary_elements"}
    cheap = {name: own for name, own in by_model.items() if name not in finest}
    return {**cheap, ESTIMATE: value, **finest}


RUN = _NoiseStudy()
