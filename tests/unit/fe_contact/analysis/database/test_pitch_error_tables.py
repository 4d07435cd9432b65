"""Tables of pairs with pitch deviations: their period, positions, cost and error."""

from dataclasses import replace

import numpy as np
import pytest
from analysis_requests import point_request, table_request

from fe_contact import Gear, GearPair, PitchDeviation, Run, RunOut, TableAxes, Wave, analyze, flank_results
from fe_contact.analysis import position_nodes
from fe_contact.analysis.estimates.position_errors import measured_nodes
from fe_contact.analysis.pairs import solved_contact
from fe_contact.analysis.position_nodes import adaptive_nodes, assessed_pitches
from fe_contact.analysis.request.request_check import check_request
from fe_contact.analysis.tables import solve_table
from fe_contact.contact.sweep import solve_sets
from fe_contact.effects import EFFECTS, ContactScene, compose
from fe_contact.errors import InputError
from fe_contact.planning.plan import NodeRule
from model_studies.stage_clock import StageClock

TORQUES = (30.0, 100.0)
RNG = np.random.default_rng(21)


def gear(teeth, deviation=(), **more):
    return Gear(teeth, 4e-3, 25e-3, 40e-3, pitch_deviation=PitchDeviation(tuple(deviation)), **more)


@pytest.fixture(scope="module")
def pair():
    return GearPair(gear(20, RNG.normal(0.0, 3e-6, 20)), gear(23))


@pytest.fixture(scope="module")
def table(pair):
    return analyze(pair, torques=[100.0], level="draft")


def test_one_erring_gear_has_the_period_of_its_teeth_and_is_right_between(table, pair):
    assert table.period == 20
    assert table.position.size % 20 == 0
    assert table.metadata.receipt["predicted"]["pitches"] == 20
    per_pitch = table.position.reshape(20, -1)
    assert per_pitch - np.arange(20)[:, None] == pytest.approx(np.tile(per_pitch[0], (20, 1)), abs=1e-14)
    # At positions all over the period, solved one by one as flank results.
    position = RNG.uniform(0.0, 20.0, 400)
    exact = flank_results(pair, *point_request(torque=100.0, level="draft"), Run(), at=position).deflection
    error = np.abs(table.ste(position, pair.normal_force(100.0)) - exact)
    stated = table.metadata.receipt["error_by_source"]["table_interpolation_m"][0]
    assert np.ptp(exact) > 5e-6
    assert error.max() < 0.002 * np.ptp(exact)
    assert np.sqrt(np.mean(error**2)) < 0.0002 * np.ptp(exact)
    assert np.mean(error <= stated) > 0.99


def test_the_curve_of_a_long_period_shows_orders_between_the_mesh_harmonics():
    """An eccentric pinion is its order 1, and leaves the mesh harmonic as it is."""
    eccentric = GearPair(gear(20, 5e-6 * np.sin(2 * np.pi * np.arange(20) / 20 + 0.4)), gear(23))
    options = {"torques": [100.0], "level": "draft", "positions": 32}
    table, perfect = (analyze(p, **options) for p in (eccentric, GearPair(gear(20), gear(23))))
    spectrum = table.spectrum(torque=100.0)
    assert spectrum.pinion_order[:3] == pytest.approx([1.0, 2.0, 3.0])
    assert spectrum.wheel_order[0] == pytest.approx(23 / 20)
    assert spectrum.amplitude[0] == pytest.approx(5e-6 * np.cos(np.radians(20.0)), rel=0.05)
    assert spectrum.amplitude[1:19].max() < 0.05 * spectrum.amplitude[0]
    assert float(table.harmonics(torque=100.0)[0]) == pytest.approx(
        float(perfect.harmonics(torque=100.0)[0]), rel=0.05
    )


@pytest.mark.law
def test_load_shares_follow_the_early_tooth():
    """A tooth 20 um early carries all, wherever it is in mesh; pairs count from each whole pitch."""
    early = GearPair(gear(20, np.where(np.arange(20) == 4, 20e-6, 0.0)), gear(23))
    table = analyze(early, torques=[30.0], level="draft", positions=16)
    curve = table.curve(torque=30.0, at=[3.8, 4.0, 4.2])
    pair = [int(curve.pair[k]) for k in curve.load_share.argmax(axis=1)]
    assert pair == [-1, 0, 0]
    assert curve.load_share.max(axis=1) == pytest.approx(1.0, abs=1e-9)


