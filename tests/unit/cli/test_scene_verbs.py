"""What the verbs of studies of scenes find, beyond the contract of all studies: modes, response, steady."""

import json
import re
from dataclasses import replace

import numpy as np
import pytest
from command_line import loa, printed
from scene_files import scene_file

from dynamics.linearize import ForcedResponse, peaks
from dynamics.periodic import find_orbit
from lineofaction.gearbox.number_list import number_list
from lineofaction.gearbox.problems import EXIT_FAILED, BadInput
from lineofaction.gearbox.studies.steady.run import RUN as STEADY
from lineofaction.report.document import write_report


@pytest.fixture
def scene(tmp_path):
    return scene_file(tmp_path)


# ``loa modes``.


def test_modes_cross_the_orders_of_the_mesh_at_critical_speeds(scene):
    answer = printed("modes", scene, "--speed-rpm", "0:9000:1500", "--orders", 3)
    assert answer["at_rest"][-1]["kind"] == "torsional-lateral on mesh"
    assert answer["speed_rpm"] == pytest.approx([0, 1500, 3000, 4500, 6000, 7500, 9000])
    assert answer["mesh_frequency_hz"]["mesh"] == pytest.approx(
        [20 / 60 * rpm for rpm in answer["speed_rpm"]]
    )
    for crossing in answer["critical_speeds"]:
        excited = crossing["order"] * 20 / 60 * crossing["speed_rpm"]
        assert crossing["frequency_hz"] == pytest.approx(excited, rel=1e-8)
    assert {crossing["order"] for crossing in answer["critical_speeds"]} == {1, 2, 3}
    assert answer["equilibrium"]["status"] == "converged"
    shown = loa("modes", scene, "--speed-rpm", "0:6000:3000", "-o", scene.with_name("modes.html")).stdout
    assert "torsional-lateral on mesh" in shown
    assert re.search(r"^least damped critical speed: [\d.]+ rpm", shown, re.MULTILINE)
    page = scene.with_name("modes.html").read_text("utf-8")
    assert "Campbell diagram: whirl modes over speed" in page and "Critical speeds" in page


def test_of_many_modes_the_lowest_are_printed(scene, monkeypatch):
    monkeypatch.setattr("lineofaction.report.response.modes.PRINTED_MODES", 2)
    shown = loa("modes", scene).stdout
    assert re.findall(r"^ +(\d+) +[\d.]+ ", shown, re.MULTILINE) == ["1", "2"]
    assert re.search(r"^\d+ more up to [\d.]+ kHz: in the report, with --json$", shown, re.MULTILINE)


def test_an_order_that_a_mesh_does_not_excite_has_no_static_error_to_compare(scene, monkeypatch):
    """It was 0 times the static one, as if it vanished."""
    own = "lineofaction.report.response.response.peaks"
    monkeypatch.setattr(own, lambda found: [replace(peak, amplification=0.0) for peak in peaks(found)])
    shown = loa("response", scene, "--speed-rpm", "500:9000:500", "--orders", 2).stdout
    assert re.search(r"^mesh mesh .* -$", shown, re.MULTILINE)


def test_a_load_that_parts_the_flanks_is_refused_by_name(scene):
    scene.write_text(scene.read_text().replace("torque_n_m = [100.0]", "torque_n_m = [-100.0]"))
    result = loa("modes", scene, "--json")
    assert (result.exit_code, result.stdout) == (2, "")
    assert "meshes[0]" in result.stderr and "driving flank" in result.stderr


def test_ranges_hold_their_last_speed():
    assert number_list("--speed-rpm", "0:1:0.1") == pytest.approx(np.linspace(0.0, 1.0, 11))
    assert number_list("--speed-rpm", "100:300:150") == [100.0, 250.0]
    assert number_list("--speed-rpm", "7:7:1") == [7.0]
    with pytest.raises(BadInput):
        number_list("--speed-rpm", "0:nan:1")


def test_a_load_far_beyond_the_table_ends_the_study_or_is_told(scene):
    heavy = scene.read_text(encoding="utf-8").replace("torque_n_m = [100.0]", "torque_n_m = [100000.0]")
    assert "100000.0" in heavy
    scene.write_text(heavy, encoding="utf-8")
    result = loa("modes", scene)
    assert result.exit_code == EXIT_FAILED
    assert "the table's highest load" in " ".join(result.stderr.split())
    scene.write_text(heavy.replace("[run]", '[run]\non_violation = "report"'), encoding="utf-8")
    result = loa("modes", scene)
    assert result.exit_code == 0, result.stderr
    assert "VIOLATED: force inside the table" in result.stdout


# ``loa response``.


def test_json_holds_amplitudes_by_order_and_speed_and_the_peaks(scene):
    answer = printed("response", scene, "--speed-rpm", "100:6000:50", "--orders", 4)
    assert answer["order"] == [1.0, 2.0, 3.0, 4.0]
    mesh = answer["meshes"]["mesh"]
    force = np.array(mesh["mesh_force_n"])
    assert force.shape == (4, len(answer["speed_rpm"])) == (4, 119)
    # at a crawl the flanks follow the static error
    np.testing.assert_allclose(
        np.array(mesh["dynamic_transmission_error_um"])[:, 0], mesh["static_transmission_error_um"], rtol=0.02
    )
    for peak in answer["peaks"]:
        speed = answer["speed_rpm"].index(peak["speed_rpm"])
        assert peak["frequency_hz"] == pytest.approx(peak["order"] * 20 / 60 * peak["speed_rpm"])
        part = mesh["mesh_force_n"] if peak["name"] == "mesh" else answer["bearings"][peak["name"]]["force_n"]
        values = part[answer["order"].index(peak["order"])]
        assert peak["amplitude_n"] == values[speed] > max(values[speed - 1], values[speed + 1])
    largest = answer["peaks"][0]
    assert largest["quantity"] == "mesh_force"
    # the nearest mode is met within the step of the speeds
    assert largest["frequency_hz"] == pytest.approx(largest["natural_frequency_hz"], rel=0.03)
    assert answer["residual"] < 1e-9 and answer["parting_rpm"] == []


