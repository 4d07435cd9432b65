"""Modified flanks, free-form flanks and pitch deviations: amounts, places, sums."""

import math
from collections.abc import Callable
from dataclasses import asdict, fields, replace

import numpy as np
import pytest
from spur_gears import GEAR, make_gear

from bounds import DEPTHS, Direction, Kind
from fe_contact import FlankGrid, FlankModification, Gear, GearPair, PitchDeviation, RingGear, ToothFlank
from fe_contact.errors import InputError
from fe_contact.flank.modification import FLANK_FIELDS, fields_of


def over_profile(gear: Gear, count: int = 201) -> np.ndarray:
    return np.linspace(gear.form_roll_length, gear.tip_roll_length, count)


def test_neutral_modification_is_exactly_zero():
    gear = make_gear()
    assert FlankModification().neutral
    removed = FlankModification().material_removed(gear, over_profile(gear), 0.01)
    assert removed.tobytes() == np.zeros(201).tobytes()
    # a length without an amount is neutral as well
    assert FlankModification(tip_relief_length=1e-3).neutral
    lengths = FlankModification(tip_relief_length=1e-3, root_relief_length=1e-3, end_relief_length=1e-3)
    assert not np.any(lengths.material_removed(gear, over_profile(gear), 0.0125))


@pytest.mark.parametrize("shape", ["linear", "parabolic"])
def test_reliefs_reach_their_amounts_at_tip_root_and_both_ends(shape):
    gear = make_gear()
    relief = FlankModification(tip_relief=20e-6, tip_relief_length=1.5e-3, tip_relief_shape=shape)
    start, tip = gear.roll_length(gear.tip_radius - 1.5e-3), gear.tip_roll_length
    removed = relief.material_removed(gear, [gear.form_roll_length, start, 0.5 * (start + tip), tip])
    middle = 10e-6 if shape == "linear" else 5e-6
    assert removed == pytest.approx([0.0, 0.0, middle, 20e-6], rel=1e-12, abs=1e-18)
    relief = FlankModification(root_relief=8e-6, root_relief_length=1e-3, root_relief_shape=shape)
    start, form = gear.roll_length(gear.form_radius + 1e-3), gear.form_roll_length
    removed = relief.material_removed(gear, [form, 0.5 * (start + form), start, gear.tip_roll_length])
    middle = 4e-6 if shape == "linear" else 2e-6
    assert removed == pytest.approx([8e-6, middle, 0.0, 0.0], rel=1e-12, abs=1e-18)
    relief = FlankModification(end_relief=12e-6, end_relief_length=2e-3, end_relief_shape=shape)
    face = np.array([-12.5e-3, -11.5e-3, -10.5e-3, 0.0, 10.5e-3, 11.5e-3, 12.5e-3])
    middle = 6e-6 if shape == "linear" else 3e-6
    removed = relief.material_removed(make_gear(), 0.012, face)
    assert removed == pytest.approx([12e-6, middle, 0.0, 0.0, 0.0, middle, 12e-6], rel=1e-9, abs=1e-18)


def test_crownings_and_slopes_over_profile_and_face():
    gear = make_gear()
    removed = FlankModification(profile_crowning=6e-6).material_removed(gear, over_profile(gear, 5))
    assert removed == pytest.approx([6e-6, 1.5e-6, 0.0, 1.5e-6, 6e-6], abs=1e-18)
    removed = FlankModification(profile_slope=10e-6).material_removed(gear, over_profile(gear, 5))
    assert removed == pytest.approx([-5e-6, -2.5e-6, 0.0, 2.5e-6, 5e-6], abs=1e-18)
    gear, roll = make_gear(), 0.012
    face = np.array([-12.5e-3, -6.25e-3, 0.0, 6.25e-3, 12.5e-3])
    crowned = FlankModification(helix_crowning=8e-6).material_removed(gear, roll, face)
    assert crowned == pytest.approx([8e-6, 2e-6, 0.0, 2e-6, 8e-6], abs=1e-18)
    sloped = FlankModification(helix_slope=8e-6).material_removed(gear, roll, face)
    assert sloped == pytest.approx([-4e-6, -2e-6, 0.0, 2e-6, 4e-6], abs=1e-18)


