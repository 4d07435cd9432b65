"""Levels between the loads: the kink where a further pair comes into contact."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from held_out import held_out_error

from fe_contact.ste.load_levels import LoadLevels, refined_levels, smooth_share

COARSE = (266.0, 1330.0, 2660.0, 5320.0, 10640.0)
BETWEEN = (900.0, 2000.0, 4000.0, 8000.0)
# dense where the handovers sweep, so that the load direction is what is tested
POSITION = np.unique(
    np.concatenate([np.arange(64) / 64, np.linspace(0.1, 0.24, 150), np.linspace(0.76, 0.9, 150)])
)


def without_kinks(make, **case):
    """The same table, said to hold the same pairs at all loads: one smooth curve from load to load."""
    database = make(**case)
    return make(**case, pairs_in_contact=np.ones(database.status.shape))


def test_levels_gather_in_steps_with_a_kink(make):
    table = without_kinks(make).force_table()
    added = np.setdiff1d(table.level, [0.0, *COARSE])
    count = [int(np.sum((added > low) & (added < high))) for low, high in pairwise([0.0, *COARSE])]
    assert count == [0, 3, 1, 1, 1]
    # The pairs change between the second and third load only.
    pairs = np.ones((64, 5, 1, 1))
    pairs[:, 2:] = 2
    level = make(pairs_in_contact=pairs).force_table().level
    assert np.sum((level > 1330.0) & (level < 2660.0)) == 64
    # Where no kink is, more levels leave the curve as it is.
    refined, plain = make(), without_kinks(make)
    changing = np.any(np.diff(refined.pairs_in_contact[:, :, 0, 0], axis=1) != 0, axis=1)
    x = refined.position[~changing]
    assert x.size > 20
    force = np.geomspace(266.0, 10640.0, 200)
    one, other = refined.ste(x[:, None], force), plain.ste(x[:, None], force)
    assert np.allclose(one, other, rtol=2e-4, atol=0.0)


def test_a_helical_pair_comes_into_contact_gradually(make):
    """A corner of a flank that touches first adds no stiffness at once: no kink, a smooth curve."""
    geometry = make().geometry
    straight, steep = (replace(geometry, base_helix_angle=angle) for angle in (0.0, 0.35))
    slight = replace(geometry, base_helix_angle=0.001)
    assert smooth_share(straight) == 0.0
    assert smooth_share(steep) == 1.0
    assert smooth_share(slight) < 0.05
    force, lag, _ = smooth_law(0.9)
    assert force.size == 4 + 2 * 3
    assert lag == pytest.approx(1e-8 * force**0.9, rel=8e-4)


def smooth_law(exponent: float):
    """Return force, deflection and stiffness on the smooth curve of 1e-8 F^n at loads five times apart."""
    force = np.array([0.0, 100.0, 500.0, 2500.0])
    one = np.ones((6, 1, 1, 1))
    compliance = exponent * 1e-8 * np.maximum(force, 1.0) ** (exponent - 1.0)
    levels = LoadLevels(force, 1e-8 * force**exponent * one, (force > 0.0) / compliance * one)
    smooth = refined_levels(levels, np.array([0, 1, 1, 2]) * np.ones((6, 1, 1, 1), dtype=int), 1.0)
    return smooth.force, smooth.deflection[0, 0, 0], smooth.stiffness[0, 0, 0]


def test_a_linear_law_stays_linear():
    """A cubic in F^(1/4) alone is 1.6e-3 off between loads five times apart."""
    force, lag, stiffness = smooth_law(1.0)
    assert lag == pytest.approx(1e-8 * force, rel=1e-12)
    assert stiffness[1:] == pytest.approx(1e8, rel=1e-12)


@pytest.mark.parametrize("exponent", [0.6, 0.75, 0.9])
def test_laws_that_stiffen_are_followed(exponent):
    """Line contact is near 0.9; a triangle of contact that grows is near 0.6."""
    force, lag, stiffness = smooth_law(exponent)
    assert lag[1:] == pytest.approx(1e-8 * force[1:] ** exponent, rel=1.1e-3)
    compliance = exponent * 1e-8 * force[1:] ** (exponent - 1.0)
    assert stiffness[1:] == pytest.approx(1.0 / compliance, rel=3.5e-3)


@pytest.mark.parametrize("stiff", [(0.2, 1.0), (1.0, 0.2), (3.0, 3.0), (0.4, 0.4), (50.0, 1.0), (1e-3, 1e3)])
def test_the_smooth_curve_rises_whatever_the_stiffness_at_its_ends(stiff):
    """Stiffness at the ends in parts of that of the step's secant."""
    force = np.array([0.0, 100.0, 500.0, 2500.0])
    lag = 1e-8 * force * np.ones((6, 1, 1, 1))
    ends = 1e8 * np.array([1.0, 1.0, *stiff]) * np.ones((6, 1, 1, 1))
    smooth = refined_levels(LoadLevels(force, lag, ends), np.ones((6, 1, 1, 4), dtype=int), 1.0)
    assert np.all(np.diff(smooth.deflection, axis=-1) > 0.0)
    assert np.all(smooth.stiffness[..., 1:] > 0.0)


