"""What turns with a gear: run-out, waves, flanks of teeth, against the closed forms of stiff teeth."""

import math
from dataclasses import replace

import numpy as np
import pytest
from analysis_requests import table_request

from fe_contact import analyze
from fe_contact.analysis.pairs.operating_points import operating_points
from fe_contact.analysis.pairs.pair_contact import pair_contact
from fe_contact.analysis.request.request_check import check_request
from fe_contact.contact.model import ContactModel, MeetingTeeth
from fe_contact.effects import EFFECTS, ContactScene, compose
from fe_contact.effects.tooth_deviations import sharpest_crest
from fe_contact.errors import InputError
from fe_contact.geometry import (
    FlankGrid,
    FlankModification,
    Gear,
    GearPair,
    InternalGearPair,
    PitchDeviation,
    RingGear,
    RunOut,
    ToothFlank,
    Wave,
)
from fe_contact.planning.plan import make_plan
from fe_contact.ste.spectrum import Spectrum

HELIX = math.radians(22.0)
AMPLITUDE, ANGLE = 2e-7, 0.7
PINION, WHEEL = 0, 1


def gear(teeth, hand=0, **changes):
    values = {"normal_module": 2e-3, "face_width": 30e-3, "bore_diameter": 20e-3} | changes
    return Gear(teeth=teeth, helix_angle=hand * HELIX, **values)


def pair_of(kind, index, **deviations):
    own = [deviations if index == each else {} for each in (PINION, WHEEL)]
    if kind == "internal":
        ring = RingGear(
            teeth=67, normal_module=2e-3, face_width=30e-3, rim_diameter=150e-3, tip_diameter=131e-3, **own[1]
        )
        return InternalGearPair(gear(23, **own[0]), ring)
    hand = 1 if kind == "helical" else 0
    return GearPair(gear(23, hand, **own[0]), gear(67, -hand, **own[1]), axial_offset=0.0)


def gaps(pair, position, face):
    """Gap of all teeth that stand at the path of contact, at positions (P,) and faces (F,) -> (P, J, F)."""
    model, _ = compose(ContactScene(pair, np.array([100.0]), EFFECTS), {})
    meeting = np.rint(position)[:, None] + np.arange(-2, 3)
    roll = pair.path_of_contact.pitch_point + (position[:, None] - meeting) * pair.base_pitch
    roll_1 = roll[:, :, None] - face * math.tan(pair.base_helix_angle)
    rolls = roll_1, pair.mating_roll_length(roll_1)
    return model.gap_of_teeth(MeetingTeeth(pair, meeting[:, :, None].astype(int), *rolls, face)), model


POSITION = np.linspace(0.0, 67.0, 335, endpoint=False)
FACE = np.linspace(-15e-3, 15e-3, 7)
TEETH = {PINION: 23, WHEEL: 67}


@pytest.mark.parametrize("kind", ["spur", "helical", "internal"])
@pytest.mark.parametrize("index", [PINION, WHEEL])
def test_an_eccentric_gear_moves_all_contacts_alike_by_its_turned_eccentricity(kind, index):
    """A rigid gear that stands off by e moves along the line of action by e cos(turn - angle)."""
    run_out = RunOut(eccentricity=5e-6, eccentricity_angle=ANGLE)
    found, model = gaps(pair_of(kind, index, run_out=run_out), POSITION, FACE)
    turn = 2.0 * math.pi * POSITION / TEETH[index]
    assert model.period == TEETH[index]
    assert np.abs(found + 5e-6 * np.cos(turn - ANGLE)[:, None, None]).max() < 1e-6 * 5e-6


