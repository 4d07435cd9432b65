"""Complaints: the mesh and the harmonic that teeth, ratios and speeds give by hand, and bad questions."""

import json
import math
import tomllib
from typing import Any

import pytest
from pytest import approx
from repository import ROOT
from typer.testing import CliRunner

import lineofaction as loa
from dynamics.mechanism.passing import MESH, SIDEBAND
from lineofaction.cli.commands import app
from lineofaction.gearbox.convert.case_plausibility import case_warnings
from lineofaction.gearbox.convert.checked_case import CheckedCase
from lineofaction.gearbox.convert.complaint import Complaint, complaint_of, complaint_of_case, marks_of_case
from lineofaction.gearbox.convert.scene import check_scene
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas import validated
from lineofaction.gearbox.schemas.case import Case
from lineofaction.gearbox.schemas.complaint import ComplaintFields, ComplaintInput, with_options
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.report.document import read_inputs
from lineofaction.report.drawing.marks import of_run
from lineofaction.report.response.complaint import PAGE

Json = dict[str, Any]
ANGLE = math.radians(20.0)


def train(*stages: tuple[int, int], idler: bool = False) -> Json:
    """Return a scene of stages of module 2 mm one behind another; an idler's gear is in both meshes."""
    shafts, gears, meshes, x = [{"name": "shaft 0"}], [], [], 0.0
    for k, (pinion, wheel) in enumerate(stages):
        driver = f"wheel {k - 1}" if idler and k else f"pinion {k}"
        gears += [] if idler and k else [{"name": driver, "shaft": f"shaft {k}"}]
        gears.append({"name": f"wheel {k}", "shaft": f"shaft {k + 1}"})
        x += pinion + wheel
        shafts.append({"name": f"shaft {k + 1}", "origin_mm": [x, 0.0, 0.0]})
        stiffness = {
            "teeth": [pinion, wheel],
            "base_radius_mm": pinion * math.cos(ANGLE),
            "working_pressure_angle_deg": 20.0,
            "face_width_mm": 20.0,
            "stiffness_n_per_m": {"value": [3e8]},
        }
        meshes.append({"name": f"mesh {k}", "driver": driver, "driven": f"wheel {k}", "stiffness": stiffness})
    last = f"shaft {len(stages)}"
    return {
        "run": {"duration_s": 1.0},
        "shafts": [{"length_mm": 50.0, "diameter_mm": 20.0} | shaft for shaft in shafts],
        "gears": [{"position_mm": 25.0, "bore_diameter_mm": 20.0} | gear for gear in gears],
        "meshes": meshes,
        "drives": [{"name": "motor", "shaft": "shaft 0", "speed_rpm": [1000.0]}],
        "loads": [{"name": "brake", "shaft": last, "torque_n_m": [10.0]}],
    }


def planetary(held: str = "ring") -> Json:
    """Return the set of Lin and Parker: sun 27, planets 36, ring 99 teeth; the sun turns."""
    scene = tomllib.loads((ROOT / "examples/lin_parker_planetary_scene.toml").read_text("utf-8"))
    scene["drives"] = [
        {"name": "held", "shaft": held, "speed_rpm": [0.0]},
        {"name": "motor", "shaft": "sun", "speed_rpm": [1000.0]},
    ]
    scene["loads"] = [
        {"name": "brake", "shaft": "ring" if held == "carrier" else "carrier", "torque_n_m": [10.0]}
    ]
    scene.pop("free_rotations", None)
    return scene


def asked(scene: Json, levels: dict[str, tuple[float, ...]] | None = None, **fields: Any) -> Complaint:
    stated = validated(SceneInput, scene | {"complaint": fields})
    return complaint_of(stated, check_scene(stated, {}), levels or {})


