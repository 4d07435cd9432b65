"""Sound of runs through the housings of a scene: a recording, and its loudness and other ratings of sound."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from bounds.brief import brief
from bounds.types import Json
from dynamics.acoustics import Recording, SoundFigures, sound_figures
from dynamics.acoustics.sound_quality import is_steady
from dynamics.housings import ReducedHousing, scene_housing
from dynamics.housings.reduced_housing import SurfaceHousing
from dynamics.noise import scene_pressure, velocity_recording
from dynamics.orders import driving_speed
from dynamics.results import RunResult
from dynamics.results.other_housings import other_housings
from dynamics.types import FloatArray
from lineofaction.gearbox.convert.boundary_errors import boundary_errors
from lineofaction.gearbox.convert.housings import FOLDER, HousedScene
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.studies.computation import Computation, Means, record_file
from lineofaction.gearbox.studies.housings import no_surface, require_surface
from lineofaction.gearbox.studies.listen import ONE_RECEIVER, REMEDY, Inputs, ListenFigures
from lineofaction.gearbox.units import MM
from model_studies.result_record import ResultRecord

PRINCIPAL = "principal"
"""Name of the direction of the largest motion of a point."""
DIRECTIONS = ("x", "y", "z", PRINCIPAL)
"""Directions along which the velocity of a point is recorded."""
KIND, SCHEMA = "recording", "lineofaction recording"
"""Kind of the result, and attribute of its files."""
NO_LOUDNESS = "loudness is that of a sound pressure alone"
"""Remark on a recording of a velocity, which has no figures of sound."""
FREE_FIELD = (
    "free field: no room, floor or attached parts; the air is at rest and does not act back. Each mode has "
    "the level of the estimate in the mean over all directions, mostly within 1.5 dB, and the directions of "
    "monopoles, which neither scatter nor shadow: at one place it may be off by more"
)
"""Remark on the model of a sound pressure."""
POINTS = 200
"""Number of points of the curve of speed in a result, equally spaced over the run."""


@dataclass(frozen=True)
class SceneHousings:
    """The reduced housings of a scene by name, the bearings in the order of their seats, and the means."""

    housings: Mapping[str, ReducedHousing]
    bearings: Mapping[str, tuple[str, ...]]
    means: Means

    @classmethod
    def of(cls, subject: HousedScene, means: Means) -> SceneHousings:
        """Return the housings of a scene."""
        return cls(subject.housings, {part.name: part.bushings for part in subject.inputs.housings}, means)

    def pressure(self, run: RunResult, microphone_mm: tuple[float, ...]) -> Recording:
        """Return the sound pressure at a microphone in the scene's frame, the sum over the housings.

        Raises `BadInput`: the microphone is not in the air, the run has no forces on bearings of a housing,
        or no housing has a surface.
        """
        surfaces = [
            SurfaceHousing(name, body, self.bearings[name])
            for name, body in self.housings.items()
            if body.surface is not None
        ]
        if not surfaces:
            raise no_surface(list(self.bearings))
        position, cache = np.array(microphone_mm) * MM, self.means.home / FOLDER
        with boundary_errors():
            return scene_pressure(surfaces, run, position, cache, self.means.report)

    def velocity(self, run: RunResult, point: str, direction: str = "") -> Recording:
        """Return the velocity of a named point along one of `DIRECTIONS`, by default the principal one.

        Raises `BadInput`: no housing or several have such a point, or there is no such direction.
        """
        owners = [
            name
            for name, body in self.housings.items()
            for body_point in body.points
            if body_point.name == point
        ]
        _require_point(
            point, [body_point.name for body in self.housings.values() for body_point in body.points]
        )
        if direction and direction not in DIRECTIONS:
            raise BadInput.of("direction", direction, f"one of {', '.join(DIRECTIONS)}")
        axis = None if direction in ("", PRINCIPAL) else np.eye(3)[DIRECTIONS.index(direction)]
        with boundary_errors():
            return velocity_recording(
                self.housings[owners[0]], run, point, axis, bearings=self.bearings[owners[0]]
            )


def _require_point(point: str, names: Sequence[str]) -> None:
    """Refuse a point that is not one of the names, or several; raises `BadInput`."""
    if names.count(point) != 1:
        bound = f"the name of one point; known: {', '.join(names) or 'none'}"
        raise BadInput.of("point", point, bound, "Name points in the housing's table of the scene.")


@dataclass(frozen=True)
class Receiver:
    """Place where a run is heard: a microphone (mm) in the frame of the scene, or a point of a housing.

    `direction` is one of `DIRECTIONS`; empty: the direction of the largest motion of the point.
    """

    microphone_mm: tuple[float, ...] = ()
    point: str = ""
    direction: str = ""

    def in_scene(self, scene: SceneInput) -> Receiver:
        """Return the receiver; one without microphone and point gets the microphone of the scene's complaint.

        Raises `BadInput`: the scene has no complaint with a microphone.
        """
        if self.point or self.microphone_mm:
            return self
        if scene.complaint is None or scene.complaint.microphone_mm is None:
            bound = f"{ONE_RECEIVER}; the scene has no complaint with a microphone"
            raise BadInput.of("microphone_mm", None, bound, REMEDY)
        return replace(self, microphone_mm=tuple(scene.complaint.microphone_mm))


@brief
@dataclass(frozen=True)
class HeardRun(ResultRecord):
    """A run through the housings of a scene."""

    run: str
    """Name of the run, or its content hash."""
    recording: Recording
    figures: SoundFigures | None
    """Figures of a sound pressure; None for a motion."""
    other_housings: tuple[str, ...]
    """Names of housings that the scene of the run did not have, or had with other data."""
    time: FloatArray
    speed: FloatArray
    """`time`, `speed`: Times, s, and speed of the driving gear of the first mesh, rad/s. Shape (n,) each."""

    @property
    def remarks(self) -> tuple[str, ...]:
        """The remarks on effects that the recording leaves out."""
        remark_on_sound = NO_LOUDNESS if self.figures is None else FREE_FIELD
        return (remark_on_sound, *(warning["message"] for warning in self.warnings))

    @property
    def remark(self) -> str:
        """The remarks as one text."""
        return "; ".join(self.remarks)

    @property
    def warnings(self) -> list[Json]:
        """A warning for each of `other_housings`: the forces of the run lack the effect of its motion."""
        difference = "as the scene has it; its forces lack what that does"
        messages = (
            f'run {self.run}: it did not move in housing "{name}" {difference}'
            for name in self.other_housings
        )
        return [{"check": "other_housing", "message": message} for message in messages]


def received_run(name: str, run: RunResult, housings: SceneHousings, receiver: Receiver) -> HeardRun:
    """Return a run as a receiver hears it.

    Raises `BadInput` as `SceneHousings.pressure` and `velocity`.
    """
    time = np.linspace(float(run.time[0]), float(run.time[-1]), POINTS)
    speed = np.interp(time, run.time, driving_speed(run))
    if receiver.point:
        recording, figures = housings.velocity(run, receiver.point, receiver.direction), None
    else:
        recording = housings.pressure(run, receiver.microphone_mm)
        figures = sound_figures(recording, steady=is_steady(driving_speed(run)))
    scene_housings = [scene_housing(body, part) for part, body in housings.housings.items()]
    return HeardRun(name, recording, figures, other_housings(scene_housings, run), time - time[0], speed)


def recording_metadata(recording: Recording) -> Json:
    """Return quantity, unit, RMS, duration and sample rate of a recording; the RMS is in its unit."""
    return {
        "quantity": recording.quantity,
        "unit": recording.unit,
        "rms": recording.rms,
        "duration_s": recording.samples.size / recording.sample_rate,
        "sample_rate_hz": recording.sample_rate,
    }


def _receiver(inputs: Inputs) -> Receiver:
    return Receiver(tuple(inputs.microphone_mm or ()), inputs.point or "", inputs.direction or "")


class _ListenStudy(Computation[SceneInput, HousedScene, Inputs, ListenFigures, HeardRun]):
    inputs, answer, file = Inputs, ListenFigures, record_file((KIND, HeardRun))
    tables = False  # the run has its forces, so the study needs no STE tables

    def check(self, scene: SceneInput, inputs: Inputs) -> None:
        """Refuse a microphone where nothing radiates, and a point that no housing has."""
        if inputs.point is None:
            _receiver(inputs).in_scene(scene)
            require_surface(scene)
        else:
            _require_point(inputs.point, [point.name for part in scene.housings for point in part.points])

    def compute(self, subject: HousedScene, inputs: Inputs, means: Means) -> HeardRun:
        assert means.run is not None  # the inputs name it
        receiver = _receiver(inputs).in_scene(subject.inputs)
        received = received_run(inputs.run, means.run, SceneHousings.of(subject, means), receiver)
        means.report("sound", 1.0)
        return received

    def _derived(self, received: HeardRun) -> Json:
        return {"full_scale": received.recording.peak, **recording_metadata(received.recording)}

    def warnings(self, received: HeardRun) -> list[Json]:
        return received.warnings


RUN = _ListenStudy()
