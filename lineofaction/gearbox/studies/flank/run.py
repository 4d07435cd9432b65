"""Flank results of a case at one load and one alignment."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from bounds.types import Json
from fe_contact.analysis.flanks.flank_file import FORMAT
from fe_contact.analysis.flanks.flank_results import flank_results
from fe_contact.analysis.flanks.load_distribution import LoadDistribution
from fe_contact.analysis.run_plan import predicted_designs
from fe_contact.options import Run
from lineofaction.gearbox.convert.boundary_errors import boundary_errors
from lineofaction.gearbox.convert.case import case_json
from lineofaction.gearbox.convert.case_plausibility import phrased_for
from lineofaction.gearbox.convert.checked_case import CheckedCase
from lineofaction.gearbox.schemas.flank_point import FlankPoint
from lineofaction.gearbox.studies.computation import Means, PointStudy, ResultFile
from lineofaction.gearbox.studies.cost import StudyCost, Work
from lineofaction.gearbox.studies.flank import FlankFigures, Inputs
from lineofaction.gearbox.units import MM, MPA, UM, as_typed


def flanks_of(checked: CheckedCase, run: Run) -> LoadDistribution:
    """Return the results on the flanks of a case of one load and one alignment, over a mesh cycle.

    Its warnings are in the fields and units of the case. Raises `BadInput`: no such pair, or a request that
    no plan can meet; `JobFailed`: no mesh, or positions without a solution.
    """
    case, point = checked.case, checked.at_point
    with boundary_errors():
        results = flank_results(point, run=run, case=case_json(case))
    warnings = phrased_for(case, results.metadata.warnings)
    return replace(results, metadata=replace(results.metadata, warnings=warnings))


class _FlankStudy(PointStudy[FlankFigures, LoadDistribution]):
    inputs, answer = Inputs, FlankFigures
    file = ResultFile(
        "format", (FORMAT,), LoadDistribution.to_netcdf, LoadDistribution.from_netcdf, LoadDistribution
    )

    def predicted(self, case: CheckedCase, _inputs: FlankPoint, cache: Path | None) -> StudyCost:
        """Return the cost of the bodies and of one solution with its errors."""
        with boundary_errors():
            predicted = predicted_designs(case.at_point, cache)
        parts = (
            Work("gears", predicted.bodies, stage="compliance"),
            Work("contact", predicted.design, stage="contact"),
            Work("coarse gears", predicted.coarse_bodies, stage="errors"),
            Work("its errors", predicted.errors, stage="errors"),
        )
        return StudyCost(parts, predicted.bytes)

    def compute(self, case: CheckedCase, _inputs: FlankPoint, means: Means) -> LoadDistribution:
        return flanks_of(case, means.analysis)

    def _derived(self, flanks: LoadDistribution) -> Json:
        scene, centroid = flanks.scene, flanks.load_centroid
        return {
            "torque_n_m": as_typed(scene.torque),
            "misalignment_um": as_typed(scene.misalignment, UM),
            "center_distance_change_mm": as_typed(scene.center_distance_change, MM),
            **_errors(flanks),
            "largest_face_load_factor": flanks.face_load_factor.max(),
            "load_centroid": (centroid.min(), centroid.max()),
            "largest_line_load_n_per_mm": flanks.largest_line_load.value * MM,
            "edge_line_load_n_per_mm": flanks.edge_line_load.value * MM,
            "largest_pressure_mpa": flanks.clear_pressure.max() * 1e-6,
            "edge_pressure_mpa": flanks.edge_pressure * 1e-6,
        }

    def warnings(self, flanks: LoadDistribution) -> list[Json] | None:
        return flanks.metadata.warnings


def _errors(flanks: LoadDistribution) -> Json:
    """Return the errors of the figures, NaN where one is not estimated."""
    return {
        "k_h_beta_error": flanks.cycle_face_load_factor.error,
        "largest_face_load_factor_error": flanks.largest_face_load_factor.error,
        "largest_line_load_error_n_per_mm": flanks.largest_line_load.error * MM,
        "edge_line_load_error_n_per_mm": flanks.edge_line_load.error * MM,
        "largest_pressure_error_mpa": flanks.largest_pressure.error / MPA,
    }


RUN = _FlankStudy()
