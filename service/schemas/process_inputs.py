"""Inputs of the processes that take a case or a scene under its name."""

from __future__ import annotations

from pydantic import Field, create_model

from service.registry import Study
from service.schemas.case import Case
from service.schemas.case_or_scene import CaseOrScene
from service.schemas.flank import FlankPoint
from service.schemas.model import BoundaryModel
from service.schemas.scene import SceneInput
from service.schemas.sensitivity import DeviationsInput


class AnalyzeInputs(BoundaryModel):
    """Inputs of the process analyze."""

    case: Case = Field(description="The case, as in a case file")


class SimulateInputs(BoundaryModel):
    """Inputs of the process simulate."""

    scene: SceneInput = Field(description="The scene, with cases written out or databases by hash")


class FlankInputs(FlankPoint):
    """Inputs of the process flank."""

    case: Case = Field(description="The case, as in a case file")


class SensitivityInputs(DeviationsInput):
    """Inputs of the process sensitivity."""

    case: Case = Field(description="The case, as in a case file; its highest load counts")


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
    return create_model(f"{study.name.capitalize()}Inputs", __base__=bases, __doc__=text)
