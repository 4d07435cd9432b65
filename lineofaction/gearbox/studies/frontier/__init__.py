"""The accuracy study of a case or a scene: error against time."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, Strict

from lineofaction.gearbox.schemas.case_or_scene import Name
from lineofaction.gearbox.schemas.model import BoundaryModel

MOST_FULL_CONTACT = 64


class Inputs(BoundaryModel):
    """The fidelities to run, and full contact beside those of a case."""

    rungs: Annotated[tuple[Name, ...], Strict(False)] | None = Field(
        default=None,
        min_length=1,
        max_length=64,
        description="Fidelities to run, by name, at least two; default: all valid ones",
        examples=[["thin_slices", "corrected", "3d_standard"]],
    )
    up_to: Literal["corrected_fine", "3d_draft", "3d_standard", "3d_fine"] = Field(
        default="3d_fine",
        title="Up to",
        description="The most expensive fidelity of a case: the finest in two dimensions, or one in three "
        "(minutes)",
        examples=["3d_draft"],
    )
    full_contact: int | None = Field(
        default=None,
        ge=1,
        le=MOST_FULL_CONTACT,
        description="Positions of a case at which full finite-element contact is computed as well: about 3 "
        "CPU s each in plane strain, 70 or more over the face",
        examples=[4],
    )
