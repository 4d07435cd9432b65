"""loa study: many scenes from two files, equal to single runs, taken up after a kill; of other flanks too."""

import json
import os
import signal
import subprocess
import sys
import time
import tomllib
from dataclasses import dataclass
from functools import wraps
from pathlib import Path
from typing import get_args

import numpy as np
import pytest
from command_line import loa
from declared_figures import check_declared
from repository import EXAMPLES
from scene_files import SCENE, scene_file
from spur_case import spur_case

from dynamics import RunResult, simulate
from dynamics.study import QUANTITIES, Design, Levels, Response, Study, StudyTask, responses_of, study
from dynamics.study.run_study import _run_batch
from fe_contact.options import Run
from fe_contact.ste import PairGeometry
from host.directories import cache_home
from lineofaction.cli.computed_tables import computed_table
from lineofaction.gearbox import workbench
from lineofaction.gearbox.convert.case import gear_pair
from lineofaction.gearbox.convert.checked_case import CheckedCase
from lineofaction.gearbox.convert.scene import check_scene, dynamic_scene
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas import read_model
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.studies.study import Inputs, QuantityName
from lineofaction.gearbox.studies.study.design import design_of
from lineofaction.gearbox.studies.study.request import factor_places, names_with_planets
from lineofaction.gearbox.studies.study.run import RUN
from lineofaction.gearbox.studies.study.scenes import VariedScene, places_of, with_value
from lineofaction.gearbox.subjects import scene_of, with_inline_cases
from lineofaction.report.document import write_report

STUDY = """
samples = 3
seed = 5
keep_worst = 1
[[factors]]
path = "loads.brake.torque_n_m"
levels = [50.0, 100.0]
[[factors]]
path = "bushings.*.radial_stiffness_n_per_m"
normal = { mean = 2e8, standard_deviation = 1e7, low = 1.5e8 }
[[responses]]
quantity = "bearing_force"
part = "left"
order = 1
[[responses]]
quantity = "dte_peak_to_peak"
"""


def study_file(folder: Path, text: str = STUDY) -> Path:
    path = folder / "study.toml"
    path.write_text(text, encoding="utf-8")
    return path


@pytest.fixture
def scene(tmp_path):
    return scene_file(tmp_path)


@dataclass(frozen=True)
class Studied:
    """The study of `STUDY` in this process: its scene, the folder of its results, what it printed."""

    scene: Path
    out: Path
    printed: str


@pytest.fixture(scope="module")
def studied(tmp_path_factory):
    folder = tmp_path_factory.mktemp("studied")
    scene, out = scene_file(folder), folder / "out"
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_CACHE_HOME", str(folder / "cache"))
        result = loa("study", scene, study_file(folder), "-o", out, "--json")
    assert result.exit_code == 0, result.output
    return Studied(scene, out, result.stdout)


def test_figures_are_those_of_loa_simulate(studied, tmp_path):
    answer = json.loads(studied.printed)
    check_declared("study", answer)
    made = Study.from_netcdf(studied.out / "study.nc")
    figures = RUN.figures(made)
    assert figures == {name: answer[name] for name in figures}
    point = int(made.worst[0])
    torque, stiffness = made.value[point].tolist()
    text = studied.scene.read_text(encoding="utf-8")
    text = text.replace("[100.0]", f"[{torque!r}]").replace("2e8", repr(stiffness))
    alone_file = studied.scene.with_name("alone.toml")
    alone_file.write_text(text, encoding="utf-8")
    assert loa("simulate", alone_file, "-o", tmp_path / "alone.nc").exit_code == 0
    alone = RunResult.from_netcdf(tmp_path / "alone.nc")
    assert made.figure[point, 1] == np.ptp(alone.dynamic_transmission_error[0])
    kept = RunResult.from_netcdf(studied.out / "study_runs" / f"point_{point}.nc")
    np.testing.assert_array_equal(kept.bearing_force, alone.bearing_force)


@pytest.mark.law
def test_two_processes_give_the_same_bits(studied, scene, tmp_path):
    assert loa("study", scene, study_file(tmp_path), "-o", tmp_path / "two", "--workers", 2).exit_code == 0
    one, two = (Study.from_netcdf(folder / "study.nc") for folder in (studied.out, tmp_path / "two"))
    np.testing.assert_array_equal(one.figure, two.figure)


