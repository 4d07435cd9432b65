"""A mesh in closed form: its teeth, and its stiffness and transmission error over a base pitch."""

from __future__ import annotations

from typing import Annotated, Self

from pydantic import ConfigDict, Field, Strict, model_validator

from lineofaction.gearbox.schemas.model import BoundaryModel, Listed, refuse, refuse_unsorted
from lineofaction.gearbox.schemas.rules import all_of, at_most_one_of

Value = Annotated[float, Field(ge=-1e15, le=1e15)]
Values = Listed[Value]
Phases = Annotated[tuple[Annotated[float, Field(ge=-1e6, le=1e6)], ...], Strict(False)]
Positions = Annotated[tuple[Annotated[float, Field(ge=0.0, lt=1.0)], ...], Strict(False)]
Teeth = Annotated[int, Field(ge=1, le=100_000)]


class PeriodicInput(BoundaryModel):
    """A value over a base pitch: constant, the sum of harmonics, or tabulated."""

    model_config = ConfigDict(json_schema_extra=all_of(at_most_one_of("amplitude", "position")))

    value: Values = Field(
        min_length=1,
        max_length=10_000,
        description="The constant or the mean; with position the values there",
        examples=[[4e8]],
    )
    amplitude: Values | None = Field(
        default=None,
        min_length=1,
        max_length=100,
        description="Amplitudes a of the harmonics n = 1, 2, ...: a cos(2 pi n x + phase) at the position x",
        examples=[[5e7, 1e7]],
    )
    phase_deg: Phases | None = Field(
        default=None,
        max_length=100,
        description="Phases of the harmonics; left out: 0",
        examples=[[0.0, 90.0]],
    )
    position: Positions | None = Field(
        default=None,
        min_length=2,
        max_length=10_000,
        description="Positions of the values in base pitches, from 0 to below 1, increasing; cubic pieces "
        "without overshoot join them",
        examples=[[0.0, 0.5]],
    )

    @model_validator(mode="after")
    def _as_many(self) -> Self:
        """Refuse more than one kind, and lists that do not fit each other."""
        if self.amplitude is not None and self.position is not None:
            refuse("amplitude", list(self.amplitude), "left out where position is given", "Keep one of them.")
        refuse_unsorted("position", self.position)
        count = 1 if self.position is None else len(self.position)
        if len(self.value) != count:
            refuse("value", list(self.value), f"a list of {count}", "One, or one for each of position.")
        phases = () if self.phase_deg is None else self.phase_deg
        if phases and len(phases) != len(self.amplitude or ()):
            bound = f"a list of {len(self.amplitude or ())}, one for each of amplitude"
            refuse("phase_deg", list(phases), bound)
        return self


class StiffnessMeshInput(BoundaryModel):
    """A mesh whose force in contact is k(x) (d - e(x)), x the position in base pitches."""

    teeth: Listed[Teeth] = Field(
        min_length=2, max_length=2, description="Teeth of pinion and wheel", examples=[[20, 40]]
    )
    base_radius_mm: float = Field(
        gt=0.0,
        le=1e6,
        description="Base radius of the pinion in mm; the wheel's is larger by the ratio of the teeth",
        examples=[37.588],
    )
    working_pressure_angle_deg: float = Field(
        ge=0.0,
        lt=80.0,
        description="Transverse working pressure angle in degrees; with the base radii it sets the center "
        "distance",
        examples=[20.0],
    )
    base_helix_angle_deg: float = Field(
        default=0.0,
        gt=-68.0,
        lt=68.0,
        description="Base helix angle of the pinion in degrees; above 0: right hand",
        examples=[0.0],
    )
    face_width_mm: float = Field(
        gt=0.0, le=1e6, description="Face width of both gears in mm", examples=[25.0]
    )
    internal: bool = Field(default=False, description="The wheel is a ring gear", examples=[False])
    stiffness_n_per_m: PeriodicInput = Field(
        description="Stiffness k along the transverse line of action in N/m", examples=[{"value": [4e8]}]
    )
    transmission_error_um: PeriodicInput | None = Field(
        default=None,
        description="Transmission error e without load in µm; left out: 0",
        examples=[{"value": [0.0], "amplitude": [5.0]}],
    )


class CoastFlankInput(BoundaryModel):
    """The backs of a mesh's teeth, alike to their fronts, for the effect "backlash"."""

    backlash_um: float = Field(
        ge=0.0, le=1e5, description="Backlash along the transverse line of action in µm", examples=[80.0]
    )
    tooth_thickness: float | None = Field(
        default=None,
        gt=0.0,
        lt=1.0,
        description="Thickness of the driver's teeth over the pitch, both on the operating pitch circle; "
        "left out: both gears' teeth are equally thick",
        examples=[0.49],
    )
