"""From a case to a gear pair and the arguments of `fe_contact.analyze`."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import fields, replace
from typing import Any

from bounds import inside
from fe_contact.allowed_error import AllowedError
from fe_contact.body.parts import PARTS
from fe_contact.errors import FeContactError
from fe_contact.geometry import (
    FlankGrid,
    FlankModification,
    Gear,
    GearPair,
    InternalGearPair,
    ParallelAxes,
    PitchDeviation,
    RingGear,
    Shaft,
)
from fe_contact.material import Material
from fe_contact.options import AnalysisOptions, OperatingPoint, TableAxes
from service.convert.declared import declared_part, in_si, parts_in_si
from service.convert.errors import translated
from service.problems import BadInput
from service.schemas import (
    AccuracyInput,
    Case,
    ErrorsInput,
    LoadInput,
    MaterialInput,
    PairInput,
    ToothingInput,
    WheelInput,
)
from service.schemas.flank import FlankPoint
from service.units import DEGREE, MM, NM, UM

Json = dict[str, Any]

_COEFFICIENTS = (
    "profile_shift_coefficient",
    "addendum_coefficient",
    "dedendum_coefficient",
    "root_radius_coefficient",
)


def gear_pair(case: Case) -> ParallelAxes:
    """Return the gear pair of a case, an `InternalGearPair` if its wheel is a ring gear.

    Raises
    ------
    BadInput
        No such pair exists; named by the case's fields, in its units.
    """
    with boundary_errors():
        pinion = _gear("pinion", case.pair, case.material, +1.0)
        shafts = (_shaft("pinion", case.pair.pinion), _shaft("wheel", case.pair.wheel))
        distance = case.pair.center_distance_mm * MM
        if case.pair.wheel.internal:
            return InternalGearPair(pinion, _ring_gear(case.pair, case.material), distance, shafts=shafts)
        return GearPair(pinion, _gear("wheel", case.pair, case.material, -1.0), distance, shafts=shafts)


@contextmanager
def boundary_errors(prefix: str = "") -> Iterator[None]:
    """Turn errors of the libraries into the boundary's."""
    try:
        yield
    except FeContactError as error:
        known = translated(error)
        if isinstance(known, BadInput) and prefix:
            known = known.within(prefix)
        raise known or error from None


def _gear(name: str, pair: PairInput, material: MaterialInput, hand: float) -> Gear:
    """One external gear of the pair; mating ones have opposite hands."""
    gear = getattr(pair, name)
    with inside(name):
        return Gear(
            bore_diameter=gear.bore_diameter_mm * MM,
            **_parts(Gear, gear),
            **_toothing(gear, pair, material, hand),
        )


def _ring_gear(pair: PairInput, material: MaterialInput) -> RingGear:
    """Return the wheel as a ring gear, which has the hand of its pinion."""
    wheel: WheelInput = pair.wheel
    with inside("wheel"):
        return RingGear(
            rim_diameter=(wheel.rim_diameter_mm or 0.0) * MM,
            cutter_teeth=wheel.cutter_teeth or 0,
            cutter_profile_shift_coefficient=wheel.cutter_profile_shift_coefficient or 0.0,
            **_parts(RingGear, wheel),
            **_toothing(wheel, pair, material, +1.0),
        )


def _parts(kind: type, gear: ToothingInput) -> Json:
    """Return the parts of a gear's body that gears of its kind have."""
    own = {entry.name for entry in fields(kind)}
    return parts_in_si({name: fact for name, fact in PARTS.items() if name in own}, gear)


def _toothing(toothing: ToothingInput, pair: PairInput, material: MaterialInput, hand: float) -> Json:
    """Fields that external gears and ring gears share."""
    tip = toothing.tip_diameter_mm
    return {
        "teeth": toothing.teeth,
        "normal_module": pair.normal_module_mm * MM,
        "face_width": toothing.face_width_mm * MM,
        "normal_pressure_angle": pair.normal_pressure_angle_deg * DEGREE,
        "helix_angle": hand * pair.helix_angle_deg * DEGREE if pair.helix_angle_deg else 0.0,
        "tip_diameter": None if tip is None else tip * MM,
        "thickness_allowance": toothing.thickness_allowance_um * UM,
        "modification": _modification(toothing),
        "material": Material(**in_si(Material, toothing.material or material)),
        "pitch_deviation": PitchDeviation(tuple(value * UM for value in toothing.pitch_deviation_um)),
        **{coefficient: getattr(toothing, coefficient) for coefficient in _COEFFICIENTS},
    }


def _shaft(name: str, gear: ToothingInput) -> Shaft | None:
    """Return the shaft of a gear, None for a rigid one."""
    return declared_part(Shaft, gear.shaft, f"{name}.shaft")


def _modification(toothing: ToothingInput) -> FlankModification:
    """Return the flank modification of a gear."""
    return FlankModification(**in_si(FlankModification, toothing), flank_grid=_flank_grid(toothing))


def _flank_grid(toothing: ToothingInput) -> FlankGrid | None:
    """Return the free-form flank of a gear, None if it has none."""
    grid = toothing.flank_grid
    if grid is None:
        return None
    with inside("flank_grid"):
        return FlankGrid(
            roll_length=tuple(value * MM for value in grid.roll_length_mm),
            face_position=tuple(value * MM for value in grid.face_position_mm),
            removed=tuple(tuple(value * UM for value in row) for row in grid.removed_um),
        )


def table_axes(case: Case) -> TableAxes:
    """Return what the table of a case is computed over, in SI."""
    load, errors = case.load, case.errors
    with boundary_errors():
        return TableAxes(
            load.torque_n_m,
            load.normal_force_n,
            tuple(value * UM for value in errors.misalignment_um),
            tuple(value * MM for value in errors.center_distance_change_mm),
            case.accuracy.pitches,
        )


def analysis_options(case: Case) -> AnalysisOptions:
    """Return accuracy, model and effects of a case, in SI."""
    accuracy = case.accuracy
    with boundary_errors():
        return AnalysisOptions(
            tolerance=_allowed(accuracy),
            time_budget=accuracy.time_budget_s,
            level=accuracy.level,
            model=accuracy.model,
            positions=accuracy.positions,
            effects=dict(case.effects),
            receipt=accuracy.receipt,
            on_violation=accuracy.on_violation,
        )


def study_options(case: Case) -> AnalysisOptions:
    """Return the options of a case for a study, which measures its errors and repeats what it must."""
    return replace(analysis_options(case), receipt="full", on_violation="repeat")


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


def operating_point(case: Case) -> OperatingPoint:
    """Return the first load and the first alignment of a case, in SI."""
    load, errors = case.load, case.errors
    return OperatingPoint(
        None if load.torque_n_m is None else load.torque_n_m[0],
        None if load.normal_force_n is None else load.normal_force_n[0],
        errors.misalignment_um[0] * UM,
        errors.center_distance_change_mm[0] * MM,
    )


def _allowed(accuracy: AccuracyInput) -> AllowedError | None:
    """Return the tolerance requested."""
    if accuracy.tolerance is None:
        return None
    return AllowedError(accuracy.tolerance, accuracy.tolerance_floor_nm * NM)


def case_json(case: Case) -> Json:
    """Return the case with all defaults, as JSON: what is hashed and echoed."""
    return case.model_dump(mode="json")
