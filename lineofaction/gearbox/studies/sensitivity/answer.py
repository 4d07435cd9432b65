"""Figures of a sensitivity study."""

from __future__ import annotations

from lineofaction.gearbox.schemas.figures import Figures, Part


class Ripple(Part):
    """Peak-to-peak STE over a deviation, with its error, and its change."""

    peak_to_peak_um: list[float]
    peak_to_peak_error_um: list[float]
    change_percent: list[float]


class MisalignmentRipple(Ripple):
    """Over the misalignment."""

    misalignment_um: list[float]


class CenterDistanceRipple(Ripple):
    """Over the change of the center distance."""

    center_distance_change_percent: list[float]


class DeviationCurves(Part):
    """Both curves with or without corner contact."""

    corner_contact: bool
    misalignment: MisalignmentRipple
    center_distance: CenterDistanceRipple


class PairFigures(Part):
    """One pair."""

    name: str
    normal_force_n: float
    center_distance_mm: float
    curves: list[DeviationCurves]


class SensitivityFigures(Figures):
    """The pairs of a study."""

    pairs: list[PairFigures]


ANSWER = SensitivityFigures
