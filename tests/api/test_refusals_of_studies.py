"""What studies refuse, each by the name of the field: in Python, by the verb, and over HTTP before a job is.

Beside tests/api/test_contract_of_studies.py. The tables hold what a study refuses by its own rules; bounds of
single numbers are in tests/contract/test_every_bound.py. A study without a row here fails.
"""

import re
import warnings
from typing import Any

import pytest
from small_inputs import small_inputs
from study_runs import refused_call, verb_call

from dynamics.accuracy import FIDELITIES as SCENE_FIDELITIES
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.registry import STUDIES

Json = dict[str, Any]

CLOSED = ["iso6336", "thin_slices"]
ABSENT = "ef" * 32
TIP = {"tip_relief_um": [0.0, 40.0], "tip_relief_length_mm": [0.1, 0.5]}
GRID = {
    "factors": [
        {"path": "loads.brake.torque_n_m", "levels": [0.5, 1.0]},
        {"path": "bushings.*.radial_stiffness_n_per_m", "uniform": {"low": 0.9e8, "high": 1e8}},
    ],
    "responses": [{"quantity": "bearing_force", "part": "input at 0", "order": 1}],
    "samples": 3,
}


CHANGE: Json = {"after": small_inputs("change")["after"], "speed_rpm": [300.0]}
WAVES: Json = {name: value for name, value in small_inputs("force-waves").items() if name != "scene"}
FEWER_TEETH: Json = CHANGE["after"] | {
    "pair": CHANGE["after"]["pair"] | {"wheel": CHANGE["after"]["pair"]["wheel"] | {"teeth": 19}}
}


def factor(index: int, **changes: Any) -> Json:
    """Return the study with another factor; what is None is left out."""
    factors = [dict(each) for each in GRID["factors"]]
    own = factors[index] | changes
    factors[index] = {name: value for name, value in own.items() if value is not None}
    return GRID | {"factors": factors}