@pytest.mark.parametrize("kind", ["spur", "helical", "internal"])
@pytest.mark.parametrize("index", [PINION, WHEEL])
def test_a_wobbling_gear_tilts_all_contacts_alike(kind, index):
    run_out = RunOut(wobble=5e-6, wobble_angle=ANGLE)
    found, _ = gaps(pair_of(kind, index, run_out=run_out), POSITION, FACE)
    turn = 2.0 * math.pi * POSITION / TEETH[index]
    tilt = 5e-6 * np.cos(turn - ANGLE)[:, None, None] * FACE / 30e-3
    assert np.abs(found + tilt).max() < 1e-6 * 5e-6


@pytest.mark.parametrize("kind", ["spur", "helical", "internal"])
@pytest.mark.parametrize("index", [PINION, WHEEL])
def test_a_wave_along_the_contact_lines_is_the_same_on_all_of_them(kind, index):
    """It does not average out: the flanks stand off by it at its own order."""
    found, _ = gaps(pair_of(kind, index, waves=(Wave(11, AMPLITUDE, ANGLE),)), POSITION, FACE)
    turn = 2.0 * math.pi * POSITION / TEETH[index]
    assert np.abs(found + AMPLITUDE * np.cos(11 * turn - ANGLE)[:, None, None]).max() < 1e-6 * AMPLITUDE


def test_a_wave_along_the_axis_averages_by_its_phase_over_a_contact_line():
    """Its mean over a line whose phase runs through n lead is sinc times the amplitude."""
    order, face = 40, np.linspace(-15e-3, 15e-3, 3001)
    pair = pair_of("helical", PINION, waves=(Wave(order, AMPLITUDE, face_waves=0.0),))
    found, _ = gaps(pair, POSITION[:40], face)
    mean = found.mean(axis=2)[:, 0]
    run = order * 30e-3 * math.tan(pair.base_helix_angle) / pair.pinion.base_radius
    turn = 2.0 * math.pi * POSITION[:40] / 23
    expected = -AMPLITUDE * math.sin(0.5 * run) / (0.5 * run) * np.cos(order * turn)
    assert np.abs(mean - expected).max() < 1e-3 * AMPLITUDE


def test_waves_of_the_contact_lines_are_those_of_so_many_over_the_face():
    pair = pair_of("helical", PINION, waves=(Wave(11, AMPLITUDE, ANGLE),))
    lead = 30e-3 * math.tan(pair.base_helix_angle) / pair.pinion.base_radius
    stated = pair_of("helical", PINION, waves=(Wave(11, AMPLITUDE, ANGLE, 11 * lead / (2 * math.pi)),))
    first, second = (gaps(each, POSITION, FACE)[0] for each in (pair, stated))
    assert np.abs(first - second).max() < 1e-12 * AMPLITUDE


def test_pairs_keep_their_gap_as_they_move_on():
    """What is pair j just below a whole pitch is pair j + 1 above it."""
    waves = (Wave(11, AMPLITUDE, ANGLE, 3.0), Wave(0, AMPLITUDE, 0.0, 2.0))
    pair = pair_of("helical", WHEEL, waves=waves, run_out=RunOut(1e-6, 0.2, 2e-6, 0.5))
    below, above = (gaps(pair, np.arange(1.5, 60.0) + by, FACE)[0] for by in (-1e-9, 0.0))
    assert np.abs(below[:, 1:] - above[:, :-1]).max() < 1e-6 * AMPLITUDE


@pytest.mark.parametrize(("orders", "period"), [((23,), 1), ((46, 69), 1), ((11,), 23), ((0,), 1)], ids=str)
def test_the_period_is_that_of_the_teeth_that_differ(orders, period):
    waves = tuple(Wave(order, AMPLITUDE, face_waves=1.0) for order in orders)
    assert gear(23, waves=waves).period == period


def test_a_gear_that_turns_back_shows_the_same_flanks_the_other_way():
    waves = (Wave(11, AMPLITUDE, ANGLE, 3.0),)
    pair = pair_of("helical", WHEEL, waves=waves, run_out=RunOut(1e-6, 0.2, 2e-6, 0.5))
    found, _ = gaps(pair, POSITION, FACE)
    turned, _ = gaps(pair.swapped(), -POSITION, FACE)
    assert np.abs(turned[:, ::-1] - found).max() < 1e-6 * AMPLITUDE


