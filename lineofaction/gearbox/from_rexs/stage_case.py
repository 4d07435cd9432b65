"""The cases of the stages of a gear unit."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import TypeVar

import numpy as np

from bounds.types import FloatArray
from lineofaction.gearbox.from_rexs.assumptions import mend
from lineofaction.gearbox.from_rexs.case_table import case_of
from lineofaction.gearbox.from_rexs.gear_unit import GearStage, GearUnit, Part
from lineofaction.gearbox.from_rexs.loaded_flank import LoadedFlank
from lineofaction.gearbox.from_rexs.meshing import OTHER_STAGES, STAGES, Meshing
from lineofaction.gearbox.from_rexs.placement import frame_of
from lineofaction.gearbox.from_rexs.profile_shifts import ToothedPair, derived_shifts
from lineofaction.gearbox.from_rexs.toothing import ToothingData
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas import Case
from lineofaction.gearbox.units import MM

T = TypeVar("T")
_LONGEST_NAME = 60


@dataclass(frozen=True)
class StageCase:
    """The case of a cylindrical stage."""

    stage: int
    """Id of the stage."""
    name: str
    """Name for a file: small letters, digits and underscores, unlike those of the unit's other cases."""
    case: Case
    """Case of the stage. Its pinion is the driver, unless the ring gear drives."""
    driver: int
    driven: int
    """`driver`, `driven`: Ids of the gears."""
    wheel_drives: bool
    """Whether the case's wheel, a ring gear, drives."""
    center_distance: float
    """Center distance, m."""
    equal: tuple[int, ...] = ()
    """Ids of further stages with the same case, the stages of the other planets."""

    def driving(self, stage: GearStage) -> tuple[Part, Part]:
        """Return driver and driven gear of a stage, which may be the stage of an equal planet."""
        first, second = stage.gears
        # the stage of an equal planet has another planet gear: then the gear that both stages share tells
        if self.driver == second.id or (self.driven == first.id and self.driver != first.id):
            return second, first
        return first, second

    @staticmethod
    def all_of(
        unit: GearUnit, torques: Mapping[int, tuple[float, ...]], drivers: Mapping[int, int] | None = None
    ) -> tuple[StageCase, ...]:
        """Return a case for each cylindrical stage; stages with equal cases, as of planets, share the first.

        Bevel and worm stages have no case, nor has a stage that cannot be computed; the account gives the
        reason.

        Parameters
        ----------
        torques : mapping of int to tuple of float
            Torques of the shaft on the driving gear about that gear's u axis, by id of the stage, N m. All
            have the sign of the gear's rotation. A stage without torques gets three load levels, and the
            account says so.
        drivers : mapping of int to int, optional
            Id of the driving gear by stage. Default: the gear that the file marks, or else gear 1.
        """
        for stage in unit.of_type(*OTHER_STAGES):
            stage.say("", "refused", "no cylindrical stage: its loads stand in its place")
        pairs: list[ToothedPair] = []
        for stage in unit.of_type(*STAGES):
            driver = (drivers or {}).get(stage.id)
            pair = _attempt(stage, partial(_pair, stage, torques.get(stage.id, ()), driver))
            pairs += [] if pair is None else [pair]
        shifts = derived_shifts(pairs)
        cases: list[StageCase] = []
        for pair in pairs:
            case = _attempt(pair.stage, partial(case_of, pair, pairs, shifts))
            if case is not None:
                _enter(cases, pair, case)
        return tuple(cases)


def _attempt(stage: Part, make: Callable[[], T]) -> T | None:
    """Return the value of `make` for a stage, None: it is refused, with a line in the account."""
    try:
        return make()
    except BadInput as error:
        stage.say("", "refused", f"no case: {error}{mend(error)}")
        return None


def _pair(stage: Part, torques: tuple[float, ...], driver: int | None) -> ToothedPair:
    meshing = Meshing.of(stage, driver, torques)
    loaded = [LoadedFlank.of(meshing, gear) for gear in (meshing.pinion, meshing.wheel)]
    gears = [ToothingData.of(flank) for flank in loaded]
    center_vector = frame_of(meshing.wheel).origin - frame_of(meshing.pinion).origin
    offset = float(center_vector @ meshing.z)
    distance = _center_distance(stage, center_vector - offset * meshing.z)
    pair = ToothedPair(meshing, gears[0], gears[1], distance, offset, torques)
    _ = pair.working_pressure_angle  # raises if there is none
    return pair


def _center_distance(stage: Part, across: FloatArray) -> float:
    """Return the center distance in m: the stage's own, else the distance of the gears' axes."""
    value = stage.number("center_distance", "center_distance_mm")
    if value:
        return abs(value)
    distance = float(np.linalg.norm(across))
    if not distance > 0.0:
        raise stage.refusal("center_distance", value, "given, or gears on axes apart")
    stage.say("center_distance", "derived", f"{distance / MM:.7g} mm, the distance of the gears' axes")
    return distance


def _enter(cases: list[StageCase], pair: ToothedPair, case: Case) -> None:
    """Enter a case, or add the stage to an equal case of the same planetary stage."""
    meshing, stage = pair.meshing, pair.stage
    for index, present in enumerate(cases):
        shared = {present.driver, present.driven} & {meshing.driver.id, meshing.driven.id}
        if present.case == case and present.wheel_drives == meshing.wheel_drives and shared:
            stage.say("", "derived", f"its case is that of stage {present.stage}: the planets are equal")
            cases[index] = replace(present, equal=(*present.equal, stage.id))
            return
    plain = unicodedata.normalize("NFKD", stage.name).encode("ascii", "ignore").decode().lower()
    name = re.sub(r"[^a-z0-9]+", "_", plain).strip("_")[:_LONGEST_NAME] or f"stage_{stage.id}"
    name += f"_{stage.id}" if name in {present.name for present in cases} else ""
    stage.say("", "taken", f"case {name}")
    distance, gears = pair.center_distance, (meshing.driver.id, meshing.driven.id)
    cases.append(StageCase(stage.id, name, case, *gears, meshing.wheel_drives, distance))
