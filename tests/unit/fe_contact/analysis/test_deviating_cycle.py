"""Hunting cycles by derivatives, held against all their pitches solved."""

from dataclasses import replace

import numpy as np
import pytest

from fe_contact import (
    AllowedError,
    AnalysisOptions,
    Gear,
    GearPair,
    PitchDeviation,
    Run,
    RunOut,
    TableAxes,
    ToothFlank,
    Wave,
    analyze,
)
from fe_contact.analysis import deviating_cycle as cycle_module
from fe_contact.analysis.cycle import envelope
from fe_contact.analysis.cycle.envelope import CycleContact, Envelope
from fe_contact.analysis.cycle.tangents import nominal_tangent, pitch_tangents
from fe_contact.analysis.deviating_cycle import cycle_contact, deviating_cycle
from fe_contact.errors import InputError, SolveError
from fe_contact.planning import cost_of_derivatives
from fe_contact.planning.cost_of_derivatives import BATCH, solved_pitches
from fe_contact.ste.curve_errors import DERIVATIVES, SOURCES, source_names
from fe_contact.ste.curve_quantities import MEAN, PEAK_TO_PEAK, quantity_changes

TEETH = (17, 19)
AXES = TableAxes(torques=[40.0, 120.0])
SOLVER = 2e-10
"""m by which solutions of other pitches at once may differ: the solver ends there."""
OPTIONS = AnalysisOptions(level="draft", model="plane_strain", positions=48)


def as_made(teeth: int, size: float) -> Gear:
    """Return a gear whose deviations are drawn, in parts of those of a usual one."""
    draw = np.random.default_rng(teeth)
    slopes = draw.normal(0.0, 2e-6 * size, teeth).tolist()
    return Gear(
        teeth=teeth,
        normal_module=2e-3,
        face_width=20e-3,
        bore_diameter=10e-3,
        profile_shift_coefficient=0.1,
        pitch_deviation=PitchDeviation(tuple(draw.normal(0.0, 3e-6 * size, teeth).tolist())),
        run_out=RunOut(5e-6 * size, 0.4),
        waves=(Wave(5, 3e-7 * size, 1.0),),
        tooth_flanks=tuple(ToothFlank(k + 1, profile_slope=slope) for k, slope in enumerate(slopes)),
    )


def made(size: float) -> GearPair:
    return GearPair(*(as_made(teeth, size) for teeth in TEETH))


def contact_of(size: float) -> CycleContact:
    return cycle_contact(made(size), AXES, OPTIONS, Run())[0]


@pytest.fixture(scope="module")
def exact():
    contact = contact_of(1.0)
    assert contact.pitches == 17 * 19
    return contact.exact(np.arange(contact.pitches))


@pytest.fixture(scope="module")
def cycle():
    return deviating_cycle(made(1.0), AXES, OPTIONS)


def test_gaps_of_single_teeth_add_up_to_those_of_the_pair_that_meets():
    contact = contact_of(1.0)
    gaps, _ = contact.nominal()
    pitches = np.array([0, 1, 40, 322])
    problem = contact.solved(pitches).problem
    alike = replace(contact.point.model, tooth_gaps=())
    plain = contact.point.contact.problem(alike, contact.position).candidates.gap
    found = problem.candidates.gap.reshape(pitches.size, *plain.shape)
    there = np.isfinite(plain)
    for pitch, gap in zip(range(pitches.size), found, strict=True):
        first, second = (teeth[pitch] for teeth in gaps.teeth(pitches))
        pairs = np.arange(gaps.pair.size)
        own = (gaps.gears[0][pairs, :, first] + gaps.gears[1][pairs, :, second]).transpose(1, 0, 2)
        # flanks that slope touch beside the point, a little closer
        missed = (plain + own.reshape(plain.shape))[there] - gap[there]
        assert missed.min() > -1e-12
        assert np.quantile(missed, 0.9) < 0.02e-6


def test_derivatives_are_exact_for_small_deviations():
    """But at the few positions where a pair of teeth is about to part."""
    contact = contact_of(1e-3)
    gaps, state = contact.nominal()
    nominal = nominal_tangent(gaps, state)
    pitches = np.arange(0, 323, 30)
    moved = contact.exact(pitches) - nominal.value
    found = nominal.value + nominal.motion(gaps, pitches).sum(axis=0)
    missed = np.abs(found - nominal.value - moved)
    assert np.abs(moved).max() > 5e-9
    assert np.quantile(missed, 0.9) < 1e-3 * np.abs(moved).max()
    assert missed.max() < 2e-2 * np.abs(moved).max()


