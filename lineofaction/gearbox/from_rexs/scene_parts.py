"""Which component each part of a scene is, and how its axes u, v, w lie in the scene."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from bounds.types import FloatArray
from lineofaction.gearbox.from_rexs.connections import Connection, bearings, couplings
from lineofaction.gearbox.from_rexs.gear_stages import GearStage
from lineofaction.gearbox.from_rexs.layout import Layout
from lineofaction.gearbox.from_rexs.placement import placement
from lineofaction.gearbox.from_rexs.power_flow import PowerFlow
from lineofaction.gearbox.from_rexs.scene_gears import driving_gears
from lineofaction.gearbox.from_rexs.scene_shafts import SceneShafts
from lineofaction.gearbox.from_rexs.stage_case import StageCase


@dataclass(frozen=True)
class ShaftPart:
    """A shaft.

    Attributes
    ----------
    component : int
    turn : (3, 3) array
        Takes components along u, v, w to x, y, z.
    sense : int
        +1 where u is along z, -1 where it is against it.
    zero : float
        Position of u = 0 from the left end of the scene's shaft, m.
    """

    component: int
    turn: FloatArray
    sense: int
    zero: float


@dataclass(frozen=True)
class BearingPart:
    """A bearing, or a coupling, on the ground.

    Attributes
    ----------
    component : int
    turn : (3, 3) array
        Takes components along its u, v, w to x, y, z.
    shaft_inside : bool
        Whether the shaft is on the inner side.
    """

    component: int
    turn: FloatArray
    shaft_inside: bool


@dataclass(frozen=True)
class MeshPart:
    """A stage.

    Attributes
    ----------
    component : int
    case : str
        Name of its case.
    sense : int
        +1 where the face positions of the case count along u of the shaft of the stage's gear 1, -1 against
        it; the opposite where a load case turns the train the other way.
    """

    component: int
    case: str
    sense: int


@dataclass(frozen=True)
class SceneParts:
    """The components of shafts, bearings on the ground and meshes by their names in the scene.

    Copies of planets, planet bearings and stubs are not among them.
    """

    shafts: Mapping[str, ShaftPart] = field(default_factory=dict)
    bearings: Mapping[str, BearingPart] = field(default_factory=dict)
    meshes: Mapping[str, MeshPart] = field(default_factory=dict)


def scene_parts(
    layout: Layout,
    flow: PowerFlow,
    shafts: SceneShafts,
    seats: Mapping[int, str],
    meshes: Sequence[tuple[str, StageCase]],
) -> SceneParts:
    """Return the components of a scene's parts.

    Parameters
    ----------
    layout : Layout
    flow : PowerFlow
        At the operating point of the scene.
    shafts : SceneShafts
    seats : mapping of int to str
        The bushing of each bearing on the ground, by its component.
    meshes : sequence of (str, StageCase)
        Names and cases of the scene's meshes, in the order of `shafts.stages`.
    """
    parts = {
        name: MeshPart(stage.stage.id, case.name, _face_sense(layout, flow, stage, case))
        for stage, (name, case) in zip(shafts.stages, meshes, strict=True)
    }
    return SceneParts(dict(_shafts(layout, shafts)), dict(_bearings(layout, seats)), parts)


def _shafts(layout: Layout, shafts: SceneShafts) -> Iterator[tuple[str, ShaftPart]]:
    """Yield the shafts; a carrier only if the component of its rotor is a shaft of its own."""
    for rotor, shaft in shafts.by_rotor.items():
        if rotor in layout.shafts:
            placed = layout.shafts[rotor]
            zero = float(placed.start[2]) - shaft.begin
            yield shaft.name, ShaftPart(rotor, layout.axes.turn(placed.place), placed.sense, zero)


def _bearings(layout: Layout, seats: Mapping[int, str]) -> Iterator[tuple[str, BearingPart]]:
    """Yield what holds shafts on the ground."""
    entries: tuple[Connection, ...] = (*bearings(layout.unit), *couplings(layout.unit))
    for entry in entries:
        if entry.part.id in seats and entry.held.id in layout.shafts:
            place = placement(layout.unit, entry.part) or layout.shafts[entry.held.id].place
            inside = entry.held.id == entry.inner.id
            yield seats[entry.part.id], BearingPart(entry.part.id, layout.axes.turn(place), inside)


def _face_sense(layout: Layout, flow: PowerFlow, stage: GearStage, case: StageCase) -> int:
    """Return how the face positions of the case count along u of gear 1's shaft.

    They count against the scene's z if the case's driving gear turns about +z; a ring gear that drives is
    pushed back by it.
    """
    driver, _ = driving_gears(stage, case)
    number = 0 if driver.id == stage.gears[0].id else 1
    rotor, carrier = layout.rotor(stage.shafts[number].id), layout.carrier(stage)
    relative = flow.speed(rotor) - (0.0 if carrier is None else flow.speed(carrier))
    pushed = -relative if case.wheel_drives else relative
    return -int(np.sign(pushed)) * layout.sense(stage.shafts[0].id)
