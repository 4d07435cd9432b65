"""Body of a gear in the case file: its material, rim and web, the seat of its bore, and its shaft."""

from __future__ import annotations

from pydantic import Field

from service.schemas.model import BoundaryModel


class MaterialInput(BoundaryModel):
    """Linear elastic, isotropic material."""

    youngs_modulus_gpa: float = Field(
        default=210.0,
        ge=1e-3,
        le=2000.0,
        description="Young's modulus in GPa; steel is 210",
        examples=[210.0],
    )
    poissons_ratio: float = Field(
        default=0.3, ge=0.0, le=0.499, description="Poisson's ratio; steel is 0.3", examples=[0.3]
    )


class GearShaftInput(BoundaryModel):
    """A round shaft on two bearings that carries a gear."""

    length_mm: float = Field(
        gt=0.0, le=50_000.0, description="Distance between the bearings in mm", examples=[200.0]
    )
    diameter_mm: float = Field(ge=1e-3, le=10_000.0, description="Diameter in mm", examples=[40.0])
    position_mm: float = Field(
        ge=-50_000.0,
        le=100_000.0,
        description="Mid-face of the gear in mm towards +z from the bearing of smaller z",
        examples=[60.0],
    )
    bearing_stiffness_n_per_um: float | None = Field(
        default=None,
        gt=0.0,
        le=1e9,
        description="Radial stiffness of each bearing in N/um; left out: rigid",
        examples=[400.0],
    )


class GearBlankInput(BoundaryModel):
    """Rim, web and hub of a gear; rim and hub are as wide as the face."""

    rim_thickness_mm: float = Field(
        gt=0.0,
        le=20_000.0,
        description="Rim thickness s_R in mm, from the root circle to the inside of the rim",
        examples=[12.0],
    )
    web_thickness_mm: float = Field(
        gt=0.0,
        le=5000.0,
        description="Web thickness b_s in mm; that of the face width is a solid gear",
        examples=[10.0],
    )
    hub_diameter_mm: float | None = Field(
        default=None,
        ge=1e-3,
        le=20_000.0,
        description="Outside of the hub in mm; left out: the web reaches down to the bore",
        examples=[60.0],
    )
    web_offset_mm: float = Field(
        default=0.0,
        ge=-5000.0,
        le=5000.0,
        description="Middle of the web in mm towards +z from mid-face",
        examples=[5.0],
    )


class KeyInput(BoundaryModel):
    """One parallel key: the bore slides around the shaft but for its width."""

    width_mm: float = Field(
        gt=0.0, le=5000.0, description="Width along the circumference in mm", examples=[12.0]
    )
    angle_deg: float = Field(
        default=0.0,
        ge=-180.0,
        le=180.0,
        description="Counter-clockwise from the centre line of the reference tooth at mid-face in degrees",
        examples=[180.0],
    )


class BoreSeatInput(BoundaryModel):
    """The seat of the bore on its shaft; stiffnesses are traction per displacement."""

    radial_foundation_n_per_mm3: float | None = Field(
        default=None, gt=0.0, le=1e9, description="Radial, in N/mm^3; left out: rigid", examples=[20_000.0]
    )
    tangential_foundation_n_per_mm3: float | None = Field(
        default=None,
        gt=0.0,
        le=1e9,
        description="Tangential, in N/mm^3; left out: rigid",
        examples=[10_000.0],
    )
    axial_foundation_n_per_mm3: float | None = Field(
        default=None, gt=0.0, le=1e9, description="Axial, in N/mm^3; left out: rigid", examples=[10_000.0]
    )
    width_mm: float | None = Field(
        default=None,
        gt=0.0,
        le=5000.0,
        description="Axial length of the seat in mm; left out: the face width",
        examples=[20.0],
    )
    offset_mm: float = Field(
        default=0.0,
        ge=-5000.0,
        le=5000.0,
        description="Middle of the seat in mm towards +z from mid-face",
        examples=[2.0],
    )
    key: KeyInput | None = Field(
        default=None,
        description="A key; the tangential foundation is then its own",
        examples=[{"width_mm": 12.0, "angle_deg": 0.0}],
    )
