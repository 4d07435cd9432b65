"""Speeds at which a housing's vibration is looked for, and where its parts are."""

from __future__ import annotations

from pydantic import Field

from lineofaction.gearbox.schemas.speeds import OverSpeedsOrRun


class Inputs(OverSpeedsOrRun):
    """Speeds at which a housing's vibration is looked for, and where its parts are."""

    housing: str | None = Field(
        default=None, max_length=255, description="Name of the housing; default: the first with a surface"
    )
    at_rpm: float | None = Field(
        default=None,
        gt=0.0,
        le=1e7,
        description="Speed at which contributions and deflection are shown, the nearest of those computed; "
        "default: where the motion is largest",
    )
    at_order: float | None = Field(
        default=None,
        gt=0.0,
        le=1e4,
        description="Order for which they are shown, the nearest; default: that of the largest motion",
    )
    mode: int | None = Field(
        default=None,
        ge=1,
        le=2000,
        description="Natural mode of the housing to draw in place of the operating deflection",
    )
