"""Case and scene files on the command line: read, and assessed for plausibility."""

from __future__ import annotations

from pathlib import Path

from service.cli.warned import warn
from service.client.portable import scene_of
from service.convert.case import case_at
from service.convert.plausibility import case_warnings
from service.input_file import InputFile
from service.schemas import Case, read_model
from service.schemas.flank import FlankPoint
from service.schemas.lines import located
from service.schemas.scene import SceneInput
from service.schemas.warning import left_out_warnings


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