PAIR, UNIT = train((25, 61)), train((25, 63), (21, 74))
IDLER = train((30, 45), (45, 60), idler=True)
AT_40 = {"road_speed_km_h": 40.0, "tire_radius_mm": 310.0}
# by hand: rev/s of the shaft times teeth times harmonic; planetary: (sun - carrier) 27, carrier = 27/126 sun
CASES: tuple[tuple[Json, Json, list[str], float], ...] = (
    # 1000 rpm: 16.667 x 25 = 416.67 Hz
    (PAIR, {"frequency_hz": 417.0, "speed_rpm": 1000.0}, ["mesh 0 h1"], 416.667),
    # 3360 rpm: 56 x 25 = 1400 Hz, twice that
    (PAIR, {"frequency_hz": 2810.0, "speed_rpm": 3360.0}, ["mesh 0 h2"], 2800.0),
    # speed of the wheel's shaft: 10 x 61 x 3 = 1830 Hz
    (PAIR, {"frequency_hz": 1800.0, "speed_rpm": 600.0, "shaft": "shaft 1"}, ["mesh 0 h3"], 1830.0),
    # 40 km/h: 11.111 / (2 pi 0.31) = 5.7045 rev/s x 61 x 4 = 1391.9 Hz
    (PAIR, {"frequency_hz": 1400.0, **AT_40}, ["mesh 0 h4"], 1391.9),
    # order 50 of the pinion's shaft is 2 x 25, at any speed
    (PAIR, {"order": 50.0}, ["mesh 0 h2"], math.nan),
    # order 61 of the wheel's shaft at 600 rpm: 610 Hz
    (PAIR, {"order": 61.0, "shaft": "shaft 1", "speed_rpm": 600.0}, ["mesh 0 h1"], 610.0),
    # 3000 rpm: 50 x 25 = 1250; 50 x 25/63 x 21 = 416.67, three times that is 1250: both, always
    (UNIT, {"frequency_hz": 1250.0, "speed_rpm": 3000.0}, ["mesh 0 h1", "mesh 1 h3"], 1250.0),
    # twice 416.67
    (UNIT, {"frequency_hz": 833.0, "speed_rpm": 3000.0}, ["mesh 1 h2"], 833.333),
    # 40 km/h, axle 3.2: 18.254 rev/s x 74 = 1350.8 Hz; the first stage 18.254 x 74/21 x 63 = 4052
    (UNIT, {"frequency_hz": 1370.0, **AT_40, "final_ratio": 3.2}, ["mesh 1 h1"], 1350.8),
    # an idler: 1000 rpm x 30 = 500 Hz in both its meshes
    (IDLER, {"frequency_hz": 505.0, "speed_rpm": 1000.0}, ["mesh 0 h1", "mesh 1 h1"], 500.0),
    # sun 4450 rpm, ring held: carrier 953.57; 3496.43 / 60 x 27 = 1573.4 Hz in both meshes, twice that
    (
        planetary(),
        {"frequency_hz": 3150.0, "speed_rpm": 4450.0, "shaft": "sun"},
        ["sun mesh h2", "ring mesh h2"],
        3146.8,
    ),
    # carrier 1000 rpm, ring held: 16.667 x 99 = 1650 Hz
    (
        planetary(),
        {"frequency_hz": 1660.0, "speed_rpm": 1000.0, "shaft": "carrier"},
        ["sun mesh h1", "ring mesh h1"],
        1650.0,
    ),
    # carrier held: a train, 1000 rpm x 27 = 450 Hz
    (
        planetary("carrier"),
        {"frequency_hz": 1340.0, "speed_rpm": 1000.0, "shaft": "sun"},
        ["sun mesh h3", "ring mesh h3"],
        1350.0,
    ),
)


@pytest.mark.parametrize(("scene", "fields", "names", "hertz"), CASES)
def test_the_mesh_and_the_harmonic_are_those_of_the_table(scene, fields, names, hertz):
    complaint = asked(scene, **fields)
    within = complaint.within
    assert [f"{each.excitation.name} h{each.harmonic}" for each in within] == names
    assert {each.excitation.kind for each in within} == {MESH}
    found = complaint.hertz(within[0].order)
    assert found is None if math.isnan(hertz) else found == approx(hertz, rel=1e-4)


def test_orders_are_counted_as_results_count_them():
    """Results count by pitches of the first mesh: the second stage's second harmonic is 2/3 of one."""
    complaint = asked(UNIT, frequency_hz=833.0, speed_rpm=3000.0)
    assert complaint.marks["order"] == approx(2.0 / 3.0)
    assert complaint.marks["axes"]["speed of shaft 2, rpm"] == approx(3000.0 * 25 * 21 / (63 * 74))
    assert complaint.marks["axes"]["frequency, Hz"] == 833.0


