"""From a scene file and its tables to the scene of dynamics, planetary sets too; faults by name."""

import math
import tomllib
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from changed_scenes import DROP, By, changed, changed_scene, check_refused
from repository import ROOT
from small_table import BASE_RADIUS, small_table

from dynamics.assembly.assemble import assemble
from dynamics.scene import Scene
from fe_contact.geometry import Gear, GearPair, ToothProfile
from fe_contact.geometry.backlash import base_circle_backlash
from fe_contact.ste import PairGeometry
from lineofaction.gearbox.convert.scene import dynamic_scene
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas import validated
from lineofaction.gearbox.schemas.scene import SceneInput

EXAMPLE = tomllib.loads((ROOT / "examples" / "palermo_scene.toml").read_text())


def scene(changes: dict[str, Any] | None = None) -> Scene:
    return changed_scene(EXAMPLE, changes or {})


def test_the_papers_scene_is_in_si():
    found = scene()
    assert [shaft.length for shaft in found.shafts] == pytest.approx([0.2, 0.2])
    assert found.shafts[1].origin == pytest.approx((0.08, 0.0, 0.0))
    assert len(found.bushings) == 4
    assert {b.radial_stiffness for b in found.bushings} | {b.axial_stiffness for b in found.bushings} == {1e8}
    assert found.drives[0].speed.value == pytest.approx((0.0, 955.0 * 2.0 * math.pi / 60.0))
    assert found.loads[0].torque.value == (100.0,)
    assert (found.duration, found.outputs.sample_rate) == (5.0, 2e4)
    assert found.integration.tolerance == pytest.approx(1e-9)


def test_effects_follow_a_tenth_of_a_decibel_and_runs_the_audio_band_unless_stated():
    assert (scene().level_tolerance, scene().tolerance, scene().outputs.band) == (0.1, None, 20e3)
    stated = scene({"accuracy.level_tolerance_db": 0.25, "outputs.band_hz": 5e4})
    assert (stated.level_tolerance, stated.outputs.band) == (0.25, 5e4)
    assert scene({"accuracy.level_tolerance_db": 0.0}).level_tolerance is None
    check_refused(EXAMPLE, "accuracy.level_tolerance_db", 3.5)
    check_refused(EXAMPLE, "outputs.band_hz", 500.0)


def test_gears_take_their_teeth_from_the_table():
    pinion, wheel = scene().gears
    assert (pinion.teeth, wheel.teeth) == (20, 20)
    assert pinion.base_radius == pytest.approx(BASE_RADIUS)
    assert pinion.position == pytest.approx(0.1)
    assert pinion.inertia.mass == pytest.approx(7850 * math.pi * (0.04**2 - 0.02**2) * 0.025, rel=1e-12)


def test_the_mesh_uses_the_table_it_was_given():
    mesh = scene({"meshes[0].technique": "constant_torque", "meshes[0].misalignment_um": 0.0}).meshes[0]
    assert mesh.technique == "constant_torque"
    assert mesh.table.deflection.shape[-1] == mesh.table.level.size


def test_given_inertia_is_used_as_it_is():
    given = {"mass_kg": 1.0, "polar_kg_m2": 2.0, "transverse_kg_m2": 3.0}
    found = scene({"gears[0].inertia": given, "shafts[0].diameter_mm": DROP, "shafts[0].inertia": given})
    for inertia in (found.gears[0].inertia, found.shafts[0].inertia):
        assert (inertia.mass, inertia.polar, inertia.transverse) == (1.0, 2.0, 3.0)


def test_facts_of_a_pair_have_its_hand_and_its_common_face():
    right = Gear(17, 4e-3, 25e-3, 20e-3, helix_angle=0.2)
    left = Gear(31, 4e-3, 20e-3, 20e-3, helix_angle=-0.2)
    geometry = PairGeometry.of(GearPair(right, left, axial_offset=5e-3))
    assert (geometry.teeth, geometry.helix_hand, geometry.internal) == ((17, 31), 1, False)
    assert math.isclose(geometry.face_width, 17.5e-3)
    assert PairGeometry.of(GearPair(left, right)).helix_hand == -1


