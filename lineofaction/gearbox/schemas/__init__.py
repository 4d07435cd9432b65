"""Boundary models: the case and scene files and every JSON body, strict and with units in the names.

Names are imported on first use, so that a client starts without what declares the fields of a case.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from lineofaction.gearbox.schemas.case import Case as Case
    from lineofaction.gearbox.schemas.live_answer import LiveOutput as LiveOutput
    from lineofaction.gearbox.schemas.outline import OutlineBody as OutlineBody
    from lineofaction.gearbox.schemas.plan import PlanBody as PlanBody
    from lineofaction.gearbox.schemas.query import QueryOutput as QueryOutput
    from lineofaction.gearbox.schemas.reading import read_model as read_model
    from lineofaction.gearbox.schemas.reading import read_table as read_table
    from lineofaction.gearbox.schemas.reading import validated as validated
    from lineofaction.gearbox.schemas.scene import SceneInput as SceneInput

HOMES = {
    "Case": "case",
    "LiveOutput": "live_answer",
    "OutlineBody": "outline",
    "PlanBody": "plan",
    "QueryOutput": "query",
    "SceneInput": "scene",
    "read_model": "reading",
    "read_table": "reading",
    "validated": "reading",
}
"""The module of each name."""


def __getattr__(name: str) -> object:
    """Import a name on first use."""
    if name not in HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{HOMES[name]}"), name)
