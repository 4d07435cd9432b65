"""From a scene file and its tables to the scene of dynamics."""

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
EXAMPLE = tomllib.loads((ROOT / "examples" / "palermo_scene.toml").read_text())
Change = Callable[[dict[str, Any]], object]


def scene(change: Change = lambda _table: None) -> Scene:
    table = copy.deepcopy(EXAMPLE)
    change(table)
    return dynamic_scene(validated(SceneInput, table), {"mesh": small_table()})


def test_the_papers_scene_is_in_si() -> None:
    found = scene()
    assert [shaft.length for shaft in found.shafts] == pytest.approx([0.2, 0.2])
    assert found.shafts[1].origin == pytest.approx((0.08, 0.0, 0.0))
    assert len(found.bushings) == 4
    assert {b.radial_stiffness for b in found.bushings} | {b.axial_stiffness for b in found.bushings} == {1e8}
    assert found.drives[0].speed.value == pytest.approx((0.0, 955.0 * 2.0 * math.pi / 60.0))
    assert found.loads[0].torque.value == (100.0,)
    assert (found.duration, found.outputs.sample_rate) == (5.0, 2e4)
    assert found.integration.tolerance == pytest.approx(1e-9)


def test_gears_take_their_teeth_from_the_table() -> None:
    pinion, wheel = scene().gears
    assert (pinion.teeth, wheel.teeth) == (20, 20)
    assert pinion.base_radius == pytest.approx(BASE_RADIUS)
    assert pinion.position == pytest.approx(0.1)
    assert pinion.inertia.mass == pytest.approx(7850 * math.pi * (0.04**2 - 0.02**2) * 0.025, rel=1e-12)


def test_the_mesh_uses_the_table_it_was_given() -> None:
    mesh = scene(lambda t: t["meshes"][0].update(technique="constant_torque", misalignment_um=0.0)).meshes[0]
    assert mesh.technique == "constant_torque"
    assert mesh.table.deflection.shape[-1] == mesh.table.level.size


def test_given_inertia_is_used_as_it_is() -> None:
    given = {"mass_kg": 1.0, "polar_kg_m2": 2.0, "transverse_kg_m2": 3.0}

    def change(table: dict[str, Any]) -> None:
        table["gears"][0]["inertia"] = given
        del table["shafts"][0]["diameter_mm"]
        table["shafts"][0]["inertia"] = given

    found = scene(change)
    for inertia in (found.gears[0].inertia, found.shafts[0].inertia):
        assert (inertia.mass, inertia.polar, inertia.transverse) == (1.0, 2.0, 3.0)


def test_facts_of_a_pair_have_its_hand_and_its_common_face() -> None:
    from fe_contact.geometry import Gear, GearPair  # noqa: PLC0415
    from fe_contact.ste import PairFacts  # noqa: PLC0415

    right = Gear(17, 4e-3, 25e-3, 20e-3, helix_angle=0.2)
    left = Gear(31, 4e-3, 20e-3, 20e-3, helix_angle=-0.2)
    facts = PairFacts.of(GearPair(right, left, axial_offset=5e-3))
    assert (facts.teeth, facts.helix_hand, facts.internal) == ((17, 31), 1, False)
    assert math.isclose(facts.face_width, 17.5e-3)
    assert PairFacts.of(GearPair(left, right)).helix_hand == -1


