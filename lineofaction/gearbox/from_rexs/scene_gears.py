"""Gears, meshes and additional masses of the scene."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from dynamics.shafts import Inertia, hollow_cylinder
from lineofaction.gearbox.from_rexs.carrier_body import inertia_table
from lineofaction.gearbox.from_rexs.gear_body import RIM
from lineofaction.gearbox.from_rexs.gear_unit import GearStage, Part
from lineofaction.gearbox.from_rexs.layout import Layout
from lineofaction.gearbox.from_rexs.part_names import Names
from lineofaction.gearbox.from_rexs.scene_shafts import SceneShaft, SceneShafts
from lineofaction.gearbox.from_rexs.stage_case import StageCase
from lineofaction.gearbox.units import MM

SAME = 1e-6
"""Relative difference between the distance of two axes and the center distance of their mesh from which a
scene is refused."""

INTEGRAL = 0.95
"""Share of the pitch diameter from which a shaft's section is the gear's own body."""


def scene_gears(
    layout: Layout, shafts: SceneShafts, cases: Mapping[int, StageCase]
) -> tuple[list[dict[str, Any]], list[dict[str, Any]]]:
    """Return the tables of gears and meshes; `cases` are by stage."""
    gears: dict[int, dict[str, Any]] = {}
    parts: dict[int, Part] = {}
    meshes, names, mesh_names = [], Names(), Names()
    for stage in shafts.stages:
        case = cases[stage.stage.id]
        for gear, shaft in zip(stage.gears, stage.shafts, strict=True):
            if gear.id not in gears:
                gears[gear.id] = _gear(layout, shafts, gear, shaft, names)
                parts[gear.id] = gear
        _say_distance(layout, stage, case)
        driver, driven = case.driving(stage)
        mesh: dict[str, Any] = {
            "name": mesh_names.of(stage.stage),
            "driver": gears[driver.id]["name"],
            "driven": gears[driven.id]["name"],
            "case_file": f"{case.name}.toml",
        }
        if case.wheel_drives:
            mesh["wheel_drives"] = True
        meshes.append(mesh)
    _say_angles(gears, parts)
    return list(gears.values()), meshes


def _say_distance(layout: Layout, stage: GearStage, case: StageCase) -> None:
    """State a center distance that contradicts the places of the shafts: no verb takes such a scene."""
    first, second = (layout.shafts[shaft.id].origin for shaft in stage.shafts)
    distance = math.hypot(*(second - first)[:2])
    if not math.isclose(distance, case.center_distance, rel_tol=SAME):
        text = f"{case.center_distance / MM:.7g} mm, and its shafts are {distance / MM:.7g} mm apart, "
        mend = f"--assume {stage.stage.id}.center_distance={distance / MM:.7g}"
        text += f"where no verb takes them: open it with {mend}, or move a shaft"
        stage.stage.say("center_distance", "refused", text)


def _say_angles(gears: Mapping[int, Mapping[str, Any]], parts: Mapping[int, Part]) -> None:
    """State which gears share a shaft with another one: no file says at which angle their teeth stand."""
    first: dict[str, str] = {}
    for number, part in parts.items():
        gear = gears[number]
        if first.setdefault(gear["shaft"], gear["name"]) != gear["name"]:
            text = f"0 against gear {first[gear['shaft']]}: no file says it; state tooth_angles_deg of shaft "
            part.say("tooth_angle", "defaulted", f"{text}{gear['shaft']} in the scene")


def _gear(layout: Layout, shafts: SceneShafts, gear: Part, shaft: Part, names: Names) -> dict[str, Any]:
    placed = layout.shafts[shaft.id]
    u = layout.u_on(placed, gear)
    scene_shaft = shafts.stubs.get(gear.id) or shafts.by_rotor[layout.rotor(shaft.id)]
    z = float(placed.start[2]) + placed.sense * u
    if gear.id not in shafts.stubs:
        gear.say("", "taken", f"gear on shaft {scene_shaft.name}")
    body = _body(gear, placed.outer_diameter(u), is_shaft_massless=not placed.sections)
    return scene_shaft.seat(names.of(gear), z) | body


def _body(gear: Part, shaft_diameter: float, *, is_shaft_massless: bool) -> dict[str, Any]:
    """Return the bore of a gear's cylinder, or its inertia where its body is the shaft's section."""
    module = gear.number("normal_module", "pitch cylinder, from which the inertia follows, mm")
    helix = gear.number("helix_angle_reference_diameter", "pitch cylinder, deg") or 0.0
    count = gear.teeth or 0
    pitch = abs(count) * (module or 0.0) / math.cos(helix)
    if gear.type == "ring_gear":
        return {"inertia": inertia_table(_ring(gear, pitch, module or 0.0, is_shaft_massless))}
    if shaft_diameter >= INTEGRAL * pitch:
        text = f"0: the section of its shaft is {shaft_diameter / MM:.6g} mm, the gear's own body"
        gear.say("inertia", "derived", text)
        return {"inertia": inertia_table(Inertia())}
    gear.say("inertia", "derived", f"a steel cylinder of {pitch / MM:.6g} mm, bore that of its shaft")
    return {"bore_diameter_mm": shaft_diameter / MM}


def _ring(gear: Part, pitch: float, module: float, is_shaft_massless: bool) -> Inertia:
    """Return the inertia of a ring gear: none if its shaft's sections include it, else of a rim."""
    width = gear.number("face_width", "width of the ring, mm") or 0.0
    if not is_shaft_massless or pitch <= 0.0 or width <= 0.0:
        gear.say("inertia", "derived", "0: the ring is a section of its shaft")
        return Inertia()
    gear.say("inertia", "defaulted", f"a steel ring {RIM:g} modules thick on the pitch cylinder")
    return hollow_cylinder(pitch + 2.0 * RIM * module, width, pitch)


def scene_discs(layout: Layout, shafts: SceneShafts) -> list[dict[str, Any]]:
    """Return the additional masses on the shafts of the scene as discs."""
    discs, names = [], Names()
    for part in layout.unit.of_type("additional_mass"):
        owner = part.shaft
        scene_shaft = None if owner is None else shafts.by_rotor.get(layout.rotor(owner.id))
        if owner is None or scene_shaft is None or owner.id not in layout.shafts:
            part.say("", "refused", "on no shaft of the scene")
            continue
        table = _disc(part, scene_shaft, layout.z_on(layout.shafts[owner.id], part), names)
        discs += [] if table is None else [table]
    return discs


def _disc(part: Part, shaft: SceneShaft, z: float, names: Names) -> dict[str, Any] | None:
    mass = part.number("mass_of_component", "mass of a disc, kg")
    if not mass or mass < 0.0:
        part.say("", "refused", "no mass is stated")
        return None
    text, why = "moment of inertia of a disc, kg m^2", "0 kg m^2: a point mass on the axis"
    moments = [max(0.0, part.number(f"moment_of_inertia_{a}_axis", text, 0.0, why)) for a in "uvw"]
    if moments[1] != moments[2]:
        part.say("moment_of_inertia_w_axis", "derived", "mean of v and w: a disc is a body of revolution")
    inertia = Inertia(mass, moments[0], 0.5 * (moments[1] + moments[2]))
    part.say("", "taken", f"disc on shaft {shaft.name}")
    return shaft.seat(names.of(part), z) | {"inertia": inertia_table(inertia)}