GRID = FlankGrid((3e-3, 9e-3, 40e-3), (-10e-3, 10e-3), ((2e-6, 0.0), (0.0, 1e-6), (3e-6, 5e-6)))

FINE = FlankGrid(*(np.linspace(1e-4, 9e-3, 120),) * 2, np.zeros((120, 120)))


def of_teeth(pair, index, own, face=FACE, position=POSITION):
    """Roll lengths and faces on one gear where all teeth touch, and the number of the tooth from 0."""
    meeting = np.rint(position)[:, None] + np.arange(-2, 3)
    roll = pair.path_of_contact.pitch_point + (position[:, None] - meeting) * pair.base_pitch
    roll_1 = roll[:, :, None] - face * math.tan(pair.base_helix_angle)
    rolls = roll_1, pair.mating_roll_length(roll_1)
    return *np.broadcast_arrays(rolls[index], face), meeting[:, :, None].astype(int) % own.teeth


@pytest.mark.parametrize("kind", ["spur", "helical", "internal"])
@pytest.mark.parametrize("index", [PINION, WHEEL])
@pytest.mark.parametrize(
    "deviation", [{"profile_slope": 3e-6}, {"helix_slope": -2e-6}, {"flank_grid": GRID}], ids=" ".join
)
def test_teeth_that_deviate_alike_are_a_modification(kind, index, deviation):
    """Where all teeth have it, the deviation removes what the modification of that name does."""
    own = {"flank_grid": GRID} if "flank_grid" in deviation else {k: -v for k, v in deviation.items()}
    flanks = tuple(ToothFlank(tooth, **deviation) for tooth in range(1, TEETH[index] + 1))
    pair = pair_of(kind, index, tooth_flanks=flanks)
    gear = (pair.pinion, pair.wheel)[index]
    found, model = gaps(pair, POSITION, FACE)
    roll, face, _ = of_teeth(pair, index, gear)
    assert model.period == 1
    designed = FlankModification(**own).material_removed(gear, roll, face)
    assert np.abs(found - designed).max() < 1e-6 * 1e-6


@pytest.mark.parametrize("index", [PINION, WHEEL])
def test_a_tooth_deviates_alone(index):
    """Slopes and forms of one tooth, in u and v from -1 to 1, and nothing on the others."""
    flank = ToothFlank(5, 3e-6, -1e-6, 0, 2e-6, 4e-6, 3)
    pair = pair_of("helical", index, tooth_flanks=(flank,))
    gear = (pair.pinion, pair.wheel)[index]
    found, model = gaps(pair, POSITION, FACE)
    roll, face, tooth = of_teeth(pair, index, gear)
    form, tip = gear.form_roll_length, gear.tip_roll_length
    u = np.clip((roll - 0.5 * (form + tip)) / (0.5 * (tip - form)), -1.0, 1.0)
    v = face / 15e-3
    excess = 1.5e-6 * u - 1e-6 * (1 / 3 - u**2) + 1e-6 * v + 2e-6 * np.cos(3 * math.pi * v)
    assert model.period == TEETH[index]
    assert np.abs(found + np.where(tooth == 4, excess, 0.0)).max() < 1e-6 * 1e-6