REFUSED: dict[str, list[tuple[Json, str]]] = {
    "flank": [
        ({"torque_n_m": 5.0, "normal_force_n": 5.0}, "normal_force_n"),
        ({"torque_n_m": -1.0}, "torque_n_m"),
        ({"torque": 5.0}, "torque"),
        ({"misalignment_um": 10.0}, "errors.misalignment_um"),  # in the plane
        ({"center_distance_change_mm": -1.0}, "errors.center_distance_change_mm"),
    ],
    "ablate": [
        ({"only": []}, "only"),
        ({"only": ["windage"]}, "only"),
        ({"only": ["gyroscopic"]}, "only"),  # an effect of scenes
        ({"effect": ["misalignment"]}, "effect"),
    ],
    "frontier": [
        ({"rungs": []}, "rungs"),
        ({"rungs": ["iso6336"]}, "rungs"),  # nothing to compare it to
        ({"rungs": ["iso6336", "4d"]}, "rungs"),
        ({"rungs": [SCENE_FIDELITIES[0].name, *CLOSED]}, "rungs"),
        ({"rung": CLOSED}, "rung"),
        ({"full_contact": 0}, "full_contact"),
        ({"full_contact": 65}, "full_contact"),
    ],
    "sensitivity": [
        ({"misalignment_um": [30.0, 15.0]}, "misalignment_um"),
        ({"misalignment_um": []}, "misalignment_um"),
        ({"misalignment_um": [0.0, 20000.0]}, "misalignment_um[1]"),
        ({"center_distance_change_percent": [0.0, 11.0]}, "center_distance_change_percent[1]"),
        ({"center_distance_change_percent": [-5.0]}, "errors.center_distance_change_mm"),  # the teeth jam
        ({"center_distance_change_percent": ["x"]}, "center_distance_change_percent"),
    ],
    "root-stress": [
        ({"torque_n_m": -1.0}, "torque_n_m"),
        ({"torque_n_m": 1.0, "normal_force_n": 1.0}, "normal_force_n"),
    ],
    "optimize": [
        ({"heard": {"speed_rpm": [300.0]}}, "heard"),  # of a case
        ({"heard": {"speed_rpm": [300.0], "orders": 2, "counted_orders": [3]}}, "heard.counted_orders[0]"),
        ({"heard": {"speed_rpm": [300.0], "misalignment_um": [1.0, 2.0]}}, "heard.misalignment_um"),
        ({"variables": {"most_tip_relief_um": 0.0}}, "variables.most_tip_relief_um"),
        ({"variables": {"pinion": {"tip_relief_um": [40.0, 0.0]}}}, "variables.pinion.tip_relief_um"),
        ({"variables": {"pinion": {"tip_relief_um": [-1.0, 5.0]}}}, "variables.pinion.tip_relief_um"),
        ({"variables": {"pinion": {"tip_relief_um": [0.0, 40.0]}}}, "variables.pinion.tip_relief"),
        ({"variables": {"pinion": {"helix_crowning_um": [0.0, 9.0]}}}, "helix_crowning_um"),
        ({"variables": {"pinion": TIP}, "scatter": {"misalignment_um": 8.0}}, "misalignment_um"),
        ({"variables": {"pinion": TIP}, "objective": {"weights": [1.0]}}, "objective.weights"),
        ({"search": {"evaluations": 0}}, "search.evaluations"),
        ({"torque_n_m": [80.0, 40.0]}, "torque_n_m"),
        ({"torque_n_m": [40.0, 40.0], "misalignment_um": [5.0, 5.0]}, "torque_n_m"),
        ({"torque_n_m": [40.0, 80.0], "misalignment_um": [0.0, 1.0, 2.0]}, "misalignment_um"),
        ({"misalignment_um": [0.0, 1.0, 2.0]}, "misalignment_um"),  # of the torques of the case
        ({"misalignment_um": [0.0, 2e4]}, "misalignment_um[1]"),
        ({"misalignment_um": [0.0, 5.0]}, "misalignment_um"),  # in the plane
    ],
    "scatter": [
        ({"tolerance_class": 12}, "tolerance_class"),
        ({"samples": 1}, "samples"),
        ({"distribution": "triangular"}, "distribution"),
        ({"misalignment_um": 20.0}, "misalignment_um"),  # in the plane
        ({"exact": 1}, "exact"),
        ({"finishing": "milling"}, "finishing"),
        ({"limit": "1=0.5"}, "limit"),  # without a unit
        ({"limit": "1=half um"}, "limit"),
        ({"limit": "0=1um"}, "limit"),
        ({"limit": "1=-1um"}, "limit"),
        ({"limit": "21=1um"}, "limit.order"),  # of the spectrum, none
        ({"limit": "1-gear=1um"}, "limit"),
        ({"limit": "1-pinion 0=1um"}, "limit.turns"),
        ({"limit": "1+wheel 900000=1um"}, "limit.turns"),
        ({"drawing": ["pinion.profile_slop_um=3"]}, "drawing"),
        ({"drawing": ["wheel.profile_slope_um=0"]}, "drawing"),
        ({"drawing": ["wheel.helix_slope_um=3"]}, "helix_slope"),  # in the plane
    ],
    "sweep": [
        ({"over": ["tip_releif"]}, "over"),
        ({"over": ["face_width"]}, "over"),
        ({"over": ["torque=300:100:50"]}, "over"),
        ({"over": ["torque", "tip_relief", "misalignment"]}, "over"),
        ({"show": ["loudness"]}, "show"),
    ],
    "modes": [
        ({"speed_rpm": [3.0, 2.0]}, "speed_rpm"),
        ({"speed_rpm": [-1.0]}, "speed_rpm"),
        ({"orders": 0}, "orders"),
        ({"speed": [1.0]}, "speed"),
    ],
    "complaint": [
        ({}, "complaint"),
        ({"frequency_hz": 1.4, "speed_rpm": 1200.0}, "complaint.frequency_hz"),
        ({"frequency_hz": 400.0}, "complaint.speed_rpm"),
        ({"frequency_hz": 400.0, "speed_rpm": 1200.0, "order": 20.0}, "complaint.order"),
        ({"frequency_hz": 400.0, "speed_rpm": 1200.0, "shaft": "axle"}, "complaint.shaft"),
        ({"frequency_hz": 400.0, "road_speed_km_h": 40.0}, "complaint.tire_radius_mm"),
        ({"frequency_hz": 300.0, "speed_rpm": 1200.0}, "complaint.frequency_hz"),  # 400, 800 Hz pass
        ({"order": 20.0, "microphone_mm": [0.0, 0.0, 1000.0]}, "complaint.microphone_mm"),
    ],
    "response": [
        ({"speed_rpm": []}, "speed_rpm"),
        ({"speed_rpm": [0.0, 1.0]}, "speed_rpm[0]"),
        ({"speed_rpm": [100.0], "orders": 500}, "orders"),
    ],
    "force-waves": [
        ({}, "force_wave_table"),
        (WAVES | {"force_wave_table": "motor.csv"}, "force_wave_table"),  # a service opens no files
        (WAVES | {"force_wave_table": WAVES["force_wave_table"].replace("kpa", "psi")}, "force_wave_table"),
        (WAVES | {"speed_rpm": 299.0}, "speed_rpm"),
        (WAVES | {"torque_n_m": 2.0}, "torque_n_m"),
        (WAVES | {"bore_radius_mm": 0.0}, "bore_radius_mm"),
        (WAVES | {"active_length_mm": -1.0}, "active_length_mm"),
        (WAVES | {"shaft": "rotor"}, "shaft"),
        (WAVES | {"tolerance_percent": 51.0}, "tolerance_percent"),
    ],
    "noise": [
        ({"run": None, "sensitivities": True, "speed_rpm": []}, "speed_rpm"),
        ({"speed_rpm": [300.0], "orders": 0}, "orders"),
        (
            {
                "speed_rpm": [300.0],
                "radiation": "equivalent_radiated_power",
                "microphone_mm": [0.0, 0.0, 1000.0],
            },
            "microphone_mm",
        ),
    ],
    "vibration": [({"speed_rpm": []}, "speed_rpm"), ({"speed_rpm": [300.0], "mode": 0}, "mode")],
    "listen": [
        ({"run": ABSENT, "point": "cover", "microphone_mm": [0, 0, 1]}, "microphone_mm"),
        ({"run": ABSENT, "microphone_mm": [0, 0]}, "microphone_mm"),
        ({"run": ABSENT, "microphone_mm": [0, 0, 1], "direction": "x"}, "direction"),
        ({"microphone_mm": [0, 0, 1]}, "run"),
    ],
    "steady": [
        ({"speed_rpm": [5.0, 5.0]}, "speed_rpm"),
        ({"speed_rpm": [5.0], "repeat": 99}, "repeat"),
        ({"speed_rpm": [5.0], "repeat": 0}, "repeat"),
        ({"speed_rpm": [5.0], "settling_periods": -1}, "settling_periods"),
        ({"speed_rpm": [0.0, 50.0]}, "speed_rpm[0]"),
    ],
    "change": [
        ({}, "after"),
        (CHANGE | {"mesh": "second"}, "mesh"),
        (CHANGE | {"after": FEWER_TEETH}, "after.pair.wheel.teeth"),
        (CHANGE | {"tolerances": {"misalignment_um": 10.0}}, "tolerances.misalignment_um"),  # in the plane
        (CHANGE | {"tolerances": {"samples": 20_000}}, "tolerances.samples"),
        (CHANGE | {"heard": {"quantity": "sound_power"}}, "housings"),
        (CHANGE | {"heard": {"bearing": "output in"}}, "heard.bearing"),
        (CHANGE | {"heard": {"microphone_mm": [0.0, 0.0, 500.0]}}, "housings"),
        (CHANGE | {"load_cases": []}, "load_cases"),
        (CHANGE | {"load_cases": [{"name": "back", "direction": "coast"}]}, "load_cases[0].direction"),
    ],
    "deflect": [
        ({"load_cases": [{"name": "a"}, {"name": "a"}]}, "load_cases"),
        ({"odd": 1}, "odd"),
    ],
    "elastic-ring": [
        ({"lug_tangential_n_per_m": 0.0}, "lug_tangential_n_per_m"),
        ({"lugs": 121}, "lugs"),
        ({"lugs": -1}, "lugs"),
        ({"planets": 9}, "planets"),
        ({"pin_error_um": [1.0, 2.0]}, "pin_error_um"),
        ({"way_stiffness_n_per_m": 0.0}, "way_stiffness_n_per_m"),
        ({"fit_radial_n_per_m": 1e20}, "fit_radial_n_per_m"),
    ],
    "study": [
        (GRID | {"samples": 1}, "samples"),
        (factor(0, path="loads.x.y"), "factors[0].path"),
        (factor(0, levels=None), "factors[0].levels"),
        (factor(0, iso1328_class=6), "factors[0].levels"),
        (factor(0, levels=None, iso1328_class=6), "factors[0].iso1328_class"),
        (factor(0, levels=[-1e300, 1.0]), "factors[0].levels[0]"),
        (factor(1, path="bushings.*.radiant_stiffness_n_per_m"), "factors[1].path"),
        (GRID | {"responses": [{"quantity": "bearing_force", "part": "x", "order": 1}]}, "responses[0].part"),
        (GRID | {"responses": [{"quantity": "dte_rms", "part": "x"}]}, "responses[0].part"),
        (GRID | {"responses": [{"quantity": "bearing_force", "order": 1, "mesh": "x"}]}, "responses[0].mesh"),
        (GRID | {"responses": [{"quantity": "dte_order"}]}, "responses[0].order"),
    ],
}
"""Inputs beside the small subject, and the field that is named."""

