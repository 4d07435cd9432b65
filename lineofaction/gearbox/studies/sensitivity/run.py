"""Sensitivity of cases to misalignment and center distance: from cases to curves, and their JSON."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from bounds.brief import brief, html_of, text_of
from bounds.plottable import Plottable
from bounds.types import Json
from fe_contact.analysis.request.request import Checked
from fe_contact.analysis.run_plan import predicted_designs
from fe_contact.analysis.studies.sensitivity import Sensitivity, study_sensitivity
from fe_contact.errors import InputError
from fe_contact.options import TableAxes
from lineofaction.gearbox.convert.boundary_errors import boundary_errors
from lineofaction.gearbox.convert.case import PLANE, study_options
from lineofaction.gearbox.convert.checked_case import CheckedCase, across_face
from lineofaction.gearbox.studies.computation import CaseStudy, Means, ResultFile
from lineofaction.gearbox.studies.cost import StudyCost, Work
from lineofaction.gearbox.studies.sensitivity import Inputs, SensitivityFigures
from lineofaction.gearbox.units import UM
from model_studies import Progress, in_unit
from model_studies.progress import TableFraction
from model_studies.record_file import read_record, record_content, write_record

if TYPE_CHECKING:
    import xarray

SCHEMA = "lineofaction sensitivity study"
_USUAL: tuple[tuple[float, ...], ...] = (
    (-0.2, -0.1, 0.0, 0.1, 0.2),
    (-0.1, -0.05, 0.0, 0.05, 0.1),
    (0.0, 0.05, 0.1, 0.15, 0.2),
    (-0.2, -0.15, -0.1, -0.05, 0.0),
)
"""Changes of the center distance in per cent if none are named: the first row at which a pair meshes.