UNIT = {"mass_kg": 1.0, "polar_kg_m2": 1.0, "transverse_kg_m2": 1.0}
CURVE = {"name": "m", "shaft": "input", "torque_n_m": [1.0]}
JOINT = {"name": "c", "first": "input", "second": "x", "torsional_stiffness_n_m_per_rad": 1.0}
WRONG: dict[str, tuple[str, Any]] = {
    "misspelt": ("bushings[0].stifness", 1.0),
    "no such shaft": ("gears[0].shaft", "inptu"),
    "no such gear": ("meshes[0].driven", "ring"),
    "mesh with itself": ("meshes[0].driven", "pinion"),
    "repeated name": ("shafts[1].name", "input"),
    "two sources": ("meshes[0].case", By({"meshes[0].database_file": "x.nc"})),
    "no source": ("meshes[0].case", By({"meshes[0].case_file": DROP})),
    "hash that is none": (
        "meshes[0].database_hash",
        By({"meshes[0].case_file": DROP, "meshes[0].database_hash": "abc"}),
    ),
    "stiffness no number": ("bushings[0].radial_stiffness_n_per_m", float("nan")),
    "times out of order": ("drives[0].time_s", [5.0, 0.0]),
    "curve of one point": (
        "speed_torques[0].speed_rpm",
        By(speed_torques=[CURVE | {"kind": "table", "speed_rpm": [1.0]}]),
    ),
    "fan at rest": (
        "speed_torques[0].speed_rpm",
        By(speed_torques=[CURVE | {"kind": "quadratic", "speed_rpm": [0.0]}]),
    ),
    "speed and angle": ("drives[0].speed_rpm", By({"drives[0].angle_deg": [0.0, 1.0, 2.0, 3.0]})),
    "coupling to nothing": ("couplings[0].second", By(couplings=[JOINT])),
    "coupling of two speeds": ("couplings[0].second", By(couplings=[JOINT | {"second": "output"}])),
    "speeds without times": ("drives[0].speed_rpm", [1.0]),
    "standing still": ("drives[0].speed_rpm", [0.0, 0.0]),
    "no drive": ("drives", []),
    "single brackets": ("shafts", EXAMPLE["shafts"][0]),
    "axes too far apart": ("shafts[1].origin_mm", [81.0, 0.0, 0.0]),
    "bore beyond the gear": ("gears[0].bore_diameter_mm", 90.0),
    "idle gear": ("gears[2].name", By({"gears[2]": {"name": "idle", "shaft": "input", "position_mm": 1.0}})),
    "two inertias": ("shafts[0].diameter_mm", By({"shafts[0].inertia": UNIT})),
    "two drives": (
        "drives[1].shaft",
        By({"drives[1]": {"name": "second", "shaft": "output", "speed_rpm": [10.0]}}),
    ),
}


@pytest.mark.parametrize("name", WRONG)
def test_a_scene_that_cannot_be_is_one_fault_by_name(name):
    check_refused(EXAMPLE, *WRONG[name])


def test_a_gear_in_two_meshes_must_be_the_same_in_both():
    third = {"name": "third", "shaft": "input", "position_mm": 50.0}
    mesh = EXAMPLE["meshes"][0] | {"name": "other", "driver": "third"}
    table, own = changed(EXAMPLE, {"gears[2]": third, "meshes[1]": mesh}), small_table()
    other = replace(own, geometry=replace(own.geometry, teeth=(20, 30)))
    with pytest.raises(BadInput, match=r"meshes\[1\]\.driven = 'wheel': must be the gear of 20 teeth"):
        dynamic_scene(validated(SceneInput, table), {"mesh": own, "other": other})


def test_couplings_and_angle_tables_are_in_si():
    joint = {"name": "joint", "first": "output", "second": "machine", "position_mm": 200.0}
    joint |= {"torsional_stiffness_n_m_per_rad": 5e4, "stiffness_matrix": np.eye(6).tolist()}
    found = scene(
        {
            "shafts[2]": {
                "name": "machine", "length_mm": 100.0, "diameter_mm": 50.0, "origin_mm": [80, 0, 200],
            },
            "couplings": [joint],
            "drives[0].speed_rpm": DROP,
            "drives[0].time_s": [0.0, 1.0, 2.0, 3.0],
            "drives[0].angle_deg": [0.0, 180.0, 360.0, 540.0],
        }
    )  # fmt: skip
    assert found.couplings[0].position == pytest.approx(0.2)
    assert found.couplings[0].stiffness is not None
    assert found.drives[0].speed(0.5) == pytest.approx(math.pi)


def test_torques_by_speed_are_in_si():
    fan = {"name": "fan", "shaft": "output", "kind": "quadratic", "speed_rpm": [1000.0], "torque_n_m": [40.0]}
    motor = {"name": "m", "shaft": "input", "kind": "table", "speed_rpm": [0, 1500], "torque_n_m": [-50, 0]}
    dry = {"name": "d", "shaft": "input", "kind": "constant", "speed_rpm": [1.0], "torque_n_m": [2.0]}
    found = scene({"speed_torques": [fan, motor, dry]}).speed_torques
    rpm = math.pi / 30.0
    assert found[0].curve(500.0 * rpm) == pytest.approx(10.0)
    assert found[1].curve(0.0) == pytest.approx(-50.0)
    assert found[2].curve(-3.0 * rpm) == pytest.approx(-2.0)


