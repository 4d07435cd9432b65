"""Sound power of the housings of a scene."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import partial
from pathlib import Path
from types import MappingProxyType

import numpy as np

from bounds.types import Json
from dynamics.acoustics import BoundaryElements, sound_power_level
from dynamics.acoustics.model_comparison import WORK
from dynamics.housings import write_surface
from dynamics.noise import RadiatedSound, Radiation, SurfaceHousing, loudest, microphone_pressure, scene_sound
from dynamics.noise.estimated_radiation import NAME as ESTIMATE
from dynamics.noise.exact_lines import BUDGET, COARSE, LINES
from dynamics.noise.sound_band import responses_of_band
from dynamics.noise.sounding_housing import PLANE
from dynamics.work_cost import on_this_host
from lineofaction.gearbox.convert.boundary_errors import boundary_errors
from lineofaction.gearbox.convert.housings import FOLDER
from lineofaction.gearbox.convert.scene import TabledScene
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.studies.computation import Means, SceneStudy, array_file
from lineofaction.gearbox.studies.cost import StudyCost, Work, panels_work
from lineofaction.gearbox.studies.excitations import order_names, scene_metadata
from lineofaction.gearbox.studies.figures import rows
from lineofaction.gearbox.studies.housings import (
    bearing_forces,
    no_surface,
    predicted_forces,
    require_surface,
)
from lineofaction.gearbox.studies.noise import Inputs, NoiseFigures
from lineofaction.gearbox.studies.noise.metadata import (
    pressure_metadata,
    sound_metadata,
    uncertainty_metadata,
)
from lineofaction.gearbox.studies.noise.uncertainty import uncertainty
from lineofaction.gearbox.units import MM
from model_studies.workers import spent

USUAL_LINE = BoundaryElements().cost(2 * COARSE.cells, 0.0, 0)
"""Cost of a line by boundary elements on the reference host: most hulls are the coarsest, two panels to a
cell.
"""


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
            remedy = "They vary the linear response: leave out the run."
            raise BadInput.of("sensitivities", True, "left out with a run", remedy)
        if inputs.microphone_mm is not None and inputs.radiation == PLANE.model_name:
            bound = f"left out with {PLANE.model_name}, which has no sound pressure"
            raise BadInput.of("microphone_mm", list(inputs.microphone_mm), bound, "Take the estimate.")
        require_surface(subject)

    def predicted(self, scene: SceneInput, inputs: Inputs, cache: Path | None) -> StudyCost | None:
        """Return the cost of the response, of the responses of its band, and of a usual radiation.

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
        began = spent(means.workers)
        with boundary_errors():
            surfaces = _surfaces(subject)
            sound = scene_sound(response, surfaces, _radiation(inputs, means), means.run)
        seconds = {**response.metadata["seconds"], "sound": spent(means.workers) - began}
        metadata = sound_metadata(sound, response.metadata, scene_metadata(subject)) | {"seconds": seconds}
        known = uncertainty(subject, sound, inputs, means)
        metadata |= uncertainty_metadata(known)
        if known.seconds is not None:
            seconds["uncertainty"] = known.seconds
        if (microphone := _microphone(subject.inputs, inputs)) is not None:
            bands = None if known.band is None else known.band.largest
            with boundary_errors():
                pressure = microphone_pressure(response, sound.housings, np.array(microphone) * MM, bands)
            metadata["pressure"] = pressure_metadata(pressure)
        return replace(sound.power, metadata=metadata)

    def _derived(self, sound: RadiatedSound) -> Json:
        metadata = sound.metadata
        center, bands = sound.orders.third_octaves()
        radiation, models, regions = (metadata[name] for name in ("radiation", "models", "regions"))
        points = zip(loudest(sound), regions, strict=True)
        return {
            "order_name": order_names(sound.order, metadata),
            "third_octave_hz": center,
            "third_octave_db": sound_power_level(bands),
            "radiation_efficiency": sound.efficiency.T,
            "bearings": rows(sound, sound.bearing),
            "loudest": [(point, {"regions": listed}) for point, listed in points],
            "housings": {name: (radiation[name], models[name], {}) for name in sound.housing},
            "parting": sound.speed[~sound.in_contact],
        }


def _usual_lines(points: int) -> int:
    """Return the usual number of lines that boundary elements correct: 1 of 4 points, 3 of 36."""
    return min(LINES, math.ceil(0.5 * math.sqrt(points)))


def _microphone(scene: SceneInput, inputs: Inputs) -> tuple[float, ...] | None:
    """Return the position of the microphone, mm; None: no microphone."""
    if inputs.microphone_mm is not None or scene.complaint is None or inputs.radiation == PLANE.model_name:
        return inputs.microphone_mm
    return scene.complaint.microphone_mm


def _surfaces(subject: TabledScene) -> list[SurfaceHousing]:
    """Return the housings with a surface, with the bearings in their seats; raises `BadInput`: none has."""
    surfaces = [
        SurfaceHousing(part.name, body, part.bushings)
        for part in subject.scene.housings
        if (body := subject.housings.get(part.name)) is not None and body.surface is not None
    ]
    if not surfaces:
        raise no_surface([part.name for part in subject.inputs.housings])
    return surfaces


def _radiation(inputs: Inputs, means: Means) -> Radiation:
    cache = means.home / FOLDER
    return Radiation(inputs.radiation, inputs.boundary_elements, cache, means.report, means.workers)


RUN = _NoiseStudy()
