"""Meshes of a scene file in closed form: gears, tables, what does not fit."""

from __future__ import annotations

import copy
import math
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from dynamics.scene import Scene
from lineofaction.gearbox.convert.scene import check_scene, dynamic_scene
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas import validated
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.subjects import _portable_scene

ROOT = Path(__file__).parents[3]
EXAMPLE = tomllib.loads((ROOT / "examples" / "backlash_oscillator_scene.toml").read_text())
RING = tomllib.loads((ROOT / "examples" / "lin_parker_planetary_scene.toml").read_text())
Change = Callable[[dict[str, Any]], object]


def scene(change: Change = lambda _mesh: None) -> Scene:
    given = copy.deepcopy(EXAMPLE)
    change(given["meshes"][0])
    return dynamic_scene(validated(SceneInput, given), {})


def stiffness(**fields: Any) -> Change:
    return lambda mesh: mesh["stiffness"].update(fields)


def test_gears_and_table_follow_from_the_fields() -> None:
    found = scene(stiffness(base_helix_angle_deg=10.0))
    pinion, wheel = found.gears
    assert (pinion.teeth, wheel.teeth, pinion.face_width) == (20, 20, pytest.approx(0.02))
    assert (pinion.base_radius, wheel.base_radius) == pytest.approx((0.05, 0.05))
    assert (pinion.base_helix_angle, wheel.base_helix_angle) == pytest.approx(
        (math.radians(10.0), -math.radians(10.0))
    )
    table = found.meshes[0].table
    assert table.stiffness == pytest.approx(1e8)
    assert table.deflection[0, 0, 0, 0] == pytest.approx(2.487593e-6, rel=1e-6)


def test_a_ring_gear_is_larger_by_the_ratio_of_the_teeth() -> None:
    found = dynamic_scene(validated(SceneInput, RING), {})
    sun, planet, ring = found.gears[:3]
    assert (sun.teeth, planet.teeth, ring.teeth) == (27, 36, 99)
    assert (planet.base_radius, ring.base_radius) == pytest.approx((0.0504, 0.1386))
    assert [gear.internal for gear in (sun, planet, ring)] == [False, False, True]
    assert len(found.meshes) == 6


def test_a_service_takes_the_scene_as_it_is() -> None:
    given = validated(SceneInput, EXAMPLE)
    assert _portable_scene(given, ROOT) == given
    assert given.with_database == []
    assert check_scene(given, {}).meshes[0].table.level.size == 2


@pytest.mark.parametrize(
    ("change", "field"),
    [
        (lambda mesh: mesh.pop("stiffness"), "meshes[0].case"),
        (lambda mesh: mesh.update(database_hash="0" * 64), "meshes[0].case"),
        (stiffness(teeth=[20, 30]), "shafts[1].origin_mm"),
        (stiffness(teeth=[20, 20], internal=True), "meshes[0].stiffness.teeth"),
        (stiffness(stiffness_n_per_m={"value": [-1.0]}), "meshes[0].stiffness.stiffness_n_per_m.value"),
        (
            stiffness(stiffness_n_per_m={"value": [1e8], "amplitude": [1.0], "position": [0.0, 0.5]}),
            "meshes[0].stiffness.stiffness_n_per_m.amplitude",
        ),
        (
            stiffness(stiffness_n_per_m={"value": [1e8, 2e8], "position": [0.5, 0.0]}),
            "meshes[0].stiffness.stiffness_n_per_m.position",
        ),
        (
            stiffness(stiffness_n_per_m={"value": [1e8, 2e8]}),
            "meshes[0].stiffness.stiffness_n_per_m.value",
        ),
        (
            stiffness(stiffness_n_per_m={"value": [1e8], "amplitude": [1.0], "phase_deg": [1.0, 2.0]}),
            "meshes[0].stiffness.stiffness_n_per_m.phase_deg",
        ),
    ],
)
def test_what_is_no_mesh_is_one_fault_by_name(change: Change, field: str) -> None:
    with pytest.raises(BadInput) as caught:
        scene(change)
    assert [fault.field for fault in caught.value.faults] == [field]