def test_two_straight_branches_are_found(make):
    """F = k d, and k2 (d - e) more beyond e: the kink is found to the width of one inserted step."""
    position, force = np.arange(16) / 16, np.array([100.0, 1000.0, 3000.0])
    k, k2 = 3e8, 2e8
    gap = np.linspace(4e-6, 6e-6, 16)  # kinks between the second and third load
    ste = branches(k, k2, gap[:, None], force)
    carries_two = ste > gap[:, None]
    database = make(
        position=position,
        force=force,
        static_transmission_error=ste[..., None, None],
        tangent_compliance=(1.0 / np.where(carries_two, k + k2, k))[..., None, None],
        no_load_transmission_error=np.zeros((16, 1, 1)),
        pairs_in_contact=np.where(carries_two, 2, 1)[..., None, None],
    )
    asked = np.linspace(1000.0, 3000.0, 301)
    error = np.abs(database.ste(position[:, None], asked) - branches(k, k2, gap[:, None], asked))
    inserted_step = 2000.0 / 64 / k
    assert error.max() < inserted_step * k2 / (k + k2) / 4
    assert np.median(error) < 1e-12


def test_positions_that_search_their_branch_and_those_that_do_not_are_as_alone():
    """A branch whose curvature would miss the other one is bent less; that of its neighbor stays."""
    force = np.array([0.0, 100.0, 1000.0, 3000.0, 9000.0])
    lag = np.cumsum(
        [[0.0, 4.0, 20.0, 12.0, 40.0], [0.0, 4.0, 30.0, 60.0, 150.0], [0.0, 4.0, 9.0, 5.0, 81.0]], 1
    )
    stiffness = np.array(
        [[0.0, 20.0, 60.0, 200.0, 130.0], [0.0, 20.0, 30.0, 40.0, 45.0], [0.0, 30.0, 300.0, 900.0, 950.0]]
    )
    pairs = np.array([[0, 1, 1, 2, 2]] * 3)
    stack = [part[:, None, None] for part in (1e-6 * lag, 1e6 * stiffness, pairs)]
    together = refined_levels(LoadLevels(force, *stack[:2]), stack[2], 0.0)
    for row in range(3):
        one = [part[row : row + 1] for part in stack]
        alone = refined_levels(LoadLevels(force, *one[:2]), one[2], 0.0)
        np.testing.assert_array_equal(together.force, alone.force)
        np.testing.assert_array_equal(together.deflection[row], alone.deflection[0])
        np.testing.assert_array_equal(together.stiffness[row], alone.stiffness[0])


def branches(k, k2, gap, force):
    """Deflection of the two springs."""
    alone = force / k
    return np.where(alone <= gap, alone, (force + k2 * gap) / (k + k2))


