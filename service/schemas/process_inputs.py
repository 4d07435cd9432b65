"""Inputs of the processes that take a case or a scene under its name."""

from __future__ import annotations

from pydantic import Field, create_model

from lineofaction.gearbox.registry import Study
from lineofaction.gearbox.schemas.case import Case
from lineofaction.gearbox.schemas.case_or_scene import CaseOrScene
from lineofaction.gearbox.schemas.model import BoundaryModel
from lineofaction.gearbox.schemas.scene import SceneInput
from service.schemas.ogc import class_name


class AnalyzeInputs(BoundaryModel):
    """Inputs of the process analyze."""

    case: Case = Field(description="The case, as in a case file")


class SimulateInputs(BoundaryModel):
    """Inputs of the process simulate."""

    scene: SceneInput = Field(description="The scene, with cases written out or databases by hash")


class OfCase(BoundaryModel):
    """The subject of a study: a case."""

    case: Case = Field(description="The case, as in a case file")


class OfScene(BoundaryModel):
    """The subject of a study: a scene."""

    scene: SceneInput = Field(description="The scene, with cases written out or databases by hash")


_SUBJECTS: dict[str, type[BoundaryModel]] = {
    "case": OfCase,
    "scene": OfScene,
    "case or scene": CaseOrScene,
}


def study_inputs(study: Study) -> type[BoundaryModel]:
    """Return the model of the inputs of a study's process: what is studied, and what is varied."""
    bases = (study.inputs, _SUBJECTS[study.subject])
    text = f"Inputs of the process {study.name}."
    return create_model(f"{class_name(study.name)}Inputs", __base__=bases, __doc__=text)