@pytest.mark.parametrize("form", ["profile_form", "helix_form"])
def test_a_form_of_all_teeth_is_that_of_each(form):
    """What a flank lacks is what a tooth of the same form has in excess; the mean line is zero."""
    gear = make_gear()
    roll, face = over_profile(gear, 201)[:, None], np.linspace(-12.5e-3, 12.5e-3, 201)
    hollow = FlankModification(**{form: -3e-6})
    removed = hollow.material_removed(gear, roll, face)
    tooth = ToothFlank(1, **{form: -3e-6})
    assert removed == pytest.approx(-tooth.excess(gear, roll, face), rel=1e-12, abs=1e-20)
    assert removed.max() == pytest.approx(1e-6) and removed.min() == pytest.approx(-2e-6)
    even = 0.5 * (removed[1:, 1:] + removed[:-1, :-1])
    assert abs(even.mean()) < 1e-10


def test_twist_is_a_profile_slope_that_grows_along_the_face():
    gear = make_gear()
    twisted = FlankModification(flank_twist=4e-6)
    roll, face = over_profile(gear, 5)[:, None], np.linspace(-12.5e-3, 12.5e-3, 3)
    removed = twisted.material_removed(gear, roll, face)
    across = np.linspace(-1.0, 1.0, 5)
    assert removed == pytest.approx(4e-6 * np.outer(across, [-1.0, 0.0, 1.0]), rel=1e-12, abs=1e-20)
    end = FlankModification(profile_slope=8e-6).material_removed(gear, roll, 0.0)
    assert removed[:, 2:] == pytest.approx(end, rel=1e-12, abs=1e-20)
    beyond = twisted.material_removed(gear, [0.0, 1.0], 12.5e-3)
    assert beyond == pytest.approx([-4e-6, 4e-6], rel=1e-12, abs=0.0)


def test_parts_over_profile_and_face_add_up_to_all():
    gear = make_gear()
    whole = FlankModification(
        tip_relief=20e-6, tip_relief_length=1e-3, profile_slope=3e-6, helix_crowning=5e-6, flank_twist=4e-6
    )
    roll, face = over_profile(gear, 9)[:, None], np.linspace(-12.5e-3, 12.5e-3, 5)
    parts = [part.material_removed(gear, roll, face) for part in (whole.along_profile, whole.along_face)]
    assert sum(parts) == pytest.approx(whole.material_removed(gear, roll, face), rel=1e-12, abs=1e-20)
    assert np.all(np.ptp(parts[0], axis=1) == 0.0)
    assert not whole.along_profile.varies_along_face


def test_beyond_the_involute_the_end_value_holds():
    gear = make_gear()
    relief = FlankModification(
        tip_relief=20e-6, tip_relief_length=1e-3, root_relief=5e-6, root_relief_length=1e-3
    )
    removed = relief.material_removed(gear, [0.0, 2.0 * gear.tip_roll_length])
    assert removed == pytest.approx([5e-6, 20e-6])
    curved = FlankModification(profile_crowning=6e-6, profile_slope=2e-6)
    removed = curved.material_removed(gear, [0.0, 2.0 * gear.tip_roll_length])
    assert removed == pytest.approx([5e-6, 7e-6])


def alone(name: str) -> FlankModification:
    """Return the modification of one depth as its declaration has it, over its length if it needs one."""
    length = f"{name}_length"
    names = [name, length] if length in FLANK_FIELDS else [name]
    return FlankModification(**{each: FLANK_FIELDS[each].example for each in names})


