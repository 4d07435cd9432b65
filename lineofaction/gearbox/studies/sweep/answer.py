"""Figures of a sweep."""

from __future__ import annotations

from lineofaction.gearbox.schemas.figures import Figures, Json, Part


class AxisFigures(Part):
    """One axis of the map."""

    path: str
    unit: str
    values: list[float]


class SweepFigures(Figures):
    """Points of the map: each has the paths of the axes and the figures with their errors.

    Attributes
    ----------
    least : dict
        By figure: the point where it is least, and the number of points that are as low within the errors.
    """

    over: list[AxisFigures]
    held: dict[str, float]
    shown: list[str]
    points: list[dict[str, float]]
    least: dict[str, dict[str, float]]
    failed: list[dict[str, float | str]]
    cost: Json


ANSWER = SweepFigures
