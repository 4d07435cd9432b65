"""The flank elements of meshes whose table is read along its axes or whose force acts off mid-face."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from dynamics.arrays.elements import Element
from dynamics.assembly.flanks import Flanks
from dynamics.assembly.mesh_axes import (
    common_face_width,
    distance_gradient,
    middle_from_driver,
    misalignment_gradient,
    sliding_gradients,
)
from dynamics.effects.ledger import EffectLedger
from dynamics.errors import InputError
from dynamics.forces.coast_flank import mirrored
from dynamics.forces.element_laws import Law
from dynamics.forces.grid_tables import pack_grids
from dynamics.forces.mesh_table import MeshTable
from dynamics.forces.spatial_flank import SpatialFlankLaws
from dynamics.mechanism.line_of_action import line_of_action
from dynamics.mechanism.rotor import Rotor
from dynamics.scene.scene import Scene
from dynamics.types import BoolArray, FloatArray


@dataclass(frozen=True)
class SpatialEffects:
    """Which effects a mesh has."""

    misalignment: bool
    center_distance: bool
    application_point: bool
    friction: bool

    @property
    def any(self) -> bool:
        """Whether its flanks are spatial."""
        return self.misalignment or self.center_distance or self.application_point or self.friction


@dataclass(frozen=True)
class SpatialFlank:
    """One flank: its table, its damping, its rows after that of the deflection, and how it uses them."""

    table: MeshTable
    damping: float
    reach: float
    row: tuple[int, int, int]
    fixed: tuple[float, float]
    follows: tuple[int, int]
    per_face: float
    mid_face: float
    friction: float
    radius: float
    gradient: FloatArray
    offset: FloatArray
    slides: BoolArray


def spatial_effects(ledger: EffectLedger, mesh: str) -> SpatialEffects:
    """Return the effects that are on for `mesh`."""
    return SpatialEffects(
        ledger.on("dynamic_misalignment", mesh),
        ledger.on("dynamic_center_distance", mesh),
        ledger.on("moving_application_point", mesh),
        ledger.on("friction", mesh),
    )


def spatial_elements(
    scene: Scene,
    rotors: Sequence[Rotor],
    senses: Sequence[int],
    flanks: Flanks,
    plain: Sequence[Element],
    ledger: EffectLedger,
    vectors: FloatArray,
) -> tuple[tuple[Element, ...], SpatialFlankLaws]:
    """Return the elements `plain` with those of such meshes replaced, each at its index, and their laws.

    `vectors` (k, N) are the kinematic ones, along which flanks slide but keep their deflection.
    """
    elements: list[Element] = []
    found: list[SpatialFlank] = []
    for entry, element in enumerate(plain):
        effects = spatial_effects(ledger, scene.meshes[element.mesh].name)
        if not effects.any:
            elements.append(element)
            continue
        flank = _flank(scene, rotors, senses[element.mesh], flanks, entry, element, effects)
        drift = np.where(flank.slides[:, None], flank.gradient @ vectors.T, 0.0)
        elements.append(
            Element(Law.SPATIAL_FLANK, len(found), element.mesh, flank.gradient, flank.offset, drift)
        )
        found.append(flank)
    return tuple(elements), _pack(found)


def _flank(
    scene: Scene,
    rotors: Sequence[Rotor],
    driving: int,
    flanks: Flanks,
    entry: int,
    element: Element,
    effects: SpatialEffects,
) -> SpatialFlank:
    """Return the flank at `entry` among all, which `element` has in the plane."""
    index = element.mesh
    mesh, coast = scene.meshes[index], entry >= len(scene.meshes)
    sense = -driving if coast else driving
    line = line_of_action(scene, index, sense)
    fixed = (-mesh.misalignment if coast else mesh.misalignment, mesh.center_distance_change)
    table = _table(scene, flanks, entry, index, effects)
    follows = (
        int(effects.misalignment and np.size(table.misalignment) > 1),
        int(effects.center_distance and np.size(table.center_distance_change) > 1),
    )
    turns = bool(follows[0]) or effects.application_point
    row_m, row_a = 1 if turns else -1, (2 if turns else 1) if follows[1] else -1
    rows, offset = [element.gradient[0]], [float(element.offset[0])]
    if turns:
        rows.append(misalignment_gradient(scene, rotors, index, line, sense))
        offset.append(fixed[0])
    if follows[1]:
        rows.append(distance_gradient(scene, rotors, index, line))
        offset.append(fixed[1])
    slides = len(rows) if effects.friction else -1
    if effects.friction:
        rows.extend(sliding_gradients(scene, rotors, index, line, driving))
        offset.extend([0.0, 0.0])
    driver = scene.gear(mesh.driver)
    coefficient = (mesh.friction or 0.0) / math.cos(driver.base_helix_angle)
    return SpatialFlank(
        table,
        float(flanks.law.damping[entry]),
        float(flanks.law.reach[entry]),
        (row_m, row_a, slides),
        fixed,
        follows,
        1.0 / common_face_width(scene, index) if effects.application_point else 0.0,
        middle_from_driver(scene, index, line, sense),
        coefficient if effects.friction else 0.0,
        driver.base_radius,
        np.array(rows),
        np.array(offset),
        np.arange(len(rows)) >= (slides if effects.friction else len(rows)),
    )


def _table(scene: Scene, flanks: Flanks, entry: int, index: int, effects: SpatialEffects) -> MeshTable:
    """Return the table over its axes where one moves, else the plane flank's at its operating point."""
    mesh = scene.meshes[index]
    if not (effects.misalignment or effects.center_distance):
        return flanks.tables[entry]
    if entry < len(scene.meshes):
        return mesh.table
    if mesh.coast is None:
        raise InputError(f"meshes[{index}].coast", None, "given")
    return mirrored(mesh.coast.table or mesh.table, mesh.coast.thickness)


def _pack(flanks: Sequence[SpatialFlank]) -> SpatialFlankLaws:
    """Lay out the laws."""
    return SpatialFlankLaws(
        pack_grids([flank.table for flank in flanks]),
        np.array([flank.damping for flank in flanks], dtype=float),
        np.array([flank.reach for flank in flanks], dtype=float),
        np.array([flank.row for flank in flanks], dtype=np.int64).reshape(-1, 3),
        np.array([flank.fixed for flank in flanks], dtype=float).reshape(-1, 2),
        np.array([flank.follows for flank in flanks], dtype=np.int64).reshape(-1, 2),
        np.array([flank.per_face for flank in flanks], dtype=float),
        np.array([flank.mid_face for flank in flanks], dtype=float),
        np.array([flank.friction for flank in flanks], dtype=float),
        np.array([flank.radius for flank in flanks], dtype=float),
        np.zeros(len(flanks), dtype=np.bool_),
    )