@pytest.mark.parametrize("name", fields_of(*DEPTHS, Kind.EDGE))
def test_a_figure_acts_along_what_it_is_declared_to(name):
    gear, modification, along = make_gear(helix_angle=0.2), alone(name), FLANK_FIELDS[name].along
    roll, face = over_profile(gear)[:, None], np.linspace(-12.5e-3, 12.5e-3, 5)
    removed = modification.material_removed(gear, roll, face)
    assert bool(np.ptp(removed, axis=0).max() > 0.0) == (Direction.PROFILE in along)
    assert bool(np.ptp(removed, axis=1).max() > 0.0) == (Direction.FACE in along)
    assert modification.varies is along
    assert modification.along_face.neutral == (Direction.FACE not in along)
    assert modification.along_profile.neutral == (Direction.FACE in along)


def test_the_whole_is_the_sum_of_its_parts_and_begins_where_they_do():
    gear = make_gear(helix_angle=0.2)
    parts = [alone(name) for name in (*fields_of(*DEPTHS), "tip_rounding")]
    plain = FlankModification()
    facts = [(f.name, getattr(part, f.name)) for part in parts for f in fields(part)]
    whole = FlankModification(**{name: value for name, value in facts if value != getattr(plain, name)})
    roll, face = over_profile(gear, 41)[:, None], np.linspace(-12.5e-3, 12.5e-3, 5)
    apart = sum(part.material_removed(gear, roll, face) for part in parts)
    assert whole.material_removed(gear, roll, face) == pytest.approx(apart, rel=1e-12, abs=1e-20)
    assert set(map(repr, whole.relief_starts(gear))) == {
        repr(start) for part in parts for start in part.relief_starts(gear)
    }
    (edge,) = [start for start in whole.relief_starts(gear) if start.ends_flank]
    assert whole.tip_form_roll_length(gear) == edge.roll_length < gear.tip_roll_length


ROLL = (4e-3, 7e-3, 9e-3, 14e-3, 19e-3)
FACE = (-12.5e-3, -9e-3, -2e-3, 4e-3, 12.5e-3)
NODES = FlankGrid(ROLL, FACE, 1e-6 * np.random.default_rng(7).uniform(-5.0, 20.0, (5, 5)))


def sampled(function: Callable[[np.ndarray, np.ndarray], np.ndarray]) -> FlankGrid:
    """Return the grid of a function of roll length and face position."""
    return FlankGrid(ROLL, FACE, function(np.array(ROLL)[:, None], np.array(FACE)) + np.zeros((5, 5)))


def inside(count: int = 41) -> tuple[np.ndarray, np.ndarray]:
    roll, face = np.linspace(ROLL[0], ROLL[-1], count), np.linspace(FACE[0], FACE[-1], count)
    return tuple(np.meshgrid(roll, face, indexing="ij"))


def test_nodes_are_met_with_continuous_slopes_and_end_values_hold_beyond():
    roll, face = np.meshgrid(ROLL, FACE, indexing="ij")
    assert NODES.material_removed(roll, face) == pytest.approx(np.array(NODES.removed), rel=1e-12, abs=1e-20)
    beyond = NODES.material_removed(np.array([0.0, 1.0]), np.array([-1.0, 4e-3]))
    assert beyond == pytest.approx([NODES.removed[0][0], NODES.removed[-1][3]], rel=1e-12, abs=0.0)
    # Slopes from either side of every node line agree; a bilinear surface would have kinks there.
    step, jumps, slopes = 1e-8, [], []
    for axis, others in ((0, FACE), (1, ROLL)):
        between = np.linspace(others[0], others[-1], 23)
        for node in (ROLL, FACE)[axis][1:-1]:
            at = [np.full(23, node + shift) for shift in (-step, 0.0, step)]
            places = [(a, between) if axis == 0 else (between, a) for a in at]
            low, here, high = (NODES.material_removed(*place) for place in places)
            jumps.append(np.abs((high - here) - (here - low)).max() / step)
            slopes.append(np.abs(high - low).max() / (2 * step))
    assert max(jumps) < 1e-4 * max(slopes)


