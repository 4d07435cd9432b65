"""Sound power of the housings of a scene."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from functools import partial
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
    a_weighting,
    outer_hull,
    sound_power_level,
)
from dynamics.acoustics.model_comparison import WORK
from dynamics.acoustics.recording import LOWEST
from dynamics.housings import ReducedHousing, write_surface
from dynamics.noise import (
    CorrectedRadiation,
    EstimatedRadiation,
    HousingRadiation,
    PanelSound,
    RadiatedSound,
    Region,
    SoundOverTime,
    corrected_radiation,
    estimated_radiation,
    loudest,
    models_at,
    panel_sound,
    radiated_sound,
    regions,
    sound_over_time,
)
from dynamics.noise.estimated_radiation import LEAST
from dynamics.noise.estimated_radiation import NAME as ESTIMATE
from dynamics.noise.exact_lines import BUDGET, COARSE, EXACT, FLAT, LINES, line_cost
from dynamics.noise.housing_radiation import resolved_frequency
from dynamics.noise.sound_band import responses_of_band
from dynamics.noise.sound_over_time import BLOCK
from dynamics.results import RunResult
from dynamics.types import FloatArray
from dynamics.vibration import BearingHarmonics
from dynamics.work_cost import on_this_host
from lineofaction.gearbox.convert.case import boundary_errors
from lineofaction.gearbox.convert.housings import FOLDER
from lineofaction.gearbox.convert.scene import TabledScene
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.studies.computation import Means, SceneStudy, array_file
from lineofaction.gearbox.studies.cost import StudyCost, Work, panels_work
from lineofaction.gearbox.studies.excitations import facts_of_scene, order_names
from lineofaction.gearbox.studies.figures import figures_of
from lineofaction.gearbox.studies.housings import (
    bearing_forces,
    no_surface,
    predicted_forces,
    radiation_of,
    require_surface,
)
from lineofaction.gearbox.studies.noise import (
    Inputs,
    NoiseFigures,
    PressureFigures,
    SoundOverTimeFigures,
)
from lineofaction.gearbox.studies.noise.sound_pressure import SoundSource, pressure_at
from lineofaction.gearbox.studies.noise.uncertainty import uncertainty
from lineofaction.gearbox.units import MM
from model_studies.workers import spent

PLANE, MONOPOLES = EquivalentRadiatedPower(), ElementalRadiators()
MODELS: dict[str, PanelModel] = {
    ESTIMATE: MONOPOLES,
    **{model.model_name: model for model in (PLANE, MONOPOLES)},
}
"""What is computed for a radiation."""

USUAL_LINE = BoundaryElements().cost(2 * COARSE.cells, 0.0, 0)
"""Of boundary elements on the reference host: most hulls are the coarsest, two panels to a cell."""


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
        """Refuse a scene without a housing that has a surface, sensitivities of a run, a plane at an ear."""
        if inputs.run is not None and inputs.sensitivities:
            advice = "They vary the linear response: leave out the run."
            raise BadInput.of("sensitivities", True, "left out with a run", advice)
        if inputs.microphone_mm is not None and inputs.radiation == PLANE.model_name:
            bound = f"left out with {PLANE.model_name}, which has no sound pressure"
            raise BadInput.of("microphone_mm", list(inputs.microphone_mm), bound, "Take the estimate.")
        require_surface(subject)

    def predicted(self, scene: SceneInput, inputs: Inputs, cache: Path | None) -> StudyCost | None:
        """Return what the response, those of its band, and a usual radiation take.

        How many panels a housing has its mesh says, which is not made before: of one that is larger or finer
        than a usual gear case the panels take more. Contacts of sensitivities are not predicted.
        """
        sounding = [part for part in scene.housings if part.has_surface]
        if inputs.sensitivities or not sounding:
            return None
        mounted = any(foot.mount_stiffness_n_per_m is not None for part in sounding for foot in part.feet)
        band = partial(responses_of_band, mounted=mounted) if inputs.band else None
        cost = predicted_forces(scene, inputs, band)
        if cost is None or inputs.radiation == PLANE.model_name:
            return cost
        parts = [panels_work(len(sounding))]
        if inputs.radiation == ESTIMATE and inputs.boundary_elements:
            points = len(inputs.speed_rpm) * inputs.orders
            line = on_this_host(WORK.format(BoundaryElements().model_name), USUAL_LINE, cache).seconds
            lines = min(_usual_lines(points) * len(sounding), max(int(BUDGET / USUAL_LINE.seconds), 1))
            parts.append(Work("lines by boundary elements", line, lines))
        return cost + StudyCost(tuple(parts))

    def compute(self, tabled: TabledScene, inputs: Inputs, means: Means) -> RadiatedSound:
        subject = tabled.steady
        if means.run is not None:  # the band varies the linear response, and a run is what it is
            inputs = inputs.model_copy(update={"band": False})
        response = bearing_forces(subject, inputs, means)
        with boundary_errors():
            began = spent(means.workers)
            housings = _sounding_housings(subject, response, inputs, means)
            sounds = [
                radiated_sound(response, own.body, own.bearings, own.radiation, own.name) for own in housings
            ]
            compared = {
                housing.name: _compared(response, housing, sound, inputs, means)
                for housing, sound in zip(housings, sounds, strict=True)
            }
            whole = _with_regions(RadiatedSound.of_all(sounds), response, housings, MODELS[inputs.radiation])
            off = _joined_error(housings, sounds, compared)
            radiation = {housing.name: housing.radiation for housing in housings}
            heard = None if means.run is None else _over_time(subject, means.run, radiation)
        about = response.facts
        seconds = {**about["seconds"], "sound": spent(means.workers) - began}
        named = ("leading_shaft", "equilibrium", "effect_ledger", "forces", "lines_left_out")
        own = {name: about.get(name) for name in named}
        own["excitations"] = about.get("excitations", [])
        own["over_time"] = heard and figures_of(
            SoundOverTimeFigures, heard, third_octave_db=sound_power_level(heard.power.T)
        )
        own |= facts_of_scene(subject)
        known = {**whole.facts, **own, "models": compared, "seconds": seconds}
        whole = replace(whole, facts=known)
        known |= uncertainty(subject, whole, radiation, off, inputs, means)
        if (place := _microphone(subject.inputs, inputs)) is not None:
            sources = [SoundSource(each.body, each.bearings, each.cheap) for each in housings]
            with boundary_errors():
                heard_there = pressure_at(response, sources, np.array(place) * MM, known["band"])
            known["pressure"] = figures_of(PressureFigures, heard_there)
        return replace(whole, facts=known)

    def _derived(self, sound: RadiatedSound) -> Json:
        about = sound.facts
        center, bands = sound.orders.third_octaves()
        points = zip(loudest(sound), about["regions"], strict=True)
        return {
            "order_name": order_names(sound.order, about),
            "third_octave_hz": center,
            "third_octave_db": sound_power_level(bands),
            "radiation_efficiency": sound.efficiency.T,
            "bearings": {name: _bearing(sound, index) for index, name in enumerate(sound.bearing)},
            "loudest": [(point, {"regions": regions}) for point, regions in points],
            "housings": {name: _housing(about, name) for name in sound.housing},
            "parting": sound.speed[~sound.in_contact],
        }


def _usual_lines(points: int) -> int:
    """Return how many lines boundary elements usually correct: 1 of 4 points, 3 of 36."""
    return min(LINES, math.ceil(0.5 * math.sqrt(points)))


def _microphone(scene: SceneInput, inputs: Inputs) -> tuple[float, ...] | None:
    """Return where the sound pressure is found, mm; None: nowhere."""
    if inputs.microphone_mm is not None or scene.complaint is None or inputs.radiation == PLANE.model_name:
        return inputs.microphone_mm
    return scene.complaint.microphone_mm


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
        "exact_lines": compared.get("lines", []),
        "radiation_cost": radiation.get("cost"),
    }


@dataclass(frozen=True)
class _SoundingHousing:
    """A housing that radiates: its name, its reduction, the bearings in its seats, its radiation.

    `cheap` is the radiation without the lines that boundary elements correct.
    """

    name: str
    body: ReducedHousing
    bearings: tuple[str, ...]
    cheap: HousingRadiation
    corrected: CorrectedRadiation | None

    @property
    def radiation(self) -> HousingRadiation:
        """Return the most exact radiation."""
        return self.cheap if self.corrected is None else self.corrected.radiation


def _sounding_housings(
    subject: TabledScene, response: BearingHarmonics, inputs: Inputs, means: Means
) -> list[_SoundingHousing]:
    """Return the housings with a surface; lines that boundary elements correct are divided among them."""
    bodies = [
        (part, body)
        for part in subject.scene.housings
        if (body := subject.housings.get(part.name)) is not None and body.surface is not None
    ]
    if not bodies:
        raise no_surface([part.name for part in subject.inputs.housings])
    model = BoundaryElements(progress=means.report, workers=means.workers)
    housings = []
    for part, body in bodies:
        cheap, corrected = _radiation(response, body, inputs, means), None
        if isinstance(cheap, EstimatedRadiation) and inputs.boundary_elements:
            home, budget = means.home / FOLDER, BUDGET / len(bodies)
            corrected = corrected_radiation(response, body, part.bushings, cheap, model, home, budget)
        housings.append(_SoundingHousing(part.name, body, part.bushings, cheap, corrected))
    return housings


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
    if response.floor is not None:
        hertz = np.append(hertz.ravel(), response.floor.frequency[[0, -1]])
    if means.run is not None:
        ends = [LOWEST, float(means.run.receipt["sampling"]["pass_frequency"])]
        hertz = np.append(hertz.ravel(), ends)
    own = radiation_of(body, MODELS[inputs.radiation], hertz, means)
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
    at, cache = (points[0].speed_index, points[0].order_index), means.home / FOLDER
    ladder = models_at(
        response, housing.body, housing.bearings, at, (PLANE, MONOPOLES), means.report, cache=cache
    )
    compared: Json = {
        "order": points[0].order,
        "speed": points[0].speed,
        "level": {name: result.level for name, result in ladder.results.items()},
        "efficiency": {name: result.efficiency for name, result in ladder.results.items()},
        "seconds": {name: result.cost.seconds for name, result in ladder.results.items()},
        "left_out": dict(ladder.left_out),
        "error_band": {name: list(band) for name, band in ladder.error_band.items()},
        "predicted": {name: cost._asdict() for name, cost in ladder.predicted.items()},
    }
    _add_estimate(compared, response, housing, at)
    _add_boundary_elements(compared, housing, sound, at, cache)
    finest = list(compared["level"].values())[-1]
    return compared | {"error": {name: level - finest for name, level in compared["level"].items()}}


def _add_estimate(
    compared: Json, response: BearingHarmonics, housing: _SoundingHousing, at: tuple[int, int]
) -> None:
    """Add what the estimate is without boundary elements to the models, where there is one."""
    if not isinstance(housing.cheap, EstimatedRadiation):
        return
    sound = radiated_sound(response, housing.body, housing.bearings, housing.cheap, housing.name)
    off = housing.cheap.error_band(float(sound.frequency[at]), sound.mode_alone[:, at[0], at[1]])
    compared["level"][ESTIMATE] = float(sound_power_level(sound.power[at]))
    compared["error_band"][ESTIMATE] = list(off)
    compared["predicted"][ESTIMATE] = compared["predicted"][MONOPOLES.model_name]
    compared["replaced"] = housing.cheap.replaced(sound.natural_frequency).tolist()


def _add_boundary_elements(
    compared: Json, housing: _SoundingHousing, sound: RadiatedSound, at: tuple[int, int], cache: Path
) -> None:
    """Add the lines that boundary elements correct, their level at the point, and why there are no more."""
    hertz, name = float(sound.frequency[at]), BoundaryElements().model_name
    corrected = housing.corrected
    compared["error_band"][name] = [-EXACT, EXACT]
    cost = on_this_host(WORK.format(name), line_cost(housing.body, hertz), cache)
    compared["predicted"][name] = cost._asdict()
    if corrected is None:
        return
    compared["lines"] = [asdict(line) for line in corrected.lines]
    if corrected.left_out:
        compared["left_out"][name] = "; ".join(corrected.left_out)
    here = [line for line in corrected.lines if max(line.frequency / hertz, hertz / line.frequency) <= FLAT]
    if here:
        compared["level"][name] = float(sound_power_level(sound.power[at]))
        compared["seconds"][name] = here[0].seconds


def _joined_error(
    housings: Sequence[_SoundingHousing], sounds: Sequence[RadiatedSound], compared: Mapping[str, Json]
) -> FloatArray:
    """Return from and to where the levels of all housings together are off, (2, S, H), dB; < 0: too quiet."""
    power, true = np.zeros(sounds[0].power.shape), np.zeros((2, *sounds[0].power.shape))
    for housing, sound in zip(housings, sounds, strict=True):
        radiation, about = housing.radiation, compared[housing.name]
        if isinstance(radiation, EstimatedRadiation):
            off = radiation.off(sound.frequency, sound.mode_alone)
        else:
            stated = about.get("error_band", {}).get(radiation.model_name, (0.0, 0.0))
            off = np.broadcast_to(np.reshape(stated, (2, 1, 1)), true.shape)
        power, true = power + sound.power, true + sound.power * 10.0 ** (-off / 10.0)
    return np.asarray(-10.0 * np.log10(np.maximum(true, LEAST) / np.maximum(power, LEAST)))


RUN = _NoiseStudy()
