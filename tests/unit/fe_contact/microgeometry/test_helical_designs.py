"""Designs in three dimensions of a misaligned pair: symmetries, loads of unlike misalignment."""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from analysis_requests import design_request

from fe_contact import Gear, GearPair, analyze
from fe_contact.microgeometry.design_problem import DesignProblem
from fe_contact.microgeometry.design_study import DesignSpace, design_study
from fe_contact.microgeometry.evaluator import Evaluator
from fe_contact.microgeometry.linearized_design import linearized
from fe_contact.microgeometry.objective import NO_LIMITS, Limits, WeightedMean
from fe_contact.microgeometry.optimization import Optimization, Outcome
from fe_contact.microgeometry.optimize import optimize
from fe_contact.microgeometry.scatter import NO_SCATTER, GaussHermite, Scatter
from fe_contact.microgeometry.search import Search, SearchRun, search_from
from fe_contact.microgeometry.search_methods import SIMPLEX_MERIT, SIMPLEX_SIZE, NelderMead
from fe_contact.microgeometry.variables import DesignVariable, modified
from fe_contact.options import AnalysisOptions, Run
from lineofaction.gearbox.studies.optimize.run import RUN
from model_studies.stage_clock import StageClock


def helical(hand: int) -> GearPair:
    """Overlap ratio 0.87, the pinion right-handed if `hand` is 1, straight teeth if it is 0."""
    sizes: dict[str, Any] = {"normal_module": 3e-3, "face_width": 24e-3, "bore_diameter": 30e-3}
    angle = hand * math.radians(20.0)
    pinion, wheel = (Gear(teeth=20, helix_angle=beta, **sizes) for beta in (angle, -angle))
    return GearPair(pinion, wheel, 2.0 * pinion.reference_radius)


pytestmark = pytest.mark.usefixtures("coarse_sectors")
HELICAL, SPUR = helical(1), helical(0)
CROWNING, SLOPE = "pinion.helix_crowning", "pinion.helix_slope"
RELIEF, LENGTH = "pinion.tip_relief", "pinion.tip_relief_length"
DESIGN = {CROWNING: 4e-6, SLOPE: 6e-6, RELIEF: 10e-6, LENGTH: 1e-3}
SKEW = 8e-6
POSITIONS = 8


def evaluator(pair: GearPair, skew: float, scatter: Scatter = NO_SCATTER, torque: float = 150.0) -> Evaluator:
    space = DesignSpace(pair, DESIGN, scatter, skew, POSITIONS, AnalysisOptions(level="draft"))
    return design_study(space, [torque], [], StageClock(), Run()).evaluator


def searched(
    assessed: Evaluator,
    variables: tuple[DesignVariable, ...],
    begin: tuple[float, ...],
    limits: Limits = NO_LIMITS,
) -> tuple[dict[str, float], SearchRun]:
    """Search with a simplex, whose moves are those of a mirrored problem mirrored."""
    problem = DesignProblem(assessed, variables, limits, 1e-6, objective=WeightedMean())
    search = Search(NelderMead(), evaluations=60, positions=POSITIONS)
    run = search_from(problem, search, problem.unit_point(begin), 0)
    return problem.values(run.coordinates), run


def test_every_node_is_a_whole_table_of_the_pair_made_so():
    scatter = Scatter(4e-6, {"wheel.helix_slope": 5e-6, RELIEF: 2e-6}, GaussHermite(2))
    assessed = evaluator(HELICAL, SKEW, scatter)
    found = assessed.evaluate(DESIGN)
    for node in (0, 5):
        skew, *amounts = assessed.nodes.deviation[node]
        away = dict(zip(assessed.nodes.names[1:], amounts, strict=True))
        made = modified(
            HELICAL, {name: DESIGN.get(name, 0.0) + away.get(name, 0.0) for name in DESIGN | away}
        )
        table = analyze(
            made, torques=[150.0], misalignments=[SKEW + skew], positions=POSITIONS, level="draft",
            receipt="minimal",
        )  # fmt: skip
        np.testing.assert_array_equal(found.ste[node, :, 0], table.static_transmission_error[:, 0, 0, 0])
        largest = np.fmax(table.max_pressure, table.edge_pressure).max()  # a search counts edges, too
        assert found.pressure[node, 0] == pytest.approx(largest, rel=1e-12, abs=0.0)