@pytest.mark.parametrize(
    "shape",
    [
        lambda x, y: 3e-6 + 0.0 * x * y,
        lambda x, y: 4e-2 * x * y,
        lambda x, y: 1e-2 * (x - 12e-3) ** 2 + 3e-2 * y**2,
        lambda x, y: 20.0 * (x - 9e-3) ** 2 * y * (1.0 + 50.0 * y),
    ],
    ids=["constant", "twist", "crowning", "biquadratic"],
)
def test_what_is_quadratic_in_either_direction_is_reproduced(shape):
    roll, face = inside()
    assert sampled(shape).material_removed(roll, face) == pytest.approx(
        shape(roll, face), rel=1e-9, abs=1e-18
    )


def test_a_smooth_flank_is_met_at_third_order():
    def worst(count):
        roll, face = np.linspace(4e-3, 19e-3, count), np.linspace(-12.5e-3, 12.5e-3, count)
        nodes = FlankGrid(roll, face, 1e-5 * np.sin(300.0 * roll)[:, None] * np.cos(150.0 * face))
        x, y = inside(83)
        return float(
            np.abs(nodes.material_removed(x, y) - 1e-5 * np.sin(300.0 * x) * np.cos(150.0 * y)).max()
        )

    assert np.log2(worst(21) / worst(41)) > 2.7


@pytest.mark.parametrize("first", [1, 2, 4, 8])
@pytest.mark.parametrize("along", [0, 1], ids=["roll", "face"])
@pytest.mark.parametrize("uneven", [False, True], ids=["even", "uneven"])
def test_nothing_is_invented_beside_a_step(first, along, uneven):
    nodes, other = np.linspace(4e-3, 19e-3, 9), (0.0, 1e-3, 3e-3)
    if uneven:  # a gap of 2 mm, then 0.29 mm to the relieved end
        nodes[first:] = nodes[first - 1] + 0.29e-3 + (nodes[first:] - nodes[first])
    step = np.where(np.arange(9) >= first, 20e-6, 0.0)[:, None] + np.zeros(3)
    grid = FlankGrid(nodes, other, step) if along == 0 else FlankGrid(other, nodes, step.T)
    at = np.linspace(nodes[0], nodes[-1], 4001)
    across = np.full(4001, 0.4e-3)
    removed = grid.material_removed(*(at, across) if along == 0 else (across, at))
    assert removed.min() >= -1e-18
    assert removed.max() <= 20e-6 * (1.0 + 1e-12)
    assert np.all(np.diff(removed) >= -1e-18)


def test_a_flat_between_two_reliefs_stays_flat():
    roll = (4e-3, 4.3e-3, 12e-3, 12.3e-3, 13e-3)
    removed = np.array([20e-6, 0.0, 0.0, 5e-6, 20e-6])
    at = np.linspace(roll[0], roll[-1], 4001)
    for count in (4, 5):
        grid = FlankGrid(roll[:count], (-1e-3, 1e-3), removed[:count, None] + np.zeros(2))
        assert grid.material_removed(at, 0.0 * at).min() == pytest.approx(0.0, abs=1e-20)


def test_measured_flanks_are_not_refused_and_leave_their_nodes_little():
    random = np.random.default_rng(3)
    for rows, columns in ((4, 9), (9, 11), (15, 5)):
        noise = 1e-6 * random.uniform(-1.0, 1.0, (rows, columns))
        crowned = noise + 8e-6 * np.linspace(-1.0, 1.0, columns) ** 2
        roll, face = np.linspace(4e-3, 19e-3, rows), np.linspace(-12e-3, 12e-3, columns)
        grid = FlankGrid(roll, face, crowned)
        x, y = (
            axis.ravel() for axis in np.meshgrid(*(np.linspace(*(a[0], a[-1]), 97) for a in (roll, face)))
        )
        removed = grid.material_removed(x, y)
        assert crowned.min() - 0.1e-6 < removed.min()
        assert removed.max() < crowned.max() + 0.1e-6


