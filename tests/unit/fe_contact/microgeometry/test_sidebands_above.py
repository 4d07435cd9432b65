"""Orders beside the mesh of pairs as made: what one tooth does, and which pairs are above a limit."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from fe_contact import Gear, GearPair, RunOut, analyze
from fe_contact.errors import InputError
from fe_contact.geometry.flank_tolerances import (
    cumulative_pitch_tolerance,
    run_out_tolerance,
    single_pitch_tolerance,
)
from fe_contact.microgeometry.design_study import design_study
from fe_contact.microgeometry.drawn_teeth import (
    FLANK,
    PITCH,
    RUN_OUT,
    WOBBLE,
    DrawnTeeth,
    PitchBounds,
    ToothTolerances,
    iso1328_tooth_tolerances,
)
from fe_contact.microgeometry.evaluator import Evaluator
from fe_contact.microgeometry.order_limit import OrderLimit
from fe_contact.microgeometry.scatter import ONE_NODE
from fe_contact.microgeometry.sidebands_above import MadePairs, ToothPassing, lines_of_pairs
from fe_contact.microgeometry.tolerance_study import (
    Sampling,
    ToleranceRequest,
    ToleranceStudy,
    sampled,
    scatter,
)
from fe_contact.microgeometry.tolerances import Tolerances, iso1328_tolerances
from fe_contact.options import AnalysisOptions, Run
from lineofaction.gearbox.studies.scatter.run import order_limit
from model_studies.stage_clock import StageClock

PINION, WHEEL = (Gear(z, normal_module=3e-3, face_width=20e-3, bore_diameter=20e-3) for z in (19, 28))
PAIR = GearPair(PINION, WHEEL)
TORQUES, POSITIONS = [100.0, 200.0], 16
OPTIONS = AnalysisOptions(level="draft", model="plane_strain", effects={"corner_contact": "off"})
ALIKE = Tolerances(0.0, {"pinion.profile_slope": 1e-6})
SIDEBAND = OrderLimit(1, 1e-7, "pinion", -1)
TEETH = iso1328_tooth_tolerances(PAIR, "pinion", 6, across_face=False, finishing="hobbing")
KINDS = [name for name in TEETH.widths if name != RUN_OUT]


@pytest.fixture(scope="module")
def designed():
    request = ToleranceRequest(PAIR, TORQUES, ALIKE, Sampling(positions=POSITIONS), OPTIONS, 0.0)
    study = design_study(request.space, TORQUES, [], StageClock(), Run(), request.checked)
    return replace(study.evaluator, nodes=ONE_NODE)


def solved(designed: Evaluator, gear: str, drawn: DrawnTeeth, line: int) -> Any:
    count = len(drawn.by_axis[RUN_OUT])
    return lines_of_pairs(MadePairs(designed, (), np.zeros((count, 0)), gear, drawn), (line, range(count)))


def only(drawn: DrawnTeeth, names: Sequence[str], scale: float) -> DrawnTeeth:
    by_tooth = {name: values * scale * (name in names) for name, values in drawn.by_tooth.items()}
    by_axis = {name: values * scale * (name in names) for name, values in drawn.by_axis.items()}
    return DrawnTeeth(by_axis, by_tooth)


@pytest.mark.parametrize("gear", ["pinion", "wheel"])
@pytest.mark.parametrize("name", [*KINDS, RUN_OUT])
def test_small_deviations_make_orders_as_told_to_first_order(designed, gear, name):
    """Amplitude and phase of shaft order and sidebands, by each deviation alone, against all pitches solved.

    A slope also moves the point at which teeth touch along the flank, which is left out.
    """
    teeth = replace(TEETH, gear=gear, teeth=getattr(PAIR, gear).teeth)
    drawn = only(teeth.drawn(1, seed=2), [name], 1e-4)
    limits = (OrderLimit(0, 1e-6, gear, 1), OrderLimit(1, 1e-6, gear, -1), OrderLimit(2, 1e-6, gear, 3))
    told = [ToothPassing.of(designed, limit, KINDS).lines(drawn).sum(axis=0) for limit in limits]
    found = [solved(designed, gear, drawn, limit.line(PAIR)) for limit in limits]
    scale = np.abs(found).max()
    assert scale > 1e-12
    left_out = 0.02 if name.startswith(FLANK) else 1e-3
    np.testing.assert_allclose(told, found, atol=left_out * scale, rtol=0.0)


@pytest.mark.parametrize("gear", ["pinion", "wheel"])
def test_wobble_makes_orders_where_the_load_is_off_mid_face(gear):
    """Against all pitches solved, 1e-2; none of an even spur pair, whose load stays at mid-face.

    Two turns beside a mesh order it makes none.
    """
    pair = GearPair(*(replace(own, face_width=10e-3) for own in (PINION, WHEEL)))
    scale = {}
    for misalignment in (0.0, 3e-5):
        sampling, options = Sampling(positions=POSITIONS), replace(OPTIONS, model="3d")
        request = ToleranceRequest(pair, [100.0], ALIKE, sampling, options, misalignment)
        study = design_study(request.space, [100.0], [], StageClock(), Run(), request.checked)
        nominal = replace(study.evaluator, nodes=ONE_NODE)
        teeth = ToothTolerances(gear, getattr(pair, gear).teeth, {RUN_OUT: 1e-6, WOBBLE: 1e-7, PITCH: 1e-6})
        drawn = only(teeth.drawn(1, seed=2), [WOBBLE], 1e-2)
        assert drawn.by_axis[WOBBLE][0] != 0.0
        limits = [OrderLimit(order, 1e-6, gear, turns) for order, turns in ((0, 1), (1, -1), (1, 1), (1, 2))]
        told = np.array(
            [ToothPassing.of(nominal, one, [PITCH]).lines(drawn).sum(axis=0)[0] for one in limits]
        )
        found = np.array([solved(nominal, gear, drawn, one.line(pair))[0] for one in limits])
        scale[misalignment] = np.abs(told).max() / np.abs(drawn.by_axis[WOBBLE][0])
        largest = np.abs(drawn.by_axis[WOBBLE][0]) * 0.1
        np.testing.assert_allclose(told, found, atol=1e-2 * max(np.abs(told).max(), 0.01 * largest), rtol=0.0)
    assert scale[0.0] < 1e-6 and scale[3e-5] > 0.01


def test_the_mate_changes_an_order_by_squares_alone(designed):
    """A sideband of the pinion is that of its own teeth: small deviations of the wheel leave it."""
    drawn = only(TEETH.drawn(1, seed=2), [PITCH], 1e-3)
    mate = iso1328_tooth_tolerances(PAIR, "wheel", 6, across_face=False).drawn(1, seed=4)
    wheel = replace(WHEEL, **only(mate, [PITCH], 1e-3).fields(0))
    both = replace(designed, contact=replace(designed.contact, pair=replace(PAIR, wheel=wheel)))
    line = SIDEBAND.line(PAIR)
    alone = solved(designed, "pinion", drawn, line)
    cycle = solved(both, "pinion", drawn, line * WHEEL.teeth)
    np.testing.assert_allclose(cycle, alone, atol=1e-2 * np.abs(alone).max(), rtol=0.0)


@pytest.mark.law
@pytest.mark.parametrize("teeth", [12, 23, 67])
@pytest.mark.parametrize("distribution", ["normal", "uniform"])
def test_pitches_of_teeth_that_are_out_of_center_are_within_the_class(teeth, distribution):
    gear = replace(PINION, teeth=teeth, profile_shift_coefficient=0.3, bore_diameter=5e-3)
    tolerances = iso1328_tooth_tolerances(
        replace(PAIR, pinion=gear, center_distance=None), "pinion", 6, distribution=distribution
    )
    drawn = tolerances.drawn(2000, seed=3)
    turning = np.exp(2j * np.pi * np.arange(teeth) / teeth) / np.cos(gear.transverse_pressure_angle)
    place = drawn.made[PITCH] + np.real(np.outer(drawn.by_axis[RUN_OUT], turning))
    for tolerance, found in (
        (single_pitch_tolerance, np.abs(place - np.roll(place, 1, axis=1)).max(axis=1)),
        (cumulative_pitch_tolerance, np.ptp(place, axis=1)),
        (run_out_tolerance, 2.0 * np.abs(drawn.by_axis[RUN_OUT])),
    ):
        assert 0.9 < found.max() / tolerance(gear, 6) <= 1.0 + 1e-12, tolerance.__name__


@pytest.mark.law
@pytest.mark.parametrize("teeth", [18, 23])
def test_pitches_that_accumulate_keep_their_single_ones(teeth):
    """The mean square of a single pitch is that of teeth each out of place by itself, less 1/z of the part.

    Where all of a pitch accumulates, neighboring pitches are as independent as a closed circle lets them be;
    in any case two teeth correlate by how far they are apart alone.
    """
    own = np.random.default_rng(5).normal(size=(20_000, teeth))
    for accumulated in (0.0, 0.3, 1.0):
        bounds = replace(PitchBounds.of(PINION, 6), accumulated=accumulated)
        place = bounds.places(own)
        step = place - np.roll(place, 1, axis=1)
        assert np.mean(step**2) == pytest.approx(2.0 * (1.0 - accumulated / teeth), rel=0.01)
        np.testing.assert_allclose(step.sum(axis=1), 0.0, atol=1e-10)
        np.testing.assert_allclose(
            bounds.places(np.roll(own[:3], 4, axis=1)), np.roll(place[:3], 4, axis=1), atol=1e-12
        )
        if accumulated == 1.0:
            correlated = np.corrcoef(step.T)[0, 1:]
            np.testing.assert_allclose(correlated, -1.0 / (teeth - 1), atol=0.03)
            assert np.mean(np.ptp(place, axis=1)) > 2.0 * np.mean(np.ptp(own, axis=1)) / np.sqrt(teeth)


def test_two_drawings_of_one_sequence_are_independent():
    """Teeth that follow others' dimensions have nothing to do with them, nor with the flanks in common."""
    first, second = TEETH.drawn(512, 1), TEETH.drawn(512, 1, after=TEETH.dimensions)
    slope = ALIKE.sample(512, 1)[:, 0]
    after = TEETH.drawn(512, 1, after=1)
    for name in KINDS:
        for values, others in (
            (first.by_tooth[name].T, second.by_tooth[name].T),
            (after.by_tooth[name].T, [slope]),
        ):
            correlated = [np.corrcoef(a, b)[0, 1] for a, b in zip(values, others, strict=False)]
            assert np.sqrt(np.mean(np.square(correlated))) < 1.5 / np.sqrt(512.0)
    axis = np.corrcoef(np.abs(after.by_axis[RUN_OUT]), slope)[0, 1]
    assert abs(axis) < 0.02, "a sequence fills a plane more evenly than chance does"


