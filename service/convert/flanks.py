"""Flank results at the boundary: from a case and a point to what happens on the flanks, and its JSON."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from fe_contact.analysis import LoadDistribution, flank_results
from fe_contact.options import Run
from fe_contact.progress import Progress, silent
from service.convert.case import analysis_options, boundary_errors, case_json, gear_pair, operating_point
from service.schemas import Case, ErrorsInput, LoadInput
from service.schemas.flank import FlankPoint
from service.units import MM, UM

Json = dict[str, Any]


def case_at(case: Case, point: FlankPoint) -> Case:
    """Return the case with the one load and the one alignment of a point.

    What the point leaves open is the case's highest load, and its deviations nearest to zero.
    """
    load, errors = case.load, case.errors
    if point.torque_n_m is not None:
        load = LoadInput(torque_n_m=(point.torque_n_m,))
    elif point.normal_force_n is not None:
        load = LoadInput(normal_force_n=(point.normal_force_n,))
    elif load.torque_n_m is not None:
        load = LoadInput(torque_n_m=load.torque_n_m[-1:])
    elif load.normal_force_n is not None:
        load = LoadInput(normal_force_n=load.normal_force_n[-1:])
    skew, change = point.misalignment_um, point.center_distance_change_mm
    here = ErrorsInput(
        misalignment_um=(min(errors.misalignment_um, key=abs) if skew is None else skew,),
        center_distance_change_mm=(
            min(errors.center_distance_change_mm, key=abs) if change is None else change,
        ),
    )
    accuracy = case.accuracy.model_copy(update={"positions": None})  # a cycle is always the same 64
    return case.model_copy(update={"load": load, "errors": here, "accuracy": accuracy})


def flanks_of(case: Case, cache: Path | None, progress: Progress = silent) -> LoadDistribution:
    """Return what happens on the flanks of a case of one load and one alignment, over a mesh cycle.

    Raises
    ------
    BadInput
        No such pair, or a request that no plan can meet.
    JobFailed
        No mesh, or positions without a solution.
    """
    with boundary_errors():
        run = Run(cache=cache, progress=progress)
        return flank_results(
            gear_pair(case), operating_point(case), analysis_options(case), run, case=case_json(case)
        )


def flank_json(flanks: LoadDistribution) -> Json:
    """Return the figures of flank results."""
    scene, centroid = flanks.scene, flanks.load_centroid
    return {
        "content_hash": flanks.metadata.content_hash,
        "torque_n_m": scene.torque,
        "normal_force_n": scene.normal_force,
        "misalignment_um": scene.misalignment / UM,
        "center_distance_change_mm": scene.center_distance_change / MM,
        "positions": int(flanks.position.size),
        "slices": int(flanks.face_position.size),
        "k_h_beta": flanks.mean_face_load_factor,
        "largest_face_load_factor": float(flanks.face_load_factor.max()),
        "load_centroid_mm": [float(centroid.min() / MM), float(centroid.max() / MM)],
        "largest_line_load_n_per_mm": float(flanks.line_load.max() * MM),
        "largest_pressure_mpa": float(flanks.pressure.max() * 1e-6),
        "effect_ledger": flanks.metadata.effect_ledger,
        "receipt": flanks.metadata.receipt,
    }
