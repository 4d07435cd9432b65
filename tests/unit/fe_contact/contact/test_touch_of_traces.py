"""Where flanks with measured traces come closest, against nothing but many samples of the true gap."""

import numpy as np
import pytest
from tooth_traces import KINDS, SHAPES, on_profile, pair_with, sampled_gap, traced_pair

from fe_contact import FlankModification, RunOut, ToothFlank, Wave
from fe_contact.contact import ContactProblem, PatchRule, Slices, contact_candidates, in_pitches, with_gaps
from fe_contact.contact.flank_slope import rolls_at
from fe_contact.contact.least_gap import least_gap
from fe_contact.contact.model import MeetingTeeth
from fe_contact.effects import EFFECTS, ContactScene, compose

SAMPLES = 1601
RESOLVED = 5e-9
"""m; the sampled gap itself is above its least value by so much between two samples."""
POSITION = np.arange(6) / 6.0


def touching(pair, pitches):
    """Return the contact of base pitches, and which pair of teeth meets at each candidate."""
    model, _ = compose(ContactScene(pair, np.array([100.0]), EFFECTS), {})
    rule = PatchRule(0.3e-3, 0.025e-3)
    slices = Slices.of_pair(pair, 3 if pair.base_helix_angle else 1, 2)
    plain = contact_candidates(pair, model, POSITION, rule, slices)
    size = plain.slices.pair.size
    bodies = ContactProblem(plain, np.zeros((POSITION.size, size, size)), 2e11, 1e-12, 1e-12)
    common = bodies.touching(with_gaps(pair, plain, model))
    rows = np.repeat(np.asarray(pitches), POSITION.size)
    candidates = in_pitches(pair, common, model, rows).candidates
    return model, candidates, rows[:, None] - candidates.pair


def assert_least(pair, pitches=(1, 2, 3)):
    """Compare with samples; what is designed counts at tip edges by their lever arms, which have a test."""
    model, candidates, meeting = touching(pair, pitches)
    at, minimum = sampled_gap(pair, model, candidates, meeting, SAMPLES)
    if model.gaps:
        levers = candidates.touch.lever_1[at], candidates.touch.lever_2[at]
        on_line = (levers[0] == 1.0) & (levers[1] == 1.0)
        at, minimum = tuple(index[on_line] for index in at), minimum[on_line]
    touch = candidates.touch
    rolls = rolls_at(pair, touch.s_1[at], touch.s_2[at])
    teeth = MeetingTeeth(pair, meeting[at], *rolls, candidates.face_position[at[1]])
    of_teeth = model.gap_of_teeth(teeth)  # a lag, while the slope of gear 2 turns what is designed
    above = (candidates.gap[at] - of_teeth) / (touch.lag[at] if model.gaps else 1.0) + of_teeth - minimum
    assert above.max() < 1e-9
    assert above.min() > -RESOLVED
    assert np.all(candidates.touch.curvature[at] > 0.0)
    return candidates


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("index", [0, 1])
@pytest.mark.parametrize("shape", SHAPES)
def test_a_trace_on_one_tooth_touches_where_its_true_gap_is_least(kind, index, shape):
    draw = np.random.default_rng([KINDS.index(kind), index, SHAPES.index(shape)])
    assert_least(traced_pair(kind, index, shape, draw))


@pytest.mark.parametrize("index", [0, 1])
def test_traces_beside_modifications_are_searched_with_them(index):
    """The least of a sum is not the sum of what is least: relief and trace act at the same tip."""
    relief = FlankModification(tip_relief=20e-6, tip_relief_length=0.8e-3, profile_crowning=3e-6)
    draw = np.random.default_rng(index)
    traced = traced_pair("spur", index, "white", draw)
    gear = (traced.pinion, traced.wheel)[index]
    pair = pair_with("spur", index, modification=relief, tooth_flanks=gear.tooth_flanks)
    assert_least(pair)


def test_teeth_of_all_deviations_are_searched_with_one_another():
    """Traces of both gears, run-out and waves: every pair of teeth has another sum."""
    draw = np.random.default_rng(7)
    gears = [
        (pair.pinion, pair.wheel)[index]
        for index in (0, 1)
        for pair in (traced_pair("helical", index, "filtered", draw),)
    ]
    pair = pair_with(
        "helical",
        0,
        tooth_flanks=gears[0].tooth_flanks,
        run_out=RunOut(20e-6, 0.4, 5e-6, 1.0),
        waves=(Wave(5, 3e-7, 1.0), Wave(230, 1e-7)),
    )
    wheel = pair_with("helical", 1, tooth_flanks=gears[1].tooth_flanks, run_out=RunOut(30e-6)).wheel
    assert_least(type(pair)(pair.pinion, wheel))


def test_an_edge_break_ends_the_flank_and_lowers_no_gap():
    """One step of a parabola over the break made 128 um of it that are not there."""
    plain = pair_with("spur", 1)
    tip = plain.wheel.tip_roll_length
    surface = on_profile(plain.wheel, [5e-3, tip - 0.25e-3, tip], [0.0, 0.0, 14e-6])
    pair = pair_with("spur", 1, tooth_flanks=(ToothFlank(2, flank_grid=surface),))
    candidates = assert_least(pair, range(4))
    assert candidates.gap.min() >= -1e-12


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(("waves", "height"), [(12, 6e-6), (30, 3e-6)])
def test_short_high_waves_on_all_teeth_touch_where_their_true_gap_is_least(kind, waves, height):
    """Seventeen samples of the whole flank fall between them, 6 um too high."""
    gear = pair_with(kind, 0).pinion
    part = np.linspace(0.0, 1.0, 8 * waves + 1)
    roll = gear.form_roll_length + part * (gear.tip_roll_length - gear.form_roll_length)
    surface = on_profile(gear, roll, 0.5 * height * np.cos(2.0 * np.pi * waves * part))
    assert_least(pair_with(kind, 0, modification=FlankModification(flank_grid=surface)), (0,))


def test_gaps_of_two_valleys_are_followed_into_the_deeper_one():
    """The valley whose lowest sample is the higher one; and one between two samples at the end."""

    def gap(x, of):
        deep = np.where(of == 0, 3.0 * np.abs(x - 0.55) - 0.4, x**2)
        return np.minimum(deep, (x + 0.5) ** 2 - 0.1)

    x, of = np.tile(np.linspace(-1.0, 1.0, 9), 2), np.repeat([0, 1], 9)
    place, minimum = least_gap(gap, x, of, np.full(2, 1e-6))
    assert minimum == pytest.approx([-0.4, -0.1], abs=0.02)
    assert place == pytest.approx([0.55, -0.5], abs=0.01)
    end, low = least_gap(
        lambda x, of: (x - 0.1) ** 2, np.array([0.0, 1.0]), np.zeros(2, int), np.full(1, 1e-6)
    )
    assert (end[0], low[0]) == pytest.approx((0.1, 0.0), abs=2e-2)
