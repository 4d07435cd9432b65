"""Tolerance Monte Carlo and sweeps: every sample and point is the pair analyzed alone."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import pytest
from scipy.special import ndtr
from spur_gears import LONG_RELIEFS, PAIR

from fe_contact import GearPair, PitchDeviation, analyze
from fe_contact.errors import InputError
from fe_contact.microgeometry.order_limit import Causes, ModeledPairs, OrderLimit, as_spread
from fe_contact.microgeometry.sweep import Sweep, sweep
from fe_contact.microgeometry.sweep_request import SweepAxis, SweepRequest
from fe_contact.microgeometry.tolerance_study import Sampling, ToleranceRequest, estimated_quantile, scatter
from fe_contact.microgeometry.tolerances import Tolerances
from fe_contact.microgeometry.variables import modified
from fe_contact.options import AnalysisOptions, OperatingPoint, Run
from lineofaction.gearbox.studies.figures import figures_of
from lineofaction.gearbox.studies.scatter import ScatterFigures
from model_studies.spread import quantile_bounds, rank_correlation
from model_studies.workers import Remembering, RunCost

TORQUES = [100.0, 200.0]
DRAFT: dict[str, Any] = {"level": "draft", "model": "plane_strain"}
SLOPES = Tolerances(0.0, {"pinion.profile_slope": 10e-6, "wheel.profile_slope": 2e-6})


@pytest.fixture(scope="module")
def found():
    return scatter(
        PAIR, TORQUES, SLOPES, Sampling(samples=120, seed=3, positions=16), AnalysisOptions(**DRAFT)
    )


def test_every_sample_is_the_pair_as_it_is_made(found):
    for k in (0, 60, 119):  # of different tasks
        made = modified(PAIR, dict(zip(found.names, found.deviation[k], strict=True)))
        table = analyze(made, torques=TORQUES, positions=16, receipt="minimal", **DRAFT)
        ripple = np.ptp(table.static_transmission_error[:, :, 0, 0], axis=0)
        np.testing.assert_array_equal(found.peak_to_peak[k], ripple)


def test_the_error_is_that_of_the_pair_as_designed():
    forms = Tolerances(0.0, {"pinion.profile_form": 8e-6, "wheel.profile_form": 8e-6})
    options = AnalysisOptions(**DRAFT)
    study = scatter(PAIR, TORQUES, forms, Sampling(samples=2, positions=16), options)
    table = analyze(PAIR, torques=TORQUES, effects={"profile_modification": "on"}, **DRAFT)
    alone = [table.peak_to_peak(torque=torque) for torque in TORQUES]
    np.testing.assert_allclose(study.error, [ripple.error for ripple in alone], rtol=0.02)


def test_pairs_that_cannot_be_held_over_a_long_period_are_refused_before_they_are_solved():
    sampling, options = Sampling(samples=1_000_000, exact=1_000_000), AnalysisOptions(**DRAFT)
    assert ToleranceRequest(PAIR, TORQUES, SLOPES, sampling, options, 0.0).checked.model.period == 1
    deviates = PitchDeviation(np.linspace(0.0, 5e-6, PAIR.pinion.teeth))
    made = replace(PAIR, pinion=replace(PAIR.pinion, pitch_deviation=deviates))
    request = ToleranceRequest(made, TORQUES, SLOPES, sampling, options, 0.0)
    with pytest.raises(InputError, match=r"exact.* base pitches, .* GB.*at most 8 GB"):
        _ = request.checked


def test_a_larger_sample_begins_with_the_smaller_one(found):
    more = scatter(
        PAIR, TORQUES, SLOPES, Sampling(samples=130, seed=3, positions=16), AnalysisOptions(**DRAFT)
    )
    np.testing.assert_array_equal(more.peak_to_peak[:120], found.peak_to_peak)
    other = scatter(
        PAIR, TORQUES, SLOPES, Sampling(samples=30, seed=4, positions=16), AnalysisOptions(**DRAFT)
    )
    assert not np.any(other.deviation == found.deviation[:30])


def test_the_least_of_tangents_stands_for_pairs_it_does_not_know(found):
    """Of 120 pairs, 60 solved: the others by the model are off by as much as the 45 held against it say.

    Of 20 pairs one, where the contact at an extreme changes, is 20 times as far off as the median: fewer
    held against the model may be without such a pair.
    """
    sampling = Sampling(samples=120, seed=3, positions=16, exact=60)
    model = scatter(PAIR, TORQUES, SLOPES, sampling, AnalysisOptions(**DRAFT))
    assert (model.solved, model.held, found.solved) == (60, 45, 120)
    np.testing.assert_array_equal(model.peak_to_peak[:60], found.peak_to_peak[:60])
    missed = (model.peak_to_peak - found.peak_to_peak)[60:]
    assert np.all(np.sqrt(np.mean(missed**2, axis=0)) < 2.0 * model.missed)
    assert np.all(model.missed < 0.05 * found.peak_to_peak.std(axis=0))
    assert np.all(model.missed < 0.2 * np.abs(model.first_order - found.peak_to_peak).mean(axis=0))


def test_quantiles_of_the_model_are_within_the_sampling_band_of_solved_pairs(found):
    sampling = Sampling(samples=10_000, seed=3, positions=16, exact=40)
    model = scatter(PAIR, TORQUES, SLOPES, sampling, AnalysisOptions(**DRAFT))
    for many, few in zip(model.quantiles, found.quantiles, strict=True):
        assert np.all((few.low <= many.value) & (many.value <= few.high))
        assert np.all(many.high - many.low < 0.2 * (few.high - few.low))


def test_what_a_model_tells_too_high_and_too_wide_has_mean_and_spread_of_what_is_known():
    """The law by which pairs by tangents, which lie above, are distributed as pairs that are solved."""
    draw = np.random.default_rng(7)
    known = draw.gamma(4.0, 0.1, (400, 2))
    told = 0.05 + 1.2 * known
    np.testing.assert_allclose(as_spread(told, told, known), known, rtol=1e-12)
    further = 0.05 + 1.2 * draw.gamma(4.0, 0.1, (10_000, 2))
    made = np.quantile(as_spread(further, told, known), (0.05, 0.5, 0.95), axis=0)
    np.testing.assert_allclose(
        made, np.quantile((further - 0.05) / 1.2, (0.05, 0.5, 0.95), axis=0), rtol=1e-9
    )
    alike = np.ones((5, 2))
    np.testing.assert_array_equal(
        as_spread(alike, alike, known[:5]), np.broadcast_to(known[:5].mean(0), (5, 2))
    )


@pytest.mark.parametrize(("solved", "noise"), [(12, 0.5), (60, 0.5), (250, 0.2)])
def test_bounds_of_a_share_hold_what_a_model_misses(solved, noise):
    """Of 10 000 pairs of which few are solved, by a model that misses each: the true share is within."""
    draw, limit = np.random.default_rng(11), OrderLimit(1, 1.2e-6)
    none = Causes(np.zeros(1), np.zeros(1), 0.0, np.zeros(1))
    within = []
    for _ in range(200):
        true = 1e-6 * draw.lognormal(0.0, 0.4, (10_000, 1))
        modeled = true * draw.lognormal(0.0, noise, true.shape)
        pairs = ModeledPairs(("a",), np.zeros(1), true[:solved], modeled)
        above = pairs.above(limit, 0.95, lambda _load: none)
        within.append(above.low[0] <= (true > limit.amplitude).mean() <= above.high[0])
    assert np.mean(within) > 0.93


def test_a_limit_counts_pairs_and_finds_what_decides():
    limit = OrderLimit(1, 3.1e-6)
    sampling = Sampling(samples=2000, seed=3, positions=16, exact=60)
    options = AnalysisOptions(**DRAFT)
    above = scatter(PAIR, TORQUES, SLOPES, sampling, options, limit=limit).above
    np.testing.assert_array_equal(above.share, (above.amplitude > limit.amplitude).mean(axis=0))
    assert np.all((above.low <= above.share) & (above.share <= above.high))
    assert 0.0 < above.share[above.load] == above.share.max() < 1.0
    # the pinion's slope has five times the tolerance of the wheel's
    assert above.decides == above.cure == 0
    assert above.total[0] > 0.9 and above.total[1] < 0.1
    assert np.all(above.first_order <= above.total + 0.05)
    # a pair as made, whole: its order is that of the table
    made = modified(PAIR, dict(zip(SLOPES.widths, SLOPES.sample(1, 3)[0], strict=True)))
    table = analyze(made, torques=TORQUES, positions=16, receipt="minimal", **DRAFT)
    curve = table.static_transmission_error[:, 1, 0, 0]
    assert above.amplitude[0, 1] == pytest.approx(2.0 * abs(np.fft.rfft(curve)[1]) / 16, rel=1e-9)
    # with the tolerance of a class finer, drawn anew
    finer = Tolerances(0.0, dict(SLOPES.modification) | {"pinion.profile_slope": 10e-6 / np.sqrt(2.0)})
    other = scatter(PAIR, TORQUES, finer, sampling, options, limit=limit).above
    assert other.share[above.load] == pytest.approx(above.cured[0], abs=0.02)


def test_an_order_that_positions_do_not_resolve_is_refused():
    with pytest.raises(InputError, match="1 to 7"):
        scatter(PAIR, TORQUES, SLOPES, Sampling(positions=16), limit=OrderLimit(8, 1e-6))


def test_bounds_enclose_their_quantiles_and_influence_follows_deviation(found):
    pinion, wheel = np.abs(found.influence[:, -1])
    assert pinion > 0.8 > wheel
    values = [one.value for one in found.quantiles]
    assert np.all(np.diff(values, axis=0) > 0.0)
    for one in found.quantiles:
        assert np.all(one.low <= one.value) and np.all(one.value <= one.high)
    assert np.all(found.mean_error < 0.1 * found.mean)


def test_the_first_order_answer_is_off_by_the_square_of_the_tolerances(found):
    narrow = Tolerances(0.0, {name: 0.1 * width for name, width in SLOPES.modification.items()})
    sampling = Sampling(samples=120, seed=3, positions=16)
    tenth = scatter(PAIR, TORQUES, narrow, sampling, AnalysisOptions(**DRAFT))
    one, other = (np.abs(each.first_order - each.peak_to_peak).mean(axis=0) for each in (found, tenth))
    assert np.all(other < 0.05 * one)
    assert np.all(one < 0.5 * found.peak_to_peak.std(axis=0))  # slopes of 10 um are not small


def test_bounds_cover_the_true_quantile_as_often_as_they_say():
    samples = np.random.default_rng(5).exponential(size=(80, 4000))
    true = -np.log(1.0 - 0.9)
    bounds = estimated_quantile(samples, 0.9, 0.95)
    covered = np.mean((bounds.low <= true) & (true <= bounds.high))
    assert 0.94 < covered < 0.99  # order statistics are discrete: at least the asked confidence


@pytest.mark.parametrize(
    ("samples", "first", "last"),
    [(5, None, None), (6, 1, 6), (8, 1, 8), (9, 2, 8), (10, 2, 9), (15, 4, 12), (20, 6, 15)],
)
def test_bounds_of_a_median_are_those_of_the_sign_test(samples, first, last):
    """Published tables: which samples in order enclose the median with 95 %; of five none do."""
    _, low, high = quantile_bounds(np.arange(samples, 0.0, -1.0)[:, None], 0.5, 0.95)
    assert low == (-np.inf if first is None else first)
    assert high == (np.inf if last is None else last)


def test_influence_sees_both_signs_and_small_samples_have_no_bound():
    small = estimated_quantile(np.arange(1.0, 6.0)[:, None], 0.95, 0.95)
    assert np.isinf(small.high).all() and figures_of(ScatterFigures.QuantileFigures, small)["high_um"] is None
    deviation = np.random.default_rng(1).normal(size=(400, 3))
    ripple = np.stack([deviation[:, 0] ** 2, -deviation[:, 1]], axis=1)
    found = rank_correlation(deviation, ripple)
    assert found[0, 0] == pytest.approx(1.0) and found[1, 1] == pytest.approx(-1.0)
    assert np.abs(found[2]).max() < 0.2
    with pytest.raises(InputError, match="at least one width"):
        Tolerances()


@pytest.mark.parametrize("distribution", ["normal", "uniform"])
def test_parts_lie_within_their_tolerances(distribution):
    drawn = Tolerances(5e-6, {"wheel.helix_slope": 1e-6}, distribution).sample(20_000, seed=1)
    assert np.all(np.abs(drawn) <= [5e-6, 1e-6])
    # normal: three standard deviations to the limit, less what is cut off beyond
    kept = 2.0 * ndtr(3.0) - 1.0
    cut = np.sqrt(1.0 - 2.0 * 3.0 * np.exp(-4.5) / np.sqrt(2.0 * np.pi) / kept) / 3.0
    expected = {"normal": cut, "uniform": 1.0 / np.sqrt(3.0)}[distribution]
    np.testing.assert_allclose(drawn.std(axis=0) / [5e-6, 1e-6], expected, rtol=0.02)
    assert np.abs(np.corrcoef(drawn.T)[0, 1]) < 0.03


SWEPT_TORQUES, RELIEFS = (60.0, 120.0, 200.0), (0.0, 10e-6, 30e-6)
AXES = (SweepAxis("torque", SWEPT_TORQUES), SweepAxis("tip_relief", RELIEFS))


def request(pair: GearPair, axes: tuple[SweepAxis, ...] = AXES, **options: Any) -> SweepRequest:
    return SweepRequest(pair, axes, OperatingPoint(torque=200.0), AnalysisOptions(**{**DRAFT, **options}))


@pytest.fixture(scope="module")
def swept():
    return sweep(request(LONG_RELIEFS))


def by_name(result: Sweep, name: str) -> Any:
    return next(quantity for quantity in result.quantities if quantity.name == name)


@pytest.mark.law
def test_every_point_is_the_pair_analyzed_alone(swept):
    ripple = by_name(swept, "peak_to_peak")
    for k in (1, 5, 6):
        torque, relief = swept.point[k]
        flanks = {"pinion.tip_relief": relief, "wheel.tip_relief": relief}
        table = analyze(
            modified(LONG_RELIEFS, flanks),
            torques=[torque, 210.0],
            positions=192,
            effects={"corner_contact": "on"},
            **DRAFT,
        )
        alone = table.peak_to_peak(torque=torque)
        assert abs(ripple.value[k] - alone.value) < 0.1 * (ripple.error[k] + alone.error)
        assert by_name(swept, "harmonic_1").value[k] == pytest.approx(
            table.harmonics(torque=torque)[0].value, rel=0.02
        )
        largest = np.nanmax(table.max_pressure[:, 0])
        assert by_name(swept, "max_pressure").value[k] == pytest.approx(largest, rel=0.02)


def test_the_errors_cover_a_finer_mesh(swept):
    fine = sweep(request(LONG_RELIEFS, level="standard"))
    for name in ("peak_to_peak", "harmonic_1", "max_pressure"):
        here, there = by_name(swept, name), by_name(fine, name)
        rounding = 8.0 * np.spacing(np.abs(here.value))  # where one pair carries all, meshes agree but for it
        assert np.all(np.abs(here.value - there.value) <= here.error + there.error + rounding), name
        assert np.all(here.error < 0.5 * here.value.max()), "an error that says something"


def test_the_order_of_the_axes_does_not_matter(swept):
    other = sweep(request(LONG_RELIEFS, AXES[::-1]))
    np.testing.assert_array_equal(
        other.point[:, ::-1].reshape(3, 3, 2).swapaxes(0, 1), swept.point.reshape(3, 3, 2)
    )
    for quantity in swept.quantities:
        turned = by_name(other, quantity.name).value.reshape(3, 3).T.ravel()
        np.testing.assert_array_equal(turned, quantity.value)
    assert "face_load_factor" not in {quantity.name for quantity in swept.quantities}


def test_a_gear_alone_is_not_both(swept):
    alone = sweep(request(LONG_RELIEFS, (AXES[0], SweepAxis("pinion.tip_relief", RELIEFS))))
    both, one = (by_name(each, "peak_to_peak").value.reshape(3, 3) for each in (swept, alone))
    np.testing.assert_array_equal(both[:, 0], one[:, 0])  # without relief they are alike
    assert np.all(np.abs(both[:, 1:] - one[:, 1:]) > 1e-9)


def test_a_misaligned_pair_is_computed_over_the_face():
    narrow = replace(
        PAIR, pinion=replace(PAIR.pinion, face_width=8e-3), wheel=replace(PAIR.wheel, face_width=8e-3)
    )
    axis = SweepAxis("misalignment", (-20e-6, 0.0, 20e-6))
    found = sweep(request(narrow, (axis,), model="auto"))
    factor = by_name(found, "face_load_factor")
    assert factor.value[0] == pytest.approx(factor.value[2], rel=1e-3)  # a spur pair has no hand
    assert factor.value[1] < factor.value[0] - factor.error[0]
    assert found.held == {"torque": 200.0, "center_distance_change": 0.0}


def test_pairs_are_sampled_with_their_misalignment_on_either_side():
    narrow = replace(
        PAIR, pinion=replace(PAIR.pinion, face_width=8e-3), wheel=replace(PAIR.wheel, face_width=8e-3)
    )
    tolerances = Tolerances(20e-6, {"pinion.helix_slope": 1e-6})
    found = scatter(narrow, [200.0], tolerances, Sampling(4, 3, positions=8), AnalysisOptions(level="draft"))
    at = found.names.index("misalignment")
    assert found.deviation[:, at].min() < 0.0 < found.deviation[:, at].max()
    assert np.all(np.isfinite(found.first_order)) and np.all(found.peak_to_peak > 0.0)


@pytest.mark.parametrize(
    ("axes", "name"),
    [
        ((), "one or two"),
        ((AXES[0], AXES[0]), "one axis"),
        ((AXES[1], SweepAxis("wheel.tip_relief", RELIEFS)), "one axis"),
        ((SweepAxis("torque", (100.0,)),), "at least two"),
        ((SweepAxis("helix_angle", (0.1, 0.2)),), "tip_relief"),
        ((SweepAxis("torque", tuple(np.linspace(10.0, 20.0, 5000))),), "4096"),
    ],
)
def test_what_makes_no_map_is_refused(axes, name):
    with pytest.raises(InputError, match=name):
        _ = request(PAIR, axes).checked


def test_a_relief_without_a_length_is_refused():
    with pytest.raises(InputError, match="tip_relief_length"):
        _ = request(PAIR).checked


@dataclass(frozen=True)
class Breaking:
    """Workers that are interrupted after some tasks."""

    after: int
    done: list[int] = field(default_factory=list)

    @property
    def cost(self) -> RunCost:
        return RunCost()

    def run(self, function: Callable[..., Any], shared: Any, items: Sequence[Any]) -> Iterator[Any]:
        for item in items:
            if len(self.done) == self.after:
                raise KeyboardInterrupt
            self.done.append(1)
            yield function(shared, item)


def test_an_interrupted_sweep_goes_on_where_it_was(swept, tmp_path):
    first, second = Breaking(2), Breaking(9)
    with pytest.raises(KeyboardInterrupt):
        sweep(request(LONG_RELIEFS), Run(Remembering(first, tmp_path, "1")))
    resumed = sweep(request(LONG_RELIEFS), Run(Remembering(second, tmp_path, "1")))
    assert len(second.done) == len(RELIEFS) - 2
    for quantity in swept.quantities:
        np.testing.assert_array_equal(by_name(resumed, quantity.name).value, quantity.value)