EVERY = pytest.mark.parametrize("study", STUDIES)
QUESTIONS = [(name, inputs, field) for name, refused in REFUSED.items() for inputs, field in refused]


def subject_of(study: str) -> tuple[str, Json]:
    name = "scene" if STUDIES[study].takes.subject == "scene" else "case"
    return name, small_inputs(study)[name]


def test_every_study_refuses_something():
    assert set(REFUSED) == set(STUDIES) and all(REFUSED.values())


@pytest.mark.parametrize(("study", "inputs", "field"), QUESTIONS)
def test_a_question_is_refused_by_its_field_each_way(served, tmp_path, monkeypatch, study, inputs, field):
    """Over HTTP in a document of its own type and before there is a job; the others compute nothing."""
    name, subject = subject_of(study)
    monkeypatch.setattr(STUDIES[study].run, "compute", None)
    served.assert_refused(study, {name: subject, **inputs}, field)
    answer = served.http.post(f"/v1/processes/{study}/execution", json={"inputs": {name: subject, **inputs}})
    assert (answer.status_code, answer.headers["content-type"]) == (422, "application/problem+json")
    problem = answer.json()
    assert (problem["type"], problem["status"]) == ("urn:lineofaction:problem:bad-input", 422)
    (fault, *_) = [fault for fault in problem["errors"] if field in fault["field"]]
    assert fault["bound"]
    with pytest.raises(BadInput) as caught, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        STUDIES[study].function(subject, inputs)
    (here, *_) = [each for each in caught.value.faults if field in each.field]
    assert here.bound == fault["bound"]
    known = STUDIES[study].takes.from_file or set(inputs) <= set(STUDIES[study].inputs.model_fields)
    if known and study != "listen":  # its verb takes other options
        done = refused_call(study, subject, inputs, tmp_path)
        assert (done.exit_code, done.stdout) == (2, "")
        lines = done.stderr.splitlines()
        assert lines[0].startswith("Usage: ") or len(lines) <= max(1, len(problem["errors"]))
        said = done.stderr.lower().replace("--", "").replace("-", "_")
        assert field.rpartition(".")[2].partition("[")[0] in said


