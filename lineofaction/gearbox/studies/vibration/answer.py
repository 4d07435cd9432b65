"""Figures of a housing's vibration."""

from __future__ import annotations

from lineofaction.gearbox.schemas.bearing_forces import BearingForces
from lineofaction.gearbox.schemas.figures import Figures, Json, Part
from lineofaction.gearbox.schemas.housing_costs import HousingCost


class PointVelocity(Part):
    """Velocity of a point, root mean square, by order, then by speed; x, y, z in the scene's frame."""

    velocity_mm_per_s: list[list[float]]
    velocity_xyz_mm_per_s: list[list[list[float]]]
    overall_mm_per_s: list[float]
    level_db: list[list[float]]


class Contribution(Part):
    """What a bearing or a mode contributes to the mean square of points and outer hull; sums to 1."""

    name: str
    frequency_hz: float | None
    points: dict[str, float]
    surface: float | None


class Contributions(Part):
    """Contributions at one speed and order."""

    speed_rpm: float
    order: float
    frequency_hz: float
    bearings: list[Contribution]
    modes: list[Contribution]


class VibrationFigures(Figures):
    """Velocities by order and speed, and what makes the motion at one of them."""

    leading_shaft: str
    housing: str
    natural_frequency_hz: list[float]
    highest_valid_frequency_hz: float
    orders_beyond: list[float]
    speed_rpm: list[float]
    order: list[float]
    points: dict[str, PointVelocity]
    surface_mm_per_s: list[list[float]] | None
    contributions: Contributions
    forces: BearingForces
    cpu_seconds: dict[str, float]
    reduction_cost: dict[str, HousingCost]
    effect_ledger: Json


ANSWER = VibrationFigures
