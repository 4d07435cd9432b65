"""Teeth out of their places: which of them meet, and what the transmission error makes of it."""

import math
from dataclasses import replace

import numpy as np
import pytest
from analysis_requests import table_request

from fe_contact.analysis.pairs.operating_points import operating_points
from fe_contact.analysis.pairs.pair_contact import pair_contact
from fe_contact.analysis.request.request_check import check_request
from fe_contact.contact import ContactProblem, PatchRule, Slices, contact_candidates, in_pitches
from fe_contact.contact.model import ContactModel, MeetingTeeth
from fe_contact.effects import EFFECTS, ContactScene, compose
from fe_contact.effects.pitch_error import PitchError, PitchGap
from fe_contact.geometry import Gear, GearPair, InternalGearPair, PitchDeviation, RingGear
from fe_contact.planning.plan import make_plan

Z1, Z2 = 20, 23
COSINE = math.cos(math.radians(20.0))
POSITIONS = np.arange(16) / 16
LIGHT, HEAVY = 1e-3, 300.0  # N m


def gear(teeth, deviation=(), **changes):
    values = {"normal_module": 4e-3, "face_width": 25e-3, "bore_diameter": 40e-3} | changes
    return Gear(teeth=teeth, pitch_deviation=PitchDeviation(tuple(deviation)), **values)


def one_tooth(teeth, tooth, error):
    return np.where(np.arange(teeth) == tooth, error, 0.0)


@pytest.fixture(scope="module")
def cache(tmp_path_factory):
    return tmp_path_factory.mktemp("compliance")


@pytest.fixture(scope="module")
def solved(cache):
    """STE (T, P, L) in m of a pair over whole pitches, at a light and a heavy load."""

    def solve(pair, pitches, position=POSITIONS, effects=None, torques=(LIGHT, HEAVY)):
        checked = check_request(
            pair, *table_request(torques=torques, level="draft", effects=effects or {}), check_size=False
        )
        plan = make_plan(pair, checked.request.load, checked.request.options, checked.model)
        contact = pair_contact(pair, plan, cache)
        (place,) = operating_points(checked.request.scene, checked.request.choices, contact).places
        solution = place.solve(position, plan.load, np.repeat(pitches, position.size))[1]
        assert solution.converged
        return solution.deflection.reshape(len(pitches), position.size, -1)

    return solve


@pytest.fixture(scope="module")
def perfect(solved):
    return solved(GearPair(gear(Z1), gear(Z2)), [0])[0]


def composed(pair, pitches=None):
    return compose(ContactScene(pair, np.array([100.0]), EFFECTS, pitches=pitches), {})[0]


def turned(teeth, by, pitches):
    """Directions of all teeth of a gear, numbered counter-clockwise, turned counter-clockwise."""
    return np.exp(2j * np.pi * (np.arange(teeth) + by * pitches) / teeth)


@pytest.mark.parametrize("position", [0.0, 0.3, 4.9, 37.5, 459.2])
def test_the_teeth_of_every_pair_by_turning_the_gears(position):
    """Tooth numbers of finite elements count counter-clockwise; the pinion turns clockwise, the wheel back.

    A pair j pitches ahead stands (j + fraction) pitches further in each gear's sense of rotation than the
    tooth of pair 0 stood at position 0.
    """
    first, second = np.arange(Z1) * 1e-6, np.arange(Z2) * 3e-5
    gears = GearPair(gear(Z1, first), gear(Z2, second))
    model = composed(gears)
    pitch, fraction = math.floor(position), position - math.floor(position)
    for pair in (-2, -1, 0, 1, 2):
        ahead = np.exp(-2j * np.pi * (pair + fraction) / Z1), np.exp(2j * np.pi * (pair + fraction) / Z2)
        tooth_1 = np.argmin(np.abs(turned(Z1, -1.0, position) - ahead[0]))
        tooth_2 = np.argmin(np.abs(turned(Z2, +1.0, position) - ahead[1]))
        # into mesh come teeth that stand counter-clockwise on the pinion, clockwise on the wheel
        expected = first[tooth_1] + second[-tooth_2 % Z2]
        found = model.gap_of_teeth(MeetingTeeth.at_pitch_point(gears, np.array([pitch - pair])))
        assert found == pytest.approx([-expected * COSINE], rel=1e-12, abs=1e-20)


