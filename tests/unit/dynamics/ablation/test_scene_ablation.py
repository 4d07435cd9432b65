"""Effects of a scene toggled one by one: the changes are those of two runs."""

import json
from dataclasses import replace

import numpy as np
import pytest
from geared_scenes import gear_pair_scene

from dynamics import Outputs, ablate, simulate
from dynamics.ablation import WARM_UP, runs_of_ablation
from dynamics.errors import InputError
from lineofaction.gearbox.studies.ablate.run import RUN

SCENE = gear_pair_scene(duration=0.06)
ONLY = ["lateral", "axial", "tilt", "friction"]


@pytest.fixture(scope="module")
def made():
    return ablate(SCENE, only=ONLY)


def test_a_prediction_has_every_run_and_the_freedoms_of_what_is_off(made):
    times, figures = runs_of_ablation(SCENE, ONLY)
    assert len(times) == 1 + len(made.effects)
    assert times[0] == min(times) == 1.0 + WARM_UP
    held = replace(SCENE, effects={"lateral": "off"})
    assert max(runs_of_ablation(held, ["lateral"])[0]) > 1.5
    assert runs_of_ablation(replace(SCENE, duration=0.12), ONLY)[1] == pytest.approx(2.0 * figures)


def test_a_change_is_that_of_two_runs(made):
    whole = simulate(SCENE)
    outputs = Outputs(whole.sample_rate)
    held = simulate(gear_pair_scene(duration=0.06, effects={"lateral": "off"}, outputs=outputs))
    (entry,) = (one for one in made.effects if one.name == "lateral")
    assert entry.on
    settled = slice(whole.time.size // 2, None)
    means = [float(np.mean(run.dynamic_transmission_error[0, settled])) for run in (whole, held)]
    ripples = [float(np.ptp(run.dynamic_transmission_error[0, settled])) for run in (whole, held)]
    assert made.nominal.mean[0] == means[0]
    assert entry.mean_change[0] == means[1] - means[0]
    assert entry.peak_to_peak_change[0] == ripples[1] - ripples[0]
    assert entry.cost_ratio > 0.0


def test_orders_are_those_of_the_mesh(made):
    """At 900 rpm the mesh passes at 300 Hz: over whole base pitches its harmonics are the spectrum."""
    run = simulate(SCENE)
    per_pitch = run.sample_rate / 300.0
    count = round(8 * per_pitch)
    error = run.dynamic_transmission_error[0, -count:]
    lines = 2.0 * np.abs(np.fft.rfft(error))[8::8][:5] / count
    assert made.nominal.orders[0] == pytest.approx(lines, rel=0.02, abs=0.01 * lines[0])
    force = run.bearing_force[..., -count:]
    whole = np.sqrt(np.sum((2.0 * np.abs(np.fft.rfft(force))[..., 8] / count) ** 2, axis=1))
    assert made.nominal.bearing_orders[:, 0] == pytest.approx(whole, rel=0.02)


def test_what_has_no_part_in_the_scene_is_left_out_by_name(made):
    assert made.omitted["friction"] == "no coefficient of friction given"
    assert {entry.name for entry in made.effects} | set(made.omitted) == {
        "lateral", "axial", "tilt", "friction",
    }  # fmt: skip
    figures = json.loads(json.dumps(RUN.figures(made), allow_nan=False))
    assert set(figures) == {"of", "nominal", "effects", "left_out", "mesh", "bearing"}
    assert figures["nominal"]["orders_um"] == (made.nominal.orders / 1e-6).tolist()
    with pytest.raises(InputError, match="only"):
        ablate(SCENE, only=["windage"])
