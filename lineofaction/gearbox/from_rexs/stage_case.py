"""The cases of a gear unit: one for each of its cylindrical stages."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import TypeVar

import numpy as np

from lineofaction.gearbox.from_rexs.assumption import mend
from lineofaction.gearbox.from_rexs.case_table import PairData, case_of
from lineofaction.gearbox.from_rexs.flank_sides import loaded_flank
from lineofaction.gearbox.from_rexs.gear_unit import GearUnit
from lineofaction.gearbox.from_rexs.meshing import OTHER_STAGES, STAGES, Meshing, meshing_of
from lineofaction.gearbox.from_rexs.part import Part
from lineofaction.gearbox.from_rexs.placement import frame_of
from lineofaction.gearbox.from_rexs.profile_shift import ToothedPair, derived_shifts
from lineofaction.gearbox.from_rexs.toothing import toothing_of
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas import Case
from lineofaction.gearbox.units import MM

# Center distance and axial offset of a stage.


def _center_distance_of(unit: GearUnit, stage: Part, meshing: Meshing) -> float:
    """Return the center distance in m: the stage's own, else the distance of the gears' axes.

    Raises
    ------
    BadInput
        Neither is above zero.
    """
    value = stage.number("center_distance", "center_distance_mm")
    if value:
        return abs(value)
    apart = _apart(unit, meshing)
    distance = float(np.linalg.norm(apart - (apart @ meshing.z) * meshing.z))
    if not distance > 0.0:
        raise BadInput.of(f"{stage.place}, center_distance", value, "given, or gears on axes apart")
    stage.say("center_distance", "derived", f"{distance / MM:.7g} mm, the distance of the gears' axes")
    return distance


def _axial_offset_of(unit: GearUnit, meshing: Meshing) -> float:
    return float(_apart(unit, meshing) @ meshing.z)


def _apart(unit: GearUnit, meshing: Meshing) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    """Return the way from the pinion's middle to the wheel's, m."""
    return frame_of(unit, meshing.wheel).origin - frame_of(unit, meshing.pinion).origin


T = TypeVar("T")
_LONGEST_NAME = 60


@dataclass(frozen=True)
class StageCase:
    """The case of a cylindrical stage.

    Attributes
    ----------
    stage : int
        Id of the stage.
    name : str
        Name for a file: small letters, digits and underscores, unlike those of the unit's other cases.
    case : Case
        Its pinion is the driver, unless the ring gear drives.
    driver, driven : int
        Ids of the gears.
    wheel_drives : bool
        Whether the case's wheel, a ring gear, drives.
    center_distance : float
        m.
    equal : tuple of int
        Ids of further stages with the same case: those of the other planets.
    """

    stage: int
    name: str
    case: Case
    driver: int
    driven: int
    wheel_drives: bool
    center_distance: float
    equal: tuple[int, ...] = ()


def stage_cases(
    unit: GearUnit, torques: Mapping[int, tuple[float, ...]], drivers: Mapping[int, int] | None = None
) -> tuple[StageCase, ...]:
    """Return a case for each cylindrical stage; of stages with equal cases, as of planets, the first.

    A stage that cannot be computed has no case, and the account has the reason; so have bevel and worm
    stages.

    Parameters
    ----------
    unit : GearUnit
    torques : mapping of int to tuple of float
        By id of the stage: torques of its shaft on the driving gear about that gear's u axis, N m, all of the
        sign of its sense of rotation. A stage without gets three load levels, which the account states.
    drivers : mapping of int to int, optional
        The driving gear by stage; else as the file marks it, else gear 1 of the stage.
    """
    for stage in unit.of_type(*OTHER_STAGES):
        stage.say("", "refused", "no cylindrical stage: its loads stand in its place")
    pairs = list(_pairs(unit, torques, drivers or {}))
    shifts = derived_shifts([pair.toothed for pair in pairs])
    cases: list[StageCase] = []
    for pair in pairs:
        case = _attempt(pair.toothed.stage, partial(case_of, unit, pair, pairs, shifts))
        if case is not None:
            _enter(cases, pair, case)
    return tuple(cases)


def _pairs(
    unit: GearUnit, torques: Mapping[int, tuple[float, ...]], drivers: Mapping[int, int]
) -> Iterator[PairData]:
    """Yield the pairs of the cylindrical stages that are not refused."""
    for stage in unit.of_type(*STAGES):
        make = partial(_pair, unit, stage, torques.get(stage.id, ()), drivers.get(stage.id))
        pair = _attempt(stage, make)
        if pair is not None:
            yield pair


def _attempt(stage: Part, make: Callable[[], T]) -> T | None:
    """Return what is made of a stage, None if it is refused, which the account says."""
    try:
        return make()
    except BadInput as error:
        stage.say("", "refused", f"no case: {error}{mend(error)}")
        return None


def _pair(unit: GearUnit, stage: Part, torques: tuple[float, ...], driver: int | None) -> PairData:
    """Return what the file says of a stage's gears; raises `BadInput`."""
    meshing = meshing_of(unit, stage, driver, torques)
    loaded = (loaded_flank(unit, meshing, meshing.pinion), loaded_flank(unit, meshing, meshing.wheel))
    gears = (toothing_of(meshing.pinion, loaded[0]), toothing_of(meshing.wheel, loaded[1]))
    toothed = ToothedPair(stage, *gears, _center_distance_of(unit, stage, meshing))
    _ = toothed.working_pressure_angle  # raises if there is none
    return PairData(meshing, toothed, loaded, _axial_offset_of(unit, meshing), torques)


def _enter(cases: list[StageCase], pair: PairData, case: Case) -> None:
    """Enter a case, or the stage beside an equal case of the same planetary stage."""
    meshing, stage = pair.meshing, pair.toothed.stage
    for index, present in enumerate(cases):
        shared = {present.driver, present.driven} & {meshing.driver.id, meshing.driven.id}
        if present.case == case and present.wheel_drives == meshing.wheel_drives and shared:
            stage.say("", "derived", f"its case is that of stage {present.stage}: the planets are equal")
            cases[index] = replace(present, equal=(*present.equal, stage.id))
            return
    name = _name(stage, {present.name for present in cases})
    stage.say("", "taken", f"case {name}")
    distance, gears = pair.toothed.center_distance, (meshing.driver.id, meshing.driven.id)
    cases.append(StageCase(stage.id, name, case, *gears, meshing.wheel_drives, distance))


def _name(stage: Part, taken: set[str]) -> str:
    """Return a name for a file: the stage's in plain letters, with its id if another has it."""
    plain = unicodedata.normalize("NFKD", stage.name).encode("ascii", "ignore").decode().lower()
    name = re.sub(r"[^a-z0-9]+", "_", plain).strip("_")[:_LONGEST_NAME] or f"stage_{stage.id}"
    return name if name not in taken else f"{name}_{stage.id}"
