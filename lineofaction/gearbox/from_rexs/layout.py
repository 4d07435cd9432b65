"""The layout of a gear unit: positions of its shafts by the file, else by its stages and couplings.

A placement is an origin with axes u, v, w; u is the axis of rotation. Shafts and rotors are named by the
integer ids of the file. The account states what the import derives, assumes or leaves out.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from bounds.types import FloatArray
from lineofaction.gearbox.from_rexs.gear_unit import Connection, GearStage, GearUnit, Part, PlanetarySet
from lineofaction.gearbox.from_rexs.placed_shafts import SAME_POSITION, PlacedShaft
from lineofaction.gearbox.from_rexs.placement import FIXED, Placement
from lineofaction.gearbox.from_rexs.rotors import Rotors, rotors_of
from lineofaction.gearbox.from_rexs.scene_axes import SceneAxes

_ANGLE = "rotating_angle_around_neg_u_axis"
_TOLERANCE = 1e2 * SAME_POSITION
"""Distance, m, between two statements of a position that is not worth a remark."""


@dataclass(frozen=True)
class Layout:
    """Axes, shafts, rotors and stages of a gear unit in the frame of its scene."""

    unit: GearUnit
    axes: SceneAxes
    """The frame of the scene."""
    shafts: Mapping[int, PlacedShaft]
    """The shafts parallel to z, by id."""
    rotors: Rotors
    """Sets of shafts that turn as one."""
    stages: tuple[GearStage, ...]
    """Stages with two gears on different rotors."""

    @classmethod
    def of(cls, unit: GearUnit) -> Layout:
        """Return the layout; the account says what is left out."""
        stages, sets = unit.stages, unit.planetary_sets
        placements = _shaft_places(unit, stages, sets)
        root = next(iter(unit.of_type("gear_unit")), None)
        first = [shaft.id for stage in stages if stage.is_cylindrical for shaft in stage.shafts]
        lines = [placements[shaft] for shaft in (*first, *placements) if shaft in placements]
        axes = SceneAxes.of(None if root is None else Placement.of(root), lines)
        shafts = {}
        for part in unit.of_type("shaft"):
            placement = placements.get(part.id)
            if placement is None:
                continue
            if axes.sense(placement) == 0:
                text = "not parallel to the shafts of the first stage: left out of the scene"
                part.say("", "refused", text)
                continue
            shafts[part.id] = PlacedShaft.of(part, placement, axes)
        rotors = rotors_of(unit, sets)
        turning = tuple(s for s in stages if len({rotors.of[shaft.id] for shaft in s.shafts}) == 2)
        return cls(unit, axes, shafts, rotors, turning)

    def sense(self, shaft: int) -> int:
        """Return +1 for u of a shaft along z, -1 for u against z; +1 for a shaft not parallel to z."""
        return self.shafts[shaft].sense if shaft in self.shafts else 1

    def rotation(self, part: Part, rotor_side: Part) -> FloatArray:
        """Return the matrix from u, v, w of a part to x, y, z; by default with the axes of its shaft."""
        return self.axes.rotation(Placement.of(part) or self.shafts[rotor_side.id].placement)

    def rotor(self, shaft: int) -> int:
        """Return the rotor of a shaft."""
        return self.rotors.of[shaft]

    def carrier(self, stage: GearStage) -> int | None:
        """Return the rotor of the carrier that a stage runs on, None for the ground."""
        return self.rotors.carrier_of(*(shaft.id for shaft in stage.shafts))

    def joined(self, stage: GearStage) -> set[int]:
        """Return the rotors that a stage joins: its shafts', and the carrier that it runs on."""
        rotors = {self.rotor(shaft.id) for shaft in stage.shafts}
        carrier = self.carrier(stage)
        return rotors if carrier is None else rotors | {carrier}

    def is_computed(self, stage: GearStage) -> bool:
        """Return whether a stage has parallel axes, and so a case."""
        return stage.is_cylindrical and all(shaft.id in self.shafts for shaft in stage.shafts)

    def u_on(self, shaft: PlacedShaft, part: Part, item: str = "u_coordinate_on_shaft") -> float:
        """Return the coordinate of a part along a shaft, m: by its placement, else as stated, else 0."""
        placement = Placement.of(part)
        coordinate = part.number(item, "place along the shaft, mm")
        if placement is None:
            if coordinate is None:
                part.say(item, "defaulted", "0 mm: the file gives no place")
            return coordinate or 0.0
        u = shaft.placement.along(placement.origin)
        if coordinate is not None and not math.isclose(coordinate, u, abs_tol=_TOLERANCE):
            taken = f"its place (support_vector) is at {u * 1e3:.6g} mm, which is taken"
            part.say(item, "ignored", f"{coordinate * 1e3:.6g} mm; {taken}")
        off_axis = shaft.off_axis(placement.origin)
        if off_axis > _TOLERANCE:
            text = f"{off_axis * 1e3:.4g} mm off the axis of its shaft; taken along the axis alone"
            part.say("support_vector", "refused", text)
        return u

    def z_on(self, shaft: PlacedShaft, part: Part, item: str = "u_coordinate_on_shaft") -> float:
        """Return z of a part on a shaft in the scene, m: see `u_on`."""
        return float(shaft.start[2]) + shaft.sense * self.u_on(shaft, part, item)


