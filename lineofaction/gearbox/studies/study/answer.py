"""Figures of a study of scenes."""

from __future__ import annotations

from typing import Any

from lineofaction.gearbox.schemas.figures import Figures, Json, Part


class FactorFigures(Part):
    """What was varied, and how."""

    path: str
    kind: str


class QuantileFigures(Part):
    """A quantile by combination of grid and list, with its confidence bounds; None: not known."""

    fraction: float
    value: list[float | None]
    low: list[float | None]
    high: list[float | None]


class ResponseFigures(Part):
    """Statistics of a response by combination of grid and list, in its unit."""

    name: str
    unit: str
    mean: list[float | None]
    standard_error: list[float | None]
    confidence: float
    quantiles: list[QuantileFigures]
    spread_of_level_means: dict[str, float | None]
    rank_correlation: dict[str, float | None]


class PointResponse(Part):
    """A response at a point with its stated error."""

    value: float | None
    unit: str
    error: float | None


class PointFigures(Part):
    """A point: the values of the factors and its responses."""

    point: int
    values: dict[str, float]
    responses: dict[str, PointResponse]


class FailedPoint(Part):
    """A point without responses."""

    point: int
    values: dict[str, float]
    reason: str


class StudyFigures(Figures):
    """Factors, statistics of all responses, worst and failed points.

    Attributes
    ----------
    runs : dict
        Content hashes of the runs that are kept in full, by point.
    """

    points: int
    usable: int
    samples: int
    factors: list[FactorFigures]
    responses: list[ResponseFigures]
    worst: list[PointFigures]
    failed: list[FailedPoint]
    cpu_seconds: dict[str, float | None]
    seed: int
    start: Any
    receipt: str
    neglected: Any
    design: Json
    runs: dict[str, str]


ANSWER = StudyFigures
