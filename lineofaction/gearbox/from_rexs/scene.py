"""The scene of a gear unit at an operating point."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from lineofaction.gearbox.from_rexs.gear_unit import NO_STAGE, GearStage
from lineofaction.gearbox.from_rexs.layout import Layout
from lineofaction.gearbox.from_rexs.loads import AppliedTorque, SceneMotion
from lineofaction.gearbox.from_rexs.part_names import Names
from lineofaction.gearbox.from_rexs.placement import FIXED, Placement
from lineofaction.gearbox.from_rexs.power_flow import PowerFlow
from lineofaction.gearbox.from_rexs.scene_bearings import SceneBearings
from lineofaction.gearbox.from_rexs.scene_forces import SceneForce, scene_forces
from lineofaction.gearbox.from_rexs.scene_gears import scene_discs, scene_gears
from lineofaction.gearbox.from_rexs.scene_parts import SceneParts, scene_parts
from lineofaction.gearbox.from_rexs.scene_shafts import SceneShafts
from lineofaction.gearbox.from_rexs.stage_case import StageCase
from lineofaction.gearbox.units import STANDARD_GRAVITY

PERIODS = 10
"""Number of periods of the slowest mesh in the run of the scene."""


@dataclass(frozen=True)
class SceneTable:
    """A scene as the tables of its file."""

    table: dict[str, Any]
    """Tables of a scene file; meshes name their case files."""
    leader: AppliedTorque | None
    """Torque that drives the scene and is named first."""
    forces: tuple[SceneForce, ...]
    """External loads of the file, in the order of the scene's forces."""
    parts: SceneParts
    """Components of the file from which the scene's parts are made."""

    @staticmethod
    def of(layout: Layout, flows: Sequence[PowerFlow], cases: Sequence[StageCase]) -> SceneTable:
        """Return the scene at the operating point of the first flow.

        Stages without a case, without a computed layout or without power have no mesh; torques replace them.
        """
        flow = flows[0]
        by_stage, names = _by_stage(cases), Names()
        known = [stage for stage in layout.stages if stage.stage.id in by_stage]
        computed = [stage for stage in known if layout.is_computed(stage) and flow.moves(stage)]
        cut = [stage for stage in layout.stages if stage not in computed]
        shafts = SceneShafts.of(layout, computed, names)
        _say_without_mesh(layout, cases, computed, shafts)
        bearings = SceneBearings(layout, shafts)
        gears, meshes = scene_gears(layout, shafts, by_stage)
        motion = SceneMotion(flow, shafts, cut)
        forces = tuple(scene_forces(layout, [entry.point for entry in flows], shafts))
        table: dict[str, Any] = {
            "run": {"duration_s": _duration(layout, motion.slowest_mesh())},
            "gravity_m_per_s2": _gravity(layout),
            "shafts": [shaft.table for shaft in shafts.all],
            "gears": gears,
            "discs": scene_discs(layout, shafts),
            "bushings": bearings.bushings,
            "rolling_bearings": bearings.rolling_bearings,
            "planet_bearings": bearings.planet_bearings,
            "couplings": bearings.couplings,
            "housings": bearings.housings,
            "planets": _planets(layout, {shaft.rotor: shaft.name for shaft in shafts.by_rotor.values()}),
            "meshes": meshes,
            **motion.tables(),
            "forces": [force.table(flow.point) for force in forces],
        }
        meshed = zip(shafts.stages, meshes, strict=True)
        named = [(mesh["name"], by_stage[stage.stage.id]) for stage, mesh in meshed]
        return SceneTable(
            table={key: value for key, value in table.items() if value != []},
            leader=motion.drivers[0] if motion.drivers else None,
            forces=forces,
            parts=scene_parts(layout, flow, shafts, bearings.seats, named),
        )


def _by_stage(cases: Sequence[StageCase]) -> dict[int, StageCase]:
    """Return the case of each stage by the stage's id; equal stages share one case."""
    return {stage: case for case in cases for stage in (case.stage, *case.equal)}


def _say_without_mesh(
    layout: Layout, cases: Sequence[StageCase], stages: Sequence[GearStage], shafts: SceneShafts
) -> None:
    """State the stages with a case but without a mesh in the scene, except stages of equal planets."""
    meshed = {stage.stage.id for stage in shafts.stages}
    meshed |= {s.stage.id for s in stages} & {equal for case in cases for equal in case.equal}
    on_shafts = {stage.stage.id for stage in layout.stages}
    for number in _by_stage(cases).keys() - meshed:
        text = "it has a case and no mesh: its shafts are not parallel to those of the first stage, nothing "
        text += "places them or joins them to a speed, or they carry a planet unlike the first"
        layout.unit.part(number).say("", "refused", text if number in on_shafts else NO_STAGE)


def _duration(layout: Layout, rate: float) -> float:
    duration = float(f"{PERIODS / rate:.2g}") if rate > 0.0 else 1.0
    for part in layout.unit.of_type("gear_unit"):
        text = f"{duration:g} s, {PERIODS} periods of the slowest mesh: a REXS file states no run"
        part.say("run.duration_s", "defaulted", text)
    return duration


def _gravity(layout: Layout) -> list[float]:
    """Return the acceleration of gravity in x, y, z, m/s^2; none where the file does not account for it."""
    for part in layout.unit.of_type("gear_unit"):
        if part.value("account_for_gravity") is not True:
            continue
        if layout.rotors.sets:
            part.say("account_for_gravity", "refused", "a scene with a planet carrier's frame has no gravity")
            break
        part.say("account_for_gravity", "taken", "gravity of the scene")
        items = [f"direction_vector_gravity_{axis}" for axis in "uvw"]
        vector = np.array([part.number(item, "direction of gravity") or 0.0 for item in items])
        size = part.number("gravitational_acceleration", "gravity, m/s^2")
        length = float(np.linalg.norm(vector))
        if length == 0.0 or not math.isfinite(length):
            part.say("account_for_gravity", "refused", "the file gives gravity no direction")
            break
        placement = Placement.of(part) or FIXED
        turned = layout.axes.rotation(placement) @ vector / length * (size or STANDARD_GRAVITY)
        # rounded to what the rotation does not falsify; 0.0 makes 0 of -0
        return [float(value) + 0.0 for value in np.round(turned, 12)]
    return [0.0, 0.0, 0.0]


def _planets(layout: Layout, names: dict[int, str]) -> list[dict[str, Any]]:
    """Return the number of planets of each set, which copy the first, and their angles."""
    tables = []
    for planets in layout.rotors.sets:
        first = planets.planets[0]
        if first.id not in names:
            planets.stage.say("", "refused", "no stage of the scene has its planets")
            continue
        positions = [layout.shafts[p.id].origin[:2] for p in planets.planets if p.id in layout.shafts]
        central = next((layout.shafts[c.id] for c in planets.central if c.id in layout.shafts), None)
        middle = np.mean(positions, axis=0) if central is None else central.origin[:2]
        offsets = [position - middle for position in positions]
        angles = [math.degrees(math.atan2(y, x)) for x, y in offsets]
        turned = sorted((angle - angles[0]) % 360.0 for angle in angles)
        table: dict[str, Any] = {"planet": names[first.id], "number": len(positions)}
        equal = [index * 360.0 / len(positions) for index in range(len(positions))]
        if not np.allclose(turned, equal, atol=1e-6):
            table["angles_deg"] = turned
        for planet in planets.planets[1:]:
            for part in (planet, *planet.children("cylindrical_gear")):
                part.say("", "derived", f"copy of planet {names[first.id]}")
        tables.append(table)
    return tables
