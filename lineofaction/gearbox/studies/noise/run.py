"""Sound power of the housings of a scene."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

from dynamics.acoustics import (
    Air,
    BoundaryElements,
    ElementalRadiators,
    EquivalentRadiatedPower,
    PanelModel,
    RadiationModel,
    outer_hull,
)
from dynamics.housing_modes import ReducedHousing, write_surface
from dynamics.noise import (
    HousingRadiation,
    RadiatedSound,
    kept_radiation,
    loudest,
    models_at,
    radiated_sound,
    together,
)
from dynamics.noise.housing_radiation import resolved_frequency
from dynamics.vibration import BearingHarmonics
from host import cpu_seconds
from lineofaction.gearbox.convert.case import boundary_errors
from lineofaction.gearbox.convert.housings import FOLDER
from lineofaction.gearbox.convert.scene import TabledScene
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.studies.bearing_forces import forces_of
from lineofaction.gearbox.studies.computation import Computation, Means
from lineofaction.gearbox.studies.housing_costs import reduction_costs
from lineofaction.gearbox.studies.listen.through_housing import require_surface, silent
from lineofaction.gearbox.studies.noise import Inputs
from lineofaction.gearbox.studies.noise.figures import facts
from lineofaction.gearbox.studies.noise.over_time import over_time, over_time_json, run_frequencies
from lineofaction.gearbox.studies.noise.radiating_regions import SoundingHousing, with_regions
from lineofaction.gearbox.studies.noise.uncertainty import uncertainty
from lineofaction.gearbox.studies.result_file import array_file

Json = dict[str, Any]
PLANE, MONOPOLES = EquivalentRadiatedPower(), ElementalRadiators()
MODELS: dict[str, PanelModel] = {model.model_name: model for model in (PLANE, MONOPOLES)}


def noise_of(subject: TabledScene, inputs: Inputs, means: Means) -> RadiatedSound:
    """Return the sound power of the housings of a scene that have a surface.

    Raises
    ------
    BadInput
        No housing has a surface.
    """
    if means.run is not None:  # the band varies the linear response, and a run is what it is
        inputs = inputs.model_copy(update={"band": False})
    response = forces_of(subject.scene, inputs, means)
    with boundary_errors():
        began = cpu_seconds()
        housings = [
            SoundingHousing(part.name, body, part.bushings, _radiation(response, body, inputs, means))
            for part in subject.scene.housings
            if (body := subject.housings.get(part.name)) is not None and body.surface is not None
        ]
        if not housings:
            raise silent([part.name for part in subject.inputs.housings])
        sounds = [_sound(response, housing) for housing in housings]
        compared = {
            housing.name: _compared(response, housing, sound, inputs, means)
            for housing, sound in zip(housings, sounds, strict=True)
        }
        whole = with_regions(together(sounds), response, housings, MODELS[inputs.radiation])
        radiation = {housing.name: housing.radiation for housing in housings}
        heard = None if means.run is None else over_time(subject, means.run, radiation)
    about = response.facts
    seconds = {**about["seconds"], "sound": cpu_seconds() - began}
    own = {name: about.get(name) for name in ("leading_shaft", "equilibrium", "effect_ledger", "forces")}
    own["over_time"] = over_time_json(heard)
    own["reduction_cost"] = reduction_costs(subject)
    known = {**whole.facts, **own, "models": compared, "seconds": seconds}
    whole = replace(whole, facts=known)
    return replace(whole, facts={**known, **uncertainty(subject, whole, radiation, inputs, means)})


def _radiation(
    response: BearingHarmonics, body: ReducedHousing, inputs: Inputs, means: Means
) -> HousingRadiation:
    """Return the radiation resistance of one housing."""
    model, cache = MODELS[inputs.radiation], means.home / FOLDER
    hertz = response.frequency if means.run is None else run_frequencies(means.run, response.frequency)
    return kept_radiation(body, model, hertz, cache=cache, progress=means.report)


def _sound(response: BearingHarmonics, housing: SoundingHousing) -> RadiatedSound:
    """Return the sound of one housing."""
    return radiated_sound(response, housing.body, housing.bearings, housing.radiation, housing.name)


def _compared(
    response: BearingHarmonics, housing: SoundingHousing, sound: RadiatedSound, inputs: Inputs, means: Means
) -> Json:
    """Return what the radiation models say where a housing is loudest, nothing if it is silent.

    Error and cost are those of all models, computed or not. Points that the mesh resolves come first: the
    others are beyond all models but one.
    """
    resolved = resolved_frequency(outer_hull(housing.body), Air())
    points = [point for point in loudest(sound) if point.frequency <= resolved] or loudest(sound, 1)
    if not points:
        return {}
    ladder_of = (PLANE, MONOPOLES, BoundaryElements(progress=means.report))
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
    return {
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


def check(subject: SceneInput, inputs: Inputs) -> None:
    """Refuse a scene without a housing that has a surface, and sensitivities of a run."""
    if inputs.run is not None and inputs.sensitivities:
        advice = "They vary the linear response: leave out the run."
        raise BadInput.of("sensitivities", True, "left out with a run", advice)
    require_surface(subject)


def write_panels(sound: RadiatedSound, _scene: Any, file: Path) -> None:
    """Write power and intensity of the panels at the loudest point for ParaView."""
    panels = sound.panels
    if panels is None:
        raise BadInput.of("output", str(file), "another ending than .vtu", "Nothing radiates.")
    fields = {"intensity": panels.intensity, "power": panels.power}
    write_surface(file, panels.hull.nodes, panels.hull.triangles, {}, fields)


RUN = Computation(
    noise_of,
    facts,
    array_file(RadiatedSound),
    check=check,
    writers={".vtu": write_panels},
)