@pytest.mark.parametrize("waves", [0, 1, 4])
def test_a_form_deviation_has_its_height_and_leaves_slope_and_place(waves):
    """What an inspection splits off a profile comes back: the mean line of a form is zero."""
    pair = pair_of("spur", PINION, tooth_flanks=(ToothFlank(1, profile_form=2e-6, profile_form_waves=waves),))
    ends = pair.pinion.form_roll_length, pair.pinion.tip_roll_length
    roll = np.linspace(*ends, 20001)
    model, _ = compose(ContactScene(pair, np.array([100.0]), EFFECTS), {})
    shape = model.gap_of_teeth(
        MeetingTeeth(pair, np.array(0), roll, pair.mating_roll_length(roll), np.zeros(1))
    )
    slope, mean = np.polyfit(np.linspace(-1.0, 1.0, roll.size), shape, 1)
    assert np.ptp(shape) == pytest.approx(2e-6, rel=1e-6)
    assert abs(slope) < 1e-9 * 1e-3 and abs(mean) < 1e-9 * 1e-1


def test_single_pitches_add_up_and_close_the_circle():
    """The mean is taken out; the differences of the sum are the deviations that went in."""
    single = np.random.default_rng(4).normal(0.0, 3e-6, 23)
    found = PitchDeviation.of_single_pitches(single.tolist())
    assert found.individual == pytest.approx(single - single.mean(), rel=1e-12, abs=1e-18)
    assert found.cumulative[-1] == pytest.approx(0.0, abs=1e-18)
    assert PitchDeviation.of_single_pitches(found.individual).individual == pytest.approx(found.individual)
    assert PitchDeviation.of_single_pitches(()).neutral


def test_a_gear_that_turns_back_shows_the_same_teeth_in_the_other_order():
    flanks = tuple(ToothFlank(tooth, 1e-6 * tooth, helix_slope=1e-7 * tooth) for tooth in (1, 2, 5))
    pair = pair_of("helical", WHEEL, tooth_flanks=flanks)
    found, _ = gaps(pair, POSITION, FACE)
    turned, _ = gaps(pair.swapped(), -POSITION, FACE)
    assert np.abs(turned[:, ::-1] - found).max() < 1e-6 * 1e-6


@pytest.mark.parametrize(
    ("flanks", "field"),
    [
        ((ToothFlank(24, 1e-6),), "tooth_flanks[0].tooth"),
        ((ToothFlank(1, 1e-6), ToothFlank(1, 1e-6)), "tooth_flanks[1].tooth"),
        (
            (ToothFlank(1, flank_grid=replace(GRID, roll_length=(1.0, 1.1, 1.2))),),
            "tooth_flanks[0].flank_grid.roll_length",
        ),
        (
            (ToothFlank(1, flank_grid=replace(GRID, removed=((0.0, 0.0), (0.0, -1.01e-3), (0.0, 0.0)))),),
            "tooth_flanks[0].flank_grid.removed[1][1]",
        ),
        (tuple(ToothFlank(k, flank_grid=FINE) for k in range(1, 24)), "tooth_flanks"),
    ],
    ids=["no such tooth", "twice", "beside", "beyond half the module", "too many nodes"],
)
def test_flanks_of_no_tooth_are_refused(flanks, field):
    with pytest.raises(InputError) as caught:
        gear(23, tooth_flanks=flanks)
    assert caught.value.field == field


def test_a_plane_refuses_what_varies_along_the_face(tmp_path):
    pair = pair_of("spur", PINION, tooth_flanks=(ToothFlank(1, helix_slope=1e-6),))
    with pytest.raises(InputError) as caught:
        analyze(pair, torques=[100.0], level="draft", model="plane_strain", cache=tmp_path)
    assert caught.value.field == "pinion.tooth_flanks"


def test_nothing_named_adds_nothing():
    pair = pair_of("helical", PINION, run_out=RunOut(), waves=(Wave(11, 0.0),), tooth_flanks=(ToothFlank(3),))
    model, ledger = compose(ContactScene(pair, np.array([100.0]), EFFECTS), {})
    assert model.tooth_gaps == ContactModel().tooth_gaps
    (entry,) = [entry for entry in ledger if entry.name == "tooth_deviations"]
    assert entry.verdict.neutral