def test_a_far_harmonic_is_no_better_for_being_a_little_nearer():
    """30/41 and 22/61: 1 x 30 and 4 x 22 x 30/41 = 64.39; 61 of 60 and 64.39 lies between twice and that."""
    complaint = asked(train((30, 41), (22, 61)), order=62.5)
    near, far = complaint.within
    assert (near.excitation.name, near.harmonic, far.excitation.name, far.harmonic) == (
        "mesh 0",
        2,
        "mesh 1",
        4,
    )
    assert abs(far.distance) < abs(near.distance) and complaint.ranked_by == "harmonic number"
    assert complaint.marks["order"] == approx(2.0)


def test_what_excites_more_is_likelier():
    """The same with 1 N by harmonic 2 of the first stage, 3 N by harmonic 4 of the second."""
    levels = {"mesh 0": (9.0, 1.0), "mesh 1": (9.0, 9.0, 9.0, 3.0)}
    complaint = asked(train((30, 41), (22, 61)), levels, order=62.5)
    assert [each.excitation.name for each in complaint.within] == ["mesh 1", "mesh 0"]
    assert complaint.ranked_by == "excitation"
    # a level that is not known leaves none to rank by
    unknown = asked(train((30, 41), (22, 61)), {"mesh 0": (9.0, 1.0)}, order=62.5)
    assert unknown.ranked_by == "harmonic number"


@pytest.mark.law
@pytest.mark.parametrize(
    ("order", "side", "harmonic"),
    # ring of 99 at rest, 3 planets: 99 is a multiple of 3, so that 99 - 3, 99 + 3 and 198 + 3 pass
    [(96.0, "lower", 1), (102.0, "upper", 1), (201.0, "upper", 2)],
)
def test_planets_pass_beside_the_harmonics_of_their_meshes(order, side, harmonic):
    complaint = asked(planetary(), order=order, shaft="carrier")
    bands = [each for each in complaint.within if each.excitation.kind == SIDEBAND]
    assert {(each.excitation.name, each.excitation.part, each.harmonic) for each in bands} == {
        ("sun mesh", side, harmonic),
        ("ring mesh", side, harmonic),
    }
    assert all(each.distance == approx(0.0, abs=1e-9) for each in bands)


@pytest.mark.law
def test_sidebands_are_those_that_the_planets_leave():
    """7 planets, ring of 99 at rest: 98 and 105 are multiples of 7, of the sun as well; of 3: 96, 102."""
    for number, orders in ((3, {96.0, 102.0}), (7, {98.0, 105.0})):
        scene = planetary()
        scene["planets"][0]["number"] = number
        complaint = asked(scene, order=99.0, shaft="carrier", tolerance_percent=20.0)
        for mesh in ("ring mesh", "sun mesh"):
            assert {
                round(each.order, 6)
                for each in complaint.passing
                if (each.excitation.kind, each.excitation.name) == (SIDEBAND, mesh)
            } == orders
    held = asked(planetary("carrier"), frequency_hz=1340.0, speed_rpm=1000.0, shaft="sun")
    assert not any(each.excitation.kind == SIDEBAND for each in held.passing)


def with_balls(count: int, diameter_mm: float, pitch_diameter_mm: float) -> Json:
    row = {"count": count, "diameter_mm": diameter_mm, "pitch_diameter_mm": pitch_diameter_mm}
    bearing = {"name": "left", "shaft": "shaft 0", "position_mm": 0.0, "ball": row}
    return PAIR | {"rolling_bearings": [bearing]}


def test_a_bearing_is_named_where_no_mesh_passes():
    """9 balls of 10 mm on 50 mm: 9 (1 - 0.2) / 2 = 3.6 pass the outer ring a revolution; twice is 120 Hz."""
    (only,) = asked(with_balls(9, 10.0, 50.0), frequency_hz=121.0, speed_rpm=1000.0).within
    of = only.excitation
    assert (of.kind, of.name, of.part, only.harmonic) == ("bearing", "left", "outer ring", 2)


def test_a_bearing_is_named_behind_a_mesh_only_where_it_is_nearer():
    """22 balls of 6 mm on 60 mm: 22 (1 + 0.1) / 2 = 12.1 pass the inner ring, twice 24.2; the mesh has 25."""
    scene = with_balls(22, 6.0, 60.0)
    nearer, farther = (asked(scene, order=order).within for order in (24.4, 24.8))
    assert [each.excitation.kind for each in nearer] == [MESH, "bearing"]
    assert nearer[1].order == approx(24.2)
    assert [each.excitation.kind for each in farther] == [MESH]