def test_pairs_keep_their_teeth_as_they_move_on():
    """What is pair j just below a whole pitch is pair j + 1 above it, with the same gap."""
    pair = GearPair(gear(Z1, np.arange(Z1) * 1e-6), gear(Z2, np.arange(Z2) * 1e-5))
    model = composed(pair)
    plain = contact_candidates(
        pair, model, np.array([0.0, 1.0 - 1e-9]), PatchRule(3e-4, 2e-4), Slices.of_pair(pair, 1)
    )
    problem = in_pitches(pair, _without_compliance(plain), model, np.repeat(np.arange(4), 2))
    possible = np.isfinite(plain.gap)
    start = np.tile(np.where(possible, plain.gap, np.nan), (4, 1))
    added = (problem.candidates.gap - start).reshape(4, 2, -1)
    assert problem.candidates.position == pytest.approx([0, 1, 1, 2, 2, 3, 3, 4], abs=1e-8)
    for pitch in range(3):
        below, above = added[pitch, 1, :-1], added[pitch + 1, 0, 1:]
        both = np.isfinite(below) & np.isfinite(above)
        assert both.sum() >= 2
        assert below[both] == pytest.approx(above[both], rel=0.0, abs=1e-19)


def _without_compliance(candidates):
    return ContactProblem(candidates, np.zeros((2, 1, 1)), 1.0, 1.0, 1.0)


@pytest.mark.parametrize("side", ["pinion", "wheel"])
def test_an_early_tooth_lowers_the_error_by_itself_while_it_is_in_mesh(solved, perfect, side):
    """At no load to speak of it carries alone, all along the path of contact, and pushes the gears ahead."""
    error, tooth = 5e-6, 7
    teeth = {"pinion": (one_tooth(Z1, tooth, error), ()), "wheel": ((), one_tooth(Z2, tooth, error))}[side]
    pair = GearPair(gear(Z1, teeth[0]), gear(Z2, teeth[1]))
    change = solved(pair, range(5, 10))[..., 0] - perfect[:, 0]
    phase = (np.arange(5, 10)[:, None] + POSITIONS - tooth) * pair.base_pitch
    path = pair.path_of_contact
    in_mesh = (phase >= path.start - path.pitch_point) & (phase <= path.end - path.pitch_point)
    assert change[in_mesh] == pytest.approx(-error * COSINE, rel=2e-3)
    far = np.abs(phase) > 1.2 * pair.base_pitch
    assert np.all(change[far] == 0.0)


def test_an_early_tooth_of_a_ring_gear_lowers_the_error_by_itself(solved):
    """Its teeth turn the same way as the pinion's, and come into mesh in the order of the list."""
    error, tooth = 5e-6, 7
    plain = {"normal_module": 4e-3, "face_width": 25e-3, "rim_diameter": 300e-3, "cutter_teeth": 25}
    ring = RingGear(teeth=60, tip_diameter=0.2345, **plain)
    early = replace(ring, pitch_deviation=PitchDeviation(tuple(one_tooth(60, tooth, error))))
    perfect, pair = (InternalGearPair(gear(Z1), wheel) for wheel in (ring, early))
    pitches = range(5, 10)
    change = solved(pair, pitches)[..., 0] - solved(perfect, [0])[..., 0]
    phase = (np.arange(5, 10)[:, None] + POSITIONS - tooth) * pair.base_pitch
    path = pair.path_of_contact
    in_mesh = (phase >= path.start - path.pitch_point) & (phase <= path.end - path.pitch_point)
    assert change[in_mesh] == pytest.approx(-error * COSINE, rel=2e-3)
    assert np.all(change[np.abs(phase) > 1.2 * pair.base_pitch] == 0.0)


def test_a_late_tooth_raises_the_error_by_itself_where_it_must_carry_alone(solved, perfect):
    """In single contact; in double contact its neighbor takes the load and nothing rises."""
    error, tooth = 0.5e-6, 7
    late = solved(GearPair(gear(Z1, one_tooth(Z1, tooth, -error)), gear(Z2)), [6, 7])[..., 0]
    rise = late - perfect[:, 0]
    assert rise[1, 0] == pytest.approx(error * COSINE, rel=1e-3)  # position 7: that tooth at the pitch point
    assert rise[0, 8] == pytest.approx(0.0, abs=1e-3 * error)  # position 6.5: two pairs touch


def test_equal_deviations_turn_the_gear_and_met_ones_do_nothing(solved, perfect):
    error = 30e-6
    pair = GearPair(gear(Z1, [error] * Z1), gear(Z2))
    assert composed(pair).period == 1
    shifted = solved(pair, [0])[0]
    assert shifted + error * COSINE == pytest.approx(perfect, rel=1e-9, abs=1e-17)
    pattern = 1e-6 * np.array([0.0, 5.0, -3.0, 8.0])
    pair = GearPair(gear(20, np.tile(pattern, 5)), gear(24, np.tile(-pattern, 6)))
    assert composed(pair).period == 4
    same = solved(GearPair(gear(20), gear(24)), [0])
    assert solved(pair, range(4)) == pytest.approx(np.repeat(same, 4, axis=0), rel=1e-12, abs=1e-20)


