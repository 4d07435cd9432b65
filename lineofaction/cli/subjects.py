"""Cases and scenes of files with their warnings, and the predicted cost of work on them."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from bounds.types import Json
from host.directories import cache_home
from lineofaction.cli.cached_tables import CachedTables
from lineofaction.cli.verb_warnings import in_lines, warn
from lineofaction.gearbox.convert.case import case_at
from lineofaction.gearbox.convert.checked_case import CheckedCase
from lineofaction.gearbox.convert.plan import costs_of
from lineofaction.gearbox.convert.plausibility import case_warnings
from lineofaction.gearbox.input_file import InputFile
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.project import inputs_in, usual_speeds
from lineofaction.gearbox.schemas import Case, read_model, validated
from lineofaction.gearbox.schemas.fault_lines import located
from lineofaction.gearbox.schemas.flank_point import FlankPoint
from lineofaction.gearbox.schemas.model import BoundaryModel
from lineofaction.gearbox.schemas.plan import left_out_warnings
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.schemas.studied import OverSpeeds
from lineofaction.gearbox.studies.cost import StudyCost, Work, panels_work
from lineofaction.gearbox.studies.run_cost import run_cost
from lineofaction.gearbox.studies.scene_before_tables import CASES
from lineofaction.gearbox.study import Study
from lineofaction.gearbox.subjects import scene_of, with_inline_cases
from model_studies.progress import ANNOUNCED

_READING, _PLAYED, _BY_EAR = 0.5, 0.06, 2.9
"""CPU seconds of reading a run, of a second of sound, and of a second of sound at a microphone, with the
figures of hearing."""


def assessed_case(file: InputFile, point: FlankPoint | None = None) -> CheckedCase:
    """Return the case in a file, at one load and alignment if requested; warn of what is implausible.

    Raises `BadInput`: the file holds no case, or no such pair exists.
    """
    case = read_model(Case, file)
    if point is not None:
        case = case_at(case, point)
    checked = CheckedCase(case)
    with located(file):
        warn(case_warnings(checked))
    return checked


def assessed_scene(file: Path | InputFile) -> tuple[SceneInput, Path]:
    """Return the scene in a file and the folder its files are relative to; warn of what its import left out.

    Raises `BadInput`: the file holds no scene.
    """
    scene, folder = scene_of(file)
    warn(left_out_warnings(scene.left_out))
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


def study_cost(
    study: Study, subject: CheckedCase | SceneInput, folder: Path, inputs: Any
) -> StudyCost | None:
    """Return the predicted cost of a study, without the tables of a scene; None: not predicted."""
    written = with_inline_cases(subject, folder) if isinstance(subject, SceneInput) else subject
    return study.run.predicted(written, inputs, cache_home() / "compliance")


def table_cost(case: Case) -> StudyCost:
    """Return the predicted cost of the table of a case, in all passes that are expected."""
    passes = costs_of(CASES.of(case), cache_home() / "compliance")
    seconds = sum(cost.cpu_seconds for cost in passes)
    return StudyCost((Work("tables", seconds),), max(cost.memory_bytes for cost in passes))


def tables_cost(scene: SceneInput, folder: Path) -> StudyCost:
    """Return the predicted cost of the tables of a scene that are not kept."""
    written = (mesh.case for mesh in with_inline_cases(scene, folder).meshes if isinstance(mesh.case, Case))
    cases = {case.model_dump_json(): case for case in written}
    return sum(
        (table_cost(case) for case in cases.values() if not CachedTables.file(case).is_file()), StudyCost(())
    )


def simulation_cost(scene: SceneInput, folder: Path) -> StudyCost | None:
    """Return the predicted cost of a run, without the tables of its scene; None: not predicted."""
    return run_cost(with_inline_cases(scene, folder))


def listening_cost(seconds: float, *, housings: int = 0) -> StudyCost:
    """Return the predicted cost of a run of so many seconds as a sound: through so many housings by ear."""
    rate = _BY_EAR if housings else _PLAYED
    sound = Work("runs", _READING), Work("seconds of sound", rate, seconds)
    return StudyCost((panels_work(housings), *sound) if housings else sound)


def announce_cost(verb: str, costs: Sequence[StudyCost | None]) -> None:
    """Say on standard error what a verb will take, if that is more than a moment and can be predicted."""
    total = sum(filter(None, costs), StudyCost(()))
    if None not in costs and total.seconds > ANNOUNCED:
        sys.stderr.write(in_lines(f"loa {verb}: {total.text}", sys.stderr) + "\n")
