"""From a case to a gear pair and the arguments of `fe_contact.analyze`."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Any, TypeVar

from bounds import inside
from fe_contact.allowed_error import AllowedError
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
    Toothing,
)
from fe_contact.material import Material
from fe_contact.options import AnalysisOptions, OperatingPoint, TableAxes
from lineofaction.gearbox.convert.declared import declared_part, in_si
from lineofaction.gearbox.convert.errors import translated
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas import (
    AccuracyInput,
    Case,
    ErrorsInput,
    LoadInput,
    ToothingInput,
)
from lineofaction.gearbox.schemas.flank import FlankPoint
from lineofaction.gearbox.units import MM, NM, UM

Json = dict[str, Any]

Toothed = TypeVar("Toothed", bound=Toothing)


def gear_pair(case: Case) -> ParallelAxes:
    """Return the gear pair of a case, an `InternalGearPair` if its wheel is a ring gear.

    Raises
    ------
    BadInput
        No such pair exists; named by the case's fields, in its units.
    """
    with boundary_errors():
        pinion = _gear(Gear, "pinion", case)
        shafts = (_shaft("pinion", case.pair.pinion), _shaft("wheel", case.pair.wheel))
        facts = in_si(GearPair, case.pair)
        if case.pair.wheel.internal:
            return InternalGearPair(pinion, _gear(RingGear, "wheel", case), shafts=shafts, **facts)
        return GearPair(pinion, _gear(Gear, "wheel", case), shafts=shafts, **facts)


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


def _gear(kind: type[Toothed], name: str, case: Case) -> Toothed:
    """One gear of the pair; mating external ones have opposite hands."""
    gear: ToothingInput = getattr(case.pair, name)
    hand = -kind.sign if name == "wheel" else 1
    with inside(name):
        facts = in_si(kind, gear, case.pair)
        return kind(
            **facts | {"helix_angle": hand * facts["helix_angle"] + 0.0},  # -0.0 becomes 0.0
            modification=_modification(gear),
            material=Material(**in_si(Material, gear.material or case.material)),
            pitch_deviation=PitchDeviation(tuple(value * UM for value in gear.pitch_deviation_um)),
        )


def _shaft(name: str, gear: ToothingInput) -> Shaft | None:
    """Return the shaft of a gear, None for a rigid one."""
    return declared_part(Shaft, gear.shaft, f"{name}.shaft")


def _modification(toothing: ToothingInput) -> FlankModification:
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
