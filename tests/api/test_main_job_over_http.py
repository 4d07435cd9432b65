"""The real processes, end to end over HTTP: a case to its database, a scene to its run."""

import copy
import json
import shutil
import tomllib
from typing import Any

import numpy as np
import pytest
from declared_figures import check_declared, document
from fastapi.testclient import TestClient
from repository import EXAMPLES
from running_service import until

from dynamics.simulation import simulate
from fe_contact.analysis.analyze import analyze
from lineofaction.client import LineOfActionClient
from lineofaction.gearbox.convert.case import analysis_options, case_json, gear_pair, table_axes
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas import Case, validated
from service.app import create_app
from service.settings import Settings


def table(name: str) -> dict[str, Any]:
    return tomllib.loads((EXAMPLES / name).read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def case():
    found = table("palermo_spur_20_20.toml")
    found["load"] = {"torque_n_m": [50, 100, 200]}
    found["accuracy"] = {"level": "draft", "positions": 16}
    return found


@pytest.fixture(scope="module")
def client(tmp_path_factory):
    """A client of a running service with its real processes."""
    directory = tmp_path_factory.mktemp("service")
    with TestClient(create_app(Settings(data_directory=directory / "data"))) as service:
        transport = service._transport
        with LineOfActionClient(
            "http://testserver", cache_dir=directory / "tables", transport=transport
        ) as found:
            yield found


def scene(case: dict[str, Any]) -> dict[str, Any]:
    """Return the paper's scene at 400 rpm for 20 ms, with the case written out."""
    found = table("palermo_scene.toml")
    del found["meshes"][0]["case_file"]
    found["meshes"][0]["case"] = case
    found["run"]["duration_s"] = 0.02
    found["drives"][0] |= {"time_s": [0.0], "speed_rpm": [400.0]}
    return found


@pytest.mark.law
def test_the_service_gives_what_python_gives(client, case):
    job, seen = client.analyze.submit(case), []

    def ended():
        seen.append(client.status(job.id))
        return seen[-1].status == "successful"

    until(ended)
    served = job.result()
    model = validated(Case, case)
    here = analyze(gear_pair(model), table_axes(model), analysis_options(model), case=case_json(model))
    assert np.array_equal(served.static_transmission_error, here.static_transmission_error)
    assert served.metadata.case == here.metadata.case
    progress = [state.progress for state in seen]
    assert progress == sorted(progress) and progress[-1] == 100
    assert any(state.stage for state in seen)  # on a busy machine the first and last progress may be all


def test_a_database_carries_the_hash_it_is_found_under(client, case):
    key = client.analysis_key(case)
    assert client.fetch(key).metadata.content_hash == key


def test_a_scene_runs_on_the_stored_table(client, case):
    run = client.simulate(scene(case))
    force = run.to_xarray()["mesh_force"].to_numpy()
    assert force.mean() == pytest.approx(100.0 / (0.04 * np.cos(np.radians(20.0))), rel=0.02)


def test_the_figures_of_a_run_and_of_its_table_are_as_declared(client, case):
    check_declared("run", document(client.simulate.submit(scene(case)).figures()))
    check_declared("database", document(client.analyze.submit(case).figures()))


@pytest.mark.law
def test_a_hash_serves_as_well_as_the_case(client, case):
    by_hash = scene(case)
    del by_hash["meshes"][0]["case"]
    by_hash["meshes"][0]["database_hash"] = client.analysis_key(case)
    run, other = client.simulate(by_hash).to_xarray(), client.simulate(scene(case)).to_xarray()
    assert np.array_equal(run["mesh_force"].to_numpy(), other["mesh_force"].to_numpy())


@pytest.mark.law
@pytest.mark.parametrize("how", ["case", "case_file", "database_hash", "database_file"])
def test_a_scene_runs_here_on_tables_of_the_service(client, case, tmp_path, how):
    """However a mesh takes its table, the run is bit by bit the one that the service makes."""
    given, mesh = scene(case), scene(case)["meshes"][0]
    key = client.analysis_key(case)
    (tmp_path / "case.json").write_text(json.dumps(case))
    shutil.copyfile(client.fetch_file(key), tmp_path / "ste.nc")
    names = {"case": case, "case_file": "case.json", "database_hash": key, "database_file": "ste.nc"}
    given["meshes"] = [{k: v for k, v in mesh.items() if k != "case"} | {how: names[how]}]
    (tmp_path / "scene.json").write_text(json.dumps(given))
    here = simulate(client.scene(tmp_path / "scene.json"))
    there = client.simulate(scene(case))
    assert np.array_equal(here.mesh_force, there.mesh_force)
    assert np.array_equal(here.bearing_force, there.bearing_force)


def test_faults_of_tables_are_named_by_the_scene(client, case):
    wrong = copy.deepcopy(scene(case))
    wrong["meshes"][0]["case"]["pair"]["pinion"]["bore_diameter_mm"] = 95.0
    with pytest.raises(BadInput, match=r"meshes\[0\]\.case\.pair\.pinion\.bore_diameter_mm"):
        client.scene(wrong)
    del wrong["meshes"][0]["case"]
    wrong["meshes"][0]["database_file"] = "nowhere.nc"
    with pytest.raises(BadInput, match=r"meshes\[0\]\.database_file = 'nowhere\.nc': must be an STE"):
        client.scene(wrong)


def test_a_scene_that_cannot_be_is_refused_before_it_is_a_job(client, case):
    wrong = copy.deepcopy(scene(case))
    wrong["shafts"][1]["origin_mm"] = [81.0, 0.0, 0.0]
    with pytest.raises(BadInput, match=r"shafts\[1\]\.origin_mm"):
        client.simulate.submit(wrong)
    wrong = copy.deepcopy(scene(case))
    wrong["meshes"][0]["case"]["pair"]["pinion"]["bore_diameter_mm"] = 95.0
    with pytest.raises(BadInput, match=r"meshes\[0\]\.case\.pair\.pinion\.bore_diameter_mm = 95\.0"):
        client.simulate.submit(wrong)


def test_the_service_opens_no_file_for_a_caller(client, case):
    for field in ("case_file", "database_file"):
        wrong = scene(case)
        del wrong["meshes"][0]["case"]
        wrong["meshes"][0][field] = "/etc/hostname"
        with pytest.raises(BadInput, match="reads no files of its callers"):
            client.submit("simulate", {"scene": wrong})


def test_a_hash_nobody_knows_is_refused(client, case):
    wrong = scene(case)
    del wrong["meshes"][0]["case"]
    wrong["meshes"][0]["database_hash"] = "ab" * 32
    with pytest.raises(BadInput, match="the hash of a stored database"):
        client.simulate.submit(wrong)