def test_a_coast_flank_has_the_thickness_of_teeth_that_share_the_pitch():
    """Against the drawn tooth: the angle between its flanks on the pitch circle, over the pitch."""
    gear = Gear(20, 4e-3, 25e-3, 40e-3, thickness_allowance=50e-6)
    pair = GearPair(gear, gear, 80.3e-3)
    backlash = base_circle_backlash(gear, gear, pair.working_pressure_angle)
    x, y = ToothProfile(gear).involute(gear.base_radius * math.tan(pair.working_pressure_angle))
    drawn = 2.0 * math.atan2(abs(x), y) * gear.teeth / (2.0 * math.pi)

    given = {"backlash_um": 1e6 * backlash}
    found = scene({"meshes[0].coast_flank": given}).meshes[0].coast
    assert found.backlash == pytest.approx(backlash, rel=1e-12)
    assert found.thickness == pytest.approx(drawn, rel=1e-9)

    given = {"backlash_um": 80.0, "tooth_thickness": 0.4}
    told = scene({"meshes[0].coast_flank": given}).meshes[0].coast
    assert told.thickness == 0.4
    assert scene().meshes[0].coast is None


def test_a_coefficient_of_friction_goes_to_its_mesh():
    assert scene().meshes[0].friction is None
    assert scene({"meshes[0].friction": 0.05}).meshes[0].friction == 0.05
    with pytest.raises(BadInput, match="friction"):
        scene({"meshes[0].friction": 0.0})


def ring_table() -> Any:
    """The small table as that of 20 teeth in a ring of 60, at the same center distance and base pitch."""
    table = small_table()
    radius = (BASE_RADIUS, 3.0 * BASE_RADIUS)
    geometry = replace(table.geometry, teeth=(20, 60), base_radius=radius, internal=True)
    return replace(table, geometry=geometry)


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


def planetary(changes: dict[str, Any] | None = None) -> Scene:
    return changed_scene(PLANETARY, changes or {}, {"ring mesh": ring_table()})


def test_a_planetary_set_has_all_its_planets():
    found = planetary()
    assert [gear.internal for gear in found.gears[:3]] == [False, False, True]
    assert len(found.meshes) == 8
    assert found.shafts[4].origin == pytest.approx((0.0, 0.08, 0.0))
    assert [b.tangential_error for b in found.planet_bearings] == pytest.approx([2e-5, 0.0, 0.0, 0.0])
    assert found.drives[0].stiffness == 1e7
    assert found.free_rotations[0].initial_speed == pytest.approx(20.0 * math.pi)


@pytest.mark.parametrize(
    ("field", "value"),
    [
        (
            "planets[0].number",
            By({"planets[0].number": 3, "planets[0].tangential_errors_um": [0.0] * 3}),
        ),
        ("planets[0].tangential_errors_um", By({"planets[0].number": 3})),
        ("planets[0].planet", "moon"),
        ("shafts[0].frame", "nobody"),
        ("meshes[0].driven", By({"shafts[0].frame": DROP})),
        ("planet_bearings[0].carrier", "ring"),
        ("drives[0].speed_rpm", By(free_rotations=[])),
        ("free_rotations[0].sense", "-z"),
    ],
)
def test_planetary_sets_that_cannot_be_are_one_fault_by_name(field, value):
    check_refused(PLANETARY, field, value, {"ring mesh": ring_table()})


def test_a_ring_gear_may_drive():
    """The wheel of its case then is the driver; an external wheel is told to be another case's pinion."""
    ring = {"name": "ring mesh", "case_file": "ring.toml", "driver": "ring", "driven": "planet"}
    turned = {
        "meshes[0].driver": "planet",
        "meshes[0].driven": "sun",
        "loads[0]": {"name": "motor", "shaft": "carrier", "torque_n_m": [-200.0]},
        "loads[1]": {"name": "brake", "shaft": "sun", "torque_n_m": [50.0]},
    }
    found = planetary(turned | {"meshes[1]": ring | {"wheel_drives": True}})
    assert [gear.internal for gear in found.gears[:3]] == [False, False, True]
    with pytest.raises(BadInput, match=r"meshes\[1\]\.driven"):
        planetary(turned | {"meshes[1]": ring | {"wheel_drives": False}})
    with pytest.raises(BadInput, match=r"meshes\[0\]\.wheel_drives"):
        planetary({"meshes[0].wheel_drives": True})


def test_the_planetary_example_is_a_system():
    """On fake tables with the facts of its pairs: six meshes, all torques carried, planets that fit."""
    table = small_table()

    def of(teeth, internal):
        base = math.cos(math.radians(20.0)) * 1e-3
        radius = (base * teeth[0], base * teeth[1])
        geometry = replace(table.geometry, teeth=teeth, base_radius=radius, base_pitch=2.0 * math.pi * base)
        geometry = replace(geometry, center_distance=0.06, internal=internal)
        return replace(table, geometry=geometry, torque=table.force * radius[0])

    example = tomllib.loads((ROOT / "examples" / "planetary_scene.toml").read_text())
    tables = {"sun mesh": of((24, 36), False), "ring mesh": of((36, 96), True)}
    system = assemble(changed_scene(example, {}, tables))
    assert len(system.scene.meshes) == 6
    assert system.kinematics.ratio[0][0] * 5 == 1  # the carrier
    base = math.cos(math.radians(20.0)) * 1e-3
    assert system.flanks.nominal_force == pytest.approx([60.0 / 3.0 / (24 * base)] * 6)
