"""Bearings of a scene: rolling bearings by their rows, bushings, and bearings of planets."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise
from typing import Annotated, Any, Literal, Self

from pydantic import ConfigDict, Field, model_validator

from dynamics.bearings import BallBearing, CatalogLine, RollerBearing
from dynamics.bearings.rolling_bearing import RollingBearing
from dynamics.bearings.seat import Bushing, PlanetBearing
from lineofaction.gearbox.schemas.declared import declared_in, with_fields
from lineofaction.gearbox.schemas.model import BoundaryModel, Listed, Name, Number, SeatRows, refuse
from lineofaction.gearbox.schemas.rules import absent, all_of, both, exactly_one_of, required
from lineofaction.gearbox.units import MRAD, UM

ROWS = ("ball", "roller", "catalog")
_TILTS_OR_NOT = {
    "if": {"properties": {"direction": {"enum": ["x", "y", "z"]}}},
    "then": both(required("displacement_um", "force_n"), absent("tilt_mrad", "moment_n_m")),
    "else": both(required("tilt_mrad", "moment_n_m"), absent("displacement_um", "force_n")),
}
_Curve = Annotated[Listed[Number], Field(min_length=2, max_length=1000)]


@with_fields(declared_in(BallBearing))
class BallRowInput(BoundaryModel):
    """A row of balls in grooves: a deep groove ball bearing, or one of angular contact."""


@with_fields(declared_in(RollerBearing))
class RollerRowInput(BoundaryModel):
    """A row of rollers: a cylindrical roller bearing, or a tapered one."""


@with_fields(declared_in(CatalogLine))
class CatalogLineInput(BoundaryModel):
    """The line of a deep groove ball bearing in a catalog, from which its balls are estimated."""


@with_fields(declared_in(RollingBearing))
class RollingBearingInput(BoundaryModel):
    """One row of rolling elements between a shaft and the ground, by its geometry."""

    model_config = ConfigDict(json_schema_extra=all_of(exactly_one_of(*ROWS)))

    name: Name = Field(description="Name of the bearing", examples=["input left"])
    shaft: Name = Field(description="The shaft it carries", examples=["input"])
    position_mm: float
    ball: BallRowInput | None = Field(
        default=None,
        description="Balls and grooves of the bearing",
        examples=[{"count": 8, "diameter_mm": 11.5, "pitch_diameter_mm": 43.5}],
    )
    roller: RollerRowInput | None = Field(
        default=None,
        description="Rollers of the bearing",
        examples=[{"count": 14, "diameter_mm": 9.0, "length_mm": 13.6, "pitch_diameter_mm": 53.5}],
    )
    catalog: CatalogLineInput | None = Field(
        default=None,
        description="Line of the bearing, a deep groove ball bearing, in a catalog",
        examples=[{"bore_mm": 25.0, "outside_diameter_mm": 62.0, "static_rating_n": 11600.0}],
    )

    @model_validator(mode="after")
    def _one_row(self) -> Self:
        rows = [name for name in ROWS if getattr(self, name) is not None]
        if len(rows) != 1:
            refuse("ball", rows or None, f"given once, as one of {', '.join(ROWS)}", "Keep one of them.")
        return self


class BearingInput(BoundaryModel):
    """Springs and dampers of a bearing, and its nonlinear laws."""

    class BearingLawInput(BoundaryModel):
        """A nonlinear law of a bearing."""

        @property
        def renamed(self) -> dict[str, Any]:
            """Fields of the law, in SI, that are called otherwise here."""
            return {}

    class RollingContactInput(BearingLawInput):
        """The radial force of a rolling bearing with clearance."""

        stiffness_n_per_m_n: float = Field(
            gt=0.0,
            le=1e20,
            description="Factor k of the force k (r - clearance)^exponent of the whole bearing, N and m",
            examples=[5e8],
        )
        exponent: float = Field(
            default=10.0 / 9.0,
            ge=1.0,
            le=3.0,
            description="Exponent of that force: 10/9 for rollers, 1.5 for balls",
            examples=[1.5],
        )
        radial_clearance_um: float = Field(
            default=0.0,
            ge=0.0,
            le=1e4,
            description="Radial displacement from the middle to contact in µm",
            examples=[20.0],
        )
        damping_n_s_per_m: float | None = Field(
            default=None,
            ge=0.0,
            le=1e12,
            description="Damping in full contact in N s/m; left out: from damping_ratio",
            examples=[500.0],
        )
        damping_ratio: float = Field(
            default=0.05, ge=0.0, le=10.0, description="Damping ratio in full contact", examples=[0.05]
        )

        @property
        def renamed(self) -> dict[str, Any]:
            """The clearance."""
            return {"clearance": self.radial_clearance_um * UM}

    class SpringCurveInput(BearingLawInput):
        """A bearing's force by displacement in one direction."""

        model_config = ConfigDict(json_schema_extra=all_of(_TILTS_OR_NOT))

        direction: Literal["x", "y", "z", "tilt_x", "tilt_y"] = Field(
            description="Direction of displacement and force", examples=["x"]
        )
        displacement_um: _Curve | None = Field(
            default=None,
            description="Displacements in µm, increasing; for x, y, z",
            examples=[[-40.0, 0.0, 40.0]],
        )
        force_n: _Curve | None = Field(
            default=None,
            description="Forces in N at these displacements, increasing",
            examples=[[-6000.0, 0.0, 6000.0]],
        )
        tilt_mrad: _Curve | None = Field(
            default=None,
            description="Tilts in mrad, increasing; for tilt_x, tilt_y",
            examples=[[-1.0, 0.0, 1.0]],
        )
        moment_n_m: _Curve | None = Field(
            default=None,
            description="Moments in N m at these tilts, increasing",
            examples=[[-50.0, 0.0, 50.0]],
        )

        @model_validator(mode="after")
        def _of_its_direction(self) -> Self:
            """Displacement and force, or tilt and moment, as many of each."""
            tilts = self.direction.startswith("tilt")
            pair = ("tilt_mrad", "moment_n_m") if tilts else ("displacement_um", "force_n")
            for field in ("displacement_um", "force_n", "tilt_mrad", "moment_n_m"):
                value = getattr(self, field)
                if (value is None) == (field in pair):
                    bound = "given" if field in pair else "left out"
                    refuse(field, value, f'{bound} for direction "{self.direction}"')
            first, second = (getattr(self, field) for field in pair)
            if len(first) != len(second):
                refuse(pair[1], list(second), f"a list of {len(first)}, one for each of {pair[0]}")
            for field, values in zip(pair, (first, second), strict=True):
                if any(b <= a for a, b in pairwise(values)):
                    refuse(field, list(values), "strictly increasing")
            return self

        @property
        def renamed(self) -> dict[str, Any]:
            """Tilts and moments."""
            if self.tilt_mrad is None:
                return {}
            return {"displacement": tuple(tilt * MRAD for tilt in self.tilt_mrad), "force": self.moment_n_m}

    name: Name = Field(description="Name of the bushing", examples=["input left"])
    shaft: Name = Field(description="The shaft it carries", examples=["input"])
    stiffness_matrix: SeatRows | None = Field(
        default=None,
        description="Added stiffness: 5 by 5 in x, y, z, tilt_x, tilt_y, or 6 by 6 with 0 for the rotation; "
        "N, m, rad",
    )
    damping_matrix: SeatRows | None = Field(
        default=None,
        description="Added damping, likewise; N, m, rad, s; left out: proportional to the stiffness, from "
        "damping_ratio",
    )
    rolling_contact: RollingContactInput | None = Field(
        default=None,
        description="Radial force of a rolling bearing with clearance, beside the linear stiffness",
        examples=[{"stiffness_n_per_m_n": 5e8, "radial_clearance_um": 20.0}],
    )
    spring_curves: Listed[SpringCurveInput] = Field(
        default=(),
        max_length=5,
        description="Forces by displacement, one per direction, beside the linear ones",
    )

    @model_validator(mode="after")
    def _holds(self) -> Self:
        others = (self.stiffness_matrix, self.rolling_contact, self.spring_curves or None)
        if "radial_stiffness_n_per_m" not in self.model_fields_set and all(part is None for part in others):
            bound = "given, or stiffness_matrix, rolling_contact or spring_curves instead"
            refuse("radial_stiffness_n_per_m", None, bound, "For example 1e8.")
        directions = [curve.direction for curve in self.spring_curves]
        for index, direction in enumerate(directions):
            if direction in directions[:index]:
                refuse(f"spring_curves[{index}].direction", direction, "a direction that no other curve has")
        return self

    @property
    def laws(self) -> Mapping[str, Mapping[str, BearingLawInput]]:
        """The nonlinear laws of the bearing, by kind and by field."""
        contact = {} if self.rolling_contact is None else {"rolling_contact": self.rolling_contact}
        curves = {f"spring_curves[{index}]": curve for index, curve in enumerate(self.spring_curves)}
        return {"rolling_contacts": contact, "spring_curves": curves}


@with_fields(declared_in(Bushing))
class BushingInput(BearingInput):
    """A linear bearing between a shaft and the ground."""

    position_mm: float
    preload_force_n: Listed[Number] | None = Field(
        default=None,
        min_length=3,
        max_length=3,
        description="Force x, y, z in N on the shaft at zero displacement",
        examples=[[0.0, 0.0, 500.0]],
    )
    preload_moment_n_m: Listed[Number] | None = Field(
        default=None,
        min_length=2,
        max_length=2,
        description="Moment about x, y in N m on the shaft at zero displacement",
        examples=[[0.0, 0.0]],
    )


@with_fields(declared_in(PlanetBearing))
class PlanetBearingInput(BearingInput):
    """A linear bearing between a planet and its pin in the carrier."""

    shaft: Name = Field(description="The planet's shaft", examples=["planet"])
    carrier: Name = Field(description="The carrier's shaft", examples=["carrier"])