@EVERY
def test_a_request_without_its_subject_or_with_an_odd_one_is_refused(served, study):
    name, subject = subject_of(study)
    inputs = {key: value for key, value in small_inputs(study).items() if key != name}
    inputs |= {"run": ABSENT} if study == "listen" else {}
    served.assert_refused(study, inputs, name)
    served.assert_refused(study, {name: subject, **inputs, "odd": 1}, "odd")
    if name == "case":
        wrong, field = {"case": subject | {"load": {"torque_n_m": [-1.0]}}}, "load.torque_n_m[0]"
    else:
        wrong, field = {"scene": subject | {"shafts": []}}, "shafts"
    served.assert_refused(study, inputs | wrong, field)
    answer = served.http.post(f"/v1/processes/{study}/execution", json={"inputs": inputs | wrong})
    assert [fault["field"] for fault in answer.json()["errors"]] == [field]  # as in the file of the subject


@pytest.mark.parametrize(
    "study", [name for name, row in STUDIES.items() if row.takes.subject == "case or scene"]
)
def test_a_case_beside_a_scene_is_refused(served, study):
    both = {"case": small_inputs("analyze")["case"], "scene": small_inputs("modes")["scene"]}
    with pytest.raises(BadInput, match=r"case.*left out beside one"):
        served.client.submit(study, both)


