"""Support of a ring gear, and the planets in it."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from lineofaction.gearbox.schemas.figures import Figures, Json, Part
from lineofaction.gearbox.schemas.model import BoundaryModel, Row

Stiffness = Annotated[float, Field(ge=0.0, le=1e13)]
MAX_LUGS = 120
"""Copy of the number in `dynamics.elastic_ring.ring_support`, which loads what computes."""


class Inputs(BoundaryModel):
    """Support of the ring gear of a case of planet and ring, and the planets of the stage."""

    planets: int = Field(default=3, ge=1, le=12, description="Planets at equal angles", examples=[4])
    lugs: int = Field(default=0, ge=0, le=MAX_LUGS, description="Lugs or bolts at equal angles", examples=[8])
    lug_radial_n_per_m: Stiffness = Field(
        default=0.0, description="Radial stiffness of each lug in N/m; 0: it slides", examples=[2e8]
    )
    lug_tangential_n_per_m: Stiffness = Field(
        default=0.0, description="Tangential stiffness of each lug in N/m; 0: it slides", examples=[2e8]
    )
    fit_radial_n_per_m: Stiffness = Field(
        default=0.0,
        description="Radial stiffness of spline or press fit in N/m: force of all around per expansion",
        examples=[1e10],
    )
    fit_tangential_n_per_m: Stiffness = Field(
        default=0.0,
        description="Tangential stiffness of spline or press fit in N/m: force of all around per slip",
        examples=[1e10],
    )
    pin_error_um: Row[Annotated[float, Field(ge=-1000.0, le=1000.0)]] = Field(
        default=(),
        max_length=12,
        description="Way along the line of action by which each planet is late, in µm; default: none is",
        examples=[[10.0, 0.0, 0.0, 0.0]],
    )
    way_stiffness_n_per_m: float | None = Field(
        default=None,
        gt=0.0,
        le=1e13,
        description="Stiffness of sun mesh and pin in series in N/m; default: the sun mesh is as stiff as "
        "that of the ring, and the pin is rigid",
        examples=[1.5e8],
    )
    sun_floats: bool = Field(default=True, description="The sun is free in its plane", examples=[False])


class ElasticRingFigures(Figures):
    """Deflection of the ring in the meshes, its modes, loads of the planets, side lines of the mesh order."""

    class LoadCase(Part):
        """Deflections and loads of the planets under a torque on each."""

        torque_n_m: float
        force_n: float
        table_deflection_um: float
        table_deflection_error_um: float | None
        """None: the case asks for no errors."""
        ring_deflection_um: float
        """Mean over the way from one lug to the next."""
        ring_deflection_error_um: float
        ring_ripple_um: float
        """Peak to peak over that way."""
        ring_ripple_error_um: float
        share: list[float]
        """Loads of the planets over their mean, at the angle where one is largest."""
        largest_share_error: float
        share_on_rigid_ring: list[float]

    class RingMode(Part):
        """A natural mode of the ring on its support."""

        frequency_hz: float
        frequency_error_hz: float
        waves: int
        share: float
        """Share of the kinetic energy in this number of waves."""

    class SideLine(Part):
        """A line in the force of a lug under the first mesh order, per N of mesh force."""

        order: int
        radial_n: float
        tangential_n: float

    height_mm: float
    """Rim below the teeth."""
    load_cases: list[LoadCase]
    modes: list[RingMode]
    side_lines: list[SideLine]
    series_error: float
    """Deflection that the harmonics left out change, over it."""
    left_out: list[str]
    receipt: Json