def test_teeth_are_within_their_class():
    for distribution in ("normal", "uniform"):
        drawn = replace(TEETH, distribution=distribution).drawn(200, seed=1)
        pitches = drawn.by_tooth[PITCH]
        single = np.abs(pitches - np.roll(pitches, 1, axis=1)).max()
        assert 0.5 < single / single_pitch_tolerance(PINION, 6) <= 1.0
        assert 0.9 < 2.0 * np.abs(drawn.by_axis[RUN_OUT]).max() / run_out_tolerance(PINION, 6) <= 1.0
        for name, values in drawn.by_tooth.items():
            assert 0.95 < np.abs(values).max() / TEETH.widths[name] <= 1.0
            correlated = np.corrcoef(values.T) - np.eye(PINION.teeth)
            assert np.sqrt(np.mean(correlated**2)) < 1.2 / np.sqrt(200.0)  # no more than chance
        assert abs(np.exp(1j * np.angle(drawn.by_axis[RUN_OUT])).mean()) < 0.02
    first, more = TEETH.drawn(3, seed=1), TEETH.drawn(9, seed=1)
    np.testing.assert_array_equal(first.by_tooth[PITCH], more.by_tooth[PITCH][:3])


def test_what_all_teeth_have_in_common_is_not_drawn_twice():
    """Squares of the part in common and of the rest add up to the tolerance; all of it in common: no rest."""
    every = iso1328_tooth_tolerances(PAIR, "wheel", 6, across_face=True)
    assert set(every.widths) == {RUN_OUT, PITCH}
    hobbed = iso1328_tooth_tolerances(PAIR, "wheel", 6, finishing="hobbing")
    common = iso1328_tolerances(PAIR, 6, finishing="hobbing")
    whole = iso1328_tolerances(PAIR, 6)
    for name in ("profile_slope", "profile_form", "helix_slope", "helix_form"):
        parts = [common.widths[f"wheel.{name}"], hobbed.widths[FLANK + name]]
        parts += [hobbed.widths[WOBBLE]] * (name == "helix_slope")
        assert np.linalg.norm(parts) == pytest.approx(whole.widths[f"wheel.{name}"])


