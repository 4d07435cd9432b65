"""What the accuracy ladder is run on."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field, Strict

from service.schemas.case_or_scene import CaseOrScene, Name


class FrontierInput(CaseOrScene):
    """A case or a scene, and the rungs to run."""

    rungs: Annotated[tuple[Name, ...], Strict(False)] | None = Field(
        default=None,
        min_length=1,
        max_length=64,
        description="Rungs to run, by name, at least two; left out: all that are valid",
        examples=[["thin_slices", "corrected", "3d_standard"]],
    )