def test_a_curved_branch_is_followed(make):
    """F = c d^1.2 up to the kink: the exponent comes from the step before."""
    force = np.array([100.0, 300.0, 1000.0, 3000.0])
    soft, gap = 3e8 * 1e6**0.2, 6e-6
    edge = soft * gap**1.2

    def law(asked):
        alone = (asked / soft) ** (1 / 1.2)
        together = gap + np.maximum(asked - edge, 0.0) / 1e9
        return np.where(asked <= edge, alone, together)

    ste = law(force)
    tangent = np.where(force <= edge, 1.2 * force / ste, 1e9)
    shape = (8, 4, 1, 1)
    database = make(
        position=np.arange(8) / 8,
        force=force,
        static_transmission_error=np.broadcast_to(ste[:, None, None], shape),
        tangent_compliance=np.broadcast_to(1.0 / tangent[:, None, None], shape),
        no_load_transmission_error=np.zeros((8, 1, 1)),
        pairs_in_contact=np.broadcast_to(np.where(force <= edge, 1, 2)[:, None, None], shape),
    )
    assert 1000.0 < edge < 3000.0
    asked = np.linspace(1000.0, 0.95 * edge, 50)
    error = np.abs(database.ste(0.3, asked) - law(asked)).max()
    straight = np.abs(ste[2] + (asked - 1000.0) / tangent[2] - law(asked)).max()
    assert error < 0.02 * straight


@pytest.mark.parametrize("relief", [0.0, 10e-6])
def test_it_pays_between_the_loads(make, relief):
    """At held-out loads and positions, against one smooth curve from load to load."""
    case = {"position": POSITION, "relief": relief, "force": COARSE}
    truth = make(position=(np.arange(211) + 0.37) / 211, relief=relief, force=BETWEEN)
    refined, plain = held_out_error(make(**case), truth), held_out_error(without_kinks(make, **case), truth)
    assert refined.relative_rms < 0.5 * plain.relative_rms
    assert refined.maximum < 0.7 * plain.maximum


def test_no_false_peaks_beside_the_handover(make):
    """Peak-to-peak between the loads, where smooth curves read several per cent too high."""
    truth, refined, plain = (
        make(position=POSITION, force=BETWEEN),
        make(position=POSITION),
        without_kinks(make, position=POSITION),
    )
    for force in BETWEEN:
        exact = float(truth.peak_to_peak(force=force))
        assert float(refined.peak_to_peak(force=force)) == pytest.approx(exact, rel=0.01)
    too_high = max(float(plain.peak_to_peak(force=f)) / float(truth.peak_to_peak(force=f)) for f in BETWEEN)
    assert too_high > 1.02


def test_a_long_period_has_as_many_levels_as_can_be_held():
    """23/67 over its hunting cycle, 64 positions a pitch: 2 million numbers of a quantity, not 6.6."""
    k, k2, force = 3e8, 2e8, np.array([0.0, 100.0, 1000.0, 3000.0])
    gap = np.linspace(4e-6, 6e-6, 1541 * 64)
    deflection = np.concatenate([np.zeros((gap.size, 1)), branches(k, k2, gap[:, None], force[1:])], axis=1)
    two = deflection > gap[:, None]
    pairs = (np.where(two, 2, 1) * (force > 0.0))[:, None, None]
    stiffness = np.where(two, k + k2, k) * (force > 0.0)
    levels = LoadLevels(force, deflection[:, None, None], stiffness[:, None, None])
    long, short = (
        refined_levels(levels, pairs, 0.0),
        refined_levels(LoadLevels(force, levels.deflection[::64], levels.stiffness[::64]), pairs[::64], 0.0),
    )
    assert long.deflection.size <= 2_000_000 + gap.size
    assert short.force.size == 4 + 64 + 5  # those of the kink, and of the wide step below it
    at = np.isclose(long.force[:, None], short.force).any(axis=1)
    assert at.sum() >= 4
    branch = branches(k, k2, gap[:, None], long.force[long.force >= 1000.0])
    np.testing.assert_allclose(long.deflection[:, 0, 0, long.force >= 1000.0], branch, atol=1e-12)