def test_mirrored_in_everything_a_design_is_as_good():
    one = evaluator(HELICAL, SKEW).evaluate(DESIGN)
    mirrored = evaluator(helical(-1), -SKEW)
    two = mirrored.evaluate(DESIGN | {SLOPE: -DESIGN[SLOPE]})
    np.testing.assert_allclose(two.ste, one.ste, rtol=1e-12, atol=0.0)
    np.testing.assert_allclose(two.face_load_factor, one.face_load_factor, rtol=1e-9)
    unlike = mirrored.evaluate(DESIGN)  # the slope is not mirrored
    assert abs(unlike.peak_to_peak / one.peak_to_peak - 1.0).max() > 0.05


@pytest.mark.nightly
def test_mirrored_hand_and_misalignment_give_the_mirrored_design():
    crowning, scatter = DesignVariable(CROWNING, 0.0, 20e-6), Scatter(5e-6, rule=GaussHermite(3))
    right, left = (
        searched(
            evaluator(helical(hand), hand * SKEW, scatter),
            (crowning, DesignVariable(SLOPE, -30e-6, 30e-6)),
            (5e-6, hand * 5e-6),
        )
        for hand in (1, -1)
    )
    # rounding may turn a late decision of the simplex: as far as it has converged
    assert abs(left[0][SLOPE] + right[0][SLOPE]) <= SIMPLEX_SIZE * 60e-6
    assert abs(left[0][CROWNING] - right[0][CROWNING]) <= SIMPLEX_SIZE * 20e-6
    assert left[1].assessed.objective == pytest.approx(
        right[1].assessed.objective, rel=SIMPLEX_MERIT, abs=0.0
    )
    assert right[0][SLOPE] < -4e-6


@pytest.mark.law
def test_the_helix_slope_takes_up_a_fixed_misalignment_of_straight_teeth():
    """Both open the flanks linearly over the face, so the best slope moves by the misalignment."""
    straight, misaligned = (
        searched(
            evaluator(SPUR, skew, Scatter(5e-6, rule=GaussHermite(3))),
            (DesignVariable(SLOPE, -20e-6 - skew, 20e-6 - skew), DesignVariable(CROWNING, 0.0, 20e-6)),
            (5e-6 - skew, 5e-6),
        )
        for skew in (0.0, SKEW)
    )
    assert misaligned[0][SLOPE] == pytest.approx(straight[0][SLOPE] - SKEW, rel=1e-6, abs=1e-11)
    assert misaligned[1].assessed.objective == pytest.approx(
        straight[1].assessed.objective, rel=1e-9, abs=0.0
    )


def test_crowning_that_evens_the_load_grows_with_the_scatter():
    """It costs ripple: the least that keeps the face load factor at every node is taken."""
    found = [
        searched(
            evaluator(HELICAL, 0.0, Scatter(deviation, rule=GaussHermite(3)), torque=300.0),
            (DesignVariable(CROWNING, 0.0, 30e-6),),
            (15e-6,),
            Limits(face_load_factor=1.3),
        )
        for deviation in (4e-6, 9e-6, 12e-6)
    ]
    needed = [values[CROWNING] for values, _ in found]
    assert needed[0] == 0.0 and 1e-6 < needed[1] < needed[2] < 10e-6
    assert found[0][1].assessed.violation == 0.0 and found[1][1].assessed.violation == 0.0
    assert found[0][1].assessed.objective < found[1][1].assessed.objective