def test_small_deviations_superpose_at_high_load_and_their_weights_sum_to_one(solved, perfect):
    """All pairs in contact stay in contact, so STE is a weighted mean of their errors."""
    error, double = 0.05e-6, POSITIONS == 0.5

    def change(*teeth):
        deviation = sum(one_tooth(Z1, tooth, error) for tooth in teeth)
        return (solved(GearPair(gear(Z1, deviation), gear(Z2)), [6])[0] - perfect)[double, 1]

    ahead, behind = change(6), change(7)
    assert change(6, 7) == pytest.approx(ahead + behind, rel=1e-3)
    assert change(6, 7) == pytest.approx([-error * COSINE], rel=1e-3)
    assert ahead == pytest.approx(behind, rel=0.2)  # about half each


def test_the_mean_over_a_whole_cycle_is_that_of_the_deviations(solved):
    """Every tooth carries in its turn: what one pitch gains the others lose."""
    rng = np.random.default_rng(8)
    deviation = rng.uniform(-0.2e-6, 0.2e-6, Z1)
    changed = solved(GearPair(gear(Z1, deviation), gear(Z2)), range(Z1))[..., 1]
    plain = solved(GearPair(gear(Z1), gear(Z2)), [0])[..., 1]
    assert np.mean(changed - plain) == pytest.approx(-deviation.mean() * COSINE, rel=0.05, abs=0.005e-6)


def test_everything_repeats_with_the_period_and_not_before(solved):
    rng = np.random.default_rng(9)
    pair = GearPair(gear(18, rng.normal(0, 3e-6, 18)), gear(24, rng.normal(0, 3e-6, 24)))
    assert composed(pair).period == 72
    start, cycle, gear_1, gear_2 = solved(pair, [5, 5 + 72, 5 + 18, 5 + 24])
    assert np.array_equal(start, cycle)
    assert np.abs(start - gear_1).max() > 1e-7
    assert np.abs(start - gear_2).max() > 1e-7


def test_swapped_gears_meet_the_same_teeth_going_backwards(solved):
    """Without corner contact, whose gap is not the same from both sides."""
    rng = np.random.default_rng(10)
    pair = GearPair(gear(Z1, rng.normal(0, 3e-6, Z1)), gear(Z2, rng.normal(0, 3e-6, Z2)))
    off = {"corner_contact": "off"}
    position = np.array([0.1, 0.45, 0.8])
    there = solved(pair, [37], position, off)[0]
    torques = tuple(torque * Z2 / Z1 for torque in (LIGHT, HEAVY))
    back = solved(pair.swapped(), [-38], 1.0 - position, off, torques)[0]
    assert back == pytest.approx(there, rel=1e-6)


def test_neutral_or_off_is_the_perfect_pair_to_the_bit(solved, perfect):
    erring = GearPair(gear(Z1, one_tooth(Z1, 0, 9e-6)), gear(Z2))
    assert np.array_equal(solved(erring, [0], effects={"pitch_error": "off"})[0], perfect)
    neutral = GearPair(gear(Z1, np.zeros(Z1)), gear(Z2))
    assert np.array_equal(solved(neutral, [0], effects={"pitch_error": "on"})[0], perfect)


def test_the_verdict_gives_the_figures_of_the_standard_and_periods_multiply():
    pair = GearPair(gear(Z1, one_tooth(Z1, 3, 5e-6)), gear(Z2))
    verdict = PitchError().called_for(ContactScene(pair, np.array([100.0]), EFFECTS))
    assert verdict.on
    assert "pinion f_p 5 µm, F_p 5 µm" in verdict.reason
    assert verdict.reason.endswith("over 20 base pitches")
    plain = GearPair(gear(Z1), gear(Z2))
    assert not PitchError().called_for(ContactScene(plain, np.array([100.0]), EFFECTS)).on
    terms = (PitchGap(0, (1e-6, 0.0), 2), PitchGap(1, (2e-6, 0.0, 0.0), 3))
    model = ContactModel(tooth_gaps=terms)
    assert model.period == 6
    pair = GearPair(gear(Z1, np.arange(Z1) * 1e-6), gear(Z2, np.arange(Z2) * 1e-5))
    model = composed(pair, pitches=30)
    assert model.period == 30
    assert model.gap_of_teeth(MeetingTeeth.at_pitch_point(pair, np.array([29, 30, 31]))) == pytest.approx(
        -COSINE * np.array([9e-6 + 6e-5, 0.0, 1e-6 + 1e-5]), abs=1e-18
    )
