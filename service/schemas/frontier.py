"""What the accuracy ladder is run on."""

from __future__ import annotations

from typing import Annotated, Self

from pydantic import Field, Strict, model_validator

from service.schemas.case_or_scene import CaseOrScene, Name
from service.schemas.model import refuse

MOST_FULL_CONTACT = 64


class FrontierInput(CaseOrScene):
    """A case or a scene, the rungs to run, and full contact beside those of a case."""

    rungs: Annotated[tuple[Name, ...], Strict(False)] | None = Field(
        default=None,
        min_length=1,
        max_length=64,
        description="Rungs to run, by name, at least two; left out: all that are valid",
        examples=[["thin_slices", "corrected", "3d_standard"]],
    )
    full_contact: int | None = Field(
        default=None,
        ge=1,
        le=MOST_FULL_CONTACT,
        description="Positions of a case at which full finite-element contact is run beside the ladder, "
        "about 3 CPU s each in plane strain, 70 or more over the face",
        examples=[4],
    )

    @model_validator(mode="after")
    def _full_contact_is_for_cases(self) -> Self:
        """Refuse full contact of a scene."""
        if self.full_contact is not None and self.case is None:
            refuse("full_contact", self.full_contact, "left out for a scene", "Give it with a case.")
        return self