@pytest.mark.law
def test_a_killed_study_goes_on_where_it_was(scene, tmp_path):
    many = STUDY.replace("samples = 3", "samples = 40").replace("keep_worst = 1", "")
    arguments = ["study", str(scene), str(study_file(tmp_path, many)), "-o", str(tmp_path / "killed")]
    kept = tmp_path / "cache" / "lineofaction" / "studies"
    decided = 4  # points at which effects are decided before the runs

    def finished():
        return [file for file in kept.glob("*/*") if file.suffix != ".partial"]

    with subprocess.Popen([sys.executable, "-m", "lineofaction.cli", *arguments], env=os.environ) as running:
        deadline = time.monotonic() + 120.0
        while len(finished()) < decided + 3 and time.monotonic() < deadline:
            assert running.poll() is None
            time.sleep(0.002)
        running.send_signal(signal.SIGKILL)
    before = len(finished()) - decided
    assert 3 <= before < 10 and not (tmp_path / "killed" / "study.nc").exists()
    done = []

    @wraps(_run_batch)
    def counted(task, batch):
        done.append(len(batch))
        return _run_batch(task, batch)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("dynamics.study.run_study._run_batch", counted)
        assert loa(*arguments).exit_code == 0
    assert len(done) == 10 - before  # of 80 runs, 8 in a batch
    assert not list(kept.glob("*"))
    assert loa(*arguments[:-1], tmp_path / "whole").exit_code == 0
    killed, whole = (Study.from_netcdf(tmp_path / name / "study.nc") for name in ("killed", "whole"))
    np.testing.assert_array_equal(killed.figure, whole.figure)


@pytest.mark.parametrize(
    ("path", "said"),
    [
        ("loads.brake.torque_nm", "torque_n_m"),
        ("loads.break.torque_n_m", "brake"),
        ("lods.brake.torque_n_m", "loads"),
        ("meshes.mesh.case.pair.pinion.tip_relif_um", "tip_relief_um"),
        ("meshes.mesh.case.pair.pinion.face_width_mm", "tip_relief_um"),
        ("meshes.mesh.case.pair.pinion.tip_relief_um", "takes a database"),
    ],
)
def test_a_path_that_there_is_not_is_refused_with_the_nearest(scene, tmp_path, path, said):
    text = STUDY.replace("loads.brake.torque_n_m", path)
    result = loa("study", scene, study_file(tmp_path, text))
    assert result.exit_code == 2
    assert "factors[0].path" in result.stderr and path in result.stderr and said in result.stderr


@pytest.mark.parametrize(
    ("old", "new", "field"),
    [
        ('part = "left"', 'part = "middle"', "responses[0].part"),
        ("order = 1", "", "order"),
    ],
)
def test_a_response_that_there_is_not_is_refused_by_its_field(scene, tmp_path, old, new, field):
    text = STUDY.replace(old, new)
    result = loa("study", scene, study_file(tmp_path, text))
    assert result.exit_code == 2 and field in result.stderr, result.output


def test_a_path_names_parts_entries_and_what_is_left_out(scene):
    inputs = read_model(SceneInput, scene)
    assert places_of(inputs, "path", "bushings.*.damping_ratio") == (
        ("bushings", 0, "damping_ratio"), ("bushings", 1, "damping_ratio"),
    )  # fmt: skip
    assert places_of(inputs, "path", "loads.brake.torque_n_m[0]") == (("loads", 0, "torque_n_m", 0),)
    (backlash,) = places_of(inputs, "path", "meshes.mesh.coast_flank.backlash_um")
    table = inputs.model_dump(mode="json")
    with_value(table, backlash, 30.0)
    assert table["meshes"][0]["coast_flank"] == {"backlash_um": 30.0}
    with_value(table, ("drives", 0, "speed_rpm"), 5.0)
    assert table["drives"][0]["speed_rpm"] == [5.0] * len(inputs.drives[0].speed_rpm or ())


def test_the_quantities_are_those_of_the_library():
    assert get_args(QuantityName) == tuple(QUANTITIES)


def test_a_value_that_the_scene_refuses_is_a_failed_point(scene, tmp_path):
    text = STUDY.replace("levels = [50.0, 100.0]", "levels = [50.0, 1e5]")  # beyond what the table holds
    assert loa("study", scene, study_file(tmp_path, text), "-o", tmp_path / "out").exit_code == 0
    made = Study.from_netcdf(tmp_path / "out" / "study.nc")
    failed = RUN.figures(made)["failed"]
    assert [row["point"] for row in failed] == [3, 4, 5] and all(row["reason"] for row in failed)
    assert np.isnan(made.figure[3:]).all() and np.isfinite(made.figure[:3]).all()


def test_the_report_has_the_runs_and_their_plots(studied, tmp_path):
    write_report(studied.out / "study.nc", tmp_path / "again.html")
    for page in (studied.out / "study.html", tmp_path / "again.html"):
        text = page.read_text(encoding="utf-8")
        for word in ("study_curves", "study_distribution", "study_tornado", "torque_n_m", "energy audit"):
            assert word in text


def test_a_grid_without_samples_has_a_report(scene, tmp_path):
    text = 'factors = [{ path = "loads.brake.torque_n_m", levels = [50.0, 100.0] }]\n'
    text += 'responses = [{ quantity = "dte_rms" }]\n'
    result = loa("study", scene, study_file(tmp_path, text), "-o", tmp_path / "out")
    assert result.exit_code == 0, result.output
    page = (tmp_path / "out" / "study.html").read_text(encoding="utf-8")
    assert "study_curves" in page and "study_tornado" in page
    assert np.isnan(Study.from_netcdf(tmp_path / "out" / "study.nc").correlation(0)).all()


