"""The bodies of a scene except its shafts, and their joints: gears, discs, couplings, planets."""

from __future__ import annotations

from typing import Annotated, Self

from pydantic import ConfigDict, Field, Strict, model_validator

from dynamics.bearings.seat import PlanetBearing
from dynamics.joints.coupling import Coupling
from dynamics.shafts.bodies import Inertia
from dynamics.shafts.rigid_bodies import DiscBody, GearBody
from lineofaction.gearbox.schemas.declared import declared_in, figures, with_fields
from lineofaction.gearbox.schemas.model import BoundaryModel, Coordinate, CouplingRows, Listed, Name, refuse
from lineofaction.gearbox.schemas.rules import all_of, exactly_one_of

_PIN = next(figure for figure in figures(PlanetBearing) if figure.name == "radial_error")
PinErrors = Annotated[tuple[Annotated[float, *_PIN.limits], ...], Strict(False)]
LENGTHS_AGREE = 1e-6  # relative difference within which lengths are equal


@with_fields(declared_in(Inertia, required=True))
class InertiaInput(BoundaryModel):
    """Inertia of a body of revolution about its own center of mass."""


@with_fields(declared_in(GearBody))
class GearBodyInput(BoundaryModel):
    """A gear on a shaft; its teeth, base radius, helix and face width come from the mesh it takes part in."""

    name: Name = Field(description="Name of the gear", examples=["pinion"])
    shaft: Name = Field(description="The shaft that carries it", examples=["input"])
    bore_diameter_mm: float = Field(
        default=0.0,
        ge=0.0,
        le=1e5,
        description="Bore in mm of the steel cylinder from which the inertia follows",
        examples=[40.0],
    )
    inertia: InertiaInput | None = Field(
        default=None,
        description="Inertia; left out: a steel cylinder of pitch diameter and face width",
        examples=[{"mass_kg": 0.7, "polar_kg_m2": 7e-4, "transverse_kg_m2": 4e-4}],
    )


@with_fields(declared_in(Coupling))
class CouplingInput(BoundaryModel):
    """A flexible coupling between two shafts of the same speed."""

    name: Name = Field(description="Name of the coupling", examples=["joint"])
    first: Name = Field(description="One shaft", examples=["output"])
    second: Name = Field(description="The other shaft", examples=["machine"])
    stiffness_matrix: CouplingRows | None = Field(
        default=None, description="Added stiffness: 6 by 6 in x, y, z, tilt_x, tilt_y, rotation; N, m, rad"
    )
    damping_matrix: CouplingRows | None = Field(
        default=None, description="Added damping, likewise; N, m, rad, s"
    )


class PlanetsInput(BoundaryModel):
    """Several planets from one, whose shaft, gears, bearings and meshes are in the scene."""

    planet: Name = Field(description="The shaft of the first planet", examples=["planet"])
    number: int = Field(ge=1, le=100, description="Number of planets in all", examples=[3])
    angles_deg: Listed[Coordinate] | None = Field(
        default=None,
        description="Angles from the first planet about +z in degrees; left out: equally spaced",
        examples=[[0.0, 120.0, 240.0]],
    )
    radial_errors_um: PinErrors | None = Field(
        default=None, description="Position errors of all pins outwards in µm", examples=[[0.0, 0.0, 0.0]]
    )
    tangential_errors_um: PinErrors | None = Field(
        default=None, description="Position errors of all pins about +z in µm", examples=[[20.0, 0.0, 0.0]]
    )

    @model_validator(mode="after")
    def _lists_by_planet(self) -> Self:
        for field in ("angles_deg", "radial_errors_um", "tangential_errors_um"):
            values = getattr(self, field)
            if values is not None and len(values) != self.number:
                bound = f"a list of {self.number}, one for each planet"
                refuse(field, list(values), bound, "Or leave it out.")
        return self


@with_fields(declared_in(DiscBody))
class DiscInput(BoundaryModel):
    """A flywheel, coupling half or rotor on a shaft."""

    class SteelCylinderInput(BoundaryModel):
        """A steel cylinder from which an inertia follows."""

        outer_diameter_mm: float = Field(gt=0.0, le=1e5, description="Outer diameter in mm", examples=[300.0])
        width_mm: float = Field(gt=0.0, le=1e6, description="Width along the axis in mm", examples=[40.0])
        bore_diameter_mm: float = Field(
            default=0.0, ge=0.0, le=1e5, description="Bore in mm", examples=[40.0]
        )

    model_config = ConfigDict(json_schema_extra=all_of(exactly_one_of("inertia", "cylinder")))

    name: Name = Field(description="Name of the disc", examples=["flywheel"])
    shaft: Name = Field(description="The shaft that carries it", examples=["input"])
    inertia: InertiaInput | None = Field(
        default=None,
        description="Inertia about its center of mass",
        examples=[{"mass_kg": 22.0, "polar_kg_m2": 0.25, "transverse_kg_m2": 0.13}],
    )
    cylinder: SteelCylinderInput | None = Field(
        default=None,
        description="A steel cylinder instead of the inertia",
        examples=[{"outer_diameter_mm": 300.0, "width_mm": 40.0}],
    )

    @model_validator(mode="after")
    def _one_inertia(self) -> Self:
        if (self.inertia is None) == (self.cylinder is None):
            refuse("inertia", self.inertia, "given, or cylinder instead, but not both", "Keep one of them.")
        return self
