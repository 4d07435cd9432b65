"""Studies as jobs beyond their contract: rungs that fail, kept runs, rotors, textbooks."""

import importlib
import math
import tomllib
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from repository import EXAMPLES
from study_service import CASE, prepared, scene_by_hash, study_service

from dynamics import RunResult, TimeLaw, simulate
from dynamics.study import Response, responses_of
from fe_contact import SteDatabase
from fe_contact.analysis.studies.frontier import FIDELITIES
from fe_contact.errors import SolveError
from lineofaction.gearbox.convert.scene import dynamic_scene
from lineofaction.gearbox.result_figures import figures_of
from service.worker import study_work
from service.worker.order import WorkOrder
from service.worker.process import default_registry

FRONTIER = default_registry()["frontier"]
CLOSED = ["iso6336", "thin_slices"]
STUDY = {
    "factors": [
        {"path": "loads.brake.torque_n_m", "levels": [50.0, 100.0]},
        {"path": "meshes.mesh.damping_ratio", "uniform": {"low": 0.05, "high": 0.1}},
    ],
    "responses": [{"quantity": "dte_rms"}, {"quantity": "bearing_force", "order": 1}],
    "samples": 3,
    "keep_worst": 1,
}


@pytest.fixture(scope="module")
def served(tmp_path_factory):
    with study_service(tmp_path_factory.mktemp("service")) as found:
        yield found


@pytest.fixture(scope="module")
def client(served):
    return served.client


# The ladder of an accuracy study, worked in this process.


def worked(inputs: dict[str, Any], workspace: Path) -> tuple[dict[str, Any], list[float]]:
    """Do the work; return its JSON and the progress of the whole job."""
    seen: list[float | None] = []
    order = WorkOrder(FRONTIER.entry, inputs, FRONTIER.key(inputs), workspace, workspace)
    (product,) = study_work.frontier(order, lambda *step: seen.append(step[2] if len(step) > 2 else None))
    assert (product.key, product.kind) == (order.key, "frontier")
    return figures_of("frontier", product.file), [part for part in seen if part is not None]


@pytest.mark.parametrize(
    ("failure", "said"), [(SolveError("no equilibrium"), "no equilibrium"), (MemoryError(), "out of memory")]
)
def test_a_rung_that_fails_is_named_and_the_others_survive(tmp_path, monkeypatch, failure, said):
    class Failing:
        """The rung in the middle of the ladder, which fails as it runs."""

        name, title, family, element_size = "corrected", "fails", "auto", 1.0

        def refusal(self, _checked):
            return None

        def run(self, *_):
            raise failure

    rungs = [rung for rung in FIDELITIES if rung.name in CLOSED]
    importlib.import_module("lineofaction.gearbox.studies.frontier.run")  # keeps those it finds
    module = importlib.import_module("fe_contact.analysis.studies.frontier")
    monkeypatch.setattr(module, "FIDELITIES", (rungs[0], Failing(), rungs[1]))
    made, progress = worked(prepared(FRONTIER, case=CASE, rungs=[*CLOSED, "corrected"]), tmp_path)
    assert made["left_out"] == {"corrected": said}
    assert [rung["name"] for rung in made["rungs"]] == CLOSED
    assert progress == sorted(progress) and progress[-1] == pytest.approx(1.0)


def test_recorded_full_contact_stands_beside_the_ladder_of_its_pair(tmp_path):
    case = tomllib.loads((EXAMPLES / "palermo_spur_20_20.toml").read_text("utf-8"))
    case["load"]["torque_n_m"] = [50.0, 100.0]
    made, _ = worked(prepared(FRONTIER, case=case, rungs=CLOSED, full_contact=1), tmp_path)
    beside = made["full_contact"]
    assert (beside["positions_run"], beside["positions_solved"]) == (1, 1)
    assert beside["torques_n_m"] == pytest.approx([50.0, 75.0, 100.0])
    assert beside["own_error_estimate"] < 5e-3
    assert made["rungs"][0]["mean_error"] > 1e-3 and made["reference"] == "thin_slices"
    assert all(rung["cpu_seconds"] > 0.0 for rung in made["rungs"])


