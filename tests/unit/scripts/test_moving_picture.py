"""The moving picture of the README moves, is small, and is drawn by its script."""

import moving_picture
import numpy as np
import pytest
from PIL import Image
from repository import ROOT
from scipy.io import wavfile

from lineofaction.report.drawing.figure import Axis, Line, Panel

PICTURE = ROOT / "docs" / "images" / "relief.gif"


def test_the_readme_shows_a_picture_that_moves_in_less_than_a_megabyte():
    assert "docs/images/relief.gif" in (ROOT / "README.md").read_text("utf-8")
    assert PICTURE.stat().st_size < 1_000_000
    with Image.open(PICTURE) as shown:
        assert shown.n_frames == 2 * len(moving_picture.RELIEFS) - 2
        assert shown.info["loop"] == 0


@pytest.mark.law
def test_frames_run_there_and_back_and_rest_at_the_ends(tmp_path):
    x = np.array([0.0, 1.0])
    axes = Axis("x"), Axis("y", limits=(0.0, 3.0))
    panels = [Panel(*axes, (Line("a", x, k * x, "#0072B2"),)) for k in range(3)]
    drawn = [moving_picture.frame((panel,)) for panel in panels]
    moving_picture.moving(drawn, tmp_path / "moving.gif")
    with Image.open(tmp_path / "moving.gif") as shown:
        seen = []
        for index in range(shown.n_frames):
            shown.seek(index)
            seen.append((np.asarray(shown.convert("RGB")).tobytes(), shown.info["duration"]))
    assert len(seen) == 4 and seen[1][0] == seen[3][0] != seen[2][0]
    assert [duration for _, duration in seen] == [900, 160, 900, 160]


def test_the_sound_lasts_as_long_as_the_picture_and_is_small():
    file = PICTURE.with_suffix(".wav")
    assert file.stat().st_size < 300_000
    rate, samples = wavfile.read(file)
    shown = moving_picture.there_and_back(len(moving_picture.RELIEFS))
    assert len(samples) == pytest.approx(1e-3 * sum(duration for _, duration in shown) * rate, abs=len(shown))
    assert np.abs(samples).max() == pytest.approx(1.0)
    for page, address in {
        "README.md": "docs/images/relief.wav",
        "docs/index.md": "_static/relief.wav",
    }.items():
        assert address in (ROOT / page).read_text("utf-8")


@pytest.mark.law
def test_a_ripple_twice_as_large_sounds_twice_as_loud_and_each_harmonic_by_its_velocity():
    angle = 2.0 * np.pi * np.arange(64) / 64
    curve = 3.0 + 0.5 * np.sin(angle) + 0.25 * np.sin(2.0 * angle + 1.0)
    first, second, *others = moving_picture.velocities(curve)
    assert first == pytest.approx(second) == pytest.approx(np.pi * moving_picture.MESH_HZ)
    assert np.allclose(others, 0.0)
    heard = moving_picture.sound([curve, 2.0 * curve], [500, 500]).samples
    half, edge = heard.size // 2, moving_picture.SAMPLE_RATE // 20
    quiet, loud = (
        np.sqrt(np.mean(np.square(part))) for part in (heard[edge : half - edge], heard[half + edge : -edge])
    )
    assert loud / quiet == pytest.approx(2.0, rel=1e-3)


def test_both_gears_are_relieved_and_the_case_is_left_alone():
    case = {"pair": {"pinion": {"tip_relief_um": 1.0}, "wheel": {}}}
    changed = moving_picture.relieved(case, 4.0)
    assert [changed["pair"][gear]["tip_relief_um"] for gear in ("pinion", "wheel")] == [4.0, 4.0]
    assert case == {"pair": {"pinion": {"tip_relief_um": 1.0}, "wheel": {}}}