def test_the_verdict_states_the_amounts_and_the_period():
    flanks = (ToothFlank(2), ToothFlank(3, profile_slope=4e-6))
    own = {"waves": (Wave(11, 5e-7),), "run_out": RunOut(eccentricity=1e-5), "tooth_flanks": flanks}
    pair = pair_of("helical", PINION, **own)
    _, ledger = compose(ContactScene(pair, np.array([100.0]), EFFECTS), {})
    (entry,) = [entry for entry in ledger if entry.name == "tooth_deviations"]
    assert entry.verdict.reason == (
        "pinion eccentricity 10 µm, 11 waves 0.5 µm, flanks of 1 of 23 teeth up to 2 µm, over 23 base pitches"
    )


def test_orders_are_named_by_what_turns():
    orders = np.array([1 / 23, 11 / 23, 22 / 23, 1.0, 24 / 23, 66 / 67, 5 / 67, 2.0, 1 / 23 + 1 / 67])
    lines = Spectrum(orders, orders, orders, 0.0, (23, 67))
    assert lines.names == (
        "pinion 1", "pinion 11", "mesh 1 - pinion 1", "mesh 1", "mesh 1 + pinion 1", "mesh 1 - wheel 1",
        "wheel 5", "mesh 2", "mesh 0.0584",
    )  # fmt: skip


@pytest.fixture(scope="module")
def solved(tmp_path_factory):
    """STE (23 pitches x 8 positions, 2 loads) of a plane pair in m."""
    cache, position = tmp_path_factory.mktemp("compliance"), np.arange(8) / 8

    def solve(pair, position=position, pitches=23):
        request = table_request(torques=(1e-3, 100.0), level="draft", effects={"corner_contact": "off"})
        checked = check_request(pair, *request, check_size=False)
        plan = make_plan(pair, checked.request.load, checked.request.options, checked.model)
        contact = pair_contact(pair, plan, cache)
        (place,) = operating_points(checked.request.scene, checked.request.choices, contact).places
        solution = place.solve(position, plan.load, np.repeat(np.arange(pitches), position.size))[1]
        assert solution.converged
        return solution.deflection.reshape(pitches * position.size, -1)

    return solve


@pytest.fixture(scope="module")
def plain(solved):
    return solved(pair_of("spur", PINION))


TURN = 2.0 * math.pi * np.arange(23 * 8) / (23 * 8)


def test_under_any_load_an_eccentric_gear_adds_its_turned_eccentricity(solved, plain):
    """All contacts on the line of action stand off alike: the loads stay, the gears run ahead by it."""
    run_out = RunOut(eccentricity=1e-7, eccentricity_angle=ANGLE)
    found = solved(pair_of("spur", PINION, run_out=run_out))
    assert np.abs(found - plain + 1e-7 * np.cos(TURN - ANGLE)[:, None]).max() < 1e-3 * 1e-7


def test_under_light_load_a_tooth_that_stands_out_is_followed(solved):
    """Early by its pitch it carries alone: the STE is its flank as it passes, and that of the others none."""
    early = PitchDeviation(tuple(np.where(np.arange(23) == 5, 5e-6, 0.0)))
    flank = ToothFlank(6, profile_slope=2e-7, profile_form=-1e-7)
    plain, shaped = (
        solved(pair_of("spur", PINION, pitch_deviation=early, tooth_flanks=flanks))[:, 0].reshape(23, -1)
        for flanks in ((), (flank,))
    )
    pair = pair_of("spur", PINION)
    position = np.arange(-4, 4) / 8
    roll = pair.path_of_contact.pitch_point + position * pair.base_pitch
    u = (
        2.0
        * (roll - pair.pinion.form_roll_length)
        / (pair.pinion.tip_roll_length - pair.pinion.form_roll_length)
        - 1.0
    )
    change = (shaped - plain).ravel()[5 * 8 - 4 : 5 * 8 + 4]
    assert np.abs(change + 1e-7 * u - 1e-7 * (1 / 3 - u**2)).max() < 2e-3 * 1e-7
    assert np.abs((shaped - plain)[8:]).max() == 0.0


