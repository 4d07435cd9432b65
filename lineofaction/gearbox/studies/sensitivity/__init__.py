"""The inputs of a sensitivity study."""

from __future__ import annotations

from typing import Annotated, Self

from pydantic import Field, model_validator

from lineofaction.gearbox.schemas.case import Misalignment
from lineofaction.gearbox.schemas.figures import Figures, Part, Source
from lineofaction.gearbox.schemas.model import BoundaryModel, Row, refuse_unsorted

Percent = Annotated[float, Field(ge=-10.0, le=10.0)]


class Inputs(BoundaryModel):
    """Misalignments and changes of the center distance, varied one at a time; zero is always added."""

    misalignment_um: Row[Misalignment] = Field(
        default=(0.0, 15.0, 30.0, 45.0, 60.0),
        title="Misalignments, µm",
        min_length=1,
        max_length=64,
        description="Misalignments in µm, increasing",
        examples=[[0.0, 30.0]],
    )
    center_distance_change_percent: Row[Percent] = Field(
        default=(),
        title="Changes of the center distance, %",
        max_length=64,
        description="Changes of the center distance in per cent of the nominal one, increasing; default: "
        "five from -0.2 to 0.2, of a pair whose teeth jam there from -0.1 to 0.1 or to one side",
        examples=[[0.0, 0.1]],
    )

    @model_validator(mode="after")
    def _increasing(self) -> Self:
        refuse_unsorted("misalignment_um", self.misalignment_um)
        refuse_unsorted("center_distance_change_percent", self.center_distance_change_percent)
        return self


class PairFigures(Part):
    """The curves of one pair."""

    class DeviationCurves(Part):
        """Both curves with or without corner contact."""

        class Ripple(Part):
            """Peak-to-peak STE over a deviation, with its error, and its change."""

            peak_to_peak_um: list[float]
            peak_to_peak_error_um: Annotated[list[float], Source("error")]
            contact_ratio_under_load: Annotated[list[float], Source("carrying")]
            change_percent: Annotated[list[float], Source(lambda curve: 100.0 * curve.relative_change)]

        class MisalignmentRipple(Ripple):
            """Peak-to-peak over the misalignment."""

            misalignment_um: Annotated[list[float], Source("deviation")]

        class CenterDistanceRipple(Ripple):
            """Peak-to-peak over the change of the center distance."""

            center_distance_change_percent: list[float]

        corner_contact: bool
        misalignment: MisalignmentRipple
        center_distance: CenterDistanceRipple

    name: str
    normal_force_n: float
    center_distance_mm: float
    curves: list[DeviationCurves]


class SensitivityFigures(Figures):
    """The pairs of a study."""

    pairs: list[PairFigures]