@pytest.mark.law
def test_both_gears_repeat_after_the_hunting_cycle_or_the_pitches_asked_for():
    both = GearPair(gear(20, RNG.normal(0.0, 3e-6, 20)), gear(22, RNG.normal(0.0, 3e-6, 22)))
    options = {"torques": [100.0], "level": "draft", "positions": 8}
    cycle, part = analyze(both, **options), analyze(both, **options, pitches=30)
    assert (cycle.period, part.period) == (220, 30)
    # away from its seam the part is the cycle
    same = slice(8, 28 * 8)
    assert np.array_equal(
        part.static_transmission_error[same], cycle.static_transmission_error[: 30 * 8][same]
    )
    assert part.metadata.content_hash != cycle.metadata.content_hash


@pytest.mark.law
@pytest.mark.parametrize("edges", ["on", "off"])
def test_pitches_solved_in_parts_are_the_whole_table(monkeypatch, edges):
    """To the last bit, however small the parts: flanks that roll under load and edges left out included."""
    first = gear(17, RNG.normal(0.0, 3e-6, 17), waves=(Wave(4, 0.4e-6),), run_out=RunOut(4e-6))
    options = {"torques": [60.0, 100.0], "level": "draft", "model": "plane_strain", "positions": 8}
    options |= {"effects": {"corner_contact": edges}, "on_violation": "report"}
    tables, sizes = [], []

    def counted(problem, sets):
        sizes[-1].append(problem.candidates.gap.size)
        return solve_sets(problem, sets)

    monkeypatch.setattr(solved_contact, "solve_sets", counted)
    for maximum in (2**18, 100, 1):
        sizes.append([])
        monkeypatch.setattr(solved_contact, "POINTS_AT_ONCE", maximum)
        tables.append(analyze(GearPair(first, gear(23)), **options))
    assert len(sizes[0]) == 1 and max(sizes[1]) <= 100 and len(sizes[2]) == 17
    whole, *parted = tables
    for table in parted:
        assert all(np.array_equal(getattr(table, n), getattr(whole, n), equal_nan=True) for n in whole.stored)
        receipts = (t.metadata.receipt["assumptions"] for t in (table, whole))
        for found, of_whole in zip(*receipts, strict=True):
            change = pytest.approx(of_whole.get("change", 0.0), rel=1e-12)  # a sum, by parts
            assert found | {"change": 0.0} == of_whole | {"change": 0.0}
            assert found.get("change", 0.0) == change


@pytest.mark.parametrize(
    ("teeth", "options", "message"),
    [
        ((97, 101), {}, r"pitches = 9797: must be at most 2343 .* CPU s and .* GB"),
        ((97, 101), {"positions": 8, "pitches": 20_000}, "at most 18750 with 8 positions"),
        ((97, 101), {"pitches": 0}, "an integer from 1"),
        ((97, 101), {"pitches": 2.5}, "an integer from 1"),
        (None, {"pitches": 20}, "left out where all teeth are alike"),
    ],
)
def test_periods_that_cannot_be_tabulated_are_refused_by_name(teeth, options, message):
    pair = GearPair(gear(97), gear(101))
    if teeth:
        pair = GearPair(gear(97, RNG.normal(0, 1e-6, 97)), gear(101, RNG.normal(0, 1e-6, 101)))
    with pytest.raises(InputError, match=message) as refusal:
        check_request(pair, *table_request(torques=TORQUES, **options))
    assert refusal.value.field == "pitches"
    assert check_request(pair, TableAxes(torques=TORQUES), check_size=False).cycle is None


def test_a_misalignment_axis_shortens_the_longest_period():
    pair = GearPair(gear(97, RNG.normal(0, 1e-6, 97)), gear(101))
    options = {"torques": TORQUES, "misalignments": np.arange(40) * 1e-6}
    with pytest.raises(InputError, match="40 alignments"):
        check_request(pair, *table_request(**options))
    assert check_request(pair, *table_request(positions=8, **options)).cycle.alignments == 40


