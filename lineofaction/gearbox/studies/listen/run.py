"""A run through the housings of a scene: sound pressure at a microphone, or velocity of a point."""

from __future__ import annotations

from typing import Any

from lineofaction.gearbox.convert.housings import HousedScene
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.studies.computation import Computation, Means
from lineofaction.gearbox.studies.listen import Inputs
from lineofaction.gearbox.studies.listen.heard_run import (
    HeardRun,
    Receiver,
    heard_run,
    recording_facts,
    sound_facts,
)
from lineofaction.gearbox.studies.listen.through_housing import SceneHousings, require_point, require_surface
from lineofaction.gearbox.studies.result_file import record_file

Json = dict[str, Any]


def _listen_to(subject: HousedScene, inputs: Inputs, means: Means) -> HeardRun:
    """Return the run as it is heard.

    Raises
    ------
    BadInput
        The microphone is not in the air, or the run has no forces on the bearings of a housing.
    """
    assert means.run is not None  # the inputs name it
    receiver = Receiver(inputs.microphone_mm or (), inputs.point or "", inputs.direction or "")
    heard = heard_run(inputs.run, means.run, SceneHousings.of(subject), receiver)
    means.report("sound", 1.0)
    return heard


def check(scene: SceneInput, inputs: Inputs) -> None:
    """Refuse a microphone where nothing radiates, and a point that no housing has."""
    if inputs.point is None:
        require_surface(scene)
    else:
        require_point(inputs.point, [point.name for part in scene.housings for point in part.points])


def facts(heard: HeardRun) -> Json:
    """Return the figures, as the verb prints them for each of its files."""
    return {
        "run": heard.run,
        "full_scale": heard.recording.peak,
        "remark": heard.remark,
        **recording_facts(heard.recording),
        "sound": sound_facts(heard).get("sound"),
        "other_housings": list(heard.other_housings),
    }


RUN = Computation(
    _listen_to,
    facts,
    record_file(("recording", HeardRun)),
    tables=False,
    check=check,
    warnings=lambda heard: heard.warnings,
)