def _shaft_places(
    unit: GearUnit, stages: Sequence[GearStage], sets: Sequence[PlanetarySet]
) -> dict[int, Placement]:
    """Return the placements of the shafts by their ids; shafts whose placement is not known are left out.

    A shaft without a placement in the file follows from one that has it. The other shaft of a stage is at the
    center distance, in the direction w turned about -u by the stage's angle, with the gears face to face. A
    coupling joins coaxial shafts. If the file places no shaft, the first shaft of the first stage is the
    origin. The shaft of a carrier that follows from none of these has the placement of a central shaft of its
    planetary set.
    """
    shafts = unit.of_type("shaft")
    placements = {shaft.id: placement for shaft in shafts if (placement := Placement.of(shaft)) is not None}
    if not placements and stages:
        first = stages[0].shafts[0]
        placements[first.id] = FIXED
        first.say("support_vector", "defaulted", "no shaft has a place; the first is the origin")
    _spread(unit, stages, placements)
    for planets in sets:
        pins = {pin.id for pin in planets.pins}
        for shaft in planets.carrier:
            base = next((placements[part.id] for part in planets.central if part.id in placements), None)
            if shaft.type == "shaft" and base is not None and shaft.id not in {*placements, *pins}:
                placements[shaft.id] = base
                text = "on the axis of the central shafts, its begin at theirs"
                shaft.say("support_vector", "defaulted", text)
    _spread(unit, stages, placements)
    for shaft in shafts:
        if shaft.id not in placements:
            shaft.say("", "refused", "neither a place, a stage nor a coupling says where it stands")
    return placements


def _spread(unit: GearUnit, stages: Sequence[GearStage], placements: dict[int, Placement]) -> None:
    """Add the placements that follow from known ones by stages, couplings and bearings, until none does."""
    connections = (*unit.couplings, *unit.bearings)
    while True:
        before = len(placements)
        for stage in stages:
            _by_stage(stage, placements)
        for entry in connections:
            _by_coupling(entry, placements)
        if len(placements) == before:
            return


def _by_stage(stage: GearStage, placements: dict[int, Placement]) -> None:
    """Add the placement of a shaft of a cylindrical stage if that of the other shaft alone is known."""
    known = [shaft.id in placements for shaft in stage.shafts]
    if not stage.is_cylindrical or known[0] == known[1]:
        return
    center_distance = stage.stage.number("center_distance", "center distance of the stage, mm")
    if center_distance is None:
        return
    angle = stage.stage.number(_ANGLE, "direction from gear 1 to gear 2, deg", 0.0, "0 deg")
    sign = 1.0 if known[0] else -1.0  # from the first shaft to the second, or back
    base, new = stage.shafts if known[0] else stage.shafts[::-1]
    u, v, w = placements[base.id].axes
    across = sign * center_distance * (math.sin(angle) * v + math.cos(angle) * w)
    ends = [_u(gear, "u_coordinate_on_shaft") for gear in stage.gears]
    offset = across + sign * (ends[0] - ends[1]) * u
    _add_shaft(new, base, offset, f"center distance and {_ANGLE} of component {stage.stage.id}", placements)


def _by_coupling(coupling: Connection, placements: dict[int, Placement]) -> None:
    """Add the placement of a shaft of a coupling or bearing if that of the other shaft alone is known."""
    sides = (coupling.inner, coupling.outer)
    known = [side.id in placements for side in sides]
    if known[0] == known[1] or any(side.type != "shaft" for side in sides):
        return
    base, new = sides if known[0] else sides[::-1]
    inner, outer = (_u(coupling.part, f"u_coordinate_on_shaft_{side}_side") for side in ("inner", "outer"))
    offset = (1.0 if known[0] else -1.0) * (inner - outer) * placements[base.id].u
    _add_shaft(new, base, offset, f"coaxial: component {coupling.part.id}", placements)


def _u(part: Part, item: str) -> float:
    return part.number(item, "place along the shaft, mm") or 0.0


def _add_shaft(
    shaft: Part, base: Part, offset: FloatArray, text: str, placements: dict[int, Placement]
) -> None:
    base_placement = placements[base.id]
    placements[shaft.id] = Placement(np.asarray(base_placement.origin + offset), base_placement.axes)
    shaft.say("support_vector", "derived", text)
