"""Gear of the case file: toothing and flank modifications (ISO 21771 names, units in the names)."""

from __future__ import annotations

from typing import Annotated, Self

from pydantic import Field, Strict, model_validator

from fe_contact.body.parts import PARTS
from fe_contact.flank.modification import FlankModification
from service.schemas.declared import declared_in, parts_in, with_fields
from service.schemas.gear_body import GearShaftInput, MaterialInput
from service.schemas.model import BoundaryModel, refuse

GridAxis = Annotated[
    tuple[Annotated[float, Field(ge=-10_000.0, le=10_000.0)], ...],
    Strict(False),
    Field(min_length=2, max_length=500),
]
GridRow = Annotated[
    tuple[Annotated[float, Field(ge=-1000.0, le=1000.0)], ...],
    Strict(False),
    Field(min_length=2, max_length=500),
]
PitchDeviations = Annotated[
    tuple[Annotated[float, Field(ge=-1000.0, le=1000.0)], ...], Strict(False), Field(max_length=1000)
]


class FlankGridInput(BoundaryModel):
    """A free-form flank as a grid: one row of removed material per roll length."""

    roll_length_mm: GridAxis = Field(
        description="Roll lengths of the rows in mm, increasing", examples=[[4.0, 10.0, 16.0]]
    )
    face_position_mm: GridAxis = Field(
        description="Distances of the columns from mid-face in mm, increasing", examples=[[-12.5, 12.5]]
    )
    removed_um: Annotated[tuple[GridRow, ...], Strict(False)] = Field(
        min_length=2,
        max_length=500,
        description="Material removed in um, a row per roll length",
        examples=[[[0.0, 2.0], [0.0, 0.0], [5.0, 7.0]]],
    )


@with_fields({**declared_in(FlankModification), **parts_in(PARTS)})
class ToothingInput(BoundaryModel):
    """Fields of all gears. Modifications: > 0 is material removed, normal to the involute, transverse."""

    teeth: int = Field(ge=5, le=1000, description="Number of teeth", examples=[20])
    face_width_mm: float = Field(ge=1e-3, le=5000.0, description="Face width in mm", examples=[25.0])
    profile_shift_coefficient: float = Field(
        default=0.0, ge=-3.0, le=3.0, description="Profile shift in normal modules", examples=[0.2]
    )
    addendum_coefficient: float = Field(
        default=1.0,
        ge=0.1,
        le=3.0,
        description="Addendum of the basic rack in normal modules",
        examples=[1.0],
    )
    dedendum_coefficient: float = Field(
        default=1.25,
        ge=0.1,
        le=3.0,
        description="Dedendum of the basic rack in normal modules",
        examples=[1.25],
    )
    root_radius_coefficient: float = Field(
        default=0.38,
        ge=0.0,
        le=1.0,
        description="Root fillet radius of the basic rack in normal modules",
        examples=[0.38],
    )
    tip_diameter_mm: float | None = Field(
        default=None,
        gt=0.0,
        le=50_000.0,
        description="Tip diameter in mm; left out: d + 2 m_n (h_aP + x)",
        examples=[88.0],
    )
    thickness_allowance_um: float = Field(
        default=0.0,
        ge=0.0,
        le=10_000.0,
        description="Normal tooth thickness removed at the reference circle in um (backlash)",
        examples=[50.0],
    )
    flank_grid: FlankGridInput | None = Field(
        default=None,
        description="Free-form flank, removed besides the amounts above",
        examples=[
            {
                "roll_length_mm": [4.0, 20.0],
                "face_position_mm": [-12.5, 12.5],
                "removed_um": [[0.0, 0.0], [5.0, 7.0]],
            }
        ],
    )
    pitch_deviation_um: PitchDeviations = Field(
        default=(),
        description="Cumulative pitch deviation F_pi (ISO 1328-1) of the loaded flank of every tooth in um, "
        "in the order of meshing; > 0: towards the mate; left out: none",
        examples=[[0.0, 3.0, 1.0, -4.0, -2.0]],
    )
    shaft: GearShaftInput | None = Field(
        default=None,
        description="Steel shaft that bends under the tooth forces; left out: rigid",
        examples=[{"length_mm": 200.0, "diameter_mm": 40.0, "position_mm": 60.0}],
    )
    material: MaterialInput | None = Field(
        default=None,
        description="Material of this gear; left out: the case's",
        examples=[{"youngs_modulus_gpa": 210.0}],
    )

    @model_validator(mode="after")
    def _a_deviation_per_tooth(self) -> Self:
        """Refuse a list that leaves teeth out."""
        count = len(self.pitch_deviation_um)
        if count not in (0, self.teeth):
            bound = f"a list of {self.teeth} values, one per tooth"
            refuse("pitch_deviation_um", f"{count} values", bound, "In the order in which the teeth mesh.")
        return self


class GearInput(ToothingInput):
    """One external gear."""

    bore_diameter_mm: float = Field(ge=1e-3, le=20_000.0, description="Bore diameter in mm", examples=[40.0])
