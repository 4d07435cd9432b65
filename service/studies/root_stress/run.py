"""Tooth-root stress of a case of one load and one alignment: figures in the units of the boundary."""

from __future__ import annotations

import json
import math
from typing import Any

from fe_contact.analysis import RootStressHistory, root_stress
from fe_contact.analysis.flanks.root_stress_history import ROOTS, RootPeak
from fe_contact.options import Run
from service.convert.case import analysis_options, boundary_errors, case_at, gear_pair, operating_point
from service.convert.checks import check_case
from service.convert.plausibility import phrased_for
from service.schemas import Case
from service.studies.computation import Computation, Means
from service.studies.root_stress import Inputs
from service.units import MM, UM

Json = dict[str, Any]
GEARS = ("pinion", "wheel")
MPA = 1e6


def root_stress_of(case: Case, _inputs: Inputs, means: Means) -> Json:
    """Return the peaks over a mesh cycle, what one tooth of each gear meets, the receipt and the warnings.

    Raises
    ------
    BadInput
        No such pair, or a request that no plan can meet.
    JobFailed
        No mesh, or positions without a solution.
    """
    run = Run(cache=means.home / "compliance", progress=means.report)
    with boundary_errors():
        stress = root_stress(gear_pair(case), operating_point(case), analysis_options(case), run)
    return {
        "torque_n_m": stress.torque,
        "normal_force_n": stress.normal_force,
        "misalignment_um": stress.misalignment / UM,
        "center_distance_change_mm": stress.center_distance_change / MM,
        **{gear: _gear_json(getattr(stress, gear)) for gear in GEARS},
        "receipt": stress.receipt,
        "warnings": phrased_for(case, stress.warnings),
    }


def _gear_json(history: RootStressHistory) -> Json:
    """One gear."""
    passage = history.passage()
    return {
        **{root: _peak_json(history.peak(root)) for root in ROOTS},
        "critical_section_mm": history.critical_coordinate / MM,
        "passage": {
            "position": passage.position.tolist(),
            "tension_mpa": (passage.tension / MPA).tolist(),
            "compression_mpa": (passage.compression / MPA).tolist(),
            "at_tension_peak_mpa": (passage.at_tension_peak / MPA).tolist(),
            "at_compression_peak_mpa": (passage.at_compression_peak / MPA).tolist(),
        },
    }


def _peak_json(peak: RootPeak) -> Json:
    """One root; the position is that of the tooth's own pair."""
    return {
        "stress_mpa": peak.stress.value / MPA,
        "error_mpa": peak.stress.error / MPA,
        "position": peak.position % 1.0 + peak.pair,
        "flank_coordinate_mm": peak.flank_coordinate / MM,
        "tangent_angle_deg": math.degrees(peak.tangent_angle),
        "face_position_mm": peak.face_position / MM,
    }


RUN = Computation(
    root_stress_of,
    lambda stresses: stresses,
    lambda file: json.loads(file.read_text(encoding="utf-8")),
    marks=dict.fromkeys(("pinion", "wheel", "receipt")),
    narrowed=case_at,
    check=lambda case, _inputs: check_case(case),
    normalized=lambda _case, _inputs: {},
    warnings=lambda stresses: stresses["warnings"],
)
