"""Flank results of a case: from one load and one alignment to what happens on the flanks, and its JSON."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

from fe_contact.analysis.flanks.flank_file import FORMAT, flank_results
from fe_contact.analysis.flanks.load_distribution import LoadDistribution
from fe_contact.options import Run
from lineofaction.gearbox.convert.case import (
    analysis_options,
    boundary_errors,
    case_at,
    case_json,
    check_case,
    gear_pair,
    operating_point,
)
from lineofaction.gearbox.convert.plausibility import phrased_for
from lineofaction.gearbox.schemas import Case
from lineofaction.gearbox.studies.computation import Computation
from lineofaction.gearbox.studies.figures import figures_of
from lineofaction.gearbox.studies.flank import FlankFigures
from lineofaction.gearbox.studies.result_file import ResultFile
from lineofaction.gearbox.units import MM, UM, as_typed
from model_studies import Progress, silent

Json = dict[str, Any]


def flanks_of(case: Case, cache: Path | None, progress: Progress = silent) -> LoadDistribution:
    """Return what happens on the flanks of a case of one load and one alignment, over a mesh cycle.

    Its warnings are in the fields and units of the case.

    Raises
    ------
    BadInput
        No such pair, or a request that no plan can meet.
    JobFailed
        No mesh, or positions without a solution.
    """
    run = Run(cache=cache, progress=progress)
    with boundary_errors():
        results = flank_results(
            gear_pair(case), operating_point(case), analysis_options(case), run, case=case_json(case)
        )
    warnings = phrased_for(case, results.metadata.warnings)
    return replace(results, metadata=replace(results.metadata, warnings=warnings))


def flank_json(flanks: LoadDistribution) -> Json:
    """Return the figures of flank results."""
    scene, centroid = flanks.scene, flanks.load_centroid
    return figures_of(
        FlankFigures,
        flanks,
        torque_n_m=as_typed(scene.torque),
        misalignment_um=as_typed(scene.misalignment, UM),
        center_distance_change_mm=as_typed(scene.center_distance_change, MM),
        largest_face_load_factor=flanks.face_load_factor.max(),
        load_centroid=(centroid.min(), centroid.max()),
        largest_line_load_n_per_mm=flanks.line_load.max() * MM,
        largest_pressure_mpa=flanks.clear_pressure.max() * 1e-6,
        edge_pressure_mpa=flanks.edge_pressure * 1e-6,
    )


RUN = Computation(
    lambda case, _inputs, means: flanks_of(case, means.home / "compliance", means.report),
    flank_json,
    ResultFile(
        "format", (FORMAT,), LoadDistribution.to_netcdf, LoadDistribution.from_netcdf, LoadDistribution
    ),
    narrowed=case_at,
    check=lambda case, _inputs: check_case(case, whole_table=False),
    normalized=lambda _case, _inputs: {},
    warnings=lambda results: results.metadata.warnings,
)
