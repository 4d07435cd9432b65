"""Planetary scenes in the terms of dynamics: all planets, rings that drive, faults by name."""

from __future__ import annotations

import copy
import math
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from small_table import BASE_RADIUS, small_table

from dynamics.scene import Scene
from lineofaction.gearbox.convert.scene import dynamic_scene
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas import validated
from lineofaction.gearbox.schemas.scene import SceneInput

ROOT = Path(__file__).parents[3]
Change = Callable[[dict[str, Any]], object]


def ring_table() -> Any:
    """The small table as that of 20 teeth in a ring of 60, at the same center distance and base pitch."""
    from dataclasses import replace  # noqa: PLC0415

    table = small_table()
    fields = {name: getattr(table, name) for name in table.__dataclass_fields__}
    facts = replace(table.facts, teeth=(20, 60), base_radius=(BASE_RADIUS, 3.0 * BASE_RADIUS), internal=True)
    return type(table)(**fields | {"facts": facts})


PLANETARY: dict[str, Any] = {
    "run": {"duration_s": 0.01},
    "shafts": [
        {"name": name, "length_mm": 30.0, "diameter_mm": 20.0, "frame": "carrier", "origin_mm": [x, 0.0, 0.0]}
        for name, x in (("sun", 0.0), ("ring", 0.0), ("carrier", 0.0), ("planet", 80.0))
    ],
    "gears": [{"name": name, "shaft": name, "position_mm": 15.0} for name in ("sun", "planet", "ring")],
    "planet_bearings": [
        {
            "name": "pin",
            "shaft": "planet",
            "carrier": "carrier",
            "position_mm": 15.0,
            "radial_stiffness_n_per_m": 1e8,
        }
    ],
    "planets": [{"planet": "planet", "number": 4, "tangential_errors_um": [20.0, 0.0, 0.0, 0.0]}],
    "meshes": [
        {"name": "sun mesh", "driver": "sun", "driven": "planet", "case_file": "sun.toml"},
        {"name": "ring mesh", "driver": "planet", "driven": "ring", "case_file": "ring.toml"},
    ],
    "drives": [{"name": "held", "shaft": "ring", "speed_rpm": [0.0], "stiffness_n_m_per_rad": 1e7}],
    "free_rotations": [{"name": "train", "shaft": "sun", "initial_speed_rpm": 600.0}],
    "loads": [
        {"name": "motor", "shaft": "sun", "torque_n_m": [-50.0]},
        {"name": "brake", "shaft": "carrier", "torque_n_m": [200.0]},
    ],
}


def planetary(change: Change = lambda _table: None) -> Scene:
    table = copy.deepcopy(PLANETARY)
    change(table)
    tables = {"sun mesh": small_table(), "ring mesh": ring_table()}
    return dynamic_scene(validated(SceneInput, table), tables)


def test_a_planetary_set_has_all_its_planets() -> None:
    found = planetary()
    assert [gear.internal for gear in found.gears[:3]] == [False, False, True]
    assert len(found.meshes) == 8
    assert found.shafts[4].origin == pytest.approx((0.0, 0.08, 0.0))
    assert [b.tangential_error for b in found.planet_bearings] == pytest.approx([2e-5, 0.0, 0.0, 0.0])
    assert found.drives[0].stiffness == 1e7
    assert found.free_rotations[0].initial_speed == pytest.approx(20.0 * math.pi)


@pytest.mark.parametrize(
    ("change", "field"),
    [
        (lambda t: t["planets"][0].update(number=3, tangential_errors_um=[0.0] * 3), "planets[0].number"),
        (lambda t: t["planets"][0].update(number=3), "planets[0].tangential_errors_um"),
        (lambda t: t["planets"][0].update(planet="moon"), "planets[0].planet"),
        (lambda t: t["shafts"][0].update(frame="nobody"), "shafts[0].frame"),
        (lambda t: t["shafts"][0].pop("frame"), "meshes[0].driven"),
        (lambda t: t["planet_bearings"][0].update(carrier="ring"), "planet_bearings[0].carrier"),
        (lambda t: t.update(free_rotations=[]), "drives[0].speed_rpm"),
        (lambda t: t["free_rotations"][0].update(sense="-z"), "free_rotations[0].sense"),
    ],
)
def test_planetary_sets_that_cannot_be_are_one_fault_by_name(change: Change, field: str) -> None:
    with pytest.raises(BadInput) as caught:
        planetary(change)
    (fault,) = caught.value.faults
    assert fault.field == field


def test_a_ring_gear_may_drive() -> None:
    """The wheel of its case then is the driver; an external wheel is told to be another case's pinion."""

    def turned(table: dict[str, Any]) -> None:
        table["meshes"][0].update(driver="planet", driven="sun")
        table["meshes"][1].update(driver="ring", driven="planet", wheel_drives=True)
        table["loads"] = [
            {"name": "motor", "shaft": "carrier", "torque_n_m": [-200.0]},
            {"name": "brake", "shaft": "sun", "torque_n_m": [50.0]},
        ]

    found = planetary(turned)
    assert [gear.internal for gear in found.gears[:3]] == [False, False, True]
    with pytest.raises(BadInput, match=r"meshes\[1\]\.driven"):
        planetary(lambda table: (turned(table), table["meshes"][1].update(wheel_drives=False)))
    with pytest.raises(BadInput, match=r"meshes\[0\]\.wheel_drives"):
        planetary(lambda table: table["meshes"][0].update(wheel_drives=True))


def test_the_planetary_example_is_a_system() -> None:
    """On fake tables with the facts of its pairs: six meshes, all torques carried, planets that fit."""
    from dataclasses import replace  # noqa: PLC0415

    from dynamics.assembly.assemble import assemble  # noqa: PLC0415

    table = small_table()
    fields = {name: getattr(table, name) for name in table.__dataclass_fields__}

    def of(teeth: tuple[int, int], internal: bool) -> Any:
        base = math.cos(math.radians(20.0)) * 1e-3
        radius = (base * teeth[0], base * teeth[1])
        facts = replace(table.facts, teeth=teeth, base_radius=radius, center_distance=0.06, internal=internal)
        facts = replace(facts, base_pitch=2.0 * math.pi * base)
        return type(table)(**fields | {"facts": facts, "torque": table.force * radius[0]})

    example = tomllib.loads((ROOT / "examples" / "planetary_scene.toml").read_text())
    tables = {"sun mesh": of((24, 36), False), "ring mesh": of((36, 96), True)}
    system = assemble(dynamic_scene(validated(SceneInput, example), tables))
    assert len(system.scene.meshes) == 6
    assert system.kinematics.ratio[0][0] * 5 == 1  # the carrier
    base = math.cos(math.radians(20.0)) * 1e-3
    assert system.flanks.nominal_force == pytest.approx([60.0 / 3.0 / (24 * base)] * 6)
