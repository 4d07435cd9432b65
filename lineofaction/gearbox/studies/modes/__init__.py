"""Speeds at which modes are looked for."""

from __future__ import annotations

from typing import ClassVar

from pydantic import Field

from lineofaction.gearbox.schemas.figures import Equilibrium, Figures, Ledger, Part, ReductionCosts, Seconds
from lineofaction.gearbox.schemas.model import Row
from lineofaction.gearbox.schemas.studied import MAX_SPEEDS, Orders, OverSpeeds, Speed


class Inputs(OverSpeeds):
    """Speeds at which modes are computed, in addition to modes at rest."""

    at_rest: ClassVar[bool] = True
    speed_rpm: Row[Speed] = Field(
        default=(),
        max_length=MAX_SPEEDS,
        description="Speeds of the first driven shaft in rpm, increasing; default: at rest only",
        examples=[[0.0, 1500.0, 3000.0]],
    )
    orders: Orders = Field(default=10, description="Multiples of the mesh frequencies", examples=[10])
    highest_frequency_hz: float | None = Field(
        default=None,
        gt=0.0,
        le=1e7,
        description="Highest frequency for flexible shafts; default: the highest order at the highest speed",
        examples=[5000.0],
    )


class Mode(Part):
    """Shares of the strain and the kinetic energy of a mode by part; shares below 0.1 % are left out."""

    mode: int
    kind: str
    strain_energy: dict[str, float]
    kinetic_energy: dict[str, float]


class ModesFigures(Figures):
    """Natural modes at rest, modes over speed, critical speeds."""

    class LoadedMeshes(Equilibrium):
        """The loaded equilibrium with the mean force of each mesh."""

        mesh_force_n: dict[str, float]

    class NaturalMode(Mode):
        """A natural mode at rest."""

        frequency_hz: float
        damping_ratio: float

    class WhirlMode(Mode):
        """A mode over the speeds at which it oscillates; whirl > 0 is forward."""

        speed_rpm: list[float]
        frequency_hz: list[float]
        damping_ratio: list[float]
        whirl: list[float]

    class CriticalSpeed(Part):
        """A speed at which a mesh order excites a mode."""

        speed_rpm: float
        frequency_hz: float
        order: int
        mesh: str
        mode: int
        kind: str
        whirl: float
        damping_ratio: float
        residual_hz: float

    leading_shaft: str
    highest_frequency_hz: float
    equilibrium: LoadedMeshes
    at_rest: list[NaturalMode]
    speed_rpm: list[float]
    mesh_frequency_hz: dict[str, list[float]]
    modes: list[WhirlMode]
    critical_speeds: list[CriticalSpeed]
    cpu_seconds: Seconds
    reduction_cost: ReductionCosts
    effect_ledger: Ledger
