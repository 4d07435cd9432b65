"""The stated error of a run holds what accumulates: impacts, reversals, light damping, chaos."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.accumulated_error_cases import ACCUMULATING, STEADY, scenes
from benchmarks.accumulated_errors import MAX, MIN, stated_run
from dynamics import Integration, Outputs, RunResult, simulate, simulate_to_file
from dynamics.assembly.assemble import assemble
from dynamics.errors import SolveError
from dynamics.integrators import integrate, static_equilibrium
from dynamics.integrators.method_choice import choose_method
from dynamics.simulation import interrupted_run
from dynamics.simulation.long_run_error import RunPair, blind_windows, finer_run, level_error
from dynamics.types import RunStatus
from lineofaction.hardcases.dynamics.bouncing_mass import bounce, cycle
from lineofaction.hardcases.dynamics.oscillators import BASE_RADIUS, NATURAL, coast, torsional

SCENES = scenes()
QUICK = ("torque reversal", "gentle reversal", "reversal of a free train", "undamped torque step", "rattle")


def step_error(result):
    return result.receipt["error"]["time_step"]


@pytest.mark.law
@pytest.mark.parametrize("name", QUICK)
def test_the_stated_error_is_the_true_one(name, record_figure):
    run = stated_run(name, SCENES[name])
    record_figure(f"true over stated step error, {name}", run.ratio, "0.3 to 3", "1", "own target")
    assert MIN < run.ratio < MAX
    assert not run.chaotic


@pytest.mark.law
@pytest.mark.parametrize("name", [*ACCUMULATING, *STEADY])
@pytest.mark.nightly
def test_the_stated_error_of_every_scene_is_the_true_one(name):
    run = stated_run(name, SCENES[name])
    assert run.ratio < MAX
    assert run.ratio > MIN or run.chaotic  # a level may be right by accident


@pytest.mark.law
@pytest.mark.parametrize("method", ["implicit", "explicit"])
def test_the_error_of_forty_impacts_is_that_from_the_closed_form(method):
    """Thrown to and fro between both flanks without load or damping: flights and half sines."""
    gap, speed = 20e-6, 0.1
    scene = torsional(
        torque=0.0,
        back=coast(gap),
        duration=20.0 * cycle(gap, speed, NATURAL),
        outputs=Outputs(2e5),
        integration=Integration(method, 1e-9),
    )
    system = assemble(scene)
    start = replace(static_equilibrium(system), displacement=np.zeros(1))
    thrown = np.array([-speed]) / system.arrays.direction[0]
    run = integrate(system, start, scene.integration, velocity=thrown)
    choice = choose_method(system, start.displacement, scene.integration)
    assert blind_windows(system, choice, run.states.rows, run) == "flanks part"
    finer = integrate(system, start, finer_run(scene.integration, run), velocity=thrown)
    stated = RunPair(system, run.states.rows, finer.states.rows, run.samples).error("")
    off = run.q[:, 0] * BASE_RADIUS - bounce(run.time, gap, speed, NATURAL)
    true = float(np.sqrt(np.mean(off**2)))
    assert true > 10.0 * scene.integration.tolerance
    assert MIN < true / stated["rms"] < MAX
    assert not stated["chaotic"]


def test_steady_contact_is_not_run_twice():
    error = step_error(simulate(SCENES["steady, damping 2 %"]))
    assert error["source"].startswith("runs of windows")
    assert error["met"]
    assert "seconds" not in error


def test_a_minimal_receipt_is_not_run_twice_unless_it_is_requested():
    scene = SCENES["gentle reversal"]
    lean = replace(scene, outputs=replace(scene.outputs, receipt="minimal"))
    assert "seconds" not in step_error(simulate(lean))
    wanted = replace(lean, integration=replace(lean.integration, estimate_error=True))
    assert step_error(simulate(wanted))["reason"] == "requested"


def test_a_tolerance_that_is_not_met_is_a_check_that_fails():
    run = simulate(SCENES["torque reversal"])
    error, checks = step_error(run), run.effect_ledger["checks"]
    assert error["rms"] > error["tolerance"] == 1e-9
    assert error["met"] is False
    (check,) = (check for check in checks if check["part"] == "time steps")
    assert check["holds"] is False
    assert check["reason"].endswith("1 nm requested: lower the tolerance")
    finer = replace(SCENES["torque reversal"], integration=Integration(tolerance=1e-11))
    relative = step_error(simulate(finer))["rms"] / error["rms"]
    assert relative < 0.2


def test_chaos_is_named_and_has_errors_of_levels():
    run = simulate(SCENES["chaotic rattle"])
    error = step_error(run)
    vibration = float(np.std(run.dynamic_transmission_error))
    assert error["chaotic"]
    assert error["met"] is False
    assert error["trace_rms"] > 0.1 * vibration > 10.0 * error["rms"] > 0.0
    assert 0.0 < error["levels"]["rms"] < 1.0
    assert 0.0 < error["levels"]["peak_force"] < 3.0
    assert len(error["levels"]["transmission_error_orders"]) == len(error["transmission_error_orders"])
    (check,) = (check for check in run.effect_ledger["checks"] if check["part"] == "time steps")
    assert check["reason"].startswith("chaotic motion")


def test_levels_of_two_drawings_are_as_far_apart_as_stated():
    """Noise in place of chaos: what is stated covers 19 of 20 drawings of the true level."""
    power = np.random.default_rng(7).chisquare(40, size=(400, 3, 6)) / 40.0
    stated = np.array([level_error(np.moveaxis(pair[:2], 0, 1))[0] for pair in power])
    true = np.abs(np.sqrt(power[:, 0].mean(axis=1)) - np.sqrt(power[:, 2].mean(axis=1)))
    assert 0.9 < np.mean(true <= stated) < 0.99


def test_a_stated_step_is_measured_at_half_of_it():
    scene = replace(SCENES["torque reversal"], integration=Integration(fixed_step=4e-6))
    fine = replace(scene, integration=Integration(tolerance=1e-13))
    run, truth = simulate(scene), simulate(fine)
    apart = run.dynamic_transmission_error - truth.dynamic_transmission_error
    error = step_error(run)
    assert error["source"] == "difference from a run at half the step"
    assert "met" not in error
    assert MIN < float(np.sqrt(np.mean(apart**2))) / error["rms"] < MAX


def test_the_finer_run_that_cannot_end_leaves_the_windows_and_says_so():
    scene = SCENES["reversal of a pair on bearings"]
    steps = simulate(scene).statistics
    few = int(1.1 * (steps.accepted + steps.rejected))
    run = simulate(replace(scene, integration=replace(scene.integration, step_limit=few)))
    assert run.status is RunStatus.COMPLETED
    assert step_error(run)["not_covered"] == "flanks part"
    assert "met" not in step_error(run)


def test_a_run_cancelled_while_its_error_is_measured_goes_on_from_there(tmp_path):
    scene, path, stages = SCENES["reversal of a pair on bearings"], tmp_path / "run.nc", []

    def cancel():
        return stages.count("error of the steps") == 3

    def progress(_done, stage):
        stages.append(stage)

    assert simulate_to_file(scene, path, progress=progress, cancel=cancel) is RunStatus.CANCELLED
    assert interrupted_run(path).is_dir()
    stages.clear()
    assert simulate_to_file(scene, path, resume=True, progress=progress) is RunStatus.COMPLETED
    assert "time integration" not in stages
    resumed, whole = RunResult.from_netcdf(path), simulate(scene)
    np.testing.assert_array_equal(resumed.mesh_force, whole.mesh_force)
    assert step_error(resumed)["rms"] == pytest.approx(step_error(whole)["rms"], rel=1e-12)


def test_a_run_cancelled_while_its_error_is_measured_is_cancelled():
    stages = []
    with pytest.raises(SolveError, match="cancelled"):
        simulate(
            SCENES["reversal of a pair on bearings"],
            lambda _done, stage: stages.append(stage),
            lambda: "error of the steps" in stages,
        )