def test_a_misaligned_pair_is_assessed_by_whole_tables():
    free = [DesignVariable(SLOPE, -30e-6, 30e-6), DesignVariable("wheel.profile_crowning", 0.0, 20e-6)]
    best = optimize(
        design_request(
            HELICAL,
            [300.0],
            free,
            Scatter(5e-6, rule=GaussHermite(2)),
            misalignment=SKEW,
            map_torques=[300.0],
            search=Search(NelderMead(), evaluations=40, positions=POSITIONS),
            level="draft",
        )
    )
    assert best.gain.value > 0.0 and best.optimum.values[SLOPE] < 0.0  # against the misalignment
    assert (best.outcome is Outcome.IMPROVED) == (best.gain.value > best.gain.error)
    skews = SKEW + best.nodes.misalignment
    for design in (best.start, best.optimum):
        np.testing.assert_allclose(design.table.misalignment, sorted([SKEW, *skews]), rtol=1e-12)
        tables = [design.table.peak_to_peak(torque=300.0, misalignment=float(skew)) for skew in skews]
        found = design.harris_map.peak_to_peak[:, 0]
        # read off the nodes here, between them there
        assert all(abs(a - b.value) <= b.error for a, b in zip(found, tables, strict=True))
        assert design.harris_map.error[:, 0].tolist() == [one.error for one in tables]


OF_LEAD = {CROWNING: 4e-6, SLOPE: 6e-6}
TORQUES, SKEWS = [100.0, 200.0, 200.0, 300.0], [3e-6, -5e-6, 8e-6, 3e-6]
WEIGHTS = (1.0, 4.0, 2.0, 3.0)
LIMITS = Limits(face_load_factor=1.3)


def evaluator_of_loads(
    pair: GearPair,
    torques: Sequence[float],
    skews: Sequence[float],
    scatter: Scatter = NO_SCATTER,
) -> Evaluator:
    space = DesignSpace(pair, OF_LEAD, scatter, skews, POSITIONS, AnalysisOptions(level="draft"))
    return design_study(space, torques, [], StageClock(), Run()).evaluator


@pytest.mark.law
def test_every_load_is_assessed_as_it_is_alone():
    scatter = Scatter(4e-6, rule=GaussHermite(2))
    together = evaluator_of_loads(HELICAL, TORQUES, SKEWS, scatter)
    whole = linearized(together, OF_LEAD, (SLOPE, CROWNING), LIMITS)
    for k, (torque, skew) in enumerate(zip(TORQUES, SKEWS, strict=True)):
        alone = linearized(
            evaluator_of_loads(HELICAL, [torque], [skew], scatter), OF_LEAD, (SLOPE, CROWNING), LIMITS
        )
        for name in ("ste", "pressure", "face_load_factor", "edge_load_share"):
            own = getattr(alone.evaluation, name)
            joint = getattr(whole.evaluation, name)[..., [k]]
            np.testing.assert_allclose(joint, own, rtol=1e-9, atol=1e-12)
        np.testing.assert_allclose(whole.curves[:, :, [k]], alone.curves, rtol=1e-6, atol=1e-8)


def test_the_order_of_the_loads_is_that_of_the_figures():
    """Loads, weights and misalignments in another order: the same figures in that order, one objective."""
    one = evaluator_of_loads(HELICAL, TORQUES, SKEWS)
    order = np.array([2, 0, 3, 1])
    other = replace(one, load=one.load[order], misalignment=one.misalignment[order])
    first, second = one.evaluate(OF_LEAD), other.evaluate(OF_LEAD)
    for name in ("ste", "pressure", "face_load_factor", "edge_load_share"):
        np.testing.assert_array_equal(getattr(second, name), getattr(first, name)[..., order])
    shuffled = WeightedMean(tuple(WEIGHTS[k] for k in order))
    objective = WeightedMean(WEIGHTS).of(one.expected(first))
    assert shuffled.of(other.expected(second)) == pytest.approx(objective, rel=1e-14)
    assert WeightedMean(WEIGHTS).of(other.expected(second)) != pytest.approx(objective, rel=1e-3)


@pytest.mark.law
def test_helix_slope_and_misalignment_of_straight_teeth_add_up_at_every_load():
    """Both open the flanks linearly over the face: a slope of minus the misalignment levels that load."""
    tilted = evaluator_of_loads(SPUR, TORQUES, SKEWS).evaluate(OF_LEAD)
    straight = evaluator_of_loads(SPUR, [100.0, 200.0, 300.0], [0.0])
    for k, (level, skew) in enumerate(zip((0, 1, 1, 2), SKEWS, strict=True)):
        turned = straight.evaluate(OF_LEAD | {SLOPE: OF_LEAD[SLOPE] + skew})
        np.testing.assert_allclose(tilted.ste[..., k], turned.ste[..., level], rtol=1e-9)
        np.testing.assert_allclose(
            tilted.face_load_factor[..., k], turned.face_load_factor[..., level], rtol=1e-9
        )


