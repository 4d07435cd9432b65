"""Load and alignment at which the flanks are looked at."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from lineofaction.gearbox.schemas.figures import Figures, Json, Source
from lineofaction.gearbox.schemas.flank_point import FlankPoint
from lineofaction.gearbox.units import boundary_ledger


class Inputs(FlankPoint):
    """One load and one alignment; the case supplies the fields that are left out."""


class FlankFigures(Figures):
    """Figures of the flanks over a mesh cycle, at one load and one alignment."""

    content_hash: Annotated[str, Source("metadata.content_hash")]
    torque_n_m: float
    normal_force_n: Annotated[float, Source("scene.normal_force")]
    misalignment_um: float
    center_distance_change_mm: float
    positions: Annotated[int, Source("position.size")]
    slices: Annotated[int, Source("face_position.size")]
    k_h_beta: Annotated[float, Source("mean_face_load_factor")]
    k_h_beta_error: float | None = Field(default=None, description="null: not estimated, `error_reason`")
    largest_face_load_factor: float
    largest_face_load_factor_error: float | None = None
    load_centroid_mm: tuple[float, float]
    largest_line_load_n_per_mm: float = Field(description="Largest line load away from edges of a flank")
    largest_line_load_error_n_per_mm: float | None = None
    edge_line_load_n_per_mm: float | None = Field(
        default=None, description="Line load at edges, mean over `edge_length_mm`; 0: no edge is reached"
    )
    edge_line_load_error_n_per_mm: float | None = None
    edge_length_mm: Annotated[float | None, Source("edge_length")] = Field(
        default=None, description="Length along the face over which a line load at an edge is averaged"
    )
    peak_length_mm: Annotated[float | None, Source("slice_width")] = Field(
        default=None, description="Length along the face over which line load and K_Hbeta take their peak"
    )
    largest_pressure_mpa: float = Field(description="Largest pressure away from edges of a flank")
    largest_pressure_error_mpa: float | None = None
    error_reason: Annotated[str, Source("errors.reason")] = Field(
        default="", description="Reason why errors that are null are not estimated"
    )
    edge_pressure_mpa: float = Field(
        description="Pressure at edges as if the flank continued beyond them; the true pressure is singular"
    )
    effect_ledger: Annotated[
        list[Json] | Json, Source("metadata.effect_ledger", document=True, turned=boundary_ledger)
    ]
    receipt: Annotated[Json, Source("metadata.receipt")]
