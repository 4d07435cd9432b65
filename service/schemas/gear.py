"""Gear of the case file: toothing and flank modifications (ISO 21771 names, units in the names)."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, Strict, model_validator

from service.schemas.gear_body import BoreSeatInput, GearBlankInput, GearShaftInput, MaterialInput
from service.schemas.model import BoundaryModel, refuse

Relief = Annotated[float, Field(ge=0.0, le=1000.0)]
Length = Annotated[float, Field(ge=0.0, le=10_000.0)]
Shape = Literal["linear", "parabolic"]
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


EdgeLength = Annotated[float, Field(ge=0.0, le=100.0)]
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


class ToothingInput(BoundaryModel):
    """What all gears have. Modifications: > 0 is material removed, normal to the involute, transverse."""

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
    tip_relief_um: Relief = Field(
        default=0.0, description="Tip relief in um at the tip diameter", examples=[20.0]
    )
    tip_relief_length_mm: Length = Field(
        default=0.0, description="Length of the tip relief in mm along the radius", examples=[1.5]
    )
    tip_relief_shape: Shape = Field(
        default="linear", description="Tip relief over its length", examples=["linear"]
    )
    root_relief_um: Relief = Field(
        default=0.0, description="Root relief in um at the start of the involute", examples=[10.0]
    )
    root_relief_length_mm: Length = Field(
        default=0.0, description="Length of the root relief in mm along the radius", examples=[1.0]
    )
    root_relief_shape: Shape = Field(
        default="linear", description="Root relief over its length", examples=["linear"]
    )
    profile_crowning_um: float = Field(
        default=0.0,
        ge=0.0,
        le=1000.0,
        description="Profile crowning in um at both ends of the profile",
        examples=[5.0],
    )
    profile_slope_um: float = Field(
        default=0.0, ge=-1000.0, le=1000.0, description="Profile slope in um from root to tip", examples=[5.0]
    )
    helix_crowning_um: float = Field(
        default=0.0,
        ge=0.0,
        le=1000.0,
        description="Lead crowning in um at both ends of the face",
        examples=[5.0],
    )
    helix_slope_um: float = Field(
        default=0.0,
        ge=-1000.0,
        le=1000.0,
        description="Helix slope in um over the face width",
        examples=[5.0],
    )
    end_relief_um: Relief = Field(default=0.0, description="End relief in um at both faces", examples=[10.0])
    end_relief_length_mm: Length = Field(
        default=0.0, description="Length of the end relief in mm along the face", examples=[2.0]
    )
    end_relief_shape: Shape = Field(
        default="linear", description="End relief over its length", examples=["linear"]
    )
    flank_twist_um: float = Field(
        default=0.0,
        ge=-1000.0,
        le=1000.0,
        description="Twist in um at the corners of the flank; > 0 removes at the tip where z is positive",
        examples=[5.0],
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
    tip_rounding_mm: EdgeLength = Field(
        default=0.0,
        description="Radius in mm of the rounded tip edge in the transverse plane, tangent to flank and tip "
        "circle; 0 is a sharp edge",
        examples=[0.3],
    )
    tip_chamfer_mm: EdgeLength = Field(
        default=0.0,
        description="Radial height h_K in mm of the tip chamfer: d_Fa = d_a - 2 h_K",
        examples=[0.4],
    )
    tip_chamfer_angle_deg: float = Field(
        default=30.0,
        ge=5.0,
        le=85.0,
        description="Angle in deg between flank and tip chamfer in the transverse plane",
        examples=[30.0],
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
    blank: GearBlankInput | None = Field(
        default=None,
        description="Rim, web and hub; left out: a solid body",
        examples=[{"rim_thickness_mm": 12.0, "web_thickness_mm": 10.0, "hub_diameter_mm": 60.0}],
    )
    seat: BoreSeatInput | None = Field(
        default=None,
        description="Seat of the bore; left out: the whole bore is fixed",
        examples=[{"tangential_foundation_n_per_mm3": 10_000.0, "width_mm": 20.0}],
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

    @model_validator(mode="after")
    def _relief_has_length(self) -> Self:
        """Refuse a relief over no length: it would be a step."""
        for name in ("tip_relief", "root_relief", "end_relief"):
            length = f"{name}_length_mm"
            if getattr(self, f"{name}_um") > 0.0 and getattr(self, length) == 0.0:
                refuse(length, 0.0, f"above 0 when {name}_um is given", f"Give {length}, for example 1.5.")
        return self

    @model_validator(mode="after")
    def _one_tip_edge(self) -> Self:
        """Refuse a tip that is rounded and chamfered."""
        if self.tip_rounding_mm > 0.0 and self.tip_chamfer_mm > 0.0:
            advice = "The tip has a rounding or a chamfer: give one of them."
            refuse("tip_chamfer_mm", self.tip_chamfer_mm, "0 where tip_rounding_mm is given", advice)
        return self


class GearInput(ToothingInput):
    """One external gear."""

    bore_diameter_mm: float = Field(ge=1e-3, le=20_000.0, description="Bore diameter in mm", examples=[40.0])
