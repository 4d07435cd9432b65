"""Inputs of the processes that take a case or a scene under its name."""

from __future__ import annotations

from pydantic import Field

from service.schemas.case import Case
from service.schemas.dynamic_studies import ModesInput, ResponseInput, SteadyInput
from service.schemas.flank import FlankPoint
from service.schemas.model import BoundaryModel
from service.schemas.optimisation import OptimisationInput
from service.schemas.sampling import SamplingInput
from service.schemas.scene import SceneInput
from service.schemas.sensitivity import DeviationsInput


class AnalyzeInputs(BoundaryModel):
    """Inputs of the process analyze."""

    case: Case = Field(description="The case, as in a case file")


class SimulateInputs(BoundaryModel):
    """Inputs of the process simulate."""

    scene: SceneInput = Field(description="The scene, with cases written out or databases by hash")


class ModesInputs(ModesInput):
    """Inputs of the process modes."""

    scene: SceneInput = Field(description="The scene, with cases written out or databases by hash")


class ResponseInputs(ResponseInput):
    """Inputs of the process response."""

    scene: SceneInput = Field(description="The scene, with cases written out or databases by hash")


class SteadyInputs(SteadyInput):
    """Inputs of the process steady."""

    scene: SceneInput = Field(description="The scene, with cases written out or databases by hash")


class FlankInputs(FlankPoint):
    """Inputs of the process flank."""

    case: Case = Field(description="The case, as in a case file")


class SensitivityInputs(DeviationsInput):
    """Inputs of the process sensitivity."""

    case: Case = Field(description="The case, as in a case file; its highest load counts")


class OptimiseInputs(OptimisationInput):
    """Inputs of the process optimise."""

    case: Case = Field(description="The case, as in a case file; its modifications are the start")


class ScatterInputs(SamplingInput):
    """Inputs of the process scatter."""

    case: Case = Field(description="The case, as in a case file; its modifications are the design")