def test_a_surface_that_leaves_its_nodes_is_refused_with_the_place():
    roll, face = (2e-3, 2.3e-3, 4.3e-3), (0.3e-3, 2.3e-3, 2.6e-3)
    removed = 20e-6 * np.array([[0.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 1.0]])
    expected = r"removed\[1\.\.2\]\[0\.\.1\] = '1\.09 µm beyond the nodes .* at most 0\.1 µm; add nodes"
    with pytest.raises(InputError, match=expected):
        FlankGrid(roll, face, removed)
    assert FlankGrid(roll, face, 0.09 * removed)


def test_where_a_grid_belongs_depends_on_whether_it_differs_over_the_face():
    even = FlankModification(flank_grid=sampled(lambda x, y: 1e-3 * (x - 4e-3)), helix_crowning=1e-6)
    assert even.along_profile.flank_grid is even.flank_grid
    assert even.along_face.flank_grid is None
    free = FlankModification(flank_grid=NODES, profile_slope=1e-6)
    assert free.along_face.flank_grid is NODES
    assert free.along_profile == FlankModification(profile_slope=1e-6)
    assert free.along_face.varies_along_profile
    assert free.varies_along_face
    assert FlankModification(flank_grid=sampled(lambda x, y: 0.0 * x * y)).neutral


def test_a_grid_adds_to_the_other_amounts_and_tells_flanks_apart():
    alone, slope = FlankModification(flank_grid=NODES), FlankModification(profile_slope=4e-6)
    gear = make_gear(modification=FlankModification(flank_grid=NODES, profile_slope=4e-6))
    roll, face = inside(9)
    total = gear.modification.material_removed(gear, roll, face)
    parts = alone.material_removed(gear, roll, face) + slope.material_removed(gear, roll, face)
    assert total == pytest.approx(parts, rel=1e-12, abs=1e-20)
    assert hash(gear) != hash(make_gear())
    assert asdict(gear)["modification"]["flank_grid"]["roll_length"] == ROLL


# a chart of five teeth: F_pi 0, 3, 1, -4, -2 um
CHART = PitchDeviation((0.0, 3e-6, 1e-6, -4e-6, -2e-6))


def test_single_and_cumulative_deviations_of_a_chart():
    assert CHART.individual == pytest.approx([2e-6, 3e-6, -2e-6, -5e-6, 2e-6], abs=1e-18)
    assert CHART.single == pytest.approx(5e-6, abs=1e-18)
    assert CHART.total == pytest.approx(7e-6, abs=1e-18)
    values = np.random.default_rng(3).normal(0.0, 5e-6, 37)
    deviation = PitchDeviation(tuple(values))
    assert deviation.individual.sum() == pytest.approx(0.0, abs=1e-19)
    assert values[0] + np.cumsum(deviation.individual[1:]) == pytest.approx(values[1:], abs=1e-19)
    assert CHART.reversed.cumulative == (0.0, -2e-6, -4e-6, 1e-6, 3e-6)
    assert CHART.reversed.reversed == CHART
    assert PitchDeviation().reversed == PitchDeviation()


@pytest.mark.parametrize(
    ("values", "period"),
    [((), 1), ((5e-6,) * 12, 1), ((1e-6, 2e-6) * 6, 2), ((1e-6, 2e-6, 3e-6, 2e-6) * 3, 4), (range(12), 12)],
)
def test_the_period_is_the_shortest_run_that_repeats(values, period):
    assert PitchDeviation(tuple(1e-6 * value for value in values)).period == period