GEARS = {"face_width_mm": 30.0, "bore_diameter_mm": 20.0}
CASE: Json = {
    "pair": {
        "normal_module_mm": 2.0,
        "center_distance_mm": 86.0,
        "pinion": {"teeth": 25, **GEARS},
        "wheel": {"teeth": 61, **GEARS},
    },
    "load": {"torque_n_m": [40.0, 80.0]},
}


@pytest.mark.parametrize(
    ("fields", "harmonic", "hertz"),
    [
        # 40 km/h: 5.7045 rev/s x 4.02 of the wheel x 61 = 1398.9 Hz
        ({"frequency_hz": 1400.0, **AT_40, "final_ratio": 4.02}, 1, 1398.9),
        # the same with the pinion on the axle: 5.7045 x 4.02 x 25 x 2 = 1146.6 Hz
        ({"frequency_hz": 1150.0, **AT_40, "final_ratio": 4.02, "final_shaft": "pinion"}, 2, 1146.6),
        # 3360 rpm of the pinion: 56 x 25 x 3 = 4200 Hz
        ({"frequency_hz": 4150.0, "speed_rpm": 3360.0}, 3, 4200.0),
        # order 122 of the wheel at 40 km/h: 2 x 61, at 5.7045 rev/s
        ({"order": 122.0, "shaft": "wheel", **AT_40}, 2, 695.9),
        ({"order": 50.0}, 2, math.nan),
    ],
)
def test_a_case_complains_of_its_pair(fields, harmonic, hertz):
    complaint = complaint_of_case(validated(Case, CASE | {"complaint": fields}))
    (only,) = complaint.within
    assert (only.excitation.kind, only.harmonic) == (MESH, harmonic)
    found = complaint.hertz(only.order)
    assert found is None if math.isnan(hertz) else found == approx(hertz, rel=1e-4)
    assert complaint.torques == {"pair": 80.0}


def test_the_table_of_a_case_is_marked_at_its_harmonic_its_speed_and_its_torque():
    fields = {"frequency_hz": 1400.0, "speed_rpm": 3360.0 / 2.44, "shaft": "wheel", "torque_n_m": 60.0}
    case = validated(Case, CASE | {"complaint": fields})
    marks = of_run(marks_of_case(case.model_dump(mode="json")) or {}, "pair")
    assert marks["axes"] == {
        "frequency, Hz": 1400.0,
        "mesh order": approx(1.0),
        "speed of the driving gear, rpm": approx(3360.0),
        "torque on the driving gear, N m": 60.0,
    }
    assert marks_of_case(CASE) is None


@pytest.mark.parametrize(
    ("fields", "field", "said"),
    [
        ({"order": 25.0, "shaft": "axle"}, "complaint.shaft", "pinion, wheel"),
        ({"order": 25.0, "bearing": "left"}, "complaint.bearing", "neither bearings"),
        ({"order": 25.0, "microphone_mm": [0.0, 0.0, 1.0]}, "complaint.microphone_mm", "nor housing"),
        # 1000 rpm: 416.7 and 833.3 Hz
        ({"frequency_hz": 550.0, "speed_rpm": 1000.0}, "complaint.frequency_hz", "416.7 Hz, off by -24 %"),
    ],
)
def test_a_bad_complaint_of_a_case_is_refused_by_every_verb(fields, field, said):
    with pytest.raises(BadInput) as error:
        case_warnings(CheckedCase(validated(Case, CASE | {"complaint": fields})))
    (fault,) = error.value.faults
    assert fault.field == field and said in f"{fault.bound} {fault.suggestion}"


