"""Axes of a table that do not rise are refused by name, value, bound: in Python, by the verb, over HTTP."""

import json
from typing import Any

import pytest
from command_line import loa
from fastapi.testclient import TestClient
from toml_text import toml_text

from fe_contact import Gear, GearPair, analyze
from fe_contact.errors import InputError
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas import Case, validated
from service.app import create_app
from service.settings import Settings

GEAR = {"teeth": 20, "face_width_mm": 25.0, "bore_diameter_mm": 40.0}
LIBRARY = {
    "torques": [100.0, 50.0],
    "normal_forces": [2000.0, 2000.0],
    "misalignments": [2e-5, 0.0],
    "center_distance_changes": [0.0, 2e-4, 1e-4],
}
BOUNDARY = {
    ("load", "torque_n_m"): [100.0, 50.0],
    ("load", "normal_force_n"): [2000.0, 2000.0],
    ("errors", "misalignment_um"): [20.0, 0.0],
    ("errors", "center_distance_change_mm"): [0.0, 0.2, 0.1],
}
BOUND = "must be strictly increasing"


def case(place: tuple[str, str], values: list[float]) -> dict[str, Any]:
    section, name = place
    load = {} if section == "load" else {"torque_n_m": [100.0]}
    return {
        "pair": {"normal_module_mm": 4.0, "center_distance_mm": 80.0, "pinion": GEAR, "wheel": GEAR},
        "load": load | ({name: values} if section == "load" else {}),
        "errors": {name: values} if section == "errors" else {},
    }


@pytest.fixture(scope="module")
def http(tmp_path_factory):
    with TestClient(create_app(Settings(data_directory=tmp_path_factory.mktemp("data")))) as found:
        yield found


@pytest.mark.parametrize(("name", "values"), LIBRARY.items())
def test_the_library_refuses_them(name, values):
    gear = Gear(20, 4e-3, 25e-3, 40e-3)
    loads = {} if name in ("torques", "normal_forces") else {"torques": [100.0]}
    with pytest.raises(InputError) as caught:
        analyze(GearPair(gear, gear, 80e-3), **(loads | {name: values}))
    assert name in str(caught.value) and str(values) in str(caught.value)
    assert BOUND in str(caught.value)


@pytest.mark.parametrize(("place", "values"), BOUNDARY.items(), ids=str)
def test_a_case_refuses_them(place, values):
    with pytest.raises(BadInput) as caught:
        validated(Case, case(place, values))
    (fault,) = caught.value.faults
    assert (fault.field, fault.value, fault.bound) == (
        ".".join(place),
        values,
        BOUND.removeprefix("must be "),
    )


@pytest.mark.parametrize(("place", "values"), BOUNDARY.items(), ids=str)
def test_the_verb_refuses_them(place, values, tmp_path):
    file = tmp_path / "case.toml"
    file.write_text(toml_text(case(place, values)))
    done = loa("analyze", file)
    said = " ".join(done.output.split())
    assert done.exit_code == 2
    assert f"{'.'.join(place)} = {values}: {BOUND}" in said


@pytest.mark.parametrize(("place", "values"), BOUNDARY.items(), ids=str)
def test_the_service_refuses_them_before_a_job_is(place, values, http):
    body = json.dumps({"inputs": {"case": case(place, values)}})
    headers = {"Content-Type": "application/json"}
    answer = http.post("/v1/processes/analyze/execution", content=body, headers=headers)
    assert answer.status_code == 422
    (fault,) = answer.json()["errors"]
    assert fault["field"].endswith(".".join(place))
    assert fault["value"] == str(values)
    assert fault["bound"] == BOUND.removeprefix("must be ")
    assert http.get("/v1/jobs").json()["jobs"] == []
