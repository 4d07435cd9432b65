"""Optimized micro-geometry against scans, known trends, and the analysis that assesses it in the end."""

import itertools
from collections.abc import Iterable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from analysis_requests import design_request
from spur_gears import LONG_RELIEFS, PAIR

from fe_contact import GearPair, analyze
from fe_contact.microgeometry.design_study import DesignSpace, design_study
from fe_contact.microgeometry.objective import Limits, WeightedMean, Worst
from fe_contact.microgeometry.optimization import Optimization, Outcome
from fe_contact.microgeometry.optimize import optimize
from fe_contact.microgeometry.scatter import Scatter
from fe_contact.microgeometry.search import Search
from fe_contact.microgeometry.search_methods import NelderMead
from fe_contact.microgeometry.variables import DesignVariable, modified
from fe_contact.options import AnalysisOptions, Run
from model_studies.stage_clock import StageClock

TORQUE = 200.0
DRAFT: dict[str, Any] = {"level": "draft", "model": "plane_strain"}
RELIEF, LENGTH = "pinion.tip_relief", "pinion.tip_relief_length"
FREE = (DesignVariable(RELIEF, 0.0, 60e-6), DesignVariable(LENGTH, 0.5e-3, 3e-3))
AMOUNTS = (DesignVariable(RELIEF, 0.0, 60e-6), DesignVariable("wheel.tip_relief", 0.0, 60e-6))
FEW = Search(evaluations=250, positions=32)
QUICK = Search(NelderMead(), evaluations=150, positions=32)


def searched(
    free: Iterable[DesignVariable] = AMOUNTS,
    pair: GearPair = LONG_RELIEFS,
    torque: float = TORQUE,
    **further: Any,
) -> Optimization:
    """Search at draft in the plane, quickly unless further requests say otherwise."""
    asked: dict[str, Any] = {"search": QUICK, "map_torques": [torque]} | DRAFT | further
    cancel = {"cancel": asked.pop("cancel")} if "cancel" in asked else {}
    return optimize(design_request(pair, [torque], free, **asked), **cancel)


@pytest.fixture(scope="module")
def found():
    return searched(search=FEW)


@pytest.mark.law
def test_no_design_of_a_fine_scan_is_better(found):
    names = [one.name for one in AMOUNTS]
    varied = dict.fromkeys(names, 30e-6), Scatter(), 0.0, FEW.positions
    space = DesignSpace(LONG_RELIEFS, *varied, AnalysisOptions(**DRAFT))
    study = design_study(space, [TORQUE], [], StageClock(), Run())
    scan = [
        float(study.evaluator.evaluate(dict(zip(names, values, strict=True))).peak_to_peak[0, 0])
        for values in itertools.product(np.linspace(0.0, 60e-6, 17), repeat=2)
    ]
    assert found.runs[0].assessed.objective <= min(scan)
    assert found.runs[0].assessed.objective > 0.5 * min(scan)  # the scan is fine


def test_it_is_assessed_by_what_analyze_finds(found):
    for design in (found.start, found.optimum):
        made = modified(LONG_RELIEFS, design.values)
        assessed = analyze(made, torques=[TORQUE], **DRAFT).peak_to_peak(torque=TORQUE)
        # the objective is read off the nodes, the curve also between them
        assert abs(design.objective.value - assessed.value) <= assessed.error
        assert design.objective.error == pytest.approx(assessed.error, rel=1e-2, abs=0.0)


def test_a_relieved_spur_pair_loses_most_of_its_ripple_alike_on_both_gears(found):
    assert found.outcome is Outcome.IMPROVED
    assert found.gain.error < 0.15 * found.gain.value  # the finite width counts at both ends
    assert found.start.objective.value > 4.0 * found.optimum.objective.value
    first, second = found.optimum.values.values()
    assert first == pytest.approx(second, rel=0.05)
    for step in found.sensitivity:
        assert step.low < found.optimum.values[step.name] < step.high
        assert min(step.change_low, step.change_high) > 0.0
    told = "; ".join(found.not_tried)
    assert "scatter of anything" in told and "neglected effects: " in told and "pitch_error" in told
    kept = next(line for line in found.not_tried if line.startswith("other values of "))
    names = kept.removeprefix("other values of ").removesuffix(" of both gears").split(", ")
    assert "helix_crowning" in names and "tip_relief" not in names
    assert "root_relief_length" not in names  # nothing is removed over it
    assert "wider bounds" not in told


