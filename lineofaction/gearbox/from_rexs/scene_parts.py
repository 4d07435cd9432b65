"""The parts of a scene by their components of the file, and how their axes u, v, w lie in it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from bounds.types import FloatArray
from lineofaction.gearbox.from_rexs.gear_unit import GearStage
from lineofaction.gearbox.from_rexs.layout import Layout
from lineofaction.gearbox.from_rexs.power_flow import PowerFlow
from lineofaction.gearbox.from_rexs.scene_shafts import SceneShafts
from lineofaction.gearbox.from_rexs.stage_case import StageCase


@dataclass(frozen=True)
class ShaftPart:
    """A shaft."""

    component: int
    rotation: FloatArray
    """Rotation from components along u, v, w to x, y, z. Shape (3, 3)."""
    sense: int
    """+1 where u is along z, -1 where it is against it."""
    zero: float
    """Position of u = 0 from the left end of the scene's shaft, m."""


@dataclass(frozen=True)
class BearingPart:
    """A bearing, or a coupling, on the ground."""

    component: int
    rotation: FloatArray
    """Rotation from components along the bearing's u, v, w to x, y, z. Shape (3, 3)."""
    shaft_inside: bool
    """Whether the shaft is on the inner side."""


@dataclass(frozen=True)
class _MeshPart:
    """A stage."""

    component: int
    case: str
    """Name of its case."""
    sense: int
    """+1 where the face positions of the case count along u of the shaft of the stage's gear 1, -1 against
    it; the opposite where a load case turns the train the other way.
    """


@dataclass(frozen=True)
class SceneParts:
    """The components of shafts, bearings on the ground and meshes by their names in the scene.

    Copies of planets, planet bearings and stubs are not among them.
    """

    shafts: Mapping[str, ShaftPart] = field(default_factory=dict)
    bearings: Mapping[str, BearingPart] = field(default_factory=dict)
    meshes: Mapping[str, _MeshPart] = field(default_factory=dict)


def scene_parts(
    layout: Layout,
    flow: PowerFlow,
    shafts: SceneShafts,
    seats: Mapping[int, str],
    meshes: Sequence[tuple[str, StageCase]],
) -> SceneParts:
    """Return the components of a scene's parts.

    `meshes` (name and case of each) stand in the order of `shafts.stages`. A planet carrier is among the
    shafts only if the file has a shaft component for it.
    """
    of_meshes = {
        name: _MeshPart(stage.stage.id, case.name, _face_sense(layout, flow, stage, case))
        for stage, (name, case) in zip(shafts.stages, meshes, strict=True)
    }
    of_shafts = {}
    for rotor, shaft in shafts.by_rotor.items():
        if (placed := layout.shafts.get(rotor)) is not None:
            rotation, zero = layout.axes.rotation(placed.placement), float(placed.start[2]) - shaft.begin
            of_shafts[shaft.name] = ShaftPart(rotor, rotation, placed.sense, zero)
    of_bearings = {}
    for entry in (*layout.unit.bearings, *layout.unit.couplings):
        if entry.part.id in seats and entry.rotor_side.id in layout.shafts:
            rotation = layout.rotation(entry.part, entry.rotor_side)
            inside = entry.rotor_side.id == entry.inner.id
            of_bearings[seats[entry.part.id]] = BearingPart(entry.part.id, rotation, inside)
    return SceneParts(of_shafts, of_bearings, of_meshes)


def _face_sense(layout: Layout, flow: PowerFlow, stage: GearStage, case: StageCase) -> int:
    """Return the sense of the case's face positions along u of gear 1's shaft, 1 or -1.

    Face positions count against the scene's z if the driving gear of the case turns about +z. Where a ring
    gear drives in the scene, the driving gear of the case is its pinion, whose force is opposite.
    """
    driver, _ = case.driving(stage)
    relative = flow.relative_speed(stage, 0 if driver.id == stage.gears[0].id else 1)
    pushed = -relative if case.wheel_drives else relative
    return -int(np.sign(pushed)) * layout.sense(stage.shafts[0].id)
