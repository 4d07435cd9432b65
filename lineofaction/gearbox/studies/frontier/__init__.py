"""The accuracy study of a case or a scene: error against time."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from lineofaction.gearbox.schemas.figures import Figures, Json, Part, Source
from lineofaction.gearbox.schemas.model import BoundaryModel, Name, Row

MAX_FULL_CONTACT = 64


class Inputs(BoundaryModel):
    """The fidelities to run, and whether full contact is run too for a case."""

    rungs: Row[Name] | None = Field(
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
        le=MAX_FULL_CONTACT,
        description="Positions at which recorded full finite-element contact is compared as well, of a case "
        "whose pair has a record",
        examples=[4],
    )


class FrontierFigures(Figures):
    """Error against time; the reference is the finest fidelity, the knee where time buys least."""

    class FidelityFigures(Part):
        """One fidelity: its CPU time, and its relative errors against the finest fidelity."""

        name: str
        title: str
        cpu_seconds: float
        mean_um: list[float] | None = None
        peak_to_peak_um: list[float] | None = None
        stated_error: float | None = None
        stages: dict[str, float] | None = None
        peak_memory_bytes: int | None = None
        mean_error: float | None = None
        peak_to_peak_error: float | None = None
        family: str | None = None
        errors: Annotated[
            dict[str, float] | None,
            Source(lambda fidelity: fidelity.errors if hasattr(fidelity, "family") else None),
        ] = None

    rungs: Annotated[list[FidelityFigures], Source("results")]
    left_out: Annotated[dict[str, str], Source("omitted")]
    knee: str | None
    chosen: str | None
    solves: int | None = None
    orders: int | None = None
    blocks: int | None = None
    transmission_error_rms_um: list[list[float]] | None = None
    reference: Annotated[str, Source("reference.name")]
    full_finite_element_contact: list[Json] | None = None
    full_finite_element_contact_origin: str | None = None
    full_contact: Json | None = None
