"""Inputs of a sweep: one or two variables of a case, and the figures that are shown over them."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from lineofaction.gearbox.schemas.figures import Figures, Json, Part, Source
from lineofaction.gearbox.schemas.model import BoundaryModel, Row

Axis = Annotated[str, Field(min_length=1, max_length=90)]
Quantity = Literal[
    "peak_to_peak", "harmonic_1", "harmonic_2", "harmonic_3", "max_pressure", "face_load_factor"
]
"""Copy of the names in `fe_contact.microgeometry.sweep.SWEPT`. Importing that module takes longer than a
service takes to start."""


class Inputs(BoundaryModel):
    """Axes of a sweep, and the figures that are shown over them."""

    over: Row[Axis] = Field(
        default=("torque", "tip_relief"),
        title="Over",
        min_length=1,
        max_length=2,
        description="One or two of torque, misalignment, center_distance_change and the flank modifications: "
        "NAME, or NAME=FIRST:LAST:STEP in the unit of the case file; without a gear a modification is that "
        "of both",
        examples=[["torque", "pinion.profile_crowning=0:10:2"]],
    )
    show: Row[Quantity] = Field(
        default=(
            "peak_to_peak",
            "harmonic_1",
            "harmonic_2",
            "harmonic_3",
            "max_pressure",
            "face_load_factor",
        ),
        min_length=1,
        max_length=6,
        description="Figures that are drawn, the first in the table of the terminal too: peak_to_peak, "
        "harmonic_1, harmonic_2, harmonic_3, max_pressure, face_load_factor (K_Hbeta; not in "
        "the plane)",
        examples=[["peak_to_peak", "max_pressure"]],
    )


class SweepFigures(Figures):
    """Points of the map: each has the paths of the axes and the figures with their errors."""

    class AxisFigures(Part):
        """One axis of the map."""

        path: str
        unit: str
        values: list[float]

    over: list[AxisFigures]
    held: dict[str, float]
    shown: list[str]
    points: list[dict[str, float]]
    least: dict[str, dict[str, float]]
    """Point at which a figure is least, and the number of points as low within the errors, by figure."""
    failed: list[dict[str, float | str]]
    cost: Annotated[Json, Source("sweep.cost")]
