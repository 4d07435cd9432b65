"""Scenes of files, assessed, and the inputs of studies."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from bounds.types import Json
from lineofaction.cli.verb_warnings import warn
from lineofaction.gearbox.convert.checked_case import CheckedCase
from lineofaction.gearbox.input_file import InputFile
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.project import inputs_in, usual_speeds
from lineofaction.gearbox.schemas import read_model, validated
from lineofaction.gearbox.schemas.model import BoundaryModel
from lineofaction.gearbox.schemas.plan import omission_warnings
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.schemas.studied import OverSpeeds
from lineofaction.gearbox.study import Study
from lineofaction.gearbox.subjects import scene_of


def assessed_scene(file: Path | InputFile) -> tuple[SceneInput, Path]:
    """Return the scene in a file and the folder of its files; warn of omissions of its import.

    Raises `BadInput`: the file holds no scene.
    """
    scene, folder = scene_of(file)
    warn(omission_warnings(scene.left_out))
    return scene, folder


def inputs_of_study(
    study: Study,
    subject: CheckedCase | SceneInput,
    project: Path | None,
    fields: Json,
    file: Path | None = None,
) -> Any:
    """Return the inputs of a study: options, or its file, named or the one in the folder.

    Speeds that a study of a scene needs and that nobody names are the usual ones. Raises `BadInput`.
    """
    if not study.takes.from_file:
        if isinstance(subject, SceneInput) and (count := _speeds_to_choose(study.inputs, fields)):
            fields = {**fields, "speed_rpm": usual_speeds(subject, project, count)}
        return validated(study.inputs, fields)
    file = file or (inputs_in(project, study) if project else None)
    if file is None and not study.takes.bare:
        raise BadInput.of("study", None, "a study file", f"For example: loa {study.name} {study.example}")
    return validated(study.inputs, {}) if file is None else read_model(study.inputs, file)


def _speeds_to_choose(inputs: type[BoundaryModel], fields: Json) -> int:
    """Return the number of speeds that inputs need if neither speeds nor a run are named; 0: none."""
    if not issubclass(inputs, OverSpeeds) or inputs.at_rest or fields.keys() & {"speed_rpm", "run"}:
        return 0
    return inputs.usual_speeds
