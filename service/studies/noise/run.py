"""Sound power of the housings of a scene."""

from __future__ import annotations

import time
from dataclasses import replace
from typing import Any

from dynamics.acoustics import BoundaryElements, ElementalRadiators, EquivalentRadiatedPower, RadiationModel
from dynamics.housing_modes import ReducedHousing
from dynamics.linearize import ForcedResponse
from dynamics.noise import (
    HousingRadiation,
    RadiatedSound,
    kept_radiation,
    loudest,
    models_at,
    radiated_sound,
    together,
)
from service.convert.case import boundary_errors
from service.convert.scene import TabledScene
from service.problems import BadInput
from service.schemas.scene import SceneInput
from service.studies.computation import Computation, Means
from service.studies.noise import Inputs
from service.studies.noise.figures import facts
from service.studies.noise.uncertainty import uncertainty
from service.studies.response.run import response_of
from service.studies.result_file import array_file

Json = dict[str, Any]
PLANE, MONOPOLES = EquivalentRadiatedPower(), ElementalRadiators()
MODELS: dict[str, RadiationModel] = {model.model_name: model for model in (PLANE, MONOPOLES)}
ADVICE = (
    "Give a housing by step_file, mesh_file or modes_file: matrices alone do not say what the air touches."
)


def noise_of(subject: TabledScene, inputs: Inputs, means: Means) -> RadiatedSound:
    """Return the sound power of the housings of a scene that have a surface.

    Raises
    ------
    BadInput
        No housing has a surface.
    """
    with boundary_errors():
        response = response_of(subject.scene, inputs, means)
        sounds, compared, radiation = [], {}, {}
        began = time.process_time()
        for part in subject.scene.housings:
            body = subject.housings.get(part.name)
            if body is not None and body.surface is not None:
                radiation[part.name] = _radiation(response, body, inputs, means)
                sound = radiated_sound(response, body, part.bushings, radiation[part.name], part.name)
                compared[part.name] = _compared(response, body, part.bushings, sound, inputs)
                sounds.append(sound)
    if not sounds:
        raise _silent(subject.inputs)
    whole = together(sounds)
    about = response.facts
    seconds = {**about["seconds"], "sound": time.process_time() - began}
    own = {name: about[name] for name in ("leading_shaft", "equilibrium", "effect_ledger")}
    known = {**whole.facts, **own, "models": compared, "seconds": seconds}
    whole = replace(whole, facts=known)
    return replace(whole, facts={**known, **uncertainty(subject, whole, radiation, inputs, means)})


def _radiation(
    response: ForcedResponse, body: ReducedHousing, inputs: Inputs, means: Means
) -> HousingRadiation:
    """Return the radiation resistance of one housing."""
    model, cache = MODELS[inputs.radiation], means.home / "housings"
    return kept_radiation(body, model, response.frequency, cache=cache, progress=means.report)


def _compared(
    response: ForcedResponse,
    body: ReducedHousing,
    bearings: tuple[str, ...],
    sound: RadiatedSound,
    inputs: Inputs,
) -> Json:
    """Return what the radiation models say where a housing is loudest; nothing if it is silent."""
    points = loudest(sound, 1)
    if not points:
        return {}
    finest = (BoundaryElements(),) if inputs.boundary_elements else ()
    models: tuple[RadiationModel, ...] = (PLANE, MONOPOLES, *finest)
    at = points[0].speed_index, points[0].order_index
    ladder = models_at(response, body, bearings, at, models)
    return {
        "order": points[0].order,
        "speed": points[0].speed,
        "level": {name: result.level for name, result in ladder.results.items()},
        "error": ladder.errors,
        "efficiency": {name: result.efficiency for name, result in ladder.results.items()},
        "seconds": {name: result.cpu_seconds for name, result in ladder.results.items()},
        "left_out": dict(ladder.left_out),
    }


def check(subject: SceneInput, _inputs: Inputs) -> None:
    """Refuse a scene without a housing that has a surface."""
    if not any(part.is_solid or part.modes_file is not None for part in subject.housings):
        raise _silent(subject)


def _silent(scene: SceneInput) -> BadInput:
    """Return the error of a scene whose housings have no surface."""
    names = [part.name for part in scene.housings]
    return BadInput.of("housings", names, "at least one with a surface", ADVICE)


RUN = Computation(
    noise_of,
    facts,
    array_file(RadiatedSound),
    check=check,
    of_scene=lambda tabled: tabled,
)
