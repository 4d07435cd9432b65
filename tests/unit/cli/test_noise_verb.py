"""``loa noise``: what it prints and writes, its levels, and how it refuses."""

import re
import sys
from dataclasses import replace
from functools import cache
from html import escape

import meshio
import numpy as np
import pytest
from command_line import loa, printed
from computed_once import computed_once
from declared_figures import check_declared
from hulls import box
from reduced_housings import bare_housing
from scene_files import scene_file
from sounding_housings import smooth_motion, with_surface
from sounding_scene import sound

from dynamics.acoustics import Hull, a_weighting
from dynamics.acoustics.boundary_elements import EDGES
from dynamics.noise import RadiatedSound, exact_lines, loudest
from dynamics.noise.coarse_hull import Coarseness
from lineofaction.gearbox.studies.noise import run
from lineofaction.report.drawing import surface_view
from lineofaction.report.drawing.figure import HeatMap
from lineofaction.report.housing import noise as page
from lineofaction.report.housing.noise import DEPTH, _cells, _limits, _model_tables, row_axis
from lineofaction.report.housing.sound_bands import NARROWER

SWEEP = ("--speed-rpm", "300:6000:600", "--orders", 4)
BANDS = (*SWEEP, "--no-boundary-elements")
SPEEDS = (*BANDS, "--no-band")


@cache
def housing():
    bare = bare_housing(("left", "right"), motions=3, positions=[(0.0, 0.0, 0.05), (0.08, 0.0, 0.05)])
    hull = box((0.3, 0.2, 0.15), (6, 4, 3))
    return with_surface(bare, hull, smooth_motion(hull, len(bare.stiffness)))


@pytest.fixture(scope="module", autouse=True)
def _once():
    """Compute what equal calls ask for once; pictures of surfaces and hulls of lines are coarse."""
    with computed_once(run), pytest.MonkeyPatch.context() as patch:
        patch.setattr(exact_lines, "COARSE", Coarseness(EDGES, 100))
        patch.setattr(surface_view, "ACROSS", 90)
        yield


@pytest.fixture
def scene(tmp_path):
    file = scene_file(tmp_path)
    housing().to_netcdf(tmp_path / "case.nc")
    file.write_text(f'{file.read_text()}[[housings]]\nname = "case"\nmodes_file = "case.nc"\n')
    return file


def test_json_holds_levels_by_order_and_speed_and_the_loudest_points(scene):
    answer = printed("noise", scene, *SPEEDS)
    check_declared("noise", answer)
    level, weighted = np.array(answer["level_db"]), np.array(answer["level_db_a"])
    assert level.shape == (4, 10)
    np.testing.assert_allclose(weighted - level, a_weighting(np.array(answer["frequency_hz"])), atol=1e-9)
    total = 10.0 * np.log10(np.sum(10.0 ** (weighted / 10.0), axis=0))
    np.testing.assert_allclose(answer["total_level_db_a"], total, atol=1e-9)
    bands = 10.0 * np.log10(np.sum(10.0 ** (np.array(answer["third_octave_db"]) / 10.0), axis=0))
    np.testing.assert_allclose(bands, answer["total_level_db"], atol=1e-6)
    first = answer["loudest"][0]
    assert first["level_db_a"] == pytest.approx(weighted.max())
    assert first["bearing"] in answer["bearings"] and first["housing"] == "case"
    own = answer["bearings"][first["bearing"]]["alone_db_a"]
    at = answer["order"].index(first["order"]), answer["speed_rpm"].index(first["speed_rpm"])
    assert own[at[0]][at[1]] == pytest.approx(first["bearing_alone_db_a"])
    assert answer["housings"]["case"]["model_error_db"]["estimate"] == 0.0


