"""Tooth-root stress at the boundary: from a case of one load and one alignment to figures, and their JSON."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

from fe_contact.analysis import RootStress, RootStressHistory, root_stress
from fe_contact.analysis.root_stress_history import ROOTS, RootPeak
from fe_contact.options import Run
from fe_contact.progress import Progress, silent
from service.convert.case import analysis_options, boundary_errors, gear_pair, operating_point
from service.schemas import Case
from service.units import MM, UM

Json = dict[str, Any]
GEARS = ("pinion", "wheel")
MPA = 1e6


def root_stress_of(case: Case, cache: Path | None, progress: Progress = silent) -> RootStress:
    """Return the root stress of a case of one load and one alignment, over a mesh cycle.

    Raises
    ------
    BadInput
        No such pair, or a request that no plan can meet.
    JobFailed
        No mesh, or positions without a solution.
    """
    run = Run(cache=cache, progress=progress)
    with boundary_errors():
        return root_stress(gear_pair(case), operating_point(case), analysis_options(case), run)


def root_stress_json(stress: RootStress) -> Json:
    """Return the peaks, what one tooth of each gear meets, and the receipt."""
    return {
        "torque_n_m": stress.torque,
        "normal_force_n": stress.normal_force,
        "misalignment_um": stress.misalignment / UM,
        "center_distance_change_mm": stress.center_distance_change / MM,
        **{gear: _gear_json(getattr(stress, gear)) for gear in GEARS},
        "receipt": stress.receipt,
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
