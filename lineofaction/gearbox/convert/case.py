"""Conversion of a case to a gear pair and the arguments of `fe_contact.analyze`."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import TypeVar

from bounds import inside
from bounds.types import Json
from fe_contact.allowed_error import AllowedError
from fe_contact.flank.drawing_starts import DrawingStarts
from fe_contact.geometry import (
    FlankModification,
    Gear,
    GearPair,
    InternalGearPair,
    ParallelAxes,
    PitchDeviation,
    RingGear,
    Shaft,
    Toothing,
)
from fe_contact.geometry.flank_tolerances import NO_CLEARANCE, MisalignmentRange, misalignment_range
from fe_contact.material import Material
from fe_contact.options import AnalysisOptions, OperatingPoint, TableAxes
from lineofaction.gearbox.convert.boundary_errors import boundary_errors
from lineofaction.gearbox.convert.declared import in_si, part_of
from lineofaction.gearbox.schemas.case import Case, ErrorsInput, LoadInput
from lineofaction.gearbox.schemas.flank_point import FlankPoint
from lineofaction.gearbox.schemas.gear import ToothingInput, with_flank
from lineofaction.gearbox.units import MM, NM, UM

Toothed = TypeVar("Toothed", bound=Toothing)
THICK = 10.0
"""Largest distance from bore to root, in face widths, of discs whose rounding errors need no check: they take
less than a tenth of the tolerance."""
PLANE = ("plane_strain", "plane_stress")
"""Models that a case may state, and that have no misalignment."""


def gear_pair(case: Case) -> ParallelAxes:
    """Return the gear pair of a case, an `InternalGearPair` if its wheel is a ring gear.

    Raises `BadInput`: no such pair exists; named by the case's fields, in its units.
    """
    with boundary_errors():
        pinion = _gear(Gear, "pinion", case)
        first = part_of(Shaft, case.pair.pinion.shaft, "pinion.shaft")
        shafts = (first, part_of(Shaft, case.pair.wheel.shaft, "wheel.shaft"))
        fields = in_si(GearPair, case.pair)
        if case.pair.wheel.internal:
            return InternalGearPair(pinion, _gear(RingGear, "wheel", case), shafts=shafts, **fields)
        return GearPair(pinion, _gear(Gear, "wheel", case), shafts=shafts, **fields)


def with_flanks(pair: ParallelAxes, case: Case, changes: Mapping[str, Mapping[str, object]]) -> ParallelAxes:
    """Return the pair of a case with other flanks; all else stays as it was checked.

    Raises `BadInput` as `gear_pair`.

    Parameters
    ----------
    pair : GearPair or InternalGearPair
        Gear pair of the case.
    changes : mapping
        Figures of flanks of "pinion" and "wheel" by their fields, within the bounds of these.
    """
    with boundary_errors():
        gears = {
            name: _with_flank(name, getattr(pair, name), with_flank(getattr(case.pair, name), figures))
            for name, figures in changes.items()
            if figures
        }
        return replace(pair, **gears) if gears else pair


def _with_flank(name: str, gear: Toothed, figures: ToothingInput) -> Toothed:
    """Return a gear of the pair with the modification that its table states."""

    def plain() -> Toothed:
        return replace(gear, modification=FlankModification())

    with inside(name):
        return replace(gear, modification=_modification(figures, plain))


def _gear(kind: type[Toothed], name: str, case: Case) -> Toothed:
    """One gear of the pair; mating external ones have opposite hands."""
    gear: ToothingInput = getattr(case.pair, name)
    hand = -kind.sign if name == "wheel" else 1
    with inside(name):
        fields = in_si(kind, gear, case.pair)
        fields |= {
            "helix_angle": hand * fields["helix_angle"] + 0.0,  # -0.0 becomes 0.0
            "material": Material(**in_si(Material, gear.material or case.material)),
            "pitch_deviation": _pitch_deviation(gear),
        }
        return kind(**fields, modification=_modification(gear, lambda: kind(**fields)))


def _modification(gear: ToothingInput, plain: Callable[[], Toothing]) -> FlankModification:
    """Return the modification of a gear; `plain` makes the gear without it."""
    fields, starts = in_si(FlankModification, gear), DrawingStarts(**in_si(DrawingStarts, gear))
    return FlankModification(**fields | starts.lengths(fields, plain))


def _pitch_deviation(gear: ToothingInput) -> PitchDeviation:
    """Return the deviations that a gear states as cumulative or as single ones."""
    if gear.single_pitch_deviation_um:
        return PitchDeviation.of_single_pitches([value * UM for value in gear.single_pitch_deviation_um])
    return PitchDeviation(tuple(value * UM for value in gear.pitch_deviation_um))


def table_axes(case: Case) -> TableAxes:
    """Return the axes of the table of a case, in SI."""
    load, errors, allowed = case.load, case.errors, allowed_misalignment(case)
    with boundary_errors():
        return TableAxes(
            load.torque_n_m,
            load.normal_force_n,
            tuple(value * UM for value in errors.misalignment_um) if allowed is None else allowed.axis,
            tuple(value * MM for value in errors.center_distance_change_mm),
            case.accuracy.pitches,
        )


def allowed_misalignment(case: Case) -> MisalignmentRange | None:
    """Return the range that a class allows; None where the case states its misalignments.

    Raises `BadInput`: no such pair exists, or it is beyond the standards.
    """
    errors = case.errors
    if errors.misalignment_class is None:
        return None
    first, second = errors.bearing_clearance_um or NO_CLEARANCE
    pair = gear_pair(case)
    with boundary_errors():
        return misalignment_range(pair, errors.misalignment_class, (first * UM, second * UM))


def analysis_options(case: Case) -> AnalysisOptions:
    """Return accuracy, model and effects of a case, in SI."""
    accuracy = case.accuracy
    with boundary_errors():
        relative, floor = accuracy.tolerance, accuracy.tolerance_floor_nm * NM
        allowed = None if relative is None else AllowedError(relative, floor)
        converted = {"tolerance": allowed, "effects": dict(case.effects)}
        return AnalysisOptions(**in_si(AnalysisOptions, accuracy) | converted)


def study_options(options: AnalysisOptions) -> AnalysisOptions:
    """Return the options of a case for a study, which measures its errors and repeats passes."""
    return replace(options, receipt="full", on_violation="repeat")


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
    misalignment, change = point.misalignment_um, point.center_distance_change_mm
    alignment = ErrorsInput(
        misalignment_um=(min(errors.misalignment_um, key=abs) if misalignment is None else misalignment,),
        center_distance_change_mm=(
            min(errors.center_distance_change_mm, key=abs) if change is None else change,
        ),
    )
    accuracy = case.accuracy.model_copy(update={"positions": None})  # flank results have their own 64
    return case.model_copy(update={"load": load, "errors": alignment, "accuracy": accuracy})


def operating_point(case: Case) -> OperatingPoint:
    """Return the first load and the first alignment of a case, in SI."""
    load, errors = case.load, case.errors
    return OperatingPoint(
        None if load.torque_n_m is None else load.torque_n_m[0],
        None if load.normal_force_n is None else load.normal_force_n[0],
        errors.misalignment_um[0] * UM,
        errors.center_distance_change_mm[0] * MM,
    )


def case_json(case: Case) -> Json:
    """Return the case with all defaults as JSON, which is hashed and echoed."""
    return case.model_dump(mode="json")


def case_as_filed(case: Case) -> Json:
    """Return the case with its title block, as in a file; no result depends on the title block."""
    block = {} if case.report is None else {"report": case.report.model_dump(mode="json")}
    return case_json(case) | block
