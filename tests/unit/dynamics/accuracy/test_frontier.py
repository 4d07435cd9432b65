"""The accuracy study: errors that fall, models that are what they say, fidelities without a result."""

import json
from dataclasses import replace

import numpy as np
import pytest
from geared_scenes import RPM, gear_pair_scene, spring_table, square_wave_table, with_mesh

from dynamics import Integration, TimeLaw, ablate, frontier
from dynamics.accuracy import (
    FIDELITIES,
    FIGURES,
    BlockGrid,
    TimeIntegration,
    knee_of_results,
    runs_of_frontier,
)
from dynamics.assembly.assemble import assemble
from dynamics.errors import InputError
from dynamics.simulation import run_scene
from lineofaction.gearbox.studies.frontier.run import RUN

LINEAR = "harmonic_response"
RUN_UP = gear_pair_scene(speed=TimeLaw.ramp(100.0 * RPM, 900.0 * RPM, 0.4), duration=0.4)


@pytest.fixture(scope="module")
def found():
    return frontier(RUN_UP)


def test_a_prediction_has_every_run_and_the_steps_of_its_tolerance(found):
    integrated = [result for result in found.results if result.name not in ("quasi_static", LINEAR)]
    steps, beside = runs_of_frontier(RUN_UP, [fidelity.name for fidelity in FIDELITIES])
    assert (len(steps), beside) == (len(integrated), 0.0)
    runs = (replace(RUN_UP, integration=Integration(tolerance=value)) for value in (1e-9, 1e-11))
    finer, finest = (run_scene(run).statistics.accepted for run in runs)
    assert steps[-1] / steps[-3] == pytest.approx(finest / finer, rel=0.3)


def by_name(found):
    return {result.name: result for result in found.results}


def test_errors_fall_with_the_tolerance(found):
    steps = [r for r in found.results if r.family == "steps"]
    for figure in FIGURES:
        errors = [result.errors[figure] for result in steps]
        assert errors[0] > 5.0 * errors[2] > 50.0 * errors[-1] > 0.0
    assert all(result.cpu_seconds > 0.0 for result in steps)


def test_fewer_nodes_cost_accuracy(found):
    fidelity = by_name(found)
    assert fidelity["table_quarter"].error > 3.0 * fidelity["table_half"].error


def test_models_with_less_in_them_are_worse_than_any_step(found):
    fidelity = by_name(found)
    worst = max(fidelity["1_nm"].error, fidelity["table_half"].error)
    for name in ("quasi_static", "harmonic_response", "torsion"):
        assert fidelity[name].error > worst
    assert fidelity["quasi_static"].bearing_force_orders == pytest.approx(1.0)  # its forces do not vibrate
    assert np.isnan(fidelity["torsion"].bearing_force_orders)  # nothing moves in the bearings
    assert "in_plane" in found.omitted  # the scene has no more than that


def test_the_linear_response_is_the_run_where_nothing_is_nonlinear():
    scene = gear_pair_scene(spring_table(4e8, 1e-7), duration=0.4)
    scene = with_mesh(scene, damping_ratio=0.1)
    found = by_name(frontier(scene, fidelities=["harmonic_response", "quasi_static", "0.1_nm", "0.01_nm"]))
    linear, static = found["harmonic_response"], found["quasi_static"]
    assert linear.transmission_error_orders < 1e-4
    assert linear.bearing_force_orders < 0.02  # the first block rings from the start at rest
    assert static.transmission_error_orders > 50.0 * linear.transmission_error_orders


def test_the_scenes_own_setting_is_marked(found):
    assert found.chosen == "1_nm"
    assert found.results[-1].name == FIDELITIES[-1].name == "0.01_nm"
    own = replace(RUN_UP, integration=Integration(tolerance=3e-9), duration=0.1)
    assert frontier(own, fidelities=["10_nm", "1_nm", "0.1_nm"]).chosen == "1_nm"


def test_the_knee_does_not_go_below_the_error_of_the_table(found):
    """Steps whose error is far below that of the table they share buy nothing."""
    fidelity = by_name(found)
    finer = [
        name for name in ("0.1_nm", "0.01_nm") if fidelity[name].error < fidelity["table_half"].error / 30.0
    ]
    assert finer
    doubling = [replace(result, cpu_seconds=2.0**k) for k, result in enumerate(found.results)]
    knee = knee_of_results(doubling)
    assert knee is not None
    assert knee not in finer


def test_it_can_be_written_as_json(found):
    written = json.loads(json.dumps(RUN.figures(found), allow_nan=False))
    assert written["knee"] in {None, *(fidelity["name"] for fidelity in written["rungs"])}
    assert written["knee"] == found.knee
    assert "bearing_force_orders" not in next(r for r in written["rungs"] if r["name"] == "torsion")["errors"]


@pytest.mark.parametrize("study", [frontier, ablate])
def test_a_scene_without_meshes_has_no_transmission_errors_to_compare(study):
    with pytest.raises(InputError, match="meshes = 0: must be at least one"):
        study(replace(RUN_UP, meshes=()))


def test_runs_too_short_to_compare_and_unknown_fidelities_are_refused():
    with pytest.raises(InputError, match="duration"):
        frontier(replace(RUN_UP, duration=0.001))
    with pytest.raises(InputError, match="fidelities"):
        frontier(RUN_UP, fidelities=["2_nm"])


def test_a_fixed_step_knows_no_tolerance():
    fixed = replace(RUN_UP, integration=Integration(fixed_step=1e-5))
    assert TimeIntegration("x", "x", "steps", tolerance=1e-9).refusal(fixed) is not None


def test_blocks_hold_whole_parts_of_the_run():
    system = assemble(gear_pair_scene(square_wave_table(), duration=0.4))
    blocks = BlockGrid.of(system)
    assert blocks.orders == 5
    assert blocks.bounds[0, 0] == 0
    assert blocks.bounds[-1, 1] == round(0.4 * system.sampling.rate) + 1
    np.testing.assert_array_equal(blocks.bounds[1:, 0], blocks.bounds[:-1, 1])