def test_tangents_lie_above(exact):
    """Where teeth part others take over: the transmission error is concave in the gaps, but at tip edges."""
    contact = contact_of(1.0)
    gaps, state = contact.nominal()
    nominal, pitches = nominal_tangent(gaps, state), np.array([3, 150])
    tangents = pitch_tangents(gaps, contact.solved(pitches), pitches)
    assert np.stack([each.value for each in tangents]) == pytest.approx(exact[pitches], abs=SOLVER)
    for tangent in (nominal, *tangents):
        above = tangent.value + tangent.motion(gaps, np.arange(contact.pitches)).sum(axis=0) - exact
        assert np.quantile(above, 0.01) > -0.02e-6
        assert above.max() > 0.5e-6
    own = tangents[1].motion(gaps, pitches[1:])
    change, every = own.sum(axis=0), np.ones(own.shape[1:], dtype=bool)
    assert tangents[1].value + change[0] == pytest.approx(exact[150], abs=SOLVER)
    assert np.abs(tangents[1].distance(own, change, every)).max() < 1e-15


def test_stated_errors_cover_the_whole_cycle_solved(cycle, exact):
    assert 16 < np.count_nonzero(cycle.solved) < 81
    assert cycle.ste[cycle.solved] == pytest.approx(exact[cycle.solved], abs=SOLVER)
    left = np.abs(cycle.ste - exact)[~cycle.solved]
    assert np.mean(left <= cycle.error) > 0.95
    position = np.arange(exact[..., 0].size) / 48
    own, whole = (each.reshape(position.size, -1) for each in (cycle.ste, exact))
    true = quantity_changes(position, own, whole, 323, position)
    assert np.mean(true <= cycle.quantity_error) > 0.95
    values = np.stack([exact.mean(axis=(0, 1)), np.ptp(exact, axis=(0, 1))])
    assert np.all(cycle.quantity_error[[MEAN, PEAK_TO_PEAK]] <= AllowedError().of(values))
    assert np.all(cycle.quantity_error < 0.05 * values[1])


def test_orders_of_both_shafts_are_named_with_their_error(cycle):
    lines = cycle.orders()
    largest = [lines.names[k] for k in np.argsort(-lines.amplitude)[:8]]
    assert {"pinion 1", "wheel 1"} <= set(largest)
    assert lines.error[0] == pytest.approx(cycle.quantity_error[2, -1])


def test_a_cycle_that_needs_many_pitches_is_solved_whole(exact, monkeypatch):
    """Nothing is left to derivatives where a tenth of a nanometer is allowed."""
    monkeypatch.setattr(AnalysisOptions, "allowed", AllowedError(1e-4, 1e-10))
    cycle = deviating_cycle(made(1.0), AXES, OPTIONS)
    assert cycle.solved.all()
    assert not cycle.quantity_error.any()
    assert not cycle.error.any()
    assert cycle.ste == pytest.approx(exact, abs=SOLVER)


def test_drawn_pitches_do_not_test_themselves():
    envelope = Envelope.of(contact_of(1.0))
    minimum = envelope.minimum.ste[envelope.drawn]
    own = minimum == envelope.exact[: envelope.drawn.size]
    assert own.any()
    assert np.all(envelope.without.ste[own] > minimum[own])


def test_a_revolution_of_few_teeth_is_solved_whole():
    pair = replace(made(1.0), wheel=replace(as_made(19, 0.0), tooth_flanks=(), waves=()))
    cycle = deviating_cycle(pair, AXES, OPTIONS)
    assert cycle.ste.shape == (17, 48, 2)
    assert cycle.solved.all()


@pytest.mark.parametrize(
    ("axes", "positions", "field"),
    [
        (TableAxes(torques=[40.0], misalignments=(0.0, 1e-6)), 48, "misalignments"),
        (TableAxes(torques=[40.0], center_distance_changes=(0.0, 1e-6)), 48, "center_distance_changes"),
        (AXES, 40, "positions"),
    ],
    ids=str,
)
def test_what_a_cycle_cannot_be_is_refused(axes, positions, field):
    with pytest.raises(InputError) as caught:
        deviating_cycle(made(1.0), axes, replace(OPTIONS, positions=positions))
    assert caught.value.field == field


@pytest.fixture(scope="module")
def tables():
    """Return the same table by derivatives, and all its pitches solved."""
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(cost_of_derivatives, "TABLE_SAVES", 0.0)
        derived = analyze(made(1.0), AXES, OPTIONS)
        patched.setattr(cost_of_derivatives, "TABLE_SAVES", np.inf)
        return derived, analyze(made(1.0), AXES, OPTIONS)


