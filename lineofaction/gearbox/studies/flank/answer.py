"""Figures of flank results."""

from __future__ import annotations

from pydantic import Field

from lineofaction.gearbox.schemas.figures import Figures, Json


class FlankFigures(Figures):
    """Figures of the flanks over a mesh cycle, at one load and one alignment."""

    content_hash: str
    torque_n_m: float
    normal_force_n: float
    misalignment_um: float
    center_distance_change_mm: float
    positions: int
    slices: int
    k_h_beta: float
    largest_face_load_factor: float
    load_centroid_mm: tuple[float, float]
    largest_line_load_n_per_mm: float
    largest_pressure_mpa: float = Field(description="Where no strip reaches an edge of a flank")
    edge_pressure_mpa: float = Field(description="At edges as if the flank went on; the true one is singular")
    effect_ledger: list[Json] | Json
    receipt: Json


ANSWER = FlankFigures
