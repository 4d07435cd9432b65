"""``loa vibration``: what it prints and writes, and how it refuses."""

import json
import re
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest
from command_line import loa, printed
from computed_once import computed_once
from declared_figures import check_declared
from housing_solid import housed_scene, write_housed_scene
from scene_files import scene_file

from dynamics.vibration import vibration_level
from lineofaction.gearbox.studies.vibration import run
from lineofaction.report.drawing import surface_view

SPEEDS = ("--speed-rpm", "1500:3000:250", "--orders", 4)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return write_housed_scene(tmp_path_factory.mktemp("vibration"), modes=6)


@pytest.fixture(scope="module", autouse=True)
def _once():
    """Compute what equal calls ask for once; pictures of surfaces are coarse."""
    with computed_once(run), pytest.MonkeyPatch.context() as patch:
        patch.setattr(surface_view, "ACROSS", 90)
        yield


@pytest.fixture(scope="module")
def cache(tmp_path_factory):
    return tmp_path_factory.mktemp("cache")


@pytest.fixture
def scene(folder, cache, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(cache))
    return folder / "scene.json"


def test_the_surface_and_the_cost_of_the_housing_are_written(scene, tmp_path):
    files = {ending: tmp_path / f"vibration.{ending}" for ending in ("nc", "vtu", "html")}
    for file in files.values():
        result = loa("vibration", scene, *SPEEDS, "-o", file)
        assert (result.exit_code, result.stderr) == (0, "")
    found = run.RUN.file.read(files["nc"])
    surface = meshio.read(files["vtu"])
    assert [cells.type for cells in surface.cells] == ["triangle6"]
    size = surface.point_data["velocity_magnitude"]
    parts = surface.point_data["velocity_real"], surface.point_data["velocity_imaginary"]
    np.testing.assert_allclose(size, np.hypot(*parts))
    np.testing.assert_allclose(size, np.abs(found.shape.motion))
    cost = run.RUN.figures(found)["reduction_cost"]["case"]
    assert cost["predicted_cpu_seconds"] > 0.0 and cost["cpu_seconds"] > 0.0 and cost["predicted_bytes"] > 0.0
    assert re.search(r"case: reduction +\S+ ", result.stdout)
    page = files["html"].read_text("utf-8")
    for text in ("case: reduction", "housing_velocity", "housing_shape", "housing_contributions"):
        assert text in page
    assert "housing_transfer" in page


@pytest.mark.law
def test_figures_are_root_mean_squares_and_contributions_add_up(scene):
    answer = told(scene)
    cover = answer["points"]["cover"]
    velocity = np.array(cover["velocity_mm_per_s"])
    assert velocity.shape == (4, 7)
    along = np.array(cover["velocity_xyz_mm_per_s"])
    np.testing.assert_allclose(np.sqrt((along**2).sum(axis=0)), velocity)
    np.testing.assert_allclose(np.sqrt((velocity**2).sum(axis=0)), cover["overall_mm_per_s"])
    np.testing.assert_allclose(cover["level_db"], vibration_level(1e-3 * velocity))
    shown = answer["contributions"]
    order, speed = answer["order"].index(shown["order"]), answer["speed_rpm"].index(shown["speed_rpm"])
    assert velocity[order, speed] == velocity.max()
    for parts in (shown["bearings"], shown["modes"]):
        assert sum(part["points"]["cover"] for part in parts) == pytest.approx(1.0)
        assert sum(part["surface"] for part in parts) == pytest.approx(1.0)
    assert [part["name"] for part in shown["bearings"]] == ["input left", "output left"]
    levels = [size["level"] for size in answer["effect_ledger"]["influences"].values()]
    assert {(level["quantity"], level["unit"]) for level in levels} == {("surface velocity of case", "dB")}
    assert answer["highest_valid_frequency_hz"] == pytest.approx(0.7 * answer["natural_frequency_hz"][-1])


def test_parts_are_those_of_the_order_and_speed_asked_for(scene):
    shown = told(scene, "--at-rpm", 2600, "--at-order", 2.9)["contributions"]
    assert (shown["speed_rpm"], shown["order"]) == (pytest.approx(2500.0), 3.0)
    assert shown["frequency_hz"] == pytest.approx(2500.0 / 60.0 * 20 * 3)


def test_orders_that_the_modes_kept_do_not_carry_are_named(folder, scene):
    few = folder / "few.json"
    few.write_text(json.dumps(housed_scene(folder, modes=1)))
    result = loa("vibration", few, "--speed-rpm", "2500,6000", "--orders", 4)
    assert result.exit_code == 0
    answer = printed("vibration", few, "--speed-rpm", "2500,6000", "--orders", 4)
    beyond = [order for order in answer["order"] if order * 2000.0 > answer["highest_valid_frequency_hz"]]
    assert answer["orders_beyond"] == beyond != []
    assert f"orders {', '.join(f'{order:g}' for order in beyond)} go beyond" in result.stdout


def test_a_mode_is_drawn_in_place_of_the_deflection(scene, tmp_path):
    assert loa("vibration", scene, *SPEEDS, "--mode", 2, "-o", tmp_path / "mode.vtu").exit_code == 0
    motion = meshio.read(tmp_path / "mode.vtu").point_data["mode_2_real"]
    assert np.linalg.norm(motion, axis=1).max() == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--mode", 7), ("mode = 7", "from 1 to 6")),
        (("--housing", "other"), ("housing = 'other'", "one of case")),
    ],
)
def test_what_is_not_there_is_refused(scene, options, words):
    result = loa("vibration", scene, *SPEEDS, *options)
    assert result.exit_code == 2
    for word in words:
        assert word in " ".join(result.stderr.split()), result.stderr


def test_a_scene_without_a_housing_that_moves_is_refused_with_advice(tmp_path):
    result = loa("vibration", scene_file(tmp_path), *SPEEDS)
    assert result.exit_code == 2
    assert "housings" in result.stderr and "step_file" in result.stderr


def told(scene: Path, *options: object) -> Any:
    answer = printed("vibration", scene, *SPEEDS, *options)
    check_declared("vibration", answer)
    return answer