def test_a_study_of_failed_runs_alone_is_still_shown_and_has_failed(scene, tmp_path):
    text = STUDY.replace("levels = [50.0, 100.0]", "levels = [1e5, 2e5]")
    result = loa("study", scene, study_file(tmp_path, text), "-o", tmp_path / "out")
    assert result.exit_code == 1 and "No run has figures" in result.stderr
    assert "Runs without figures: 6 of 6" in result.output
    assert Study.from_netcdf(tmp_path / "out" / "study.nc").worst.size == 0


def test_a_factor_says_whether_it_is_sampled():
    inputs = Inputs.model_validate(tomllib.loads(STUDY))
    assert [factor.sampled for factor in inputs.factors] == [False, True]


SPUR_CASE = spur_case(
    "tip_relief_um = 10.0\ntip_relief_length_mm = 2.0", torques=[50.0, 100.0], model="plane_stress"
)
PATH = "meshes.mesh.case.pair.pinion.tip_relief_um"
RESPONSES = (Response("dte_peak_to_peak"), Response("peak_mesh_force"))


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    folder = tmp_path_factory.mktemp("flanks")
    (folder / "case.toml").write_text(SPUR_CASE, encoding="utf-8")
    text = SCENE.format(duration=0.05, speed=300.0, rate=20e3)
    text = text.replace('database_file = "ste.nc"', 'case_file = "case.toml"')
    (folder / "scene.toml").write_text(text, encoding="utf-8")
    return with_inline_cases(*scene_of(folder / "scene.toml"))


@pytest.fixture(scope="module")
def scenes(written, tmp_path_factory, condensed_once):
    case = written.meshes[0].case
    assert case is not None
    database = computed_table(CheckedCase(case), Run(cache=cache_home() / "compliance"))
    places = {PATH: places_of(written, "path", PATH)}
    home = str(tmp_path_factory.mktemp("caches"))
    return VariedScene(written.model_dump_json(), {"mesh": database}, places, home)


def test_other_flanks_are_other_tables_and_the_designed_ones_agree_with_the_analysis(scenes):
    designed, deep = (simulate(scenes.scene({PATH: relief})) for relief in (10.0, 40.0))
    analysis = simulate(dynamic_scene(scenes.inputs({PATH: 10.0}), scenes.databases))
    known, same, other = (responses_of(run, RESPONSES)[0] for run in (analysis, designed, deep))
    assert same[0] == pytest.approx(known[0], rel=0.02)  # equally spaced positions, the same loads
    assert same[1] == pytest.approx(known[1], rel=0.02)
    assert abs(other[0] / known[0] - 1.0) > 0.2


def test_runs_of_equal_flanks_are_in_a_row_and_equal_to_single_runs(scenes):
    torque = "loads.brake.torque_n_m"
    both = VariedScene(
        scenes.written,
        scenes.databases,
        {torque: (("loads", 0, "torque_n_m"),), **scenes.places},
        scenes.home,
    )
    design = Design({torque: Levels((60.0, 90.0)), PATH: Levels((10.0, 40.0))})
    made = study(StudyTask(both, design.names, RESPONSES), design)
    assert made.usable == 4
    for values, figures in zip(made.value, made.figure, strict=True):
        run = simulate(both.scene(dict(zip(design.names, map(float, values), strict=True))))
        np.testing.assert_array_equal(figures, responses_of(run, RESPONSES)[0])


def test_a_class_of_iso_1328_is_a_band_about_the_design(written):
    path = "meshes.mesh.case.pair.pinion.profile_slope_um"
    factor = {"path": path, "iso1328_class": 7}
    inputs = Inputs.model_validate(
        {"factors": [factor], "responses": [{"quantity": "dte_rms"}], "samples": 500}
    )
    points = design_of(written, inputs, factor_places(written, inputs)).points[:, 0]
    # (0.4 m_n + 0.001 d + 4) um of class 5, m_n = 4, d = 80; two classes coarser: twice; above 10: whole
    assert np.abs(points).max() <= 11.0
    assert points.std() == pytest.approx(11.0 / 3.0, rel=0.1)


def test_deviations_of_a_case_with_axes_are_refused(written):
    table = written.model_dump(mode="json")
    table["meshes"][0]["case"]["errors"]["misalignment_um"] = [0.0, 10.0]
    several = SceneInput.model_validate(table)
    inputs = Inputs.model_validate(
        {"factors": [{"path": PATH, "levels": [1.0]}], "responses": [{"quantity": "dte_rms"}]}
    )
    with pytest.raises(BadInput, match="one misalignment"):
        factor_places(several, inputs)


def test_responses_may_name_what_a_scene_has_with_all_its_planets():
    inputs = workbench.read(EXAMPLES / "planetary_scene.toml")
    assert isinstance(inputs, SceneInput)
    meshes = [mesh for _, mesh in inputs.with_database if mesh.case]
    geometry = {mesh.name: PairGeometry.of(gear_pair(mesh.case)) for mesh in meshes}
    whole = check_scene(inputs, geometry)
    parts = (*whole.ground_bearings, *whole.planet_bearings)
    named = [mesh.name for mesh in whole.meshes], [part.name for part in parts]
    assert names_with_planets(inputs) == named
    assert any(name.endswith(" 2") for name in named[0]) and any(name.endswith(" 2") for name in named[1])