def optimized(
    pair: GearPair, torques: list[float], misalignment: float | list[float], **further: Any
) -> Optimization:
    search = Search(NelderMead(), evaluations=further.pop("evaluations", 12), positions=POSITIONS)
    free = [DesignVariable(SLOPE, -30e-6, 30e-6)]
    request = design_request(
        pair, torques, free, misalignment=misalignment, search=search, level="draft", **further
    )
    return optimize(request)


@pytest.mark.nightly
def test_equal_misalignments_give_the_bits_of_one_for_all():
    torques, further = [150.0, 300.0], {"map_torques": [200.0], "evaluations": 2}
    one, listed = (RUN.figures(optimized(HELICAL, torques, skew, **further)) for skew in (8e-6, [8e-6, 8e-6]))
    for result in (one, listed):
        del result["cost"]
        for run in result["runs"]:
            del run["cpu_seconds"]
    assert listed == one


@pytest.fixture(scope="module")
def found():
    torques, skews, weights = [150.0, 300.0, 300.0], [4e-6, -6e-6, 12e-6], WeightedMean((1.0, 2.0, 3.0))
    return optimized(HELICAL, torques, skews, objective=weights, map_torques=[200.0])


@pytest.mark.nightly
def test_every_load_is_confirmed_by_an_analysis_at_its_misalignment(found):
    harris = found.optimum.harris_map
    assert harris.torque.tolist() == [150.0, 200.0, 300.0, 300.0]
    skews = [4e-6, 4e-6 - 10e-6 / 3.0, -6e-6, 12e-6]  # between its neighbors, that which only the map shows
    np.testing.assert_allclose(found.map_misalignment, skews, rtol=1e-12)
    made, positions = modified(HELICAL, found.optimum.values), found.optimum.table.position.size
    for k, skew in enumerate(skews):
        torque = float(harris.torque[k])
        table = analyze(made, torques=[torque], misalignments=[skew], level="draft", positions=positions)
        assessed = table.peak_to_peak(torque=torque)
        assert abs(harris.nominal[k] - assessed.value) <= assessed.error
        assert harris.nominal_error[k] == pytest.approx(assessed.error, rel=0.1, abs=0.0)
    objective = np.average(harris.nominal[[0, 2, 3]], weights=(1.0, 2.0, 3.0))
    assert found.optimum.objective.value == pytest.approx(objective, rel=1e-12, abs=0.0)


@pytest.mark.parametrize("weights", [(1.0, 0.0), (3.0, 1.0), (1.0, 1.0), (1.0, 3.0)])
def test_the_best_slope_is_the_compromise_of_the_loads_by_their_weights(weights):
    """About minus the misalignment of a load alone, less by what the tilt does along the line of action.

    Of two loads it is between theirs and on the side of the heavier one. No slope of a scan is better.
    """
    skews, level = np.array([-12e-6, 12e-6]), {CROWNING: 4e-6}
    free, objective = (DesignVariable(SLOPE, -24e-6, 24e-6),), WeightedMean(weights)
    assessed = evaluator_of_loads(HELICAL, [300.0, 300.0], skews.tolist())
    assessed = replace(assessed, contact=replace(assessed.contact, pair=modified(HELICAL, level)))
    problem = DesignProblem(assessed, free, NO_LIMITS, 1e-6, objective=objective)
    search = Search(NelderMead(), evaluations=40, positions=POSITIONS)
    run = search_from(problem, search, np.array([0.4]), 0)
    slopes = np.linspace(-24e-6, 24e-6, 25)
    scan = [objective.of(assessed.evaluate(level | {SLOPE: x}).peak_to_peak[0]) for x in slopes]
    assert 0.98 * min(scan) < run.assessed.objective < min(scan) * (1.0 + 1e-6)
    (slope,) = problem.values(run.coordinates).values()
    assert np.sign(weights[0] - weights[1]) * slope >= 0.0 and abs(slope) < 12.2e-6
    if not all(weights):
        assert slope == pytest.approx(slopes[int(np.argmin(scan))], abs=2e-6)
        assert 9e-6 < slope < 12e-6
