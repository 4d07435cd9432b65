"""``loa vibration`` of a measured housing: a rigid mass by hand, what is absent and why, refusals."""

import csv
import math

import numpy as np
import pytest
from command_line import loa, printed
from declared_figures import check_declared
from measured_scenes import HOUSING, LINES, MASS, measured_scene

from dynamics.vibration import bearing_shares, measured_vibration, vibration_level
from lineofaction.gearbox.convert.measured_housings import measured_mobility
from lineofaction.gearbox.registry import response as loa_response
from lineofaction.gearbox.studies.vibration import run
from lineofaction.gearbox.workbench import InputWarning

SPEEDS = ("--speed-rpm", "900:1500:300", "--orders", 4)
ABSENT = {
    "in place of modes": True,
    "does not act back": True,
    "There are no modes, no surface, no deflection shape and no sound": True,
    "3 of 12 pairs of speed and order lie outside the measured band, 20 to 1200 Hz": True,
    "lid was measured along x, y of the file": True,
    "foot was measured along x of the file": True,
    "Forces without a measured function do not move the points: right x, right y": True,
    "The moments of the bearings": False,
}
"""Sentences on this housing, and one that does not hold of its scene."""


@pytest.fixture(scope="module")
def scene(tmp_path_factory):
    return measured_scene(tmp_path_factory.mktemp("measured"))


@pytest.fixture(scope="module")
def answer(scene):
    told = printed("vibration", scene, *SPEEDS)
    check_declared("vibration", told)
    return told


@pytest.mark.law
def test_a_rigid_mass_moves_by_newton(scene, answer):
    """v = F / (2 pi f m) of the bearing that was pushed; the foot has the part along x alone."""
    response = printed("response", scene, *SPEEDS)
    force = np.array(response["bearings"]["left"]["force_n"])
    hertz = np.outer(answer["order"], answer["speed_rpm"]) / 60.0 * 20.0
    rms = force / math.sqrt(2.0) / (2.0 * np.pi * hertz * MASS) * 1e3
    inside = hertz <= LINES[-1]
    lid = answer["points"]["lid"]
    velocity = np.array(lid["velocity_mm_per_s"], dtype=float)
    np.testing.assert_allclose(velocity[inside], rms[inside], rtol=1e-5)
    assert np.array_equal(np.isnan(velocity), ~inside) and np.any(~inside)
    along = np.array(lid["velocity_xyz_mm_per_s"], dtype=float)
    assert np.all(np.isnan(along[2]))
    foot = np.array(answer["points"]["foot"]["velocity_mm_per_s"], dtype=float)
    np.testing.assert_allclose(foot[inside], along[0][inside], rtol=1e-5)
    np.testing.assert_allclose(lid["overall_mm_per_s"], np.sqrt(np.nansum(velocity**2, axis=0)))
    level = np.array(lid["level_db"], dtype=float)
    np.testing.assert_allclose(level[inside], vibration_level(1e-3 * velocity[inside]))


def test_figures_are_those_of_the_library(tmp_path):
    """Two bearings, whose shares differ by order and speed."""
    both = HOUSING.replace("seat_nodes = [", 'seat_nodes = [{bearing = "right", node = 2}, ')
    scene = measured_scene(tmp_path, both, ((1, 1), (1, -2), (2, 1), (2, -2)))
    with pytest.warns(InputWarning, match="housing gearcase is measured"):
        response = loa_response(scene, speed_rpm=[900.0, 1200.0, 1500.0], orders=4)
    seats = {2: "right", 1: "left"}
    mobility = measured_mobility(tmp_path / "gearcase.uff", seats, {11: "lid", 12: "foot"})
    found = measured_vibration(response, mobility)
    for options in ((), ("--at-rpm", 1000, "--at-order", 2)):
        answer = printed("vibration", scene, *SPEEDS, *options)
        velocity = np.array(
            [answer["points"][name]["velocity_mm_per_s"] for name in found.point], dtype=float
        )
        np.testing.assert_allclose(np.swapaxes(velocity, 1, 2), 1e3 * found.rms, rtol=1e-12)
        shown = answer["contributions"]
        at = answer["speed_rpm"].index(shown["speed_rpm"]), answer["order"].index(shown["order"])
        assert options or np.nanmax(velocity) == velocity[:, at[1], at[0]].max()
        assert not options or at == (0, 1)
        share = dict(zip(mobility.bearings, bearing_shares(response, mobility)[(..., *at)], strict=True))
        for part in shown["bearings"]:
            assert list(part["points"].values()) == pytest.approx(share[part["name"]].tolist())
            assert 0.01 < abs(part["points"]["lid"]) != 1.0
        lost = np.array(answer["measured"]["omitted_part"]).T
        np.testing.assert_allclose(lost, found.omitted_force, rtol=1e-12)