@pytest.mark.law
def test_a_sound_without_an_effect_is_off_by_what_the_ledger_says(scene):
    """Of the whole analysis with the effect toggled, its radiation by monopoles: within a factor 2."""
    answer = printed("noise", scene, *SPEEDS)
    ledger = answer["effect_ledger"]
    loudest_of = np.max(answer["level_db_a"], axis=1)
    for name in ("flexible_shafts", "housing_modes"):
        level = ledger["influences"][name]["level"]
        assert (level["quantity"], level["unit"]) == ("sound power", "dB(A)")
        on = any(entry["on"] for entry in ledger["entries"] if entry["effect"] == name)
        choice = f"effects.{name}={'off' if on else 'on'}"
        other = printed("noise", scene, *SPEEDS, "--set", choice)
        order = answer["order"].index(level["order"])
        change = (np.max(other["level_db_a"], axis=1) - loudest_of)[order] * (1.0 if on else -1.0)
        assert abs(change) > 1.0
        assert 0.5 < level["decibels"] / change < 2.0, name


def test_the_table_and_the_page_say_the_same(scene, tmp_path):
    files = {ending: tmp_path / f"noise.{ending}" for ending in ("nc", "html")}
    for file in files.values():
        result = loa("noise", scene, *SPEEDS, "-o", file)
        assert result.exit_code == 0, result.stderr
    found = RadiatedSound.from_netcdf(files["nc"])
    point = loudest(found)[0]
    assert f"{point.weighted_level:.1f} dB(A) through mode {point.mode} of case" in result.stdout
    assert f"Radiation models of case at order {point.order:g}, " in result.stdout
    report = files["html"].read_text("utf-8").replace(' class="w"', "")
    assert "Sound power in third octaves" in report and '<figure id="sound_panels">' in report
    rows = list(_limits(found))
    named = [what for what, _ in rows if "above" not in what]
    assert named == ["forces on bearings", "case"]
    for what, words in rows:
        assert f"{what}: {words}" in result.stdout
        assert f'<th scope="row">{what}</th><td>{words}</td>' in report
    for row in (row for table in _model_tables(found) for row in table.rows):
        assert re.search(r"\s+".join(map(re.escape, row)), result.stdout)
        assert all(f">{escape(cell)}</td>" in report for cell in row[1:])


def test_every_model_states_its_error_and_cost_before_it_is_asked_for(scene):
    """Of this housing; boundary elements were not computed, its modes come from a file without a cost."""
    answer = printed("noise", scene, *SPEEDS)
    own = answer["housings"]["case"]
    ladder = ["equivalent_radiated_power", "monopoles", "estimate", "boundary_elements"]
    assert list(own["models_predicted"]) == list(own["models_error_band_db"]) == ladder
    assert list(own["models_db"]) == ladder[:3] and not own["models_left_out"]
    costs = [own["models_predicted"][name]["cpu_seconds"] for name in ladder]
    assert costs == sorted(costs) and costs[0] >= 0.0 and costs[3] > 10.0 * costs[2]
    for low, high in own["models_error_band_db"].values():
        assert low < 0.0 < high
    assert answer["reduction_cost"] == {}
    radiation = own["radiation_cost"]
    assert min(radiation["predicted_cpu_seconds"], radiation["cpu_seconds"]) > 0.0
    assert radiation["predicted_bytes"] > 0.0


def test_regions_and_panels_add_up_to_the_power_of_their_point(scene, tmp_path):
    for file in (tmp_path / "noise.nc", tmp_path / "noise.vtu"):
        assert loa("noise", scene, *SPEEDS, "-o", file).exit_code == 0
    found = RadiatedSound.from_netcdf(tmp_path / "noise.nc")
    points = run.RUN.figures(found)["loudest"]
    for point in points:
        whole = 1e-12 * 10.0 ** (point["level_db"] / 10.0)
        assert sum(region["power_w"] for region in point["regions"]) == pytest.approx(whole, rel=1e-9)
        assert sum(region["share"] for region in point["regions"]) == pytest.approx(1.0, rel=1e-9)
    first = points[0]["regions"][0]
    assert f"{100.0 * first['share']:.0f} % leaves case at {first['facing']}" in page._sentences(found)[0]
    assert len(page._region_table(found).rows) == sum(len(point["regions"]) for point in points[:3])
    loud = loudest(found, 1)[0]
    surface = meshio.read(tmp_path / "noise.vtu")
    (triangles,) = (cells.data for cells in surface.cells)
    hull = Hull(surface.points, triangles)
    (intensity,), (power,) = surface.cell_data["intensity"], surface.cell_data["power"]
    np.testing.assert_allclose(intensity * hull.areas, power, rtol=1e-9)
    assert power.sum() == pytest.approx(found.power[loud.speed_index, loud.order_index], rel=1e-9)


