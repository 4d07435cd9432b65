"""What is implausible is said before a job runs, in its status, and by every form of its result."""

import io
import json
import tomllib
from pathlib import Path
from typing import Any

import h5netcdf
import pytest
from study_service import empty_service

from lineofaction.gearbox.schemas.plan import InputWarning

GEAR = {"teeth": 20, "face_width_mm": 25.0, "bore_diameter_mm": 40.0}
RELIEVED = GEAR | {"tip_relief_um": 0.02, "tip_relief_length_mm": 1.5}
CASE: dict[str, Any] = {
    "pair": {"normal_module_mm": 4.0, "center_distance_mm": 80.0, "pinion": RELIEVED, "wheel": GEAR},
    "load": {"torque_n_m": [100.0]},
    "accuracy": {"level": "draft", "positions": 8, "model": "plane_strain", "receipt": "minimal"},
}
ROTOR = tomllib.loads((Path(__file__).parents[2] / "examples" / "jeffcott_scene.toml").read_text("utf-8"))


@pytest.fixture(scope="module")
def served(tmp_path_factory):
    """A client of a running service with its real processes, and the bare HTTP one."""
    with empty_service(tmp_path_factory.mktemp("service") / "data") as found:
        yield found


def messages(body: dict[str, Any]) -> list[str]:
    return [warning["message"].partition(":")[0] for warning in body["warnings"]]


def test_a_case_is_assessed_from_plan_to_result(served):
    client, http = served
    said = ["pair.pinion.tip_relief_um = 0.02 µm"]
    inputs = {"inputs": {"case": CASE}}
    assert messages(http.post("/v1/plans", json=inputs).json()) == said
    status = http.post("/v1/processes/analyze/execution", json=inputs).json()
    assert messages(status) == said
    result = client.wait(status["jobID"])
    assert messages(http.get(f"/v1/jobs/{status['jobID']}").json()) == said
    place = f"/v1/results/{result.key}"
    assert messages(http.get(place).json()) == said
    (alarm,) = http.get(f"{place}/figures").json()["alarms"][:1]
    assert alarm.startswith(f"Warning: {said[0]}")
    file = http.get(place, headers={"accept": "application/x-netcdf"}).content
    with h5netcdf.File(io.BytesIO(file), "r") as content:
        assert messages({"warnings": json.loads(content.attrs["warnings"])}) == said


def test_studies_in_json_and_netcdf_carry_it(served, tmp_path):
    client, http = served
    for process, kind, further in (
        ("flank", "flanks", {"torque_n_m": 100.0}),
        ("ablate", "ablation", {"only": ["tooth_coupling"]}),
    ):
        status = http.post(
            f"/v1/processes/{process}/execution", json={"inputs": {"case": CASE, **further}}
        ).json()
        result = client.wait(status["jobID"])
        assert result.kind == kind
        assert messages(http.get(result.href).json()) == ["pair.pinion.tip_relief_um = 0.02 µm"]


def test_what_an_import_left_out_goes_with_every_answer(served):
    client, http = served
    said = "left out of the scene"
    scene = ROTOR | {"left_out": ["shaft 5 (line 143): nothing joins it to the train"]}
    status = http.post("/v1/processes/modes/execution", json={"inputs": {"scene": scene}}).json()
    assert messages(status) == [said]
    (warning,) = status["warnings"]
    assert warning["check"] == "left_out" and InputWarning.model_validate(warning).value is None
    assert client.status(status["jobID"]).warnings == (warning,)
    result = client.wait(status["jobID"])
    assert messages(http.get(result.href).json()) == [said]
    assert http.get(f"{result.href}/figures").json()["alarms"][0].startswith(f"Warning: {said}")


def test_a_plausible_case_has_an_empty_list(served):
    _, http = served
    plain = CASE | {"pair": CASE["pair"] | {"pinion": GEAR}}
    assert http.post("/v1/plans", json={"inputs": {"case": plain}}).json()["warnings"] == []