@pytest.mark.parametrize("order", [11, 23 + 11])
def test_a_wave_is_a_ghost_order_of_its_amplitude(solved, plain, order):
    """Absent from the mesh orders; under load the strip averages over its width, (k a)^2/8 of the wave."""
    found = solved(pair_of("spur", PINION, waves=(Wave(order, AMPLITUDE),)))
    light, heavy = 2.0 / TURN.size * np.abs(np.fft.rfft(found - plain, axis=0)).T
    assert light[order] == pytest.approx(AMPLITUDE, rel=5e-3)
    assert 0.9 * AMPLITUDE < heavy[order] < AMPLITUDE
    for lines in (light, heavy):
        assert np.delete(lines, [0, order]).max() < 2e-2 * AMPLITUDE


def test_pitches_at_random_have_the_orders_of_their_sequences(solved):
    """One pair of teeth in contact: each gear's orders are its teeth's, and nothing else holds energy."""
    own = [np.random.default_rng(seed).normal(0.0, 2e-6, count) for seed, count in enumerate((23, 67))]
    sequences = [each - each.mean() for each in own]
    deviations = [{"pitch_deviation": PitchDeviation(tuple(each))} for each in sequences]
    pair = GearPair(gear(23, **deviations[PINION]), gear(67, **deviations[WHEEL]), axial_offset=0.0)
    cycle, pitch_point = 23 * 67, np.zeros(1)
    transverse = math.cos(pair.pinion.transverse_pressure_angle)
    found = solved(pair, pitch_point, cycle)[:, 0] - solved(pair_of("spur", PINION), pitch_point)[0, 0]
    lines = np.fft.rfft(found) / cycle
    expected = np.zeros(lines.size, dtype=complex)
    for sequence, other in zip(sequences, (67, 23), strict=True):
        teeth = np.fft.rfft(sequence) / sequence.size
        expected[: other * teeth.size : other] -= transverse * teeth
    assert np.abs(lines - expected).max() < 1e-9 * np.abs(expected).max()
    energy = transverse**2 * sum(np.mean(each**2) for each in sequences)
    assert np.mean(found**2) == pytest.approx(energy, rel=1e-9)


@pytest.mark.parametrize(("order", "holds"), [(11, True), (400, False)])
def test_waves_more_curved_than_the_flanks_are_told(tmp_path, order, holds):
    """The trough of such a wave touches at two places, which one touching point cannot hold."""
    pair = pair_of("spur", PINION, waves=(Wave(order, AMPLITUDE),))
    path = pair.path_of_contact
    bend = AMPLITUDE * order**2 / path.start**2 / pair.relative_curvature(path.start)
    assert sharpest_crest(pair) == pytest.approx(float(bend), rel=1e-12)
    found = analyze(pair, torques=[100.0], level="draft", positions=16, cache=tmp_path).metadata.receipt
    (entry,) = [each for each in found["assumptions"] if each["assumption"] == "flanks touch in one place"]
    assert entry["holds"] is holds


@pytest.mark.parametrize(("height", "holds"), [(3e-6, False), (3e-8, True)])
def test_a_trace_more_hollow_than_the_flanks_is_told(height, holds):
    """Two crests a strip apart hold the mate off what is between them, unless they are very low."""
    plain = pair_of("spur", WHEEL).wheel
    ends = plain.form_roll_length, plain.tip_roll_length
    crests = np.where(np.isin(np.arange(61), (30, 32)), -height, 0.0)
    surface = FlankGrid(tuple(np.linspace(*ends, 61)), (-15e-3, 15e-3), tuple((v, v) for v in crests))
    pair = pair_of("spur", WHEEL, tooth_flanks=(ToothFlank(1, flank_grid=surface),))
    assert (sharpest_crest(pair) < 0.75) is holds