WRONG: dict[str, tuple[Change, str]] = {
    "misspelt": (lambda t: t["bushings"][0].update(stifness=1.0), "bushings[0].stifness"),
    "no such shaft": (lambda t: t["gears"][0].update(shaft="inptu"), "gears[0].shaft"),
    "no such gear": (lambda t: t["meshes"][0].update(driven="ring"), "meshes[0].driven"),
    "mesh with itself": (lambda t: t["meshes"][0].update(driven="pinion"), "meshes[0].driven"),
    "repeated name": (lambda t: t["shafts"][1].update(name="input"), "shafts[1].name"),
    "two sources": (lambda t: t["meshes"][0].update(database_file="x.nc"), "meshes[0].case"),
    "no source": (lambda t: t["meshes"][0].pop("case_file"), "meshes[0].case"),
    "hash that is none": (
        lambda t: (t["meshes"][0].pop("case_file"), t["meshes"][0].update(database_hash="abc")),
        "meshes[0].database_hash",
    ),
    "negative stiffness": (
        lambda t: t["bushings"][0].update(radial_stiffness_n_per_m=-1.0),
        "bushings[0].radial_stiffness_n_per_m",
    ),
    "stiffness no number": (
        lambda t: t["bushings"][0].update(radial_stiffness_n_per_m=float("nan")),
        "bushings[0].radial_stiffness_n_per_m",
    ),
    "times out of order": (
        lambda t: t["drives"][0].update(time_s=[5.0, 0.0]),
        "drives[0].time_s",
    ),
    "curve of one point": (
        lambda t: t.update(
            speed_torques=[
                {"name": "m", "shaft": "input", "kind": "table", "speed_rpm": [1.0], "torque_n_m": [1.0]}
            ]
        ),
        "speed_torques[0].speed_rpm",
    ),
    "fan at rest": (
        lambda t: t.update(
            speed_torques=[
                {"name": "m", "shaft": "input", "kind": "quadratic", "speed_rpm": [0.0], "torque_n_m": [1.0]}
            ]
        ),
        "speed_torques[0].speed_rpm",
    ),
    "speed and angle": (
        lambda t: t["drives"][0].update(angle_deg=[0.0, 1.0, 2.0, 3.0]),
        "drives[0].speed_rpm",
    ),
    "coupling to nothing": (
        lambda t: t.update(
            couplings=[{"name": "c", "first": "input", "second": "x", "torsional_stiffness_n_m_per_rad": 1.0}]
        ),
        "couplings[0].second",
    ),
    "coupling of two speeds": (
        lambda t: t.update(
            couplings=[
                {"name": "c", "first": "input", "second": "output", "torsional_stiffness_n_m_per_rad": 1.0}
            ]
        ),
        "couplings[0].second",
    ),
    "speeds without times": (lambda t: t["drives"][0].update(speed_rpm=[1.0]), "drives[0].speed_rpm"),
    "standing still": (lambda t: t["drives"][0].update(speed_rpm=[0.0, 0.0]), "drives[0].speed_rpm"),
    "no drive": (lambda t: t.update(drives=[]), "drives"),
    "single brackets": (lambda t: t.update(shafts=t["shafts"][0]), "shafts"),
    "axes too far apart": (
        lambda t: t["shafts"][1].update(origin_mm=[81.0, 0.0, 0.0]),
        "shafts[1].origin_mm",
    ),
    "bore beyond the gear": (
        lambda t: t["gears"][0].update(bore_diameter_mm=90.0),
        "gears[0].bore_diameter_mm",
    ),
    "idle gear": (
        lambda t: t["gears"].append({"name": "idle", "shaft": "input", "position_mm": 1.0}),
        "gears[2].name",
    ),
    "two inertias": (
        lambda t: t["shafts"][0].update(
            inertia={"mass_kg": 1.0, "polar_kg_m2": 1.0, "transverse_kg_m2": 1.0}
        ),
        "shafts[0].diameter_mm",
    ),
    "negative duration": (lambda t: t["run"].update(duration_s=-1.0), "run.duration_s"),
    "two drives": (
        lambda t: t["drives"].append({"name": "second", "shaft": "output", "speed_rpm": [10.0]}),
        "drives[1].shaft",
    ),
}


@pytest.mark.parametrize("name", WRONG)
def test_a_scene_that_cannot_be_is_one_fault_by_name(name: str) -> None:
    change, field = WRONG[name]
    with pytest.raises(BadInput) as caught:
        scene(change)
    (fault,) = caught.value.faults
    assert fault.field == field
    assert fault.bound


