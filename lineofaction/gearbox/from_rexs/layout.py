"""The layout of a gear unit: its shafts along the axes of the scene, its stages, what turns together."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from lineofaction.gearbox.from_rexs.gear_stages import GearStage, gear_stages
from lineofaction.gearbox.from_rexs.gear_unit import GearUnit
from lineofaction.gearbox.from_rexs.part import Part
from lineofaction.gearbox.from_rexs.placement import Placement, placement
from lineofaction.gearbox.from_rexs.planetary_set import planetary_sets
from lineofaction.gearbox.from_rexs.rotors import Rotors, rotors_of
from lineofaction.gearbox.from_rexs.scene_axes import SceneAxes, scene_axes
from lineofaction.gearbox.from_rexs.shaft_places import shaft_places
from lineofaction.gearbox.from_rexs.shafts import SAME_PLACE, PlacedShaft, placed_shaft


@dataclass(frozen=True)
class Layout:
    """Where everything is.

    Attributes
    ----------
    unit : GearUnit
        The components.
    axes : SceneAxes
        The frame of the scene.
    shafts : mapping of int to PlacedShaft
        The shafts parallel to z, by id.
    rotors : Rotors
        What turns together.
    stages : tuple of GearStage
        All stages with two gears.
    """

    unit: GearUnit
    axes: SceneAxes
    shafts: Mapping[int, PlacedShaft]
    rotors: Rotors
    stages: tuple[GearStage, ...]

    def sense(self, shaft: int) -> int:
        """Return +1 or -1 for u along z or against it; +1 of shafts that are not parallel."""
        return self.shafts[shaft].sense if shaft in self.shafts else 1

    def rotor(self, shaft: int) -> int:
        """Return the rotor of a shaft."""
        return self.rotors.of[shaft]

    def carrier(self, stage: GearStage) -> int | None:
        """Return the rotor of the carrier that a stage runs on, None for the ground."""
        return self.rotors.carrier_of(*(shaft.id for shaft in stage.shafts))

    def is_computed(self, stage: GearStage) -> bool:
        """Return whether a stage has parallel axes, and so a case."""
        return stage.is_cylindrical and all(shaft.id in self.shafts for shaft in stage.shafts)

    def u_on(self, shaft: PlacedShaft, part: Part, item: str = "u_coordinate_on_shaft") -> float:
        """Return u of a part on a shaft, m: by its place, else by its coordinate, else 0."""
        place = placement(self.unit, part)
        stated = part.number(item, "place along the shaft, mm")
        if place is None:
            if stated is None:
                part.say(item, "defaulted", "0 mm: the file gives no place")
            return stated or 0.0
        u = shaft.along(place.origin)
        _compare(part, item, stated, u, shaft.off_axis(place.origin))
        return u

    def z_on(self, shaft: PlacedShaft, part: Part, item: str = "u_coordinate_on_shaft") -> float:
        """Return z of a part on a shaft in the scene, m: see `u_on`."""
        return float(shaft.start[2]) + shaft.sense * self.u_on(shaft, part, item)


def _compare(part: Part, item: str, stated: float | None, u: float, off_axis: float) -> None:
    """State where place and coordinate disagree, or the place is off the shaft's axis."""
    if stated is not None and not math.isclose(stated, u, abs_tol=1e2 * SAME_PLACE):
        words = f"{stated * 1e3:.6g} mm; its place (support_vector) is at {u * 1e3:.6g} mm, which is taken"
        part.say(item, "ignored", words)
    if off_axis > 1e2 * SAME_PLACE:
        words = f"{off_axis * 1e3:.4g} mm off the axis of its shaft; taken along the axis alone"
        part.say("support_vector", "refused", words)


def layout_of(unit: GearUnit) -> Layout:
    """Return the layout; the account says what is left out.

    Raises
    ------
    BadInput
        Places or sections of shafts are no such thing.
    """
    stages = gear_stages(unit)
    places = shaft_places(unit, stages)
    axes = scene_axes(_root(unit), _by_stages(stages, places))
    shafts = {}
    for part in unit.of_type("shaft"):
        place = places.get(part.id)
        if place is None:
            continue
        if axes.sense(place) == 0:
            part.say("", "refused", "not parallel to the shafts of the first stage: left out of the scene")
            continue
        shafts[part.id] = placed_shaft(unit, part, place, axes)
    rotors = rotors_of(unit, planetary_sets(unit))
    turning = tuple(s for s in stages if len({rotors.of[shaft.id] for shaft in s.shafts}) == 2)
    return Layout(unit, axes, shafts, rotors, turning)


def _root(unit: GearUnit) -> Placement | None:
    """Return the place of the gear unit."""
    units = unit.of_type("gear_unit")
    return placement(unit, units[0]) if units else None


def _by_stages(stages: tuple[GearStage, ...], places: Mapping[int, Placement]) -> list[Placement]:
    """Return the places of shafts, those of cylindrical stages first."""
    first = [shaft.id for stage in stages if stage.is_cylindrical for shaft in stage.shafts]
    return [places[shaft] for shaft in (*first, *places) if shaft in places]