def test_gears_too_narrow_for_tolerances_are_refused(served):
    case = subject_of("scatter")[1]
    narrow = case["pair"]["wheel"] | {"face_width_mm": 3.0}
    served.assert_refused(
        "scatter", {"case": case | {"pair": case["pair"] | {"wheel": narrow}}}, "face_width"
    )


def test_a_sample_too_large_for_a_job_is_refused_by_the_service_alone(served):
    served.assert_refused("scatter", {"case": subject_of("scatter")[1], "samples": 1_000_000}, "samples")


# What the text of an option, or of a file, must be.


SAID: dict[str, list[tuple[list[str], str]]] = {
    "flank": [(["--torque", "nan"], "torque_n_m")],
    "sensitivity": [
        (["--misalignment-um", "0,x"], "--misalignment-um = '0,x': must be FIRST:LAST:STEP, or increasing"),
        (["--misalignment-um", "0,nan"], "misalignment_um[1] = nan"),
        (["--center-distance-change-percent", "-5"], "jam"),
    ],
    "modes": [(["--speed-rpm", text], "--speed-rpm") for text in ("x", "0:1", "10:1:1", "0:1:-1", "0:1e6:1")],
    "response": [(["--speed-rpm", "0:100:50"], "speed_rpm[0]"), (["--speed-rpm", "1:x"], "--speed-rpm")],
    "complaint": [
        (
            ["--frequency-hz", "300", "--speed-rpm", "1200"],
            "nearest: order 20.0 of the pinion, harmonic 1, at 400 Hz",
        ),
        (["--frequency-hz", "1.4", "--speed-rpm", "1200"], "In kHz? Then write 1400."),
    ],
    "steady": [(["--speed-rpm", "0:100:50"], "speed_rpm[0]"), (["--speed-rpm", "a"], "--speed-rpm")],
    "noise": [(["--speed-rpm", "300", "--mesh-damping", "1.1,2"], "mesh_damping")],
    "vibration": [(["--speed-rpm", "300", "--at-order", "0"], "at_order")],
    "scatter": [(["--workers", "2", "--scheduler", "tcp://127.0.0.1:9"], "left out with --scheduler")],
}
"""Options, and words of the line that refuses them."""


@pytest.mark.parametrize(
    ("study", "options", "said"), [(name, *one) for name, refused in SAID.items() for one in refused]
)
def test_an_option_is_refused_in_one_line(tmp_path, monkeypatch, study, options, said):
    monkeypatch.setattr(STUDIES[study].run, "compute", None)  # called: a defect, exit code 5
    done = verb_call(study, subject_of(study)[1], tmp_path, *options, "-o", tmp_path / "x.nc")
    assert (done.exit_code, done.stdout) == (2, "")
    (line,) = done.stderr.strip().splitlines()
    assert re.match(r"error: .*must be", line) and said in line, line
    assert not (tmp_path / "x.nc").exists()