def test_equivalent_radiated_power_is_louder_where_the_housing_is_small(scene):
    by_plane = printed("noise", scene, *SPEEDS, "--radiation", "equivalent_radiated_power")
    monopoles = printed("noise", scene, *SPEEDS, "--radiation", "monopoles")
    low = np.array(by_plane["frequency_hz"]) < 300.0
    more = np.array(by_plane["level_db"]) - np.array(monopoles["level_db"])
    assert np.all(more[low] > 3.0)
    np.testing.assert_allclose(np.array(by_plane["radiation_efficiency"]), 1.0, rtol=0.003)


def test_boundary_elements_check_the_loudest_point_that_the_mesh_resolves(scene, tmp_path):
    """It is louder at 1900 Hz, above the 1618 Hz that the mesh resolves."""
    pytest.importorskip("ngsolve", reason="boundary elements need the extra boundary-elements")
    speeds = ("--speed-rpm", "1600,1750,1900,5700", "--orders", 4, "--no-band")
    report = tmp_path / "noise.html"
    result = loa("noise", scene, *speeds, "-o", report)
    assert result.exit_code == 0, result.stderr
    assert re.search(r"order [\d.]+ of \S+, harmonic 1 of \S+, at 5700 rpm", result.stdout)
    assert "without boundary" not in result.stdout
    caption = "Radiation models of case at order 2, 1750 rpm"
    assert caption in result.stdout and caption in report.read_text("utf-8")
    names = ("equivalent radiated power", "monopoles", "estimate", "boundary elements")
    found = [re.search(rf"^ *{name} +([\d.]+) ", result.stdout, re.MULTILINE) for name in names]
    plane, monopoles, estimate, finest = (float(match[1]) for match in found if match)
    assert abs(monopoles - finest) < 7.0 and abs(estimate - finest) < 3.0 and plane > finest


def test_a_scene_without_a_sounding_housing_is_refused(tmp_path):
    result = loa("noise", scene_file(tmp_path), *SPEEDS)
    assert result.exit_code == 2
    assert "housings" in result.stderr and "step_file" in result.stderr


def test_a_housing_of_matrices_alone_is_refused(scene):
    bare_housing(("left", "right"), motions=3, positions=[(0.0, 0.0, 0.05), (0.08, 0.0, 0.05)]).to_netcdf(
        scene.parent / "case.nc"
    )
    result = loa("noise", scene, *SPEEDS)
    assert result.exit_code == 2
    assert "at least one with a surface" in result.stderr


def test_levels_have_a_band_unless_it_is_left_out(scene):
    answer = printed("noise", scene, *BANDS, "--housing-damping", "0.5,1.5")
    check_declared("noise", answer)
    total, orders = answer["band"]["largest_total"], answer["band"]["orders"]
    assert total["level_db_a"] == pytest.approx(max(answer["total_level_db_a"]), abs=1e-6)
    assert total["low_db_a"] < total["level_db_a"] < total["high_db_a"]
    mean = answer["band"]["mean_total"]
    assert mean["low_db_a"] < mean["level_db_a"] < min(mean["high_db_a"], total["level_db_a"])
    assert [row["order"] for row in orders] == answer["order"]
    assert (answer["band"]["damping_source"], answer["band"]["damping_range"]) == ("range stated", [0.5, 1.5])
    assert total["width_db"] == pytest.approx(total["high_db_a"] - total["low_db_a"])
    assert all(left <= total["width_db"] for left in total["widths_without_db"].values())
    assert answer["sensitivities"] == []
    assert printed("noise", scene, *SPEEDS)["band"] is None


