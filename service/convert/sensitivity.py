"""Sensitivity studies at the boundary: from a case to curves, and their JSON."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from fe_contact.analysis import check_request
from fe_contact.analysis.sensitivity import RippleCurve, Sensitivity, study_sensitivity
from fe_contact.geometry import ParallelAxes
from fe_contact.options import Run, TableAxes
from fe_contact.progress import Progress, silent
from fe_contact.workers import InProcess, Workers
from service.convert.case import boundary_errors, gear_pair, study_options
from service.schemas import Case
from service.units import MM, UM

Json = dict[str, Any]


@dataclass(frozen=True)
class Deviations:
    """The varied values: misalignment in um, center distance in per cent of the nominal one."""

    misalignment_um: tuple[float, ...]
    center_distance_change_percent: tuple[float, ...]


@dataclass(frozen=True)
class PairStudy:
    """The study of one pair.

    Attributes
    ----------
    name : str
    normal_force, center_distance : float
        N; m.
    curves : tuple of Sensitivity
        Without and with corner contact.
    """

    name: str
    normal_force: float
    center_distance: float
    curves: tuple[Sensitivity, ...]


def study_case(
    name: str,
    case: Case,
    deviations: Deviations,
    cache: Path | None,
    progress: Progress = silent,
    workers: Workers = InProcess(),  # noqa: B008 (frozen)
) -> PairStudy:
    """Study a case at its highest load; its own misalignments and center distances are left aside.

    Raises
    ------
    BadInput
        No such pair, or a deviation at which it cannot run.
    JobFailed
        No mesh, or points without a solution.
    """
    pair = gear_pair(case)
    with boundary_errors():
        axes = _axes(case, pair, deviations)
        curves = study_sensitivity(pair, axes, study_options(case), Run(workers, cache, progress))
    return PairStudy(name, float(axes.load(pair)[0]), pair.center_distance, curves)


def check_study(case: Case, deviations: Deviations) -> None:
    """Refuse what a study cannot compute, without computing anything.

    Raises
    ------
    BadInput
        No such pair, or a deviation at which it cannot run.
    """
    pair = gear_pair(case)
    options = study_options(case)
    with boundary_errors():
        check_request(
            pair,
            _axes(case, pair, deviations),
            replace(options, model="3d" if options.model == "auto" else options.model),
        )


def _highest_force(case: Case, pair: ParallelAxes) -> float:
    """Return the highest load of the case as a normal force in N."""
    torques, forces = case.load.torque_n_m, case.load.normal_force_n
    return float(pair.normal_force(torques[-1])) if torques else float((forces or ())[-1])


def _axes(case: Case, pair: ParallelAxes, deviations: Deviations) -> TableAxes:
    """Return the highest load of the case and both axes."""
    percent = deviations.center_distance_change_percent
    return TableAxes(
        normal_forces=[_highest_force(case, pair)],
        misalignments=[value * UM for value in deviations.misalignment_um],
        center_distance_changes=[0.01 * value * pair.center_distance for value in percent],
    )


def studies_json(studies: Sequence[PairStudy]) -> Json:
    """Return the figures of all pairs."""
    return {"pairs": [_pair_json(study) for study in studies]}


def _pair_json(study: PairStudy) -> Json:
    """One pair."""
    return {
        "name": study.name,
        "normal_force_n": study.normal_force,
        "center_distance_mm": study.center_distance / MM,
        "curves": [_curves_json(curves, study.center_distance) for curves in study.curves],
    }


def _curves_json(curves: Sensitivity, center_distance: float) -> Json:
    """Both curves with or without corner contact."""
    skew, distance = curves.misalignment, curves.center_distance_change
    return {
        "corner_contact": curves.corner_contact,
        "misalignment": {"misalignment_um": (skew.deviation / UM).tolist(), **_ripple_json(skew)},
        "center_distance": {
            "center_distance_change_percent": (100.0 * distance.deviation / center_distance).tolist(),
            **_ripple_json(distance),
        },
    }


def _ripple_json(curve: RippleCurve) -> Json:
    """Peak-to-peak with its error, and its change."""
    return {
        "peak_to_peak_um": (curve.peak_to_peak / UM).tolist(),
        "peak_to_peak_error_um": (curve.error / UM).tolist(),
        "change_percent": (100.0 * curve.relative_change).tolist(),
    }
