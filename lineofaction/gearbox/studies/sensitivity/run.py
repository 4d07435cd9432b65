"""Sensitivity of cases to misalignment and center distance: from cases to curves, and their JSON."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from fe_contact.analysis import check_request
from fe_contact.analysis.studies.sensitivity import study_sensitivity
from fe_contact.geometry import ParallelAxes
from fe_contact.options import Run, TableAxes
from lineofaction.gearbox.convert.case import boundary_errors, gear_pair, study_options
from lineofaction.gearbox.schemas import Case
from lineofaction.gearbox.stages import TableFraction
from lineofaction.gearbox.studies.computation import Computation, Means
from lineofaction.gearbox.studies.figures import figures_of
from lineofaction.gearbox.studies.result_file import ResultFile
from lineofaction.gearbox.studies.sensitivity import Inputs, SensitivityFigures
from lineofaction.gearbox.studies.sensitivity.stored import FORMAT, PairStudy, read_studies, write_studies
from lineofaction.gearbox.units import UM
from model_studies import Progress

Json = dict[str, Any]
Studies = tuple[PairStudy, ...]
TABLES = 4
"""Of a pair: over each deviation, without and with corner contact."""


def study_case(case: Case, inputs: Inputs, means: Means) -> Studies:
    """Study a case at its highest load; its own misalignments and center distances are left aside.

    Raises
    ------
    BadInput
        No such pair, or a deviation at which it cannot run.
    JobFailed
        No mesh, or points without a solution.
    """
    pair = gear_pair(case)
    tables = _TableByTable(means.report)
    run = Run(means.workers, means.home / "compliance", tables.progress, tables.plan)
    with boundary_errors():
        axes = _axes(case, pair, inputs)
        curves = study_sensitivity(pair, axes, study_options(case), run)
    name = f"{case.pair.pinion.teeth}/{case.pair.wheel.teeth}"
    return (PairStudy(name, float(axes.load(pair)[0]), pair.center_distance, curves),)


class _TableByTable:
    """Turns the progress of each table into that of the study."""

    def __init__(self, report: Progress) -> None:
        self._report, self._tables = report, list[TableFraction]()

    def plan(self, stages: Mapping[str, float]) -> None:
        """Begin a table."""
        self._tables.append(TableFraction())
        self._tables[-1].plan(stages)

    def progress(self, stage: str, fraction: float) -> None:
        """Report the fraction done of the study."""
        done = len(self._tables) - 1 + self._tables[-1].at(stage, fraction)
        self._report("tables", min(done / TABLES, 1.0))


def across_face(case: Case, _inputs: Inputs) -> Case:
    """Return a case in three dimensions: no model of the plane knows a misalignment."""
    if case.accuracy.model not in ("plane_strain", "plane_stress"):
        return case
    return case.model_copy(update={"accuracy": case.accuracy.model_copy(update={"model": "3d"})})


def _check_study(case: Case, inputs: Inputs) -> None:
    """Refuse what a study cannot compute, without computing anything.

    Raises
    ------
    BadInput
        No such pair, or a deviation at which it cannot run.
    """
    pair, options = gear_pair(case), study_options(case)
    model = "3d" if options.model == "auto" else options.model
    with boundary_errors():
        check_request(pair, _axes(case, pair, inputs), replace(options, model=model))


def joined(studies: Mapping[str, Studies]) -> Studies:
    """Return the studies of several cases as one, under the names of their files."""
    return tuple(replace(study, name=name) for name, group in studies.items() for study in group)


def _highest_force(case: Case, pair: ParallelAxes) -> float:
    torques, forces = case.load.torque_n_m, case.load.normal_force_n
    return float(pair.normal_force(torques[-1])) if torques else float((forces or ())[-1])


def _axes(case: Case, pair: ParallelAxes, inputs: Inputs) -> TableAxes:
    """Return the highest load of the case and both axes."""
    percent = inputs.center_distance_change_percent
    return TableAxes(
        normal_forces=[_highest_force(case, pair)],
        misalignments=[value * UM for value in inputs.misalignment_um],
        center_distance_changes=[0.01 * value * pair.center_distance for value in percent],
    )


def studies_json(studies: Sequence[PairStudy]) -> Json:
    """Return the figures of all pairs."""
    return figures_of(SensitivityFigures, pairs=[(study, {"curves": _curves(study)}) for study in studies])


def _curves(study: PairStudy) -> list[tuple[Any, ...]]:
    """Return both curves without and with corner contact, the changes of the distance in parts of it."""
    percent = [
        (100.0 * curves.center_distance_change.deviation / study.center_distance) for curves in study.curves
    ]
    return [
        (
            curves,
            {"center_distance": (curves.center_distance_change, {"center_distance_change_percent": change})},
        )
        for curves, change in zip(study.curves, percent, strict=True)
    ]


RUN = Computation(
    study_case,
    studies_json,
    ResultFile("format", (FORMAT,), write_studies, read_studies, tuple[PairStudy, ...]),
    narrowed=across_face,
    check=_check_study,
    joined=joined,
    resumed=True,
)