REFUSED: tuple[tuple[Json, str, str], ...] = (
    ({"frequency_hz": math.nan, "speed_rpm": 1000.0}, "complaint.frequency_hz", "finite"),
    ({"frequency_hz": -1400.0, "speed_rpm": 1000.0}, "complaint.frequency_hz", "above 0"),
    ({"frequency_hz": 0.0, "speed_rpm": 1000.0}, "complaint.frequency_hz", "above 0"),
    ({"frequency_hz": 1e9, "speed_rpm": 1000.0}, "complaint.frequency_hz", "100000"),
    ({"frequency_hz": 1.4, "speed_rpm": 1000.0}, "complaint.frequency_hz", "1400"),
    ({"frequency_hz": 1400.0}, "complaint.speed_rpm", "road_speed_km_h"),
    ({"speed_rpm": 1000.0}, "complaint.frequency_hz", "order"),
    ({"frequency_hz": 1400.0, "speed_rpm": 0.0}, "complaint.speed_rpm", "above 0"),
    ({"frequency_hz": 1400.0, "speed_rpm": math.inf}, "complaint.speed_rpm", "finite"),
    ({"frequency_hz": 1400.0, "order": 3.0, "speed_rpm": 1000.0}, "complaint.order", "frequency_hz"),
    ({"frequency_hz": 1400.0, "speed_rpm": 1e3, **AT_40}, "complaint.speed_rpm", "road_speed_km_h"),
    ({"frequency_hz": 1400.0, "road_speed_km_h": 40.0}, "complaint.tire_radius_mm", "given"),
    ({"frequency_hz": 1400.0, **AT_40, "road_speed_km_h": 0.4}, "complaint.road_speed_km_h", "km/h"),
    ({"frequency_hz": 1400.0, **AT_40, "tire_radius_mm": 0.31}, "complaint.tire_radius_mm", "310"),
    ({"frequency_hz": 1400.0, **AT_40, "final_ratio": -1.0}, "complaint.final_ratio", "above 0"),
    ({"frequency_hz": 1400.0, **AT_40, "final_shaft": "axle"}, "complaint.final_shaft", "shaft 1"),
    ({"frequency_hz": 400.0, "speed_rpm": 1e3, "shaft": "axle"}, "complaint.shaft", "shaft 0"),
    ({"frequency_hz": 417.0, "speed_rpm": 1e3, "bearing": "left"}, "complaint.bearing", "none"),
    ({"frequency_hz": 417.0, "speed_rpm": 1e3, "tire_radius_mm": 310.0}, "complaint.tire_radius_mm", "road"),
    ({"order": 0.0}, "complaint.order", "above 0"),
    # 416.67 and 833.33 Hz pass: 550 is 24 % and 52 % off
    ({"frequency_hz": 550.0, "speed_rpm": 1000.0}, "complaint.frequency_hz", "416.7 Hz, off by -24 %"),
    ({"order": 33.0}, "complaint.order", 'order 25.0 of shaft 0, harmonic 1 of mesh "mesh 0"'),
    (
        {"frequency_hz": 417.0, "speed_rpm": 1000.0, "microphone_mm": [0.0, 0.0, 1000.0]},
        "complaint.microphone_mm",
        "no housing",
    ),
    ({"order": 25.0, "torque_n_m": 60.0}, "complaint.torque_n_m", "loads of the scene"),
)


@pytest.mark.parametrize(("fields", "field", "said"), REFUSED)
def test_a_bad_question_is_one_sentence_that_names_its_field(fields, field, said):
    with pytest.raises(BadInput) as error:
        asked(PAIR, **fields)
    (fault,) = error.value.faults
    assert fault.field == field
    assert said in f"{fault.bound} {fault.suggestion}"


def test_a_speed_beyond_a_table_of_torques_is_refused():
    table = {
        "name": "motor",
        "shaft": "shaft 0",
        "kind": "table",
        "speed_rpm": [0.0, 2000.0],
        "torque_n_m": [1.0, 2.0],
    }
    scene = PAIR | {"speed_torques": [table]}
    assert asked(scene, frequency_hz=417.0, speed_rpm=1000.0).within
    with pytest.raises(BadInput) as error:
        asked(scene, frequency_hz=417.0 * 2.5, speed_rpm=2500.0)
    (fault,) = error.value.faults
    assert fault.field == "complaint.speed_rpm"
    assert "0 to 2000 rpm" in fault.bound


def test_the_shaft_of_the_wheels_is_asked_for_where_several_are_loaded():
    second = {"name": "pump", "shaft": "shaft 0", "torque_n_m": [1.0]}
    scene = PAIR | {"loads": [*PAIR["loads"], second]}
    with pytest.raises(BadInput, match="2 shafts have a load"):
        asked(scene, frequency_hz=1400.0, **AT_40)
    assert asked(scene, frequency_hz=1400.0, **AT_40, final_shaft="shaft 1").within