def test_along_the_line_of_action_an_arc_is_shorter_by_the_transverse_pressure_angle():
    """The tooth turns by F_pi / r; the line of action sees r_b of it."""
    helical = replace(GEAR, helix_angle=0.4, pitch_deviation=PitchDeviation((1e-6,) * 20))
    turned = 1e-6 / helical.reference_radius
    found = helical.pitch_deviation.on_line_of_action(helical.transverse_pressure_angle)
    assert found == pytest.approx([turned * helical.base_radius] * 20, rel=1e-12, abs=0.0)
    assert helical.base_radius / helical.reference_radius < math.cos(math.radians(20.0))
    ring = RingGear(teeth=60, normal_module=4e-3, face_width=25e-3, rim_diameter=300e-3, cutter_teeth=25)
    erring = replace(ring, pitch_deviation=PitchDeviation((1e-6,) * 60))
    found = erring.pitch_deviation.on_line_of_action(erring.transverse_pressure_angle)
    assert found == pytest.approx([1e-6 * math.cos(math.radians(20.0))] * 60, rel=1e-12, abs=0.0)


def test_deviations_are_one_for_each_tooth_of_the_same_gear():
    """So the finite-element model of the perfect gear serves it."""
    erring = replace(GEAR, pitch_deviation=PitchDeviation((0.0,) * 19 + (9e-6,)))
    assert erring.macro_geometry() == GEAR.macro_geometry()
    erring = replace(GEAR, pitch_deviation=PitchDeviation(tuple(1e-6 * k for k in range(20))))
    pair = GearPair(erring, GEAR, 80e-3)
    assert pair.swapped().wheel.pitch_deviation == erring.pitch_deviation.reversed
    assert pair.swapped().swapped() == pair
    with pytest.raises(InputError, match="a list of 20") as refusal:
        replace(GEAR, pitch_deviation=PitchDeviation((1e-6,) * 19))
    assert refusal.value.field == "pitch_deviation"


@pytest.mark.parametrize("hand", [1.0, -1.0])
def test_ground_crowning_is_the_same_all_along_the_normal_that_the_worm_touches(hand):
    """So it is crowning, twist and profile crowning by closed form."""
    gear = Gear(25, 2e-3, 30e-3, 20e-3, helix_angle=hand * math.radians(22.0))
    ground = FlankModification(ground_helix_crowning=4e-6)
    form, tip = gear.form_roll_length, gear.tip_roll_length
    roll, middle, tangent = np.linspace(form, tip, 21), 0.5 * (form + tip), math.tan(gear.base_helix_angle)
    for worm in (-9e-3, 0.0, 6e-3):
        along = ground.material_removed(gear, roll, worm + (roll - middle) * tangent)
        assert along == pytest.approx(4e-6 * (2.0 * worm / 30e-3) ** 2, rel=1e-12, abs=1e-20)
    k = (tip - form) * tangent / 30e-3
    parts = FlankModification(helix_crowning=4e-6, flank_twist=-2.0 * 4e-6 * k, profile_crowning=4e-6 * k**2)
    roll, face = np.meshgrid(roll, np.linspace(-15e-3, 15e-3, 31))
    assert ground.material_removed(gear, roll, face) == pytest.approx(
        parts.material_removed(gear, roll, face), rel=1e-9, abs=1e-18
    )


def test_a_ring_gear_is_not_ground_by_a_worm():
    with pytest.raises(InputError) as caught:
        RingGear(
            60,
            4e-3,
            25e-3,
            280e-3,
            addendum_coefficient=0.75,
            modification=FlankModification(ground_helix_crowning=1e-6),
        )
    assert caught.value.field == "modification.ground_helix_crowning"


@pytest.mark.parametrize("name", fields_of(Kind.AMOUNT, Kind.DEVIATION))
def test_only_what_may_add_material_has_more_than_the_involute_anywhere(name):
    """By it samples of the gap are left out where flanks touch."""
    length = {f"{name}_length": 0.5e-3} if f"{name}_length" in FLANK_FIELDS else {}
    modification = FlankModification(**{name: 6e-6}, **length)
    roll = np.linspace(*sorted((GEAR.form_roll_length, GEAR.tip_roll_length)), 41)[:, None]
    removed = modification.material_removed(GEAR, roll, np.linspace(-0.5, 0.5, 31) * GEAR.face_width)
    assert modification.only_removes == (removed.min() >= 0.0)