def test_a_gear_in_two_meshes_must_be_the_same_in_both() -> None:
    table = copy.deepcopy(EXAMPLE)
    table["gears"].append({"name": "third", "shaft": "input", "position_mm": 50.0})
    table["meshes"].append(table["meshes"][0] | {"name": "other", "driver": "third"})
    facts = small_table().facts
    from dataclasses import replace  # noqa: PLC0415

    fields = {name: getattr(small_table(), name) for name in small_table().__dataclass_fields__}
    other = type(small_table())(**fields | {"facts": replace(facts, teeth=(20, 30))})
    with pytest.raises(BadInput, match=r"meshes\[1\]\.driven = 'wheel': must be the gear of 20 teeth"):
        dynamic_scene(validated(SceneInput, table), {"mesh": small_table(), "other": other})


def test_couplings_and_angle_tables_are_in_si() -> None:
    def change(table: dict[str, Any]) -> None:
        table["shafts"].append(
            {"name": "machine", "length_mm": 100.0, "diameter_mm": 50.0, "origin_mm": [80, 0, 200]}
        )
        joint = {
            "name": "joint",
            "first": "output",
            "second": "machine",
            "torsional_stiffness_n_m_per_rad": 5e4,
        }
        identity = [[float(i == j) for i in range(6)] for j in range(6)]
        table["couplings"] = [joint | {"position_mm": 200.0, "stiffness_matrix": identity}]
        table["drives"][0].pop("speed_rpm")
        table["drives"][0].update(time_s=[0.0, 1.0, 2.0, 3.0], angle_deg=[0.0, 180.0, 360.0, 540.0])

    found = scene(change)
    assert found.couplings[0].position == pytest.approx(0.2)
    assert found.couplings[0].stiffness is not None
    assert found.drives[0].speed(0.5) == pytest.approx(math.pi)


def test_torques_by_speed_are_in_si() -> None:
    fan = {"name": "fan", "shaft": "output", "kind": "quadratic", "speed_rpm": [1000.0], "torque_n_m": [40.0]}
    motor = {"name": "m", "shaft": "input", "kind": "table", "speed_rpm": [0, 1500], "torque_n_m": [-50, 0]}
    dry = {"name": "d", "shaft": "input", "kind": "constant", "speed_rpm": [1.0], "torque_n_m": [2.0]}
    found = scene(lambda t: t.update(speed_torques=[fan, motor, dry])).speed_torques
    rpm = math.pi / 30.0
    assert found[0].curve(500.0 * rpm) == pytest.approx(10.0)
    assert found[1].curve(0.0) == pytest.approx(-50.0)
    assert found[2].curve(-3.0 * rpm) == pytest.approx(-2.0)


def test_a_coast_flank_has_the_thickness_of_teeth_that_share_the_pitch() -> None:
    """Against the drawn tooth: the angle between its flanks on the pitch circle, over the pitch."""
    from fe_contact.geometry import Gear, GearPair, ToothProfile  # noqa: PLC0415
    from fe_contact.geometry.backlash import base_circle_backlash  # noqa: PLC0415

    gear = Gear(20, 4e-3, 25e-3, 40e-3, thickness_allowance=50e-6)
    pair = GearPair(gear, gear, 80.3e-3)
    backlash = base_circle_backlash(gear, gear, pair.working_pressure_angle)
    x, y = ToothProfile(gear).involute(gear.base_radius * math.tan(pair.working_pressure_angle))
    drawn = 2.0 * math.atan2(abs(x), y) * gear.teeth / (2.0 * math.pi)

    given = {"backlash_um": 1e6 * backlash}
    found = scene(lambda t: t["meshes"][0].update(coast_flank=given)).meshes[0].coast
    assert found is not None
    assert found.backlash == pytest.approx(backlash, rel=1e-12)
    assert found.thickness == pytest.approx(drawn, rel=1e-9)

    given = {"backlash_um": 80.0, "tooth_thickness": 0.4}
    told = scene(lambda t: t["meshes"][0].update(coast_flank=given)).meshes[0].coast
    assert told is not None
    assert told.thickness == 0.4
    assert scene().meshes[0].coast is None


def test_a_coefficient_of_friction_goes_to_its_mesh() -> None:
    assert scene().meshes[0].friction is None
    assert scene(lambda t: t["meshes"][0].update(friction=0.05)).meshes[0].friction == 0.05
    with pytest.raises(BadInput, match="friction"):
        scene(lambda t: t["meshes"][0].update(friction=0.0))
