"""Sensitivity of cases to misalignment and center distance: from cases to curves, and their JSON."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from bounds.types import Json
from fe_contact.analysis.request.request_check import check_request
from fe_contact.analysis.studies.sensitivity import RippleCurve, Sensitivity, study_sensitivity
from fe_contact.geometry import ParallelAxes
from fe_contact.options import Run, TableAxes
from fe_contact.ste.netcdf import FileFormat, digest, json_attribute
from lineofaction.gearbox.convert.case import CheckedCase, boundary_errors, study_options
from lineofaction.gearbox.schemas import Case
from lineofaction.gearbox.stages import TableFraction
from lineofaction.gearbox.studies.computation import CaseStudy, Means, ResultFile
from lineofaction.gearbox.studies.sensitivity import Inputs, SensitivityFigures
from lineofaction.gearbox.units import UM
from model_studies import Progress
from model_studies.netcdf import NetcdfContent, Variable

FORMAT = "lineofaction sensitivity study"
SCHEMA_VERSION = 1
_AXES = ("misalignment", "center_distance_change")

# dimensions, units and long name; the models are without and with corner contact
STORED: dict[str, tuple[tuple[str, ...], str, str]] = {
    "normal_force": (("pair",), "N", "normal tooth force F_bn"),
    "center_distance": (("pair",), "m", "nominal center distance"),
    "corner_contact": (("model",), "1", "1 with corner contact"),
    "misalignment": (("pair", "misaligned"), "m", "gap growth over the common face width"),
    "center_distance_change": (("pair", "changed"), "m", "deviation from the nominal center distance"),
    **{
        f"{name}_over_{axis}": (("pair", "model", along), "m", f"{text} over the {axis.replace('_', ' ')}")
        for axis, along in zip(_AXES, ("misaligned", "changed"), strict=True)
        for name, text in (
            ("peak_to_peak", "peak-to-peak static transmission error"),
            ("error", "half-width of the error band"),
        )
    },
}
FILES = FileFormat(FORMAT, "sensitivity study", SCHEMA_VERSION, tuple(STORED))


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


def _write_studies(studies: Sequence[PairStudy], path: Path) -> None:
    """Write studies of the same numbers of deviations: into a temporary file beside `path`, then renamed."""
    arrays: dict[str, Any] = {
        "normal_force": np.array([study.normal_force for study in studies]),
        "center_distance": np.array([study.center_distance for study in studies]),
        "corner_contact": np.array([own.corner_contact for own in studies[0].curves], dtype=np.int8),
    }
    for axis in _AXES:
        curves = [[getattr(each, axis) for each in study.curves] for study in studies]
        arrays[axis] = np.stack([row[0].deviation for row in curves])
        for name in ("peak_to_peak", "error"):
            stacked = [np.stack([getattr(curve, name) for curve in row]) for row in curves]
            arrays[f"{name}_over_{axis}"] = np.stack(stacked)
    arrays = {name: arrays[name] for name in STORED}
    variables = {
        name: Variable(dimensions, arrays[name], {"units": units, "long_name": text})
        for name, (dimensions, units, text) in STORED.items()
    }
    attributes = {
        "Conventions": "CF-1.11",
        "title": "Sensitivity of the transmission error to misalignment and center distance",
        "format": FORMAT,
        "schema_version": np.int64(SCHEMA_VERSION),
        "names": json.dumps([study.name for study in studies]),
        "data_sha256": digest(arrays),
    }
    NetcdfContent(variables, attributes).write(path)


def _read_studies(path: Path) -> tuple[PairStudy, ...]:
    """Read back what `_write_studies` wrote.

    Raises
    ------
    DatabaseError
        The file is missing, no netCDF-4, of another kind, of a newer schema, or damaged.
    """
    content, attributes = FILES.read(path)
    force, distance, corners = (
        content[name].tolist() for name in ("normal_force", "center_distance", "corner_contact")
    )

    def curves(pair: int, model: int) -> Iterator[RippleCurve]:
        for axis in _AXES:
            sizes = (content[f"{name}_over_{axis}"][pair, model] for name in ("peak_to_peak", "error"))
            yield RippleCurve(content[axis][pair], *sizes)

    def models(pair: int) -> tuple[Sensitivity, ...]:
        return tuple(Sensitivity(bool(on), *curves(pair, model)) for model, on in enumerate(corners))

    names = enumerate(json_attribute(path, attributes, "names"))
    return tuple(PairStudy(str(name), force[pair], distance[pair], models(pair)) for pair, name in names)


Studies = tuple[PairStudy, ...]
TABLES = 4
"""Of a pair: over each deviation, without and with corner contact."""


class _SensitivityStudy(CaseStudy[Inputs, SensitivityFigures, Studies]):
    inputs, answer = Inputs, SensitivityFigures
    file = ResultFile("format", (FORMAT,), _write_studies, _read_studies, tuple[PairStudy, ...])
    resumed = True

    def narrowed(self, checked: CheckedCase, _inputs: Inputs) -> CheckedCase:
        """Return a case in three dimensions: no model of the plane knows a misalignment."""
        accuracy = checked.case.accuracy
        if accuracy.model not in ("plane_strain", "plane_stress"):
            return checked
        across = accuracy.model_copy(update={"model": "3d"})
        return CheckedCase(checked.case.model_copy(update={"accuracy": across}))

    def check(self, case: CheckedCase, inputs: Inputs) -> None:
        pair, options = case.pair, study_options(case.options)
        model = "3d" if options.model == "auto" else options.model
        with boundary_errors():
            check_request(pair, _axes(case.case, pair, inputs), replace(options, model=model))

    def compute(self, case: CheckedCase, inputs: Inputs, means: Means) -> Studies:
        """Study a case at its highest load; its own misalignments and center distances are left aside."""
        pair, gears = case.pair, case.case.pair
        tables = _TableByTable(means.report)
        run = Run(means.workers, means.home / "compliance", tables.progress, tables.plan)
        with boundary_errors():
            axes = _axes(case.case, pair, inputs)
            curves = study_sensitivity(pair, axes, study_options(case.options), run)
        name = f"{gears.pinion.teeth}/{gears.wheel.teeth}"
        return (PairStudy(name, float(axes.load(pair)[0]), pair.center_distance, curves),)

    def joined(self, studies: Mapping[str, Studies]) -> Studies:
        """Return the studies of several cases as one, under the names of their files."""
        return tuple(replace(study, name=name) for name, group in studies.items() for study in group)

    def _derived(self, studies: Studies) -> Json:
        return {"pairs": [(study, {"curves": _curves(study)}) for study in studies]}


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


def _axes(case: Case, pair: ParallelAxes, inputs: Inputs) -> TableAxes:
    """Return the highest load of the case and both axes."""
    torques, forces = case.load.torque_n_m, case.load.normal_force_n
    percent = inputs.center_distance_change_percent
    return TableAxes(
        normal_forces=[float(pair.normal_force(torques[-1])) if torques else float((forces or ())[-1])],
        misalignments=[value * UM for value in inputs.misalignment_um],
        center_distance_changes=[0.01 * value * pair.center_distance for value in percent],
    )


def _curves(study: PairStudy) -> Iterator[tuple[Any, ...]]:
    """Yield both curves without and with corner contact, the changes of the distance in parts of it."""
    for curves in study.curves:
        moved = curves.center_distance_change
        percent = {"center_distance_change_percent": 100.0 * moved.deviation / study.center_distance}
        yield curves, {"center_distance": (moved, percent)}


RUN = _SensitivityStudy()