def test_a_table_takes_pitches_by_derivatives_and_says_how_many(tables):
    derived, solved = tables
    told = derived.metadata.receipt["cycle"]
    known = np.isfinite(derived.residuals[..., 0, 0, 0])
    assert told["pitches"] == 323
    assert 24 < told["solved"][0] < 90
    assert np.count_nonzero(known.all(axis=1)) == 48 * told["solved"][0]
    for name in ("static_transmission_error", "load_share", "max_pressure", "load_arm", "tangent_compliance"):
        own, whole = (getattr(table, name)[known[:, 0]] for table in tables)
        assert own == pytest.approx(whole, rel=1e-6, abs=SOLVER)
    assert "cycle" not in solved.metadata.receipt
    assert len(solved.curve_error) == len(SOURCES)


@pytest.mark.parametrize("in_table", [False, True])
def test_the_prediction_counts_the_pitches_that_are_solved(in_table, monkeypatch):
    """All but the batches beyond the first, which the errors decide: they are looked at after every batch."""
    looked = []

    def counted(*each):
        looked.append(within(*each))
        return looked[-1]

    within = envelope._within
    monkeypatch.setattr(envelope, "_within", counted)
    monkeypatch.setattr(cost_of_derivatives, "TABLE_SAVES", 0.0)
    if in_table:
        (solved,) = analyze(made(1.0), AXES, OPTIONS).metadata.receipt["cycle"]["solved"]
    else:
        solved = deviating_cycle(made(1.0), AXES, OPTIONS).solved.sum()
    fewest, expected = solved_pitches(323, in_table=in_table)
    assert looked.count(True) == 1
    assert fewest + BATCH * looked.count(False) - solved in (0, 1)[: 1 + in_table]  # the first may be drawn
    assert (expected - fewest) % BATCH == 0


def test_errors_of_a_table_hold_what_derivatives_miss(tables):
    derived, solved = tables
    assert source_names(derived.curve_error)[-1] == DERIVATIVES
    for name, errors in (("static_transmission_error", "curve_error"), ("load_arm", "load_arm_error")):
        own, whole = (getattr(table, name)[..., 0, 0] for table in tables)
        true = quantity_changes(solved.position, own, whole, 323, solved.position)
        assert np.mean(true <= getattr(derived, errors)[-1, ..., 0, 0] + SOLVER) > 0.95
    missed = np.abs(derived.static_transmission_error - solved.static_transmission_error)
    assert np.mean(missed <= derived.error_estimate) > 0.95
    for torque in (40.0, 120.0):
        own, whole = (table.spectrum(torque=torque) for table in tables)
        assert np.mean(np.abs(own.amplitude - whole.amplitude) <= own.error) > 0.95


def test_shares_and_pressures_are_within_what_drawn_pitches_tell(tables):
    derived, solved = tables
    told = derived.metadata.receipt["cycle"]
    share = np.abs(derived.load_share - solved.load_share).max(axis=4)
    assert np.mean(share <= told["share_error"]) > 0.97
    pressure = np.abs(derived.max_pressure - solved.max_pressure) / solved.max_pressure.max()
    assert np.mean(pressure <= told["pressure_error_relative"]) > 0.97
    assert derived.max_pressure.max() == pytest.approx(solved.max_pressure.max(), rel=0.03)
    assert derived.load_share.sum(axis=4) == pytest.approx(1.0)


def test_meshes_leave_what_they_leave_of_the_table_solved_whole(tables):
    derived, solved = (table.curve_error[SOURCES.index("discretisation"), :2] for table in tables)
    assert derived == pytest.approx(solved, rel=0.35)


def test_a_table_by_derivatives_rises_with_load(tables):
    derived, _ = tables
    position = np.linspace(0.0, 323.0, 4001)[:, None]
    loads = np.geomspace(0.5 * derived.support_force[0], derived.force[-1], 40)
    assert np.all(np.diff(derived.ste(position, loads), axis=1) > 0.0)


def test_a_table_that_needs_many_pitches_says_why_all_were_solved(monkeypatch):
    monkeypatch.setattr(AnalysisOptions, "allowed", AllowedError(1e-4, 1e-11))
    monkeypatch.setattr(cost_of_derivatives, "TABLE_SAVES", 0.0)
    table = analyze(made(1.0), TableAxes(torques=[40.0], pitches=120), OPTIONS)
    assert "do not keep the tolerance" in table.metadata.receipt["cycle"]["reason"]
    assert np.isfinite(table.residuals).all()


def test_a_pitch_beyond_what_its_teeth_deviate_is_no_result(monkeypatch):
    """A curve that single teeth lift by more than they deviate fails, with the place and both numbers."""

    def lifted(*_):
        ste, solved, errors = solve(*_)
        ste[3, 5, 0] += 100e-6
        return ste, solved, errors

    solve = cycle_module._solved
    monkeypatch.setattr(cycle_module, "_solved", lifted)
    with pytest.raises(SolveError, match=r"lifting by single teeth: .* at position 3\.\d+, force .* bound"):
        deviating_cycle(made(1.0), AXES, OPTIONS)
