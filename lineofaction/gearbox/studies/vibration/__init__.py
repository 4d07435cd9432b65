"""Speeds at which a housing's vibration is looked for, and where its parts are."""

from __future__ import annotations

from pydantic import Field

from lineofaction.gearbox.schemas.figures import (
    Excitations,
    Figures,
    Forces,
    Ledger,
    Part,
    ReductionCosts,
    Seconds,
)
from lineofaction.gearbox.schemas.studied import OverSpeedsOrRun


class Inputs(OverSpeedsOrRun):
    """Speeds at which a housing's vibration is looked for, and where its parts are."""

    housing: str | None = Field(
        default=None,
        max_length=255,
        description="Name of the housing; default: the first with a surface or points, then the first "
        "that was measured",
    )
    at_rpm: float | None = Field(
        default=None,
        gt=0.0,
        le=1e7,
        description="Speed at which contributions and deflection are shown, the nearest of those computed; "
        "default: where the motion is largest",
    )
    at_order: float | None = Field(
        default=None,
        gt=0.0,
        le=1e4,
        description="Order for which they are shown, the nearest; default: that of the largest motion",
    )
    mode: int | None = Field(
        default=None,
        ge=1,
        le=2000,
        description="Natural mode of the housing to draw in place of the operating deflection",
    )


class VibrationFigures(Figures):
    """Velocities by order and speed, and contributions to the motion at one order and speed."""

    class PointVelocity(Part):
        """Velocity of a point, root mean square, by order, then by speed; x, y, z in the scene's frame.

        `left_out_mm_per_s` is the part of the overall velocity in orders of long tables that are not listed,
        `overall_error_mm_per_s` what it may be off for them. Of a measured housing x, y, z are those of its
        file; null: outside the measured band, along an axis that nobody measured, or not known.
        """

        velocity_mm_per_s: list[list[float | None]]
        velocity_xyz_mm_per_s: list[list[list[float | None]]]
        overall_mm_per_s: list[float | None]
        left_out_mm_per_s: list[float | None]
        overall_error_mm_per_s: list[float | None]
        level_db: list[list[float | None]]

    class Contributions(Part):
        """Contributions at one speed and order."""

        class Contribution(Part):
            """Share of a bearing or mode in the mean square of points and hull; the shares sum to 1."""

            name: str
            frequency_hz: float | None
            points: dict[str, float | None]
            surface: float | None

        speed_rpm: float
        order: float
        frequency_hz: float
        bearings: list[Contribution]
        modes: list[Contribution]

    class Measurement(Part):
        """A measured housing: its file, first line, axes of points, and forces that no function carries.

        `omitted_part` is their part of the sum of the squared forces, by order, then by speed.
        """

        file: str
        lowest_frequency_hz: float
        axes: dict[str, str]
        omitted_forces: list[str]
        omitted_part: list[list[float]]
        omits_moments: bool

    leading_shaft: str
    housing: str
    natural_frequency_hz: list[float]
    highest_valid_frequency_hz: float
    orders_beyond: list[float]
    speed_rpm: list[float]
    order: list[float]
    order_name: list[str]
    points: dict[str, PointVelocity]
    surface_mm_per_s: list[list[float]] | None
    contributions: Contributions
    forces: Forces
    excitations: Excitations
    cpu_seconds: Seconds
    reduction_cost: ReductionCosts
    effect_ledger: Ledger
    measured: Measurement | None = None
    left_out: list[str] = Field(default_factory=list)