def study_of(limit: OrderLimit, teeth: ToothTolerances = TEETH) -> ToleranceStudy:
    sampling = Sampling(samples=500, seed=3, positions=POSITIONS, exact=40)
    return sampled(ToleranceRequest(PAIR, TORQUES, ALIKE, sampling, OPTIONS, 0.0, limit, teeth), Run())


@pytest.fixture(scope="module")
def above():
    found = study_of(SIDEBAND).above
    assert found is not None
    return found


def test_a_limit_beside_the_mesh_counts_pairs_solved_over_a_revolution(above):
    np.testing.assert_array_equal(above.share, (above.amplitude > SIDEBAND.amplitude).mean(axis=0))
    assert above.amplitude.shape == (500, 2) and 0.0 < above.share.max() < 1.0
    assert np.all((above.low <= above.share) & (above.share <= above.high))
    assert np.all(above.missed < 0.05 * np.median(above.amplitude, axis=0))
    assert np.all(above.beyond < 0.1)
    # a pair as made, whole: its order is that of the table
    drawn = TEETH.drawn(500, 3, after=1)
    slope = {"profile_slope": float(ALIKE.sample(1, 3)[0, 0])}
    pinion = replace(PINION, modification=replace(PINION.modification, **slope), **drawn.fields(0))
    effects = {"corner_contact": "off", "profile_modification": "on"}
    wish = {"level": "draft", "model": "plane_strain", "positions": POSITIONS, "receipt": "minimal"}
    table = analyze(replace(PAIR, pinion=pinion), torques=TORQUES, effects=effects, **wish)
    curve = table.static_transmission_error[:, :, 0, 0]
    line = 2.0 * np.abs(np.fft.fft(curve, axis=0)[SIDEBAND.line(PAIR)]) / len(curve)
    np.testing.assert_allclose(above.amplitude[0], line, rtol=1e-9)


