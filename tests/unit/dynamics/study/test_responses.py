"""Responses of a run: what each is, of one part or of the largest."""

import numpy as np
import pytest
from geared_scenes import gear_pair_scene
from planetary_scenes import planetary_scene, published_set

from dynamics import Outputs, RunResult, simulate
from dynamics.errors import InputError
from dynamics.results.mesh_figures import contact_shares, planet_load_sharing
from dynamics.study import Response, responses_of


def value(run: RunResult, response: Response, start: float = 0.0) -> float:
    (one,), _ = responses_of(run, (response,), start)
    return one


@pytest.fixture(scope="module")
def run():
    return simulate(gear_pair_scene(duration=0.1))


def test_an_order_of_a_bearing_force_is_the_amplitude_of_its_harmonic(run):
    """Whole periods at constant speed: the line of the Fourier transform."""
    samples = int(run.sample_rate * 30.0 / run.mesh_frequency[0, 0])  # thirty mesh periods
    start = float(run.time[run.time.size - samples])
    force = run.bearing_force[1, :, -samples:]
    line = 2.0 * np.abs(np.fft.rfft(force)[:, 30]) / samples
    response = Response("bearing_force", run.bearing[1], order=1)
    assert value(run, response, start) == pytest.approx(np.linalg.norm(line), rel=0.03)
    every = [value(run, Response("bearing_force", name, order=1)) for name in run.bearing]
    assert value(run, Response("bearing_force", order=1)) == pytest.approx(max(every), rel=1e-9)


def test_figures_of_a_mesh_are_those_of_its_series(run):
    error, from_then = run.dynamic_transmission_error[0], run.time >= 0.05
    assert value(run, Response("dte_peak_to_peak"), 0.05) == np.ptp(error[from_then])
    assert value(run, Response("dte_rms"), 0.05) == np.std(error[from_then])
    peak = run.largest_mesh_force[0].max()
    assert value(run, Response("peak_mesh_force", "mesh")) == peak
    assert value(run, Response("dynamic_factor")) == peak / run.nominal_force[0]
    assert value(run, Response("contact_loss")) == contact_shares(run)[0]["off"]


def test_the_mesh_load_factor_is_the_largest_of_the_central_gears():
    run = simulate(planetary_scene(published_set(3), duration=0.005))
    shared = [sharing.mesh_load_factor for sharing in planet_load_sharing(run)]
    assert len(shared) == 2 and value(run, Response("mesh_load_factor")) == max(shared)


@pytest.mark.parametrize(
    ("response", "field"),
    [
        (Response("mesh_load_factor"), "quantity"),
        (Response("peak_mesh_force", "other"), "mesh"),
        (Response("bearing_force", "other", order=1), "bearing"),
        (Response("bearing_force", order=1, mesh="other"), "mesh"),
        (Response("dte_order", order=900), "order"),
    ],
)
def test_what_a_run_has_not_is_refused(run, response, field):
    with pytest.raises(InputError) as error:
        responses_of(run, (response,))
    assert error.value.field == field


def test_bearings_that_are_not_stored_are_asked_for():
    run = simulate(gear_pair_scene(duration=0.002, outputs=Outputs(bearing_forces=False)))
    with pytest.raises(InputError, match="bearing_forces"):
        responses_of(run, (Response("bearing_force", order=1),))