@pytest.mark.law
def test_boundary_elements_narrow_the_band_and_the_largest_rest_is_named(scene):
    """The loudest lines are within 0.5 dB; what is left are guesses."""
    pytest.importorskip("ngsolve", reason="boundary elements need the extra boundary-elements")
    exact, estimate = (printed("noise", scene, *speeds)["band"] for speeds in (SWEEP, BANDS))
    assert exact["damping_source"] == "guessed" and exact["damping_range"] == [0.4, 2.0]
    for end in ("below_db", "above_db"):
        assert (
            exact["largest_total"][end]["radiation_model"] < estimate["largest_total"][end]["radiation_model"]
        )
    assert exact["largest_total"]["below_db"]["radiation_model"] < 1.5
    widths = exact["largest_total"]["widths_without_db"]
    words = loa("noise", scene, *SWEEP).stdout
    first = next(name for name in widths if name in NARROWER)
    assert f"{NARROWER[first]}: of {exact['largest_total']['width_db']:.1f} dB" in words


def test_without_the_library_the_estimate_stands_and_the_result_says_so(scene, monkeypatch):
    monkeypatch.setitem(sys.modules, "ngsolve", None)
    speeds = ("--speed-rpm", "300:6000:700", "--orders", 4, "--no-band")
    own = printed("noise", scene, *speeds)["housings"]["case"]
    assert "lineofaction[boundary-elements]" in own["models_left_out"]["boundary_elements"]
    assert own["exact_lines"] == [] and list(own["models_db"])[-1] == "estimate"


def test_what_one_decibel_costs_is_ranked(scene, tmp_path):
    report, file = tmp_path / "noise.html", tmp_path / "noise.nc"
    for target in (report, file):
        result = loa("noise", scene, *SPEEDS, "--sensitivities", "-o", target)
        assert result.exit_code == 0, result.stderr
        assert "What 1 dB costs" in result.stdout
    assert "What 1 dB costs" in report.read_text("utf-8")
    rows = RadiatedSound.from_netcdf(file).metadata["sensitivities"]
    expected = {"housing_damping", "housing_frequency", "bearing_stiffness", "mesh_damping"}
    assert {row["figure"] for row in rows} == expected
    for row in rows:
        assert row["for_one_db_less"] == pytest.approx(-1.0 / row["slope_db"])
    (damping,) = (row for row in rows if row["figure"] == "housing_damping")
    assert damping["change_db"] < 0.0


# The map of sound power: power is kept, and it ends where its colors do.


def quiet_above() -> RadiatedSound:
    power = np.array(sound().power)
    power[-1] *= 1e-12
    return replace(sound(), power=power, metadata=sound().metadata | {"leading_shaft": "input"})


def shade() -> HeatMap:
    sound = quiet_above()
    _, along = row_axis(sound.speed, sound.metadata)
    return _cells(sound.orders, along)


def test_it_holds_the_power_of_every_speed():
    drawn = np.nansum(10.0 ** (shade().z / 10.0), axis=0) * 1e-12
    total = quiet_above().orders.weighted_power.sum(axis=0)
    left_out = total.max() * 10.0 ** (-DEPTH / 10.0) * quiet_above().order.size
    np.testing.assert_allclose(drawn, total, atol=left_out)


def test_it_ends_with_what_is_shown():
    map_, frequency = shade(), quiet_above().orders.frequency
    assert np.any(np.isfinite(map_.z[-1])) and len(map_.y) == len(map_.z)
    assert map_.y[-1] < 0.5 * (frequency[-2:].max(axis=1).sum())
