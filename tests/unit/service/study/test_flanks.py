"""A study over flank amounts: tables of other flanks on one compliance."""

from __future__ import annotations

import numpy as np
import pytest
from scene_files import SCENE
from spur_case import spur_case

from dynamics.simulation import simulate
from dynamics.study import Design, Levels, Response, StudyTask, responses_of, study
from lineofaction.cli.analyze import analyzed
from lineofaction.gearbox.convert.case import CheckedCase
from lineofaction.gearbox.convert.scene import dynamic_scene
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.studies.study import Inputs
from lineofaction.gearbox.studies.study.run import _design_of, _factor_places
from lineofaction.gearbox.studies.study.scenes import VariedScene, places_of
from lineofaction.gearbox.subjects import _portable_scene, scene_of

CASE = (
    spur_case("tip_relief_um = 10.0\ntip_relief_length_mm = 2.0")
    + """
[load]
torque_n_m = [50.0, 100.0]
[accuracy]
level = "draft"
model = "plane_stress"
"""
)
PATH = "meshes.mesh.case.pair.pinion.tip_relief_um"
RESPONSES = (Response("dte_peak_to_peak"), Response("peak_mesh_force"))


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> SceneInput:
    folder = tmp_path_factory.mktemp("flanks")
    (folder / "case.toml").write_text(CASE, encoding="utf-8")
    text = SCENE.format(duration=0.05, speed=300.0, rate=20e3)
    text = text.replace('database_file = "ste.nc"', 'case_file = "case.toml"')
    (folder / "scene.toml").write_text(text, encoding="utf-8")
    return _portable_scene(*scene_of(folder / "scene.toml"))


@pytest.fixture(scope="module")
def scenes(
    written: SceneInput, tmp_path_factory: pytest.TempPathFactory, condensed_once: None
) -> VariedScene:
    case = written.meshes[0].case
    assert case is not None
    database = analyzed(CheckedCase(case), lambda _stage, _fraction: None)
    places = {PATH: places_of(written, "path", PATH)}
    home = str(tmp_path_factory.mktemp("caches"))
    return VariedScene(written.model_dump_json(), {"mesh": database}, places, home)


def test_other_flanks_are_other_tables_and_the_designed_ones_agree_with_the_analysis(
    scenes: VariedScene,
) -> None:
    designed, deep = (simulate(scenes.scene({PATH: relief})) for relief in (10.0, 40.0))
    analysis = simulate(dynamic_scene(scenes.inputs({PATH: 10.0}), scenes.databases))
    known, same, other = (responses_of(run, RESPONSES)[0] for run in (analysis, designed, deep))
    assert same[0] == pytest.approx(known[0], rel=0.02)  # equally spaced positions, the same loads
    assert same[1] == pytest.approx(known[1], rel=0.02)
    assert abs(other[0] / known[0] - 1.0) > 0.2


def test_runs_of_equal_flanks_are_in_a_row_and_equal_to_single_runs(scenes: VariedScene) -> None:
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


def test_a_class_of_iso_1328_is_a_band_about_the_design(written: SceneInput) -> None:
    path = "meshes.mesh.case.pair.pinion.profile_slope_um"
    factor = {"path": path, "iso1328_class": 7}
    inputs = Inputs.model_validate(
        {"factors": [factor], "responses": [{"quantity": "dte_rms"}], "samples": 500}
    )
    points = _design_of(written, inputs, _factor_places(written, inputs)).points[:, 0]
    # (0.4 m_n + 0.001 d + 4) um of class 5, m_n = 4, d = 80; two classes coarser: twice; above 10: whole
    assert np.abs(points).max() <= 11.0
    assert points.std() == pytest.approx(11.0 / 3.0, rel=0.1)


def test_deviations_of_a_case_with_axes_are_refused(written: SceneInput) -> None:
    table = written.model_dump(mode="json")
    table["meshes"][0]["case"]["errors"]["misalignment_um"] = [0.0, 10.0]
    several = SceneInput.model_validate(table)
    inputs = Inputs.model_validate(
        {"factors": [{"path": PATH, "levels": [1.0]}], "responses": [{"quantity": "dte_rms"}]}
    )
    with pytest.raises(BadInput, match="one misalignment"):
        _factor_places(several, inputs)
