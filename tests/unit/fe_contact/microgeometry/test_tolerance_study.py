"""Tolerance Monte Carlo: distributions of parts, bounds of quantiles, pairs as single tables have them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.special import ndtr

from fe_contact import GearPair, analyze
from fe_contact.errors import InputError
from fe_contact.microgeometry.tolerance_study import Sampling, Tolerances, ToleranceStudy, _quantile, scatter
from fe_contact.microgeometry.variables import modified
from fe_contact.options import AnalysisOptions, Run
from lineofaction.gearbox.studies.figures import figures_of
from lineofaction.gearbox.studies.scatter import QuantileFigures
from model_studies.spread import rank_correlation

TORQUES = [100.0, 200.0]
DRAFT: dict[str, Any] = {"level": "draft", "model": "plane_strain"}
SLOPES = Tolerances(0.0, {"pinion.profile_slope": 10e-6, "wheel.profile_slope": 2e-6})


@pytest.fixture(scope="module")
def found(pair: GearPair, compliances: Path) -> ToleranceStudy:
    return scatter(
        pair,
        TORQUES,
        SLOPES,
        Sampling(samples=120, seed=3, positions=16),
        AnalysisOptions(**DRAFT),
        Run(cache=compliances),
    )


def test_every_sample_is_the_pair_as_it_is_made(
    found: ToleranceStudy, pair: GearPair, compliances: Path
) -> None:
    for k in (0, 60, 119):  # of different tasks
        made = modified(pair, dict(zip(found.names, found.deviation[k], strict=True)))
        table = analyze(made, torques=TORQUES, positions=16, receipt="minimal", cache=compliances, **DRAFT)
        ripple = np.ptp(table.static_transmission_error[:, :, 0, 0], axis=0)
        np.testing.assert_array_equal(found.peak_to_peak[k], ripple)


def test_a_larger_sample_begins_with_the_smaller_one(
    found: ToleranceStudy, pair: GearPair, compliances: Path
) -> None:
    more = scatter(
        pair,
        TORQUES,
        SLOPES,
        Sampling(samples=130, seed=3, positions=16),
        AnalysisOptions(**DRAFT),
        Run(cache=compliances),
    )
    np.testing.assert_array_equal(more.peak_to_peak[:120], found.peak_to_peak)
    other = scatter(
        pair,
        TORQUES,
        SLOPES,
        Sampling(samples=30, seed=4, positions=16),
        AnalysisOptions(**DRAFT),
        Run(cache=compliances),
    )
    assert not np.any(other.deviation == found.deviation[:30])


def test_what_deviates_more_has_more_influence(found: ToleranceStudy) -> None:
    pinion, wheel = np.abs(found.influence[:, -1])
    assert pinion > 0.8 > wheel


def test_the_first_order_answer_is_off_by_the_square_of_the_tolerances(
    found: ToleranceStudy, pair: GearPair, compliances: Path
) -> None:
    narrow = Tolerances(0.0, {name: 0.1 * width for name, width in SLOPES.modification.items()})
    sampling = Sampling(samples=120, seed=3, positions=16)
    tenth = scatter(pair, TORQUES, narrow, sampling, AnalysisOptions(**DRAFT), Run(cache=compliances))
    one, other = (np.abs(each.first_order - each.peak_to_peak).mean(axis=0) for each in (found, tenth))
    assert np.all(other < 0.05 * one)
    assert np.all(one < 0.5 * found.peak_to_peak.std(axis=0))  # slopes of 10 um are not small


def test_bounds_enclose_their_quantiles(found: ToleranceStudy) -> None:
    values = [one.value for one in found.quantiles]
    assert np.all(np.diff(values, axis=0) > 0.0)
    for one in found.quantiles:
        assert np.all(one.low <= one.value) and np.all(one.value <= one.high)
    assert np.all(found.mean_error < 0.1 * found.mean)


def test_bounds_cover_the_true_quantile_as_often_as_they_say() -> None:
    samples = np.random.default_rng(5).exponential(size=(80, 4000))
    true = -np.log(1.0 - 0.9)
    bounds = _quantile(samples, 0.9, 0.95)
    covered = np.mean((bounds.low <= true) & (true <= bounds.high))
    assert 0.94 < covered < 0.99  # order statistics are discrete: at least the asked confidence


def test_a_sample_too_small_has_no_bound() -> None:
    small = _quantile(np.arange(1.0, 6.0)[:, None], 0.95, 0.95)
    assert np.isinf(small.high).all() and figures_of(QuantileFigures, small)["high_um"] is None


def test_influence_sees_both_signs_and_sizes() -> None:
    deviation = np.random.default_rng(1).normal(size=(400, 3))
    ripple = np.stack([deviation[:, 0] ** 2, -deviation[:, 1]], axis=1)
    found = rank_correlation(deviation, ripple)
    assert found[0, 0] == pytest.approx(1.0) and found[1, 1] == pytest.approx(-1.0)
    assert np.abs(found[2]).max() < 0.2


@pytest.mark.parametrize("distribution", ["normal", "uniform"])
def test_parts_lie_within_their_tolerances(distribution: Any) -> None:
    drawn = Tolerances(5e-6, {"wheel.helix_slope": 1e-6}, distribution).sample(20_000, seed=1)
    assert np.all(np.abs(drawn) <= [5e-6, 1e-6])
    # normal: three standard deviations to the limit, less what is cut off beyond
    kept = 2.0 * ndtr(3.0) - 1.0
    cut = np.sqrt(1.0 - 2.0 * 3.0 * np.exp(-4.5) / np.sqrt(2.0 * np.pi) / kept) / 3.0
    expected = {"normal": cut, "uniform": 1.0 / np.sqrt(3.0)}[distribution]
    np.testing.assert_allclose(drawn.std(axis=0) / [5e-6, 1e-6], expected, rtol=0.02)
    assert np.abs(np.corrcoef(drawn.T)[0, 1]) < 0.03


def test_no_tolerance_is_no_study() -> None:
    with pytest.raises(InputError, match="at least one width"):
        Tolerances()