All rows have equally many changes, so that the pairs of one study have equally many.
"""
TABLES = 4
"""Number of tables of a pair: over each of two deviations, without and with corner contact."""


@brief
@dataclass(frozen=True)
class PairStudy:
    """The study of one pair."""

    name: str
    normal_force: float = field(metadata=in_unit("n"))
    center_distance: float = field(metadata=in_unit("m"))
    """`normal_force`, `center_distance`: Normal force of the curves, N; center distance, m."""
    curves: tuple[Sensitivity, ...]
    """Curves over each deviation, without and with corner contact."""
    torque: float = field(default=math.nan, metadata=in_unit("n_m"))
    """Torque on the driving gear, N m; NaN in files of earlier versions."""


class Studies(tuple[PairStudy, ...], Plottable):
    """Studies of the same numbers of deviations, a pair each."""

    def __repr__(self) -> str:
        return text_of(self)

    def _repr_html_(self) -> str:
        return html_of(self)

    def to_xarray(self) -> xarray.Dataset:
        """Return the numbers with names and units, as the file has them; the rest is an attribute."""
        return record_content(_Stored(tuple(self)), SCHEMA).to_xarray()


@dataclass(frozen=True)
class _Stored:
    """Studies as they are in their file."""

    pairs: tuple[PairStudy, ...]


def write_studies(studies: Studies, path: Path) -> None:
    """Write the sensitivities of a scene to a file."""
    write_record(_Stored(tuple(studies)), path, SCHEMA)


def read_studies(path: Path) -> Studies:
    """Return the sensitivities that a file holds."""
    stored: _Stored = read_record(path, {SCHEMA: _Stored})
    return Studies(stored.pairs)


class _SensitivityStudy(CaseStudy[Inputs, SensitivityFigures, Studies]):
    inputs, answer = Inputs, SensitivityFigures
    file = ResultFile("schema", (SCHEMA,), write_studies, read_studies, Studies)
    resumed = True

    def narrowed(self, checked: CheckedCase, _inputs: Inputs) -> CheckedCase:
        """Return a case in three dimensions: no model of the plane knows a misalignment."""
        return across_face(checked) if checked.case.accuracy.model in PLANE else checked

    def normalized(self, case: CheckedCase, inputs: Inputs) -> Json:
        """Return all inputs, with the usual changes of the center distance if none are named."""
        with boundary_errors():
            changes = _changes(self.narrowed(case, inputs), inputs)
        return super().normalized(case, inputs) | {"center_distance_change_percent": list(changes)}

    def check(self, case: CheckedCase, inputs: Inputs) -> None:
        """Refuse a case that cannot be, and deviations at which it cannot be."""
        _ = case.request(_tables, inputs)

    def predicted(self, case: CheckedCase, inputs: Inputs, cache: Path | None) -> StudyCost:
        """Return the cost of the gears and the tables over each deviation, with and without corners."""
        with boundary_errors():
            checked = case.request(_tables, inputs)
            skewed = replace(checked.request, center_distance_change=np.zeros(1))  # a table has one axis
            predicted = predicted_designs(replace(checked, request=skewed), cache)
        axes = checked.request.misalignment, checked.request.center_distance_change
        values = 2 * sum(np.union1d(np.zeros(1), axis).size for axis in axes)
        per_value = predicted.design + predicted.errors
        parts = (
            Work("gears", predicted.all_bodies, stage="tables"),
            Work("values", per_value, values, "tables"),
        )
        return StudyCost(parts, predicted.bytes)

    def compute(self, case: CheckedCase, inputs: Inputs, means: Means) -> Studies:
        """Study a case at its highest load; its own misalignments and center distances do not count."""
        gears = case.case.pair
        predicted = self.predicted(case, inputs, means.analysis.cache)
        tables = _TableByTable(means.report, predicted.seconds)
        run = replace(means.analysis, progress=tables.progress, on_plan=tables.plan)
        checked = case.request(_tables, inputs)
        with boundary_errors():
            curves = study_sensitivity(checked, run=run)
        name = f"{gears.pinion.teeth}/{gears.wheel.teeth}"
        force = float(checked.request.load[0])
        torque = float(case.pair.torque(force))
        return Studies((PairStudy(name, force, case.pair.center_distance, curves, torque),))

    def joined(self, studies: Mapping[str, Studies]) -> Studies:
        """Return the studies of several cases as one, under the names of their files."""
        return Studies(replace(study, name=name) for name, group in studies.items() for study in group)

    def _derived(self, studies: Studies) -> Json:
        return {"pairs": [(study, {"curves": _curves(study)}) for study in studies]}


class _TableByTable:
    """Progress of the study from the progress of each table; `seconds` are predicted for all of them."""

    def __init__(self, report: Progress, seconds: float) -> None:
        self._report = report
        self._whole = seconds
        self._table = TableFraction()
        self._seconds: list[float] = []  # predicted, of the tables so far

    def plan(self, stages: Mapping[str, float]) -> None:
        """Begin a table."""
        self._table = TableFraction()
        self._table.plan(stages)
        self._seconds.append(sum(stages.values()))

    def progress(self, stage: str, fraction: float) -> None:
        """Report the fraction done of the study, by predicted cost."""
        *before, current = self._seconds
        done = sum(before) + current * self._table.at(stage, fraction)
        whole = self._whole
        if len(self._seconds) == TABLES:  # the last one ends the work, whatever was predicted
            whole = sum(before) + current
        self._report("tables", min(done / max(whole, done, 1e-9), 1.0))


def _changes(case: CheckedCase, inputs: Inputs) -> tuple[float, ...]:
    """Return the changes of the center distance in per cent: the named ones, or usual ones that mesh."""

    def meshes(changes: tuple[float, ...]) -> bool:
        with suppress(InputError):
            return bool(_at_changes(case, inputs, changes))
        return False

    return tuple(inputs.center_distance_change_percent) or next(filter(meshes, _USUAL), _USUAL[0])


def _tables(case: CheckedCase, inputs: Inputs) -> Checked:
    """Return the request at the highest load of the case over both deviations."""
    return _at_changes(case, inputs, _changes(case, inputs))


def _at_changes(case: CheckedCase, inputs: Inputs, percent: tuple[float, ...]) -> Checked:
    pair, load = case.pair, case.case.load
    forces = load.normal_force_n or [float(pair.normal_force((load.torque_n_m or ())[-1]))]
    axes = TableAxes(
        normal_forces=[forces[-1]],
        misalignments=[value * UM for value in inputs.misalignment_um],
        center_distance_changes=[0.01 * value * pair.center_distance for value in percent],
    )
    return Sensitivity.request(pair, axes, study_options(case.options))


def _curves(study: PairStudy) -> Iterator[tuple[Any, ...]]:
    """Yield both curves without and with corner contact, the changes of the distance in parts of it."""
    for curves in study.curves:
        distance_curve = curves.center_distance_change
        percent = {"center_distance_change_percent": 100.0 * distance_curve.deviation / study.center_distance}
        yield curves, {"center_distance": (distance_curve, percent)}


RUN = _SensitivityStudy()