def test_the_report_says_where_the_vibration_is_lost_if_it_is_known(scene, tmp_path):
    file, page = tmp_path / "response.nc", tmp_path / "page.html"
    result = loa("response", scene, "--speed-rpm", "2000:6000:100", "--orders", 3, "-o", file)
    assert result.exit_code == 0, result.stderr
    found = ForcedResponse.from_netcdf(file)
    assert f"{next(iter(peaks(found))).speed * 30 / np.pi:.1f}"[:5] in result.stdout
    assert "first-order theory" in result.stdout
    write_report(file, page)
    assert "Forced response to transmission errors and loads" in page.read_text()
    assert "Power lost by the vibration" in page.read_text()
    older = replace(found, power_source=(), power_sink=(), power_sink_kind=(), power_loss=np.empty((0, 0, 0)))
    replace(older, power_input=np.empty((0, 0, 0))).to_netcdf(file)
    write_report(file, page)
    assert "Power lost" not in page.read_text()


def test_the_power_of_the_vibration_is_lost_where_the_table_says(scene):
    arguments = ("response", scene, "--speed-rpm", "2000:6000:500", "--orders", 3)
    power = printed(*arguments)["power"]
    lost = np.sum([part["loss_w"] for part in power["losses"]], axis=0)
    assert lost.shape == (3, 9)
    np.testing.assert_allclose(lost, np.sum(list(power["input_w"].values()), axis=0), rtol=1e-9, atol=1e-12)
    assert power["residual"] < 1e-9
    worst = int(np.argmax(lost.sum(axis=0)))
    lines = loa(*arguments).stdout.splitlines()
    assert f"Power lost at {2000 + 500 * worst} rpm" in " ".join(line.strip() for line in lines)
    shares = {part["kind"]: 0.0 for part in power["losses"]}
    for part in power["losses"]:
        shares[part["kind"]] += float(np.sum(part["loss_w"], axis=0)[worst] / lost.sum(axis=0)[worst])
    table = lines[next(index for index, line in enumerate(lines) if "lost in" in line) :]
    row = next(line for line in table if line.strip().startswith("mesh "))
    assert float(row.split()[-1]) == pytest.approx(100.0 * shares["mesh"], rel=0.01)


def test_speeds_at_which_flanks_part_are_said(scene):
    scene.write_text(scene.read_text().replace("damping_ratio = 0.08", "damping_ratio = 0.005"))
    parting = printed("response", scene, "--speed-rpm", "13500:14500:50")["parting_rpm"]
    assert parting and min(parting) > 13500
    shown = loa("response", scene, "--speed-rpm", "13500:14500:50")
    assert f"flanks lift off at {len(parting)} of 21 speeds" in shown.stdout


def test_trains_that_torques_alone_move_are_refused_by_name(scene):
    text = scene.read_text().replace("[[drives]]", "[[free_rotations]]")
    scene.write_text(text.replace("speed_rpm = [900.0]", "initial_speed_rpm = 900.0"))
    result = loa("response", scene, "--speed-rpm", "100")
    assert result.exit_code == 2
    assert "free_rotations" in result.stderr


# ``loa steady``.


def test_rising_and_falling_speeds_meet_on_a_stable_branch(scene, tmp_path):
    file, page = tmp_path / "steady.nc", tmp_path / "page.html"
    done = loa("steady", scene, "--speed-rpm", "3000,3200", "--settling-periods", 2, "-o", file)
    assert (done.exit_code, done.stderr) == (0, "")
    assert "stable" in done.stdout and "branch completed" in done.stdout
    found = STEADY.figures(STEADY.file.read(file))
    write_report(file, page)
    assert "Periodic steady states over speed" in page.read_text("utf-8")
    assert [point["speed_rpm"] for point in found["up"]] == pytest.approx([3000.0, 3200.0])
    assert [point["speed_rpm"] for point in found["down"]] == pytest.approx([3200.0, 3000.0])
    up, down = found["up"][0], found["down"][1]
    assert up["status"] == "converged" and up["stability"] == "stable"
    assert np.hypot(*up["largest_multiplier"]) < 1.0
    assert up["residual_um"] < 1e-6
    assert up["meshes"]["mesh"]["rms_error_um"] == pytest.approx(
        down["meshes"]["mesh"]["rms_error_um"], rel=1e-6
    )
    assert found["jumps"] == [] and found["branch"]["status"] == "completed"


def test_motions_that_are_not_found_are_printed_and_fail(scene, tmp_path, monkeypatch):
    monkeypatch.setitem(find_orbit.__globals__, "ITERATION_LIMIT", 0)
    for form in ((), ("--json",)):
        result = loa(
            "steady", scene, "--speed-rpm", "3000", "--settling-periods", 0, "-o", tmp_path / "s.png", *form
        )
        assert result.exit_code == 1
        assert "1 of 1 motions were not found, at 3000 rpm" in result.stderr
    (point,) = json.loads(result.stdout)["up"]
    assert point["status"] == "iteration limit" and point["residual_um"] > 0.0
    assert "meshes" not in point
