"""Expectations over scatter: rules, nodes, and what a misaligned pair makes of them."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from fe_contact import GearPair, analyze
from fe_contact.microgeometry.confirmation import DesignSpace, design_study
from fe_contact.microgeometry.evaluator import Evaluator
from fe_contact.microgeometry.scatter import GaussHermite, Scatter, SobolSample
from fe_contact.microgeometry.variables import modified
from fe_contact.options import AnalysisOptions, Run
from fe_contact.stage_clock import StageClock

SLOPE, CROWNING = "pinion.profile_slope", "wheel.profile_crowning"


def evaluator(
    pair: GearPair, scatter: Scatter, compliances: Path, model: str, varied: tuple[str, ...] = ()
) -> Evaluator:
    options = AnalysisOptions(level="draft", model=model)
    space = DesignSpace(pair, dict.fromkeys(varied, 1e-6), scatter, 0.0, 16, options)
    return design_study(space, [200.0], [], StageClock(), Run(cache=compliances)).evaluator


@pytest.mark.parametrize("points", [1, 2, 5])
def test_gauss_hermite_is_exact_to_its_degree(points: int) -> None:
    place, weight = GaussHermite(points).nodes(1)
    for degree in range(0, 2 * points, 2):
        exact = math.prod(range(degree - 1, 0, -2))
        assert weight @ place[:, 0] ** degree == pytest.approx(exact, rel=1e-12)
        assert abs(weight @ place[:, 0] ** (degree + 1)) < 1e-12 * max(exact, 1)


def test_nodes_are_deviations_in_the_order_of_their_names() -> None:
    nodes = Scatter(1e-5, {CROWNING: 2e-6, SLOPE: 4e-6}, GaussHermite(3)).nodes()
    assert nodes.names == ("misalignment", SLOPE, CROWNING)
    assert nodes.weight.sum() == pytest.approx(1.0, rel=1e-14)
    np.testing.assert_allclose(nodes.weight @ nodes.deviation**2, [1e-10, 16e-12, 4e-12], rtol=1e-12)
    covariance = (nodes.weight[:, None] * nodes.deviation).T @ nodes.deviation
    assert np.abs(covariance - np.diag(np.diag(covariance))).max() < 1e-24
    assert nodes.modification(0) == {SLOPE: nodes.deviation[0, 1], CROWNING: nodes.deviation[0, 2]}


def test_a_sample_repeats_and_its_finer_one_holds_it() -> None:
    rule = SobolSample(5, seed=3)
    place, weight = rule.nodes(3)
    np.testing.assert_array_equal(place, rule.nodes(3)[0])
    np.testing.assert_array_equal(place, rule.finer(3).nodes(3)[0][:32])
    assert np.abs(weight @ place).max() < 0.1
    np.testing.assert_allclose(weight @ place**2, 1.0, rtol=0.2)
    assert not np.array_equal(place, SobolSample(5, seed=4).nodes(3)[0])


@pytest.mark.parametrize(("points", "dimensions"), [(5, 1), (5, 3), (5, 4), (4, 5), (1, 11)])
def test_every_rule_has_one_to_tell_its_error_by(points: int, dimensions: int) -> None:
    rule = GaussHermite(points)
    place, weight = rule.finer(dimensions).nodes(dimensions)
    assert place.shape == (weight.size, dimensions) and weight.size <= 1024
    assert weight.size != rule.nodes(dimensions)[1].size


def test_nothing_that_scatters_is_one_node() -> None:
    nodes = Scatter().nodes()
    assert nodes.names == () and nodes.weight.tolist() == [1.0] and nodes.finer is None


def test_every_node_is_the_pair_as_it_comes_out(pair: GearPair, compliances: Path) -> None:
    """Two deviations at once, against whole tables of pairs made so; crowning does not become negative."""
    assessed = evaluator(
        pair, Scatter(0.0, {SLOPE: 5e-6, CROWNING: 3e-6}, GaussHermite(2)), compliances, "plane_strain"
    )
    found = assessed.evaluate({CROWNING: 2e-6})
    for node, (slope, crowning) in enumerate(assessed.nodes.deviation):
        made = modified(pair, {SLOPE: slope, CROWNING: max(0.0, 2e-6 + crowning)})
        table = analyze(
            made, torques=[200.0], positions=16, model="plane_strain", level="draft", receipt="minimal",
            cache=compliances,
        )  # fmt: skip
        np.testing.assert_array_equal(found.ste[node, :, 0], table.static_transmission_error[:, 0, 0, 0])
        assert found.pressure[node, 0] == pytest.approx(table.max_pressure.max(), rel=1e-12, abs=0.0)
    assert assessed.expected(found)[0] == pytest.approx(found.peak_to_peak.mean(), rel=1e-12, abs=0.0)


def test_a_symmetric_pair_is_as_loud_misaligned_either_way(pair: GearPair, compliances: Path) -> None:
    assessed = evaluator(
        pair, Scatter(20e-6, rule=GaussHermite(3)), compliances, "3d", ("pinion.helix_crowning",)
    )
    plain = assessed.evaluate({})
    left, aligned, right = plain.peak_to_peak[:, 0]
    assert left == pytest.approx(right, rel=1e-6, abs=0.0)
    factor = plain.face_load_factor[:, 0]
    assert factor[0] == pytest.approx(factor[2], rel=1e-6, abs=0.0)
    assert factor[0] > 1.5 * factor[1]
    # crowned flanks bear nearer to the middle when misaligned, and less evenly when aligned
    crowned = assessed.evaluate({"pinion.helix_crowning": 10e-6}).face_load_factor[:, 0]
    assert crowned[0] < factor[0] and crowned[1] > factor[1]
    assert aligned > 0.0