def test_what_decides_of_an_order_is_what_makes_it(above):
    """Run-out makes the first order of a shaft, by its amount; pitches and flanks a sideband."""
    assert above.names == TEETH.names and above.total[0] == above.first_order[0] == 0.0
    # a smaller run-out leaves pitches more room in their class
    assert (
        above.cured[0] == pytest.approx(above.share[above.load], abs=0.02)
        and above.cured[0] > above.cured.min()
    )
    turning = study_of(OrderLimit(0, 4e-6, "pinion", 1)).above
    assert turning.decides == turning.cure == 0 and turning.total[0] > 0.9
    eccentric = np.abs(TEETH.drawn(500, 3, after=1).by_axis[RUN_OUT])
    # pitches that accumulate have a part in it
    np.testing.assert_allclose(turning.amplitude[:, 0], eccentric, atol=5e-6)
    # with the tolerance of a class finer, drawn anew
    finer = replace(TEETH, widths={**TEETH.widths, RUN_OUT: TEETH.widths[RUN_OUT] / np.sqrt(2.0)})
    other = study_of(turning.limit, finer).above
    assert other is not None and turning.share[turning.load] > 0.1
    assert other.share[turning.load] == pytest.approx(turning.cured[0], abs=0.01)


@pytest.mark.parametrize(
    ("changes", "limit", "field"),
    [
        ({}, OrderLimit(1, 1e-6, "pinion", 10), "limit.turns"),  # 19 teeth: 10 is nearer to mesh order 2
        ({}, OrderLimit(1, 1e-6, "wheel", 0), "limit.turns"),
        ({}, OrderLimit(0, 1e-6, "wheel", -1), "limit.turns"),
        ({}, OrderLimit(8, 1e-6, "pinion", 1), "limit.order"),
        ({"run_out": RunOut(1e-6)}, SIDEBAND, "limit.gear"),
    ],
)
def test_orders_that_drawn_teeth_cannot_make_are_refused(changes, limit, field):
    pair = replace(PAIR, wheel=replace(WHEEL, **changes))
    with pytest.raises(InputError) as refused:
        limit.check(pair, POSITIONS)
    assert refused.value.field == field


def test_teeth_that_are_alike_make_no_sideband():
    with pytest.raises(InputError, match="teeth are alike"):
        scatter(PAIR, TORQUES, ALIKE, Sampling(positions=POSITIONS), OPTIONS, limit=SIDEBAND)


@pytest.mark.parametrize(
    ("text", "limit", "name"),
    [
        ("1 = 500 nm", OrderLimit(1, 5e-7), "mesh 1"),
        ("1-pinion=80nm", OrderLimit(1, 8e-8, "pinion", -1), "mesh 1 - pinion 1"),
        ("mesh 2 + wheel 3=0dB", OrderLimit(2, 1e-6, "wheel", 3), "mesh 2 + wheel 3"),
        ("pinion 11=0.2um", OrderLimit(0, 2e-7, "pinion", 11), "pinion 11"),
    ],
)
def test_limits_are_written_as_orders_are_named(text, limit, name):
    found = order_limit(text)
    assert (found.order, found.gear, found.turns) == (limit.order, limit.gear, limit.turns)
    assert found.amplitude == pytest.approx(limit.amplitude) and found.name == name
