"""Case and scene files on the command line: read, and assessed for plausibility."""

from __future__ import annotations

from pathlib import Path

from lineofaction.cli.warned import warn
from lineofaction.gearbox.convert.case import case_at
from lineofaction.gearbox.convert.plausibility import case_warnings
from lineofaction.gearbox.input_file import InputFile
from lineofaction.gearbox.schemas import Case, read_model
from lineofaction.gearbox.schemas.flank import FlankPoint
from lineofaction.gearbox.schemas.lines import located
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.schemas.warning import left_out_warnings
from lineofaction.gearbox.subjects import scene_of


def assessed_case(file: InputFile, point: FlankPoint | None = None) -> Case:
    """Return the case in a file, at one load and alignment if requested; warn of what is implausible.

    Raises
    ------
    BadInput
        The file holds no case, or no such pair exists.
    """
    case = read_model(Case, file)
    if point is not None:
        case = case_at(case, point)
    with located(file):
        warn(case_warnings(case))
    return case


def assessed_scene(file: Path | InputFile) -> tuple[SceneInput, Path]:
    """Return the scene in a file and the folder its files are relative to; warn of what its import left out.

    Raises
    ------
    BadInput
        The file holds no scene.
    """
    scene, folder = scene_of(file)
    warn(left_out_warnings(scene.left_out))
    return scene, folder