def test_an_option_replaces_what_it_is_an_alternative_to():
    own = ComplaintInput(frequency_hz=1400.0, **AT_40)
    assert with_options(own, ComplaintFields(order=25.0)) == {"order": 25.0, **AT_40}
    by_shaft = with_options(own, ComplaintFields(speed_rpm=1000.0))
    assert by_shaft == {"frequency_hz": 1400.0, "speed_rpm": 1000.0}
    assert with_options(own, ComplaintFields(road_speed_km_h=50.0))["tire_radius_mm"] == 310.0


def test_a_run_keeps_what_its_scene_complains_of(tmp_path):
    """By the mesh: its own order, and the speed of the shaft of its driving gear."""
    scene = UNIT | {"complaint": {"frequency_hz": 833.0, "speed_rpm": 3000.0}, "run": {"duration_s": 1e-3}}
    (tmp_path / "scene.json").write_text(json.dumps(scene))
    done = CliRunner().invoke(app, ["simulate", str(tmp_path / "scene.json"), "-o", str(tmp_path / "run.nc")])
    assert done.exit_code == 0, done.stderr
    marks = read_inputs([tmp_path / "run.nc"]).marks
    assert marks["meshes"] == {
        "mesh 0": {"order": approx(2.0 / 3.0), "driver_rpm": approx(3000.0), "torque_n_m": None},
        "mesh 1": {"order": approx(2.0), "driver_rpm": approx(3000.0 * 25 / 63), "torque_n_m": None},
    }
    assert marks["axes"]["frequency, Hz"] == 833.0


@pytest.mark.law
def test_a_study_over_speed_leaves_out_the_torque_of_a_run_up():
    """From rest to 1000 rpm in 20 ms: the flanks carry the brake's 10 N m alone, and so does the answer."""
    scene = train((25, 61))
    stiffness = {"value": [3e8], "amplitude": [4e7]}
    scene["meshes"][0]["stiffness"]["stiffness_n_per_m"] = stiffness
    running = loa.response(scene, speed_rpm=[900.0], orders=2)
    scene["drives"][0] |= {"time_s": [0.0, 0.02], "speed_rpm": [0.0, 1000.0]}
    rising = loa.response(scene, speed_rpm=[900.0], orders=2)
    assert running.mean_force[0] == approx(10.0 / (0.061 * math.cos(ANGLE)), rel=1e-9)
    assert rising.mean_force == approx(running.mean_force, rel=1e-12)
    assert rising.mesh_force == approx(running.mesh_force, rel=1e-9)


def test_an_answer_names_the_speed_of_its_complaint_not_that_of_a_drive():
    scene = train((25, 61))  # driven at 1000 rpm
    scene["meshes"][0]["stiffness"]["stiffness_n_per_m"] = {"value": [3e8], "amplitude": [4e7]}
    for shaft, rpm in (("shaft 0", 610.0), ("shaft 1", 250.0)):
        answer = loa.complaint(scene, frequency_hz=254.0, speed_rpm=rpm, shaft=shaft)
        said = f"at 10 N m on shaft 1, {rpm:.0f} rpm of {shaft}"
        assert answer.metadata["operating_point"] == said
        assert answer.complaint.within[0].harmonic == 1


def test_a_force_that_no_linear_response_holds_is_told():
    """A stiffness that swings by 80 % parts the flanks in the torsional mode, at any load."""
    scene = train((25, 61))
    mode = loa.modes(scene, speed_rpm=[1.0]).natural_frequency[-1]
    said = {}
    for swing in (3e6, 2.4e8):
        stiffness = {"value": [3e8], "amplitude": [swing]}
        scene["meshes"][0]["stiffness"]["stiffness_n_per_m"] = stiffness
        answer = loa.complaint(scene, order=25.0, speed_rpm=60.0 * mode / 25.0)
        parts = any("flanks part" in str(line) for line in PAGE.text(answer))
        said[swing] = answer.metadata["parting"], parts
    assert said[3e6] == (0.0, False)
    assert said[2.4e8][0] > 0.1 and said[2.4e8][1]
