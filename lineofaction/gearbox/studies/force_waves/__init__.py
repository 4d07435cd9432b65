"""Inputs and figures of the study of the force waves of an electric machine."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from lineofaction.gearbox.schemas.figures import Equilibrium, Figures, Ledger, Part, ReductionCosts, Seconds
from lineofaction.gearbox.schemas.model import BoundaryModel, Name

MAX_CHARACTERS = 4_000_000
"""Most characters of a table."""
Size = Annotated[float, Field(gt=0.0, le=10_000.0)]
EXAMPLE = (
    "temporal_order,spatial_order,speed_rpm,torque_n_m,radial_pressure_kpa,radial_phase_deg,"
    "tangential_pressure_kpa,tangential_phase_deg\n"
    "20,2,300,1,30,0,4,90\n"
    "48,0,300,1,12,0,2,90\n"
    "48,1,300,1,1,0,0.2,90\n"
)


class Inputs(BoundaryModel):
    """Table and size of a machine, and the speed and torque at which its force waves are looked for."""

    force_wave_table: str = Field(
        min_length=1,
        max_length=MAX_CHARACTERS,
        description="Table of force waves as the text of a CSV file: temporal and spatial order, speed, "
        "torque, amplitude and phase of radial and tangential pressure, units in the names of the columns",
        examples=[EXAMPLE],
    )
    bore_radius_mm: Size = Field(description="Radius of the bore in mm", examples=[80.0])
    active_length_mm: Size = Field(description="Active length in mm", examples=[150.0])
    speed_rpm: float = Field(ge=0.0, le=1e7, description="Speed of the rotor in rpm", examples=[300.0])
    torque_n_m: float = Field(
        ge=-1e9, le=1e9, description="Torque of the machine in N m, as the table counts it", examples=[1.0]
    )
    shaft: Name | None = Field(
        default=None, description="Shaft of the rotor; left out: the first driven shaft", examples=["input"]
    )
    harmonics: int = Field(
        default=10, ge=1, le=100, description="Harmonics of the meshes that are compared", examples=[10]
    )
    tolerance_percent: float = Field(
        default=2.0,
        ge=0.0,
        le=50.0,
        description="Distance in % up to which a mesh order falls together with a temporal order",
        examples=[2.0],
    )


class ForceWavesFigures(Figures):
    """Waves with their pressures, torque and pull by temporal order, mesh orders that fall together."""

    class WaveFigures(Part):
        """A wave: amplitudes and phases of its pressures on the rotor."""

        name: str
        temporal_order: int
        spatial_order: int
        frequency_hz: float
        radial_pressure_mpa: float
        radial_phase_deg: float
        tangential_pressure_mpa: float
        tangential_phase_deg: float

    class OrderFigures(Part):
        """Torque and pull on the rotor of a temporal order: amplitude and largest force over a period."""

        temporal_order: int
        frequency_hz: float
        torque_n_m: float
        pull_n: float

    class MeshOrder(Part):
        """A harmonic of a mesh beside a temporal order, both per revolution of the rotor."""

        temporal_order: int
        mesh: str
        harmonic: int
        mesh_order: float
        mesh_frequency_hz: float
        distance_percent: float

    shaft: str
    speed_rpm: float
    torque_n_m: float
    waves: list[WaveFigures]
    largest: str
    orders: list[OrderFigures]
    mesh_orders: list[MeshOrder]
    error: str
    equilibrium: Equilibrium | None
    cpu_seconds: Seconds
    reduction_cost: ReductionCosts
    effect_ledger: Ledger | None