def test_a_pair_without_recorded_full_contact_says_how_to_get_it(tmp_path):
    made, _ = worked(prepared(FRONTIER, case=CASE, rungs=CLOSED, full_contact=1), tmp_path)
    assert made.get("full_contact") is None
    assert "python -m benchmarks.full_contact_records CASE" in made["left_out"]["full_contact"]


# Scenes.


def test_a_study_has_the_bits_of_single_runs_and_keeps_its_worst_run(client, tmp_path):
    given = scene_by_hash(tmp_path, 0.01)
    made = client.study(given, STUDY)
    tables = {"mesh": SteDatabase.from_netcdf(tmp_path / "ste.nc")}
    alone = dynamic_scene(given, tables)
    values = dict(zip(made.factor, made.value[made.worst[0]].tolist(), strict=True))
    mesh = replace(alone.meshes[0], damping_ratio=values["meshes.mesh.damping_ratio"])
    load = replace(alone.loads[0], torque=TimeLaw.constant(values["loads.brake.torque_n_m"]))
    run = simulate(replace(alone, meshes=(mesh,), loads=(load,)))
    responses = (Response("dte_rms"), Response("bearing_force", order=1))
    assert made.figure[made.worst[0]].tolist() == responses_of(run, responses)[0]
    (key,) = made.metadata["runs"].values()
    kept = RunResult.from_netcdf(client.fetch_file(key, "run"))
    np.testing.assert_array_equal(kept.mesh_force, run.mesh_force)


MASS, STIFFNESS, RATIO, UNBALANCE = 10.0, 2e6, 0.02, 1e-3  # of the scene of the rotor
ROTOR = EXAMPLES / "jeffcott_scene.toml"
RPM = math.tau / 60.0
SPEED = 3843.5 * RPM
CRITICAL = math.sqrt(STIFFNESS / MASS)
DAMPING = 2.0 * RATIO * math.sqrt(STIFFNESS * MASS)
RADIUS = UNBALANCE * SPEED**2 / abs(STIFFNESS - MASS * SPEED**2 + 1j * SPEED * DAMPING)


def test_a_rotor_without_gears_runs_on_the_circle(client):
    run = client.simulate(ROTOR)
    late = (run.time > 2.2) & (run.time < 2.4)
    radius = np.hypot(*run.displacement[:2, late])
    assert radius == pytest.approx(np.full(radius.size, RADIUS), rel=1e-4)
    assert run.receipt["sampling"]["chosen"] == "highest order of a load, 64.06 Hz"


def test_its_modes_response_and_steady_states(client):
    modes = client.modes(ROTOR, speed_rpm=[0.0, 3000.0])
    assert modes.natural_frequency == pytest.approx([CRITICAL / math.tau] * 2)
    response = client.response(ROTOR, speed_rpm=[SPEED / RPM, CRITICAL / RPM])
    assert response.order.tolist() == [1.0]
    assert np.abs(response.displacement[:2, 0, 0]) == pytest.approx([RADIUS] * 2, rel=1e-9)
    assert np.abs(response.displacement[:2, 1, 0]) == pytest.approx(
        [UNBALANCE / (2.0 * RATIO * MASS)] * 2, rel=1e-6
    )
    steady = client.steady(ROTOR, speed_rpm=[SPEED / RPM], branch=False)
    force = 0.5 * abs(STIFFNESS + 1j * SPEED * DAMPING) * RADIUS
    assert steady.rms_bearing_force == pytest.approx(np.full((1, 2), force), rel=1e-5)


def test_a_geared_rotor_hears_both_shafts(client):
    response = client.response(EXAMPLES / "geared_rotor_scene.toml", speed_rpm=[1499.2395732], orders=1)
    assert response.order * 328 == pytest.approx([1.0, 328 / 23])


def test_textbook_scenes_have_the_figures_of_their_sources(client):
    modes = client.modes(EXAMPLES / "lin_parker_planetary_scene.toml")
    assert np.max(modes.natural_frequency) == pytest.approx(11775.27, abs=0.005)
    run = client.simulate(EXAMPLES / "backlash_oscillator_scene.toml")
    deflection = (run.dynamic_transmission_error[0] - 2.487593e-6 * np.cos(1e4 * run.time)) / 50e-6
    assert np.std(deflection[-20 * 64 - 1 : -1]) == pytest.approx(0.133083, rel=1e-3)
