"""Boundary models: the case and scene files and every JSON body, strict and with units in the names.

Names are imported on first use, so that a client starts without what declares the fields of a case.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from lineofaction.gearbox.schemas.case import (
        AccuracyInput,
        Case,
        ErrorsInput,
        LoadInput,
        PairInput,
        WheelInput,
    )
    from lineofaction.gearbox.schemas.gear import GearInput, ToothingInput
    from lineofaction.gearbox.schemas.gear_body import MaterialInput
    from lineofaction.gearbox.schemas.live_answer import LiveOutput
    from lineofaction.gearbox.schemas.outline import OutlineBody
    from lineofaction.gearbox.schemas.plan import PlanBody
    from lineofaction.gearbox.schemas.query import QueryOutput
    from lineofaction.gearbox.schemas.reading import read_model, read_table, validated
    from lineofaction.gearbox.schemas.scene import SceneInput

__all__ = [
    "AccuracyInput",
    "Case",
    "ErrorsInput",
    "GearInput",
    "LiveOutput",
    "LoadInput",
    "MaterialInput",
    "OutlineBody",
    "PairInput",
    "PlanBody",
    "QueryOutput",
    "SceneInput",
    "ToothingInput",
    "WheelInput",
    "read_model",
    "read_table",
    "validated",
]

_HOME = {
    "AccuracyInput": "case",
    "Case": "case",
    "ErrorsInput": "case",
    "GearInput": "gear",
    "LiveOutput": "live_answer",
    "LoadInput": "case",
    "MaterialInput": "gear_body",
    "OutlineBody": "outline",
    "PairInput": "case",
    "PlanBody": "plan",
    "QueryOutput": "query",
    "SceneInput": "scene",
    "ToothingInput": "gear",
    "WheelInput": "case",
    "read_model": "reading",
    "read_table": "reading",
    "validated": "reading",
}


def __getattr__(name: str) -> object:
    """Import a name on first use."""
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOME[name]}"), name)
