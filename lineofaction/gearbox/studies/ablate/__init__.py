"""The change by every effect of a case or a scene: each toggled by itself."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field

from lineofaction.gearbox.schemas.figures import Figures, Json, Part, Source
from lineofaction.gearbox.schemas.model import BoundaryModel, Name, Row
from lineofaction.gearbox.units import in_um


class Inputs(BoundaryModel):
    """The effects to toggle."""

    only: Row[Name] | None = Field(
        default=None,
        min_length=1,
        max_length=64,
        description="Effects to toggle, by name; default: all",
        examples=[["tooth_coupling", "profile_modification"]],
    )


class Toggled(Part):
    """Figures of a case (by load) or of a scene (by mesh), with or without an effect."""

    mean_um: list[float]
    peak_to_peak_um: list[float]
    cpu_seconds: float
    harmonics_um: list[list[float]] | None = None
    predicted_cpu_seconds: float | None = None
    orders_um: list[list[float]] | None = None
    bearing_orders_n: list[list[float]] | None = None


class Level(Part):
    """Change of the level of the scene's quantity at the order that changes most."""

    quantity: str
    unit: str
    order: float
    decibels: float
    relative: float


def _estimate(estimate: Any) -> Json | None:
    """Return a library's estimate of an effect, its lengths in um."""
    return None if estimate is None else dict(in_um(estimate.to_json()))


class AblateFigures(Figures):
    """Influence of all effects: for a case at its loads, for a scene at its meshes and bearings."""

    class EffectFigures(Part):
        """An effect toggled: the figures with and without it, and the changes without it."""

        name: str
        on: bool
        reason: str
        with_effect: Toggled = Field(alias="with")
        without_effect: Toggled = Field(alias="without")
        estimate: Annotated[Json | None, Source("estimate", document=True, turned=_estimate)]
        level: Level | None = None
        level_change: Level | None = None
        mean_change_um: list[float]
        peak_to_peak_change_um: list[float]
        harmonic_change_um: list[list[float]] | None = None
        order_change_um: list[list[float]] | None = None
        bearing_order_change_n: list[list[float]] | None = None
        cost_ratio: float
        relative_mean_change: list[float] | None = None
        relative_peak_to_peak_change: list[float] | None = None

    of: Annotated[
        Literal["case", "scene"], Source(lambda study: "scene" if hasattr(study, "mesh") else "case")
    ]
    nominal: Toggled
    effects: list[EffectFigures]
    left_out: Annotated[dict[str, str], Source("omitted")]
    torque_n_m: list[float] | None = None
    normal_force_n: list[float] | None = None
    misalignment_um: float | None = None
    mesh: list[str] | None = None
    bearing: list[str] | None = None
