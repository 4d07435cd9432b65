"""Designs of a helical pair in three dimensions, misaligned: symmetries, and what helps against what."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from analysis_requests import design_request
from helical_pairs import helical

from fe_contact import GearPair, analyze
from fe_contact.microgeometry.confirmation import DesignSpace, design_study
from fe_contact.microgeometry.design_problem import DesignProblem
from fe_contact.microgeometry.evaluator import Evaluator
from fe_contact.microgeometry.objective import NO_LIMITS, Limits, WeightedMean
from fe_contact.microgeometry.optimization import Outcome
from fe_contact.microgeometry.optimize import optimize
from fe_contact.microgeometry.scatter import NO_SCATTER, GaussHermite, Scatter
from fe_contact.microgeometry.search import (
    SIMPLEX_MERIT,
    SIMPLEX_SIZE,
    NelderMead,
    Search,
    SearchRun,
    search_from,
)
from fe_contact.microgeometry.variables import DesignVariable, modified
from fe_contact.options import AnalysisOptions, Run
from fe_contact.stage_clock import StageClock

pytestmark = pytest.mark.usefixtures("coarse_sectors")

CROWNING, SLOPE = "pinion.helix_crowning", "pinion.helix_slope"
RELIEF, LENGTH = "pinion.tip_relief", "pinion.tip_relief_length"
DESIGN = {CROWNING: 4e-6, SLOPE: 6e-6, RELIEF: 10e-6, LENGTH: 1e-3}
SKEW = 8e-6
POSITIONS = 8


@pytest.fixture(scope="module")
def pair() -> GearPair:
    return helical(1)


def evaluator(
    pair: GearPair, compliances: Path, skew: float, scatter: Scatter = NO_SCATTER, torque: float = 150.0
) -> Evaluator:
    space = DesignSpace(pair, DESIGN, scatter, skew, POSITIONS, AnalysisOptions(level="draft"))
    return design_study(space, [torque], [], StageClock(), Run(cache=compliances)).evaluator


def searched(
    assessed: Evaluator,
    variables: tuple[DesignVariable, ...],
    begin: tuple[float, ...],
    limits: Limits = NO_LIMITS,
) -> tuple[dict[str, float], SearchRun]:
    """Search with a simplex, whose moves are those of a mirrored problem mirrored."""
    problem = DesignProblem(assessed, variables, WeightedMean(), limits, 1e-6)
    search = Search(NelderMead(), evaluations=60, positions=POSITIONS)
    run = search_from(problem, search, problem.place(begin), 0)
    return problem.values(run.place), run


def test_every_node_is_a_whole_table_of_the_pair_made_so(pair: GearPair, compliances: Path) -> None:
    scatter = Scatter(4e-6, {"wheel.helix_slope": 5e-6, RELIEF: 2e-6}, GaussHermite(2))
    assessed = evaluator(pair, compliances, SKEW, scatter)
    found = assessed.evaluate(DESIGN)
    for node in (0, 5):
        skew, *amounts = assessed.nodes.deviation[node]
        away = dict(zip(assessed.nodes.names[1:], amounts, strict=True))
        made = modified(pair, {name: DESIGN.get(name, 0.0) + away.get(name, 0.0) for name in DESIGN | away})
        table = analyze(
            made, torques=[150.0], misalignments=[SKEW + skew], positions=POSITIONS, level="draft",
            receipt="minimal", cache=compliances,
        )  # fmt: skip
        np.testing.assert_array_equal(found.ste[node, :, 0], table.static_transmission_error[:, 0, 0, 0])
        largest = np.fmax(table.max_pressure, table.edge_pressure).max()  # a search counts edges, too
        assert found.pressure[node, 0] == pytest.approx(largest, rel=1e-12, abs=0.0)


def test_mirrored_in_everything_a_design_is_as_good(pair: GearPair, compliances: Path) -> None:
    one = evaluator(pair, compliances, SKEW).evaluate(DESIGN)
    mirrored = evaluator(helical(-1), compliances, -SKEW)
    two = mirrored.evaluate(DESIGN | {SLOPE: -DESIGN[SLOPE]})
    np.testing.assert_allclose(two.ste, one.ste, rtol=1e-12, atol=0.0)
    np.testing.assert_allclose(two.face_load_factor, one.face_load_factor, rtol=1e-9)
    unlike = mirrored.evaluate(DESIGN)  # the slope is not mirrored
    assert abs(unlike.peak_to_peak / one.peak_to_peak - 1.0).max() > 0.05


@pytest.mark.nightly
def test_mirrored_hand_and_misalignment_give_the_mirrored_design(pair: GearPair, compliances: Path) -> None:
    crowning, scatter = DesignVariable(CROWNING, 0.0, 20e-6), Scatter(5e-6, rule=GaussHermite(3))
    right, left = (
        searched(
            evaluator(helical(hand), compliances, hand * SKEW, scatter),
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
def test_the_helix_slope_takes_up_a_fixed_misalignment(pair: GearPair, compliances: Path) -> None:
    """Both open the flanks linearly over the face, so the best slope moves by the misalignment."""
    straight, misaligned = (
        searched(
            evaluator(pair, compliances, skew, Scatter(5e-6, rule=GaussHermite(3))),
            (DesignVariable(SLOPE, -20e-6 - skew, 20e-6 - skew), DesignVariable(CROWNING, 0.0, 20e-6)),
            (5e-6 - skew, 5e-6),
        )
        for skew in (0.0, SKEW)
    )
    assert misaligned[0][SLOPE] == pytest.approx(straight[0][SLOPE] - SKEW, rel=1e-6, abs=1e-11)
    assert misaligned[1].assessed.objective == pytest.approx(
        straight[1].assessed.objective, rel=1e-9, abs=0.0
    )


def test_crowning_that_evens_the_load_grows_with_the_scatter(pair: GearPair, compliances: Path) -> None:
    """It costs ripple: the least that keeps the face load factor at every node is taken."""
    found = [
        searched(
            evaluator(pair, compliances, 0.0, Scatter(deviation, rule=GaussHermite(3)), torque=300.0),
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


def test_a_misaligned_pair_is_assessed_by_whole_tables(pair: GearPair, compliances: Path) -> None:
    free = [DesignVariable(SLOPE, -30e-6, 30e-6), DesignVariable("wheel.profile_crowning", 0.0, 20e-6)]
    best = optimize(
        design_request(
            pair,
            [300.0],
            free,
            Scatter(5e-6, rule=GaussHermite(2)),
            misalignment=SKEW,
            map_torques=[300.0],
            search=Search(NelderMead(), evaluations=40, positions=POSITIONS),
            level="draft",
        ),
        Run(cache=compliances),
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