def test_the_assessed_pitches_span_the_differences_between_neighbors():
    error = np.where(np.arange(20) == 7, 9e-6, 0.0) + np.where(np.arange(20) > 12, 1e-6, 0.0)
    scene = ContactScene(GearPair(gear(20, error), gear(23)), np.array([100.0]), EFFECTS)
    smooth, _, rough = assessed_pitches(scene.pair, compose(scene, {})[0], 3)
    assert smooth not in (0, 6, 7, 8, 12, 13, 19)
    assert rough in (6, 7, 8)
    assert len(assessed_pitches(scene.pair, compose(scene, {})[0], 100)) == 20
    plain = replace(scene, pair=GearPair(gear(20), gear(23)))
    assert assessed_pitches(plain.pair, compose(plain, {})[0], 3).tolist() == [0]


def steps(position):
    """Three pitches of a curve that rises by 1 over the middle one, kinked at no grid's place."""
    pitches = np.arange(-1, 2)[:, None] + position
    return np.interp(pitches, [-1.0, 0.213, 0.741, 2.0], [0.0, 0.0, 1.0, 1.0])[..., None]


@pytest.mark.parametrize("kinks", [(0.213, 0.741), (0.013, 0.994), (0.031, 0.9995)])
def test_pitches_beside_count_where_interpolants_reach(kinks):
    """Without any other of their values nodes and errors are the same to the bit."""

    def whole(position):
        pitches = np.arange(-1, 2)[:, None] + position
        return np.interp(pitches, [-1.0, -0.99, *kinks, 1.007, 2.0], [0.0, 0.3, 0.0, 1.0, 0.7, 1.0])[
            ..., None
        ]

    def near(position):
        values = whole(position)
        values[::2, ~rule.reached_by_neighbor(position)] = np.nan
        return values

    rule = NodeRule(16, 0.002, 768)
    own, nodes = (adaptive_nodes(rule, solve) for solve in (near, whole))
    assert np.array_equal(own.position, nodes.position)
    assert np.array_equal(own.interval_error, nodes.interval_error)
    assert np.array_equal(own.middle, nodes.middle)


def test_the_prediction_counts_the_pitches_that_the_search_solves(pair, monkeypatch):
    """The assessed ones at all positions that are tried, those beside at the ends."""
    tried, solved = [], []
    place, curves = position_nodes.adaptive_nodes, position_nodes._curves

    def placed(rule, solve):
        return place(rule, lambda position: tried.append(position.size) or solve(position))

    def solved_curves(points, load, position, pitches):
        solved.append(position.size * pitches.size)
        return curves(points, load, position, pitches)

    monkeypatch.setattr(position_nodes, "adaptive_nodes", placed)
    monkeypatch.setattr(position_nodes, "_curves", solved_curves)
    checked = check_request(pair, *table_request(torques=[100.0], level="draft", model="plane_strain"))
    solve_table(checked, StageClock(), Run())
    plan = checked.plan("draft")
    assert plan.nodes.searched(1) == 1.0
    assert sum(solved) == pytest.approx(sum(tried) * plan.nodes.searched(20), rel=0.15)


def test_nodes_of_one_pitch_among_others_join_its_neighbors():
    """A pitch that ends higher than it starts is no jump, for the next one goes on from there."""
    nodes = adaptive_nodes(NodeRule(16, 0.002, 768), steps)
    assert nodes.position.size < 200
    assert nodes.error.max() <= 0.002
    spacing = np.diff(nodes.position, append=1.0)
    kinks = np.abs(nodes.position[:, None] - [0.213, 0.741]).min(axis=1)
    assert spacing[kinks < 0.05].min() < 0.15 * spacing[kinks > 0.15].min()
    even = np.arange(64) / 64
    fixed, _ = measured_nodes(
        even, steps(even).reshape(192, 1), lambda x: steps(x).reshape(-1, 1), 3, NodeRule(16, 0.002, 768)
    )
    assert fixed.error[[64, 127]].max() < 1e-12
