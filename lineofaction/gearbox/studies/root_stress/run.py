"""Tooth-root stress of a case of one load and one alignment: the roots of both gears, and their figures."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from bounds.brief import brief
from bounds.types import Json
from fe_contact.analysis.flanks.root_stress import root_stress, stress_seconds
from fe_contact.analysis.flanks.root_stress_history import ROOTS, RootPassage, RootPeak, RootStressHistory
from fe_contact.plausibility.nominal_intensities import nominal_root_stresses
from lineofaction.gearbox.convert.boundary_errors import boundary_errors
from lineofaction.gearbox.convert.case_plausibility import phrased_for
from lineofaction.gearbox.convert.checked_case import CheckedCase
from lineofaction.gearbox.schemas.flank_point import FlankPoint
from lineofaction.gearbox.studies.computation import Means, PointStudy, record_file
from lineofaction.gearbox.studies.cost import StudyCost, Work
from lineofaction.gearbox.studies.root_stress import Inputs, RootStressFigures
from model_studies import in_unit
from model_studies.result_record import ResultRecord

GEARS = ("pinion", "wheel")


@dataclass(frozen=True)
class _GearRoots:
    """The roots of one gear: their peaks, where ISO 6336-3 takes its section (m), a tooth's passage.

    `nominal` is the stress of ISO 6336-3 in Pa: method B without its load factors, of spur gears.
    """

    tension: RootPeak
    compression: RootPeak
    critical_coordinate: float = field(metadata=in_unit("m"))
    passage: RootPassage
    nominal: float | None = field(default=None, metadata=in_unit("pa"))


@brief
@dataclass(frozen=True)
class Roots(ResultRecord):
    """Tooth-root stress of both gears at one load and one alignment, in SI units."""

    pinion: _GearRoots
    wheel: _GearRoots
    torque: float = field(metadata=in_unit("n_m"))
    normal_force: float = field(metadata=in_unit("n"))
    """`torque`, `normal_force`: Torque on the driving gear, N m; normal force F_bn, N."""
    misalignment: float = field(metadata=in_unit("m"))
    center_distance_change: float = field(metadata=in_unit("m"))
    """`misalignment`, `center_distance_change`: Alignment of the gears, m."""
    receipt: Json
    warnings: list[Json]
    """Warnings in the fields and units of the case."""


class _RootStressStudy(PointStudy[RootStressFigures, Roots]):
    inputs, answer, file = Inputs, RootStressFigures, record_file(("tooth-root stress", Roots))

    def predicted(self, case: CheckedCase, _inputs: FlankPoint, cache: Path | None) -> StudyCost:
        """Return the cost of the gears, one solution with its errors, and the stresses on two meshes."""
        with boundary_errors():
            checked = case.at_point
            plan = checked.planned(cache)
            prediction = checked.predicted(plan, cache)
            stresses = Work("stresses", stress_seconds(case.pair, plan, cache), stage="root stress")
            rougher = prediction.parts["error estimate"]
        parts = (
            Work("gears", prediction.stages["compliance"], stage="compliance"),
            Work("contact", prediction.parts["contact"]["table"], stage="contact"),
            Work("coarse gears", rougher["bodies"], stage="root stress"),
            Work("its errors", rougher["solutions"], stage="root stress"),
            stresses,
        )
        return StudyCost(parts, prediction.memory_bytes)

    def compute(self, case: CheckedCase, _inputs: FlankPoint, means: Means) -> Roots:
        """Return the peaks over a mesh cycle, the passage of a tooth of each gear, receipt and warnings."""
        pair, checked = case.pair, case.at_point
        with boundary_errors():
            stress = root_stress(checked, run=means.analysis)
        helical = bool(pair.pinion.helix_angle)
        nominal = (None, None) if helical else nominal_root_stresses(pair, stress.normal_force)
        return Roots(
            _roots(stress.pinion, nominal[0]),
            _roots(stress.wheel, nominal[1]),
            stress.torque,
            stress.normal_force,
            stress.misalignment,
            stress.center_distance_change,
            stress.receipt,
            phrased_for(case.case, stress.warnings),
        )

    def figures(self, roots: Roots) -> Json:
        return super().figures(roots) | {"warnings": roots.warnings}

    def warnings(self, roots: Roots) -> list[Json]:
        return roots.warnings


def _roots(history: RootStressHistory, nominal: float | None) -> _GearRoots:
    tension, compression = (history.peak(root) for root in ROOTS)
    return _GearRoots(tension, compression, history.critical_coordinate, history.passage(), nominal)


RUN = _RootStressStudy()