def test_what_is_absent_has_a_sentence(scene, answer, tmp_path):
    assert (answer["surface_mm_per_s"], answer["natural_frequency_hz"]) == (None, [])
    assert answer["contributions"]["modes"] == []
    assert answer["measured"]["axes"] == {"lid": "xy", "foot": "x"}
    assert answer["orders_beyond"] == [3.0, 4.0]
    page = tmp_path / "vibration.html"
    result = loa("vibration", scene, *SPEEDS, "-o", page)
    assert result.exit_code == 0
    shown = " ".join(result.stdout.split()), " ".join(answer["left_out"]), page.read_text("utf-8")
    for words, holds in ABSENT.items():
        assert all((words in text) == holds for text in shown), words
    assert "housing gearcase is measured" in " ".join(result.stdout.split())
    assert "nan" not in result.stdout.lower()


def test_files_hold_what_was_measured_alone(scene, answer, tmp_path):
    kept, table = tmp_path / "vibration.nc", tmp_path / "vibration.csv"
    for file in (kept, table):
        assert loa("vibration", scene, *SPEEDS, "-o", file).exit_code == 0
    found = run.RUN.figures(run.RUN.file.read(kept))
    assert {name: found[name] for name in ("points", "measured", "left_out")} == {
        name: answer[name] for name in ("points", "measured", "left_out")
    }
    rows = list(csv.DictReader(line for line in table.read_text("utf-8").splitlines() if line[0] != "#"))
    assert [name for name in rows[0] if name.startswith(("lid", "foot"))] == [
        "lid_x_mm_per_s", "lid_y_mm_per_s", "foot_x_mm_per_s",
    ]  # fmt: skip
    assert [row["valid"] for row in rows] == ["1"] * 4 + ["1", "1", "1", "0"] + ["1", "1", "0", "0"]
    assert all((row["lid_x_mm_per_s"] == "") == (row["valid"] == "0") for row in rows)


def test_a_run_moves_the_points_too(scene, tmp_path):
    """At constant speed, by the orders of the forces over the run."""
    made = tmp_path / "run.nc"
    scene.with_name("long.toml").write_text(
        scene.read_text("utf-8").replace("duration_s = 0.01", "duration_s = 0.2")
    )
    result = loa("simulate", scene.with_name("long.toml"), "-o", made)
    assert result.exit_code == 0
    assert "does not act back" in " ".join(result.stdout.split())
    answer = printed("vibration", scene, "--run", made, "--orders", 2)
    assert answer["forces"]["source"] == "run"
    assert np.array(answer["points"]["lid"]["velocity_mm_per_s"], dtype=float).max() > 0.0


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--mode", 1), ("mode = 1", "left out of a measured housing")),
        (("--housing", "other"), ("housing = 'other'", "one of gearcase")),
        (("--speed-rpm", "9000", "--orders", 2), ("speed_rpm", "inside the measured band, 20 to 1200 Hz")),
        (("--at-rpm", 1500, "--at-order", 4), ("at_order = 4", "20 to 1200 Hz")),
        (("-o", "shape.vtu"), ("shape.vtu", "has no surface")),
    ],
)
def test_what_is_not_there_is_refused(scene, options, words, monkeypatch):
    monkeypatch.chdir(scene.parent)
    given = options if "--speed-rpm" in options else (*SPEEDS, *options)
    result = loa("vibration", scene, *given)
    assert result.exit_code == 2
    for word in words:
        assert word in " ".join(result.stderr.split()), result.stderr


def test_two_housings_are_chosen_by_their_names(tmp_path):
    other = HOUSING.replace('"gearcase"', '"other"').replace('{name = "lid", node = 11}, ', "")
    scene = measured_scene(tmp_path, HOUSING + other)
    first, second = (
        printed("vibration", scene, *SPEEDS, "--housing", name) for name in ("gearcase", "other")
    )
    assert (list(first["points"]), list(second["points"])) == (["lid", "foot"], ["foot"])
    assert printed("vibration", scene, *SPEEDS)["housing"] == "gearcase"