@pytest.mark.law
def test_optimum_relief_is_the_deflection_at_the_load_and_grows_with_it(found):
    """Harris's rule: long linear reliefs about as deep as the teeth give way at the design load."""
    half = TORQUE / 2.0
    light = searched(torque=half, search=FEW)
    reliefs, deflections = [], []
    for torque, best in ((half, light.optimum), (TORQUE, found.optimum)):
        reliefs.append(np.mean(list(best.values.values())))
        deflections.append(best.table.mean(torque=torque).value)
    ratio = np.array(reliefs) / np.array(deflections)
    assert 0.6 < ratio[0] < 1.2
    assert ratio[0] == pytest.approx(ratio[1], rel=0.05, abs=0.0)
    assert reliefs[1] > 1.8 * reliefs[0]


def test_wider_bounds_never_end_worse(found):
    narrow = [replace(one, low=5e-6, high=9e-6) for one in AMOUNTS]
    held = searched(narrow)
    assert all(v.low <= held.optimum.values[v.name] <= v.high for v in held.variables)
    assert found.runs[0].assessed.objective < held.runs[0].assessed.objective
    assert "wider bounds of pinion.tip_relief, wheel.tip_relief" in held.not_tried[0]
    best = modified(LONG_RELIEFS, held.optimum.values)
    once = Search(NelderMead(), evaluations=1, positions=32)
    further = searched(AMOUNTS, best, search=once)
    assert further.runs[0].assessed.objective == pytest.approx(
        held.runs[0].assessed.objective, rel=1e-9, abs=0.0
    )


def test_edges_count_where_a_design_of_the_bounds_reaches_them():
    """Reliefs at the middle of the bounds keep edges apart, those at the lower bounds do not."""
    low, high = (
        design_request(LONG_RELIEFS, [TORQUE], [replace(one, low=low) for one in AMOUNTS], **DRAFT).space
        for low in (0.0, 50e-6)
    )
    assert low.check([TORQUE]).decision["corner_contact"] == "on"
    assert high.check([TORQUE]).decision["corner_contact"] == "off"


@pytest.mark.law
def test_equal_seeds_give_equal_results(found):
    again, other = (searched(search=replace(FEW, seed=seed)) for seed in (FEW.seed, 7))
    assert again.optimum.values == found.optimum.values
    assert again.optimum.objective == found.optimum.objective
    assert other.optimum.values != found.optimum.values
    assert other.optimum.objective.value == pytest.approx(found.optimum.objective.value, rel=0.02)


def test_the_best_of_all_starts_is_taken():
    search = Search(NelderMead(), starts=3, evaluations=60, positions=32)
    best = searched(FREE, PAIR, search=search)
    reached = [run.assessed.objective for run in best.runs]
    assert len(set(reached)) > 1
    assert best.best_run == int(np.argmin(reached))
    assert best.evaluations == sum(run.evaluations for run in best.runs) <= 180
    assert ("all its evaluations" in best.reason) is not best.runs[best.best_run].converged


def test_tip_edges_can_be_kept_from_contact_and_pressures_low(found):
    assert found.start.figures.edge_load_share.max() > 0.05  # before A and after E
    limits = Limits(edge_load_share=0.0)
    small = [replace(one, high=12e-6) for one in AMOUNTS]
    held = searched(small, limits=limits)
    assert held.start.violation == pytest.approx(held.start.figures.edge_load_share.max(), rel=1e-9, abs=0.0)
    wide = searched(limits=limits)
    assert held.outcome is Outcome.LIMITS_EXCEEDED
    assert wide.outcome is Outcome.IMPROVED and wide.optimum.violation < 0.005
    reached = float(found.optimum.figures.pressure.max())
    limits = Limits(max_pressure=0.9 * reached)
    held = searched(limits=limits)
    assert held.optimum.figures.pressure.max() < reached
    assert held.runs[0].assessed.violation < found.optimum.figures.violation(limits)
    assert (held.outcome is Outcome.LIMITS_EXCEEDED) == (held.optimum.violation > 0.005)


