"""Figures of an optimization."""

from __future__ import annotations

from typing import Any

from lineofaction.gearbox.schemas.figures import Figures, Json, Part


class VariableFigures(Part):
    """What was free, between bounds in the unit of its name."""

    name: str
    bounds: tuple[float, float]


class StepFigures(Part):
    """Change of the objective by a step of a variable down and up from the optimum."""

    name: str
    values: tuple[float, float]
    change_um: tuple[float, float]


class NodeFigures(Part):
    """The nodes of the scatter and their weights."""

    names: list[str]
    deviation: list[list[float]]
    weight: list[float]


class HarrisMapFigures(Part):
    """Transmission error over position and torque, with its errors."""

    torque_n_m: list[float]
    position: list[float]
    ste_um: list[Any]
    nominal_peak_to_peak_um: list[float]
    nominal_error_um: list[float]
    expected_peak_to_peak_um: list[float]
    expected_error_um: list[float]
    peak_to_peak_um: list[Any]
    error_um: list[Any]


class DesignFigures(Part):
    """One design as analyzed in full: its values by gear and field of a case file."""

    values: dict[str, dict[str, float]]
    objective_um: float
    objective_error_um: float
    scatter_error_um: float
    violation: float
    peak_to_peak_um: list[Any]
    max_pressure_mpa: list[float]
    face_load_factor: list[float]
    edge_load_share: list[float]
    harris_map: HarrisMapFigures


class SearchFigures(Part):
    """The result of one start of the search."""

    objective_um: float
    violation: float
    evaluations: int
    explored: int
    converged: bool
    ended: str
    spread_um: float
    cpu_seconds: float


class OptimizationFigures(Figures):
    """The start and the optimum, what was free, and how the search ended."""

    outcome: str
    reason: str
    variables: list[VariableFigures]
    torque_n_m: list[float]
    misalignment_um: list[float]
    nodes: NodeFigures
    gain_um: float
    gain_error_um: float
    start: DesignFigures
    optimum: DesignFigures
    evaluations: int
    runs: list[SearchFigures]
    best_run: int
    sensitivity: list[StepFigures]
    not_tried: list[str]
    cost: Json
    asked: Json


ANSWER = OptimizationFigures
