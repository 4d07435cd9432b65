"""Tooth deviations: the teeth of gears as made differ, so tables repeat after many base pitches."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from bounds import engineering
from bounds.pitch_tolerance import RUN_OUT_SHARE, cumulative_pitch_of_class
from dynamics.effects.effect import MeshEffect, Verdict
from dynamics.effects.loaded_parts import LoadedMesh
from dynamics.identity_cache import identity_cached
from dynamics.mechanism.additions import TEETH_AS_MADE
from dynamics.meshes.mesh_table import MeshTable
from dynamics.meshes.nominal_table import nominal_table, table_as_made
from dynamics.scene.scene import Scene
from dynamics.types import FloatArray

ASSUMED_CLASS = 6
"""Tolerance class (ISO 1328) assumed for gears whose table states no tooth deviations."""
_TO_MM, _FROM_UM = 1e3, 1e-6
"""The formula of the tolerance takes lengths in mm and returns um."""
SAMPLES = 256  # positions of a base pitch at which mesh order 1 is computed


class ToothDeviations(MeshEffect):
    """The table of all base pitches, not their mean."""

    name = "tooth_deviations"
    adds = (TEETH_AS_MADE,)
    cost = "orders of shafts beside those of the mesh: a period of many base pitches"

    def prepared(self, scene: Scene) -> Scene:
        """Return `scene` with the tables of its gears as made."""
        return _with_tables(scene, table_as_made)

    def neglected(self, scene: Scene) -> Scene:
        """Return `scene` with tables that are the mean over all base pitches."""
        return _with_tables(scene, nominal_table)

    def called_for(self, mesh: LoadedMesh) -> Verdict:
        """Call for the effect where the table covers more than one base pitch.

        Its influence is the largest difference of a base pitch from the mean of all. A table of one base
        pitch has no deviations that could be switched on; its influence is the run-out of both gears, of an
        assumed tolerance class.
        """
        made = table_as_made(mesh.mesh.table)
        if made.period == 1:
            return _of_assumed_class(mesh)
        nominal, text = nominal_table(made), f"the table repeats after {made.period} base pitches"
        if nominal is made:
            return Verdict(
                on=True,
                possible=False,
                reason=f"{text}, whose positions differ: it has no mean of one",
                influence=0.0,
            )
        mean = _static_error(nominal, mesh.force)
        size = float(np.max(np.abs(_static_error(made, mesh.force).reshape(-1, mean.size) - mean)))
        return Verdict(
            on=True,
            possible=True,
            reason=f"{text}, which differ from their mean by up to {_um(size)}",
            influence=size,
        )


def _of_assumed_class(mesh: LoadedMesh) -> Verdict:
    """Return the verdict that neglects run-out, with its influence in closed form.

    An eccentricity moves the flanks by its own size along the line of action, once per revolution of the
    shaft and whatever the load. The run-out is twice the eccentricity.
    """
    order = _mesh_order(mesh.mesh.table, mesh.force)
    first = _eccentricity(mesh, mesh.mesh.driver)
    second = _eccentricity(mesh, mesh.mesh.driven)
    reason = (
        f"all teeth are alike, deviations neglected: run-out of class {ASSUMED_CLASS} (assumed) makes order "
        f"1 of the shafts {_um(first)} (driver) and {_um(second)} (driven) beside mesh order 1, {_um(order)}"
    )
    return Verdict(on=False, possible=False, reason=reason, influence=first + second)


@identity_cached
def _mesh_order(table: MeshTable, force: float) -> float:
    """Return mesh order 1 of the transmission error at a force, m."""
    at = np.arange(SAMPLES) / SAMPLES
    curve = np.interp(at, np.asarray(table.position), _static_error(table, force), period=1.0)
    return float(2.0 * abs(np.mean(curve * np.exp(-2j * np.pi * at))))


def _eccentricity(mesh: LoadedMesh, name: str) -> float:
    """Return half the run-out tolerance of a gear by its operating pitch circle, m."""
    mechanism = mesh.train.mechanism
    gear, angle = mechanism.scene.gear(name), mechanism.lines[mesh.index].working_pressure_angle
    diameter = _TO_MM * 2.0 * gear.base_radius / math.cos(angle)
    helix = math.atan(math.tan(abs(gear.base_helix_angle)) / math.cos(angle))
    module = diameter / gear.teeth * math.cos(helix)
    cumulative_pitch = cumulative_pitch_of_class(module, diameter, ASSUMED_CLASS)
    return 0.5 * _FROM_UM * RUN_OUT_SHARE * cumulative_pitch


def _static_error(table: MeshTable, force: float) -> FloatArray:
    """Return the transmission error at a force, mean over the table's alignments, (P,) m."""
    level = np.asarray(table.level)
    # weights of the levels in linear interpolation
    share = np.array([np.interp(force, level, unit) for unit in np.eye(level.size)])
    return np.asarray(np.mean(np.asarray(table.deflection), axis=(0, 1)) @ share)


def _with_tables(scene: Scene, chosen: Callable[[MeshTable], MeshTable]) -> Scene:
    """Return `scene` with the tables that `chosen` makes of its tables; itself if all are the same."""
    meshes = list(scene.meshes)
    for index, mesh in enumerate(meshes):
        coast = mesh.coast
        if coast is not None and coast.table is not None and chosen(coast.table) is not coast.table:
            coast = replace(coast, table=chosen(coast.table))
        if coast is not mesh.coast or chosen(mesh.table) is not mesh.table:
            meshes[index] = replace(mesh, table=chosen(mesh.table), coast=coast)
    changed = any(new is not old for new, old in zip(meshes, scene.meshes, strict=True))
    return replace(scene, meshes=tuple(meshes)) if changed else scene


def _um(size: float) -> str:
    return f"{engineering(round(1e6 * size, 4))} µm"