def test_a_root_stress_that_no_relief_reaches_is_told(found):
    """One tooth carries all at the outer point of single contact, whatever the reliefs are."""
    assert np.all(np.isnan(found.start.figures.root_stress))
    limits = Limits(root_stress=130e6)
    held = searched(limits=limits)
    assert held.outcome is Outcome.LIMITS_EXCEEDED
    largest = held.start.figures.root_stress.max()
    assert held.start.violation == pytest.approx(largest / 130e6 - 1.0, rel=1e-9, abs=0.0)
    assert 0.95 * largest < held.optimum.figures.root_stress.max() < 1.01 * largest
    error = held.start.figures.root_stress_error.max()
    assert abs(largest - 144.75e6) < error < 0.01 * largest  # `root_stress` at standard accuracy
    assert np.all(np.isnan(found.start.figures.root_stress_error))


@pytest.mark.law
def test_a_gain_smaller_than_the_errors_is_not_claimed():
    tiny = [DesignVariable("pinion.profile_slope", -1e-10, 1e-10)]
    best = searched(tiny, PAIR)
    assert best.outcome in (Outcome.WITHIN_ERROR, Outcome.NOT_IMPROVED)
    assert abs(best.gain.value) <= best.gain.error
    assert "the variables have no influence" in best.reason


def test_bounds_that_leave_the_start_out_are_told():
    """The start is the pair as it is, though no design of the search may be like it."""
    good = {one.name: 8e-6 for one in AMOUNTS}
    poor = [replace(one, low=30e-6, high=31e-6) for one in AMOUNTS]
    best = searched(poor, modified(LONG_RELIEFS, good))
    assert best.start.values == good
    assert all(30e-6 <= value <= 31e-6 for value in best.optimum.values.values())
    assert best.outcome is Outcome.NOT_IMPROVED and best.gain.value < 0.0
    assert (
        "rises" in best.reason and "beyond the bounds of pinion.tip_relief, wheel.tip_relief" in best.reason
    )


def test_an_interrupted_search_gives_the_best_so_far_in_full(found):
    asked = [0]

    def cancel():
        asked[0] += 1
        return asked[0] > 61  # once before the start

    best = searched(search=FEW, cancel=cancel)
    assert "interrupted after 60 of at most 250 designs" in best.reason
    assert best.evaluations == 60 and not best.runs[0].converged
    assert found.optimum.objective.value < best.optimum.objective.value < best.start.objective.value
    made = modified(LONG_RELIEFS, best.optimum.values)
    assessed = analyze(made, torques=[TORQUE], **DRAFT).peak_to_peak(torque=TORQUE)
    assert abs(best.optimum.objective.value - assessed.value) <= assessed.error


def test_few_positions_explore_as_well_as_many(found):
    assert found.runs[0].explored > 0
    full = searched(search=replace(FEW, exploration=FEW.positions))
    reached = found.runs[0].assessed.objective
    assert reached == pytest.approx(full.runs[0].assessed.objective, rel=0.01, abs=0.0)


def test_objectives_differ_over_loads():
    torques = [80.0, 240.0]

    def best(objective):
        both: dict[str, Any] = {"objective": objective, "map_torques": torques}
        result = optimize(design_request(LONG_RELIEFS, torques, AMOUNTS, search=QUICK, **both, **DRAFT))
        return result.optimum.harris_map.expected

    light, heavy, worst = best(WeightedMean((1.0, 0.0))), best(WeightedMean((0.0, 1.0))), best(Worst())
    assert light[0] < worst[0] and heavy[1] < worst[1]
    assert worst.max() < min(light.max(), heavy.max())


def test_the_map_runs_over_all_torques():
    once = Search(NelderMead(), evaluations=2, positions=16)
    best = optimize(design_request(PAIR, [100.0, 200.0], FREE, search=once, **DRAFT))
    harris = best.optimum.harris_map
    assert {100.0, 200.0} <= set(harris.torque) and harris.torque[-1] == 250.0 and harris.torque.size > 8
    assert harris.ste.shape == (harris.position.size, harris.torque.size)
    np.testing.assert_array_equal(np.ptp(harris.ste, axis=0), harris.nominal)
    assert np.all(np.diff(harris.ste.mean(axis=0)) > 0.0)
