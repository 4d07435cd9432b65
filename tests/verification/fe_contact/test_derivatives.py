"""Derivatives of transmission error and load arm: of the contact, of the flanks, of the quantities."""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from fe_contact import FlankModification, Gear, GearPair, analyze
from fe_contact.analysis.live.condensed_pair import CondensedPair
from fe_contact.analysis.live.stored_bodies import condensed_pair
from fe_contact.contact import adjoint, force_changes, load_arm, solve_contact
from fe_contact.errors import InputError
from fe_contact.geometry import InternalGearPair, ParallelAxes, RingGear
from fe_contact.microgeometry.curve_derivatives import curve_derivatives
from fe_contact.microgeometry.variables import modified
from fe_contact.ste.curve_quantities import FIRST_HARMONIC, quantity_derivatives

pytestmark = pytest.mark.usefixtures("coarse_sectors")

TORQUES = np.array([30.0, 60.0])
RELIEF = FlankModification(tip_relief=12e-6, tip_relief_length=0.8e-3, profile_crowning=3e-6)
CROWNED = replace(RELIEF, helix_crowning=6e-6, helix_slope=2e-6)
AMOUNTS = ("pinion.tip_relief", "wheel.tip_relief", "pinion.profile_crowning", "wheel.profile_slope")
SHAPE = {"normal_module": 1.8e-3, "face_width": 15e-3}


def helical() -> GearPair:
    """Two points of a line in every slice; overlap 0.99."""
    hands = ((23, 1.0), (41, -1.0))
    return GearPair(
        *(
            Gear(
                teeth=teeth,
                bore_diameter=20e-3,
                helix_angle=hand * math.radians(22),
                modification=CROWNED,
                **SHAPE,
            )
            for teeth, hand in hands
        )
    )


def spur() -> GearPair:
    return GearPair(
        *(Gear(teeth=teeth, bore_diameter=20e-3, modification=RELIEF, **SHAPE) for teeth in (23, 41))
    )


def crowned_spur() -> GearPair:
    """Over the face, and alike to both sides of its middle."""
    crowned = replace(RELIEF, helix_crowning=6e-6)
    return GearPair(
        *(replace(gear, face_width=8e-3, modification=crowned) for gear in (spur().pinion, spur().wheel))
    )


def internal() -> InternalGearPair:
    pinion = Gear(teeth=23, bore_diameter=20e-3, modification=RELIEF, **SHAPE)
    ring = RingGear(teeth=71, rim_diameter=150e-3, addendum_coefficient=0.8, modification=RELIEF, **SHAPE)
    return InternalGearPair(pinion, ring)


@pytest.fixture(scope="module")
def condensed(tmp_path_factory):
    """Bodies of the pairs, each found once."""
    cache, known = tmp_path_factory.mktemp("bodies"), {}

    def of(name):
        if name not in known:
            pair = crowned_spur() if name == "crowned" else PAIRS[name]()
            model = "plane_strain" if name in IN_PLANE else "3d"
            wish = {"level": "draft", "model": model, "positions": 12, "receipt": "minimal"}
            table = analyze(pair, torques=TORQUES, cache=cache, **wish)
            known[name] = condensed_pair(pair, table, {}, cache)
        return known[name]

    return of


IN_PLANE = ("spur", "internal")
PAIRS: dict[str, Callable[[], ParallelAxes]] = {"helical": helical, "spur": spur, "internal": internal}


def solved(
    bodies: CondensedPair, values: dict[str, float], load: float = 1.0, *conditions: float
) -> np.ndarray:
    """Curves of other flanks, transmission error and load arm, (2, P, F) in m."""
    found = bodies.solve(modified(bodies.checked.request.pair, values), load * TORQUES, *conditions)
    return np.stack([found.solution.deflection, load_arm(found.pair, found.problem, found.solution)])


def central(bodies: CondensedPair, name: str, step: float) -> np.ndarray:
    pair = bodies.checked.request.pair
    gear, _, quantity = name.partition(".")
    value = getattr(getattr(pair, gear).modification, quantity)
    above, below = (solved(bodies, {name: value + way * step}) for way in (1.0, -1.0))
    return (above - below) / (2.0 * step)


@pytest.mark.law
@pytest.mark.parametrize("name", PAIRS)
def test_a_gap_opened_at_one_contact_counts_by_its_weight(name, condensed):
    bodies = condensed(name)
    solved = bodies.solve(bodies.checked.request.pair, TORQUES)
    problem, solution = solved.problem, solved.solution
    found, c = adjoint(solved.pair, problem, solution), problem.candidates
    lever = np.einsum("pkm,pm->pk", found.weight, c.motion_arm)
    assert lever == pytest.approx(np.ones(lever.shape), rel=1e-12)  # all moved apart: the gear lags
    heaviest, step = np.argmax(solution.force[5].sum(axis=0)), 1e-9
    ends = []
    for way in (1.0, -1.0):
        gap = c.touch.gap.copy()
        gap[5, heaviest] += way * step / c.motion_arm[5, heaviest]
        ends.append(solve_contact(problem.touching(c.touching(replace(c.touch, gap=gap))), solution.load))
    difference = (ends[0].deflection - ends[1].deflection)[5] / (2.0 * step)
    assert found.weight[5, :, heaviest] == pytest.approx(difference, rel=1e-6)
    arms = [load_arm(solved.pair, problem, end)[5] for end in ends]
    by_difference = (arms[0] - arms[1]) / (2.0 * step)
    assert found.arm_weight[5, :, heaviest] == pytest.approx(by_difference, rel=1e-5, abs=1e-12)
    moved = np.einsum("pkm,pm->pk", found.arm_weight, c.motion_arm)
    assert np.abs(moved).max() <= 1e-12 * np.abs(found.arm_weight).sum(axis=2).max()  # the arm stays


@pytest.mark.law
def test_a_tilt_of_rigid_bodies_moves_the_load_by_the_spread_of_what_carries(condensed):
    """By the second central moment of the stiffness of the contacts over the load: no body couples them."""
    bodies = condensed("helical")
    found = bodies.solve(bodies.checked.request.pair, TORQUES)
    plain, touch = np.zeros(found.problem.candidates.gap.shape), found.problem.candidates.touch
    unturned = found.problem.candidates.touching(replace(touch, slope_1=plain, slope_2=plain))
    problem = replace(found.problem, candidates=unturned, tilt=np.zeros((0, 0, 0)))
    problem = replace(problem, compliance=problem.compliance - (1.0 - 1e-9) * problem.bodies)
    c, near = problem.candidates, found.solution.load[0] * (1.0 + np.array([-1e-6, 0.0, 1e-6]))
    solution = solve_contact(problem, near)
    force, deflection = solution.force, solution.deflection
    arms = found.pair.tilt_arm(c.touch.roll_1, c.face_position)
    stiffness = c.torque_share * (force[:, 2] - force[:, 0]) / np.diff(deflection[:, ::2])
    center = (stiffness * arms).sum(axis=1) / stiffness.sum(axis=1)
    spread = (stiffness * np.square(arms - center[:, None])).sum(axis=1)
    answer = adjoint(found.pair, problem, solution)
    assert answer.added_arm[:, 1] == pytest.approx(center, abs=1e-6 * np.abs(arms).max())
    moved = (answer.arm_weight[:, 1] * c.motion_arm * arms).sum(axis=1)
    assert moved == pytest.approx(-spread / near[1], rel=1e-5)


@pytest.mark.law
def test_what_is_alike_to_both_sides_of_the_middle_moves_no_load(condensed):
    names = ["pinion.helix_crowning", "wheel.tip_relief", "pinion.helix_slope", "torque"]
    found = curve_derivatives(condensed("crowned"), crowned_spur(), TORQUES, names)
    one_sided = np.abs(found.load_arm_by[2]).max()
    assert np.abs(found.load_arm).max() < 1e-9 * crowned_spur().face_width
    assert np.abs(found.load_arm_by[:2]).max() < 1e-6 * one_sided
    assert np.abs(found.load_arm_by[3] * TORQUES).max() < 1e-8 * crowned_spur().face_width
    in_plane = curve_derivatives(condensed("spur"), spur(), TORQUES, AMOUNTS)
    assert not in_plane.load_arm.any() and not in_plane.load_arm_by.any()


@pytest.mark.law
@pytest.mark.parametrize("name", PAIRS)
def test_forces_change_as_their_derivatives_say(name, condensed):
    bodies = condensed(name)
    solved = bodies.solve(bodies.checked.request.pair, TORQUES)
    problem, solution = solved.problem, solved.solution
    c = problem.candidates
    opened = np.random.default_rng(2).normal(size=c.touch.gap.shape)
    apart = np.broadcast_to((opened * c.motion_arm)[:, None, :], solution.force.shape)
    (found,) = force_changes(problem, solution, apart[None])
    ends = [
        solve_contact(
            problem.touching(c.touching(replace(c.touch, gap=c.touch.gap + way * opened))), solution.load
        )
        for way in (1e-11, -1e-11)
    ]
    difference = (ends[0].force - ends[1].force) / 2e-11
    off = np.abs(found - difference)[solution.force > 0.0] / np.abs(difference).max()
    assert np.quantile(off, 0.99) < 1e-6
    carried = (found * c.torque_share[:, None]).sum(axis=2)
    assert np.abs(carried).max() < 1e-9 * np.abs(found).max()  # the load stays


@pytest.mark.parametrize("name", ["pinion.helix_crowning", "wheel.helix_slope"])
def test_by_amounts_over_the_face_curves_change_as_differences_say(name, condensed):
    bodies = condensed("helical")
    found = curve_derivatives(bodies, helical(), TORQUES, [name])
    ste, arm = central(bodies, name, 1e-9)
    off = np.abs(found.by[0] - ste) / np.abs(ste).max()
    assert np.quantile(off, 0.9) < 1e-6  # the rest: positions at which contacts begin within the step
    moved = np.abs(found.load_arm_by[0] - arm) / np.abs(arm).max()
    assert np.quantile(moved, 0.9) < 1e-6


@pytest.mark.parametrize("pair", PAIRS)
@pytest.mark.parametrize("name", AMOUNTS)
def test_by_amounts_along_the_profile_curves_change_as_differences_say(pair, name, condensed):
    """The gap of the solver is a parabola about its least point, by differences that move with that point."""
    bodies = condensed(pair)
    found = curve_derivatives(bodies, PAIRS[pair](), TORQUES, [name])
    by_difference = central(bodies, name, 1e-9)
    of_curves = [found.by[0], found.load_arm_by[0]] if pair == "helical" else [found.by[0]]
    for derivative, difference in zip(of_curves, by_difference, strict=False):
        off = np.abs(derivative - difference) / np.abs(derivative).max()
        assert np.median(off) < 1.1e-4 and off.max() < 2e-3


ONE_SIDED = {
    "tip_relief": ("_length", "_shape"),
    "root_relief": ("_length", "_shape"),
    "profile_crowning_tip": ("_length",),
    "end_relief_datum_face": ("_length", "_shape"),
    "helix_crowning_non_datum_face": ("_length",),
    "triangular_tip_relief": ("_length", "_shape"),
    "triangular_root_relief": ("_length", "_shape"),
}


@pytest.mark.drawn
@pytest.mark.parametrize("shape", ["circular", "exponential", "logarithmic"])
@pytest.mark.parametrize("quantity", ONE_SIDED)
def test_by_reliefs_of_any_shape_to_any_end_curves_change_as_differences_say(quantity, shape, condensed):
    facts = {"_length": 3e-3 if "face" in quantity else 1.2e-3, "_shape": shape}
    own = {quantity: 8e-6} | {quantity + end: facts[end] for end in ONE_SIDED[quantity]}
    bodies, plain = condensed("helical"), helical()
    pair = replace(plain, pinion=replace(plain.pinion, modification=FlankModification(**own)))
    for name, step in ((f"pinion.{quantity}", 1e-9), (f"pinion.{quantity}_length", 1e-6)):
        found = curve_derivatives(bodies, pair, TORQUES, [name]).by[0]
        value = own[name.partition(".")[2]]
        ends = [
            bodies.solve(modified(pair, {name: value + way * step}), TORQUES).solution.deflection
            for way in (1.0, -1.0)
        ]
        difference = (ends[0] - ends[1]) / (2.0 * step)
        off = np.abs(found - difference) / np.abs(found).max()
        assert np.median(off) < 3e-4 and np.quantile(off, 0.9) < 5e-3, (name, off)


@pytest.mark.parametrize("pair", PAIRS)
def test_by_the_length_of_a_relief_curves_change_as_differences_say(pair, condensed):
    name, bodies = "pinion.tip_relief_length", condensed(pair)
    found = curve_derivatives(bodies, PAIRS[pair](), TORQUES, [name]).by[0]
    off = np.abs(found - central(bodies, name, 1e-8)[0]) / np.abs(found).max()
    assert np.median(off) < 2e-4 and off.max() < 1e-2


def test_by_misalignment_torque_and_center_distance_curves_change_as_differences_say(condensed):
    bodies, pair = condensed("helical"), helical()
    found = curve_derivatives(bodies, pair, TORQUES, ["misalignment", "torque", "center_distance_change"])
    by = np.stack([found.by, found.load_arm_by], axis=1)
    base, more, less = (solved(bodies, {}, 1.0 + part) for part in (0.0, 1e-6, -1e-6))
    above, below, apart = (solved(bodies, {}, 1.0, *at) for at in ((1e-9,), (-1e-9,), (0.0, 2e-6)))
    change = np.abs(by[0] - (above - below) / 2e-9)
    assert (np.median(change, axis=(1, 2)) < 1e-6 * np.abs(by[0]).max(axis=(1, 2))).all()
    assert by[1, 0] == pytest.approx((more - less)[0] / (2e-6 * TORQUES), rel=1e-4)
    assert by[1, 1] == pytest.approx((more - less)[1] / (2e-6 * TORQUES), abs=1e-4 * np.abs(by[1, 1]).max())
    change = np.abs(by[2] - (apart - base) / 2e-6)
    assert (np.median(change, axis=(1, 2)) < 0.02 * np.abs(by[2]).max(axis=(1, 2))).all()


@pytest.mark.parametrize("gear", ["pinion", "wheel"])
def test_by_points_of_the_flank_integrates_to_the_amounts(gear, condensed):
    bodies = condensed("helical")
    names = [f"{gear}.profile_slope", f"{gear}.helix_slope"]
    found = curve_derivatives(bodies, helical(), TORQUES, names)
    flank = found.on_flank(gear, 9, 7)
    toothing = getattr(helical(), gear)
    ends = toothing.form_roll_length, toothing.tip_roll_length
    across = (2.0 * flank.roll_length - sum(ends)) / (ends[1] - ends[0])
    along = 2.0 * flank.face_position / toothing.face_width
    for k, height in enumerate((0.5 * across[:, None], 0.5 * along[None, :])):
        for by_point, by_amount in (
            (flank.mean, found.mean[k]),
            (flank.peak_to_peak, found.peak_to_peak[k]),
            (flank.harmonics, found.harmonics[k]),
        ):
            total = (by_point * height).sum(axis=(-2, -1))
            assert total == pytest.approx(by_amount, rel=2e-3, abs=2e-4 * np.abs(by_amount).max())
    # an even depth is closed by a lag, on a slope of gear 2 by a little more of it
    strips = found._strips
    even = strips.change(strips.normal + strips.closing.excess).mean(axis=0)
    assert np.all((even > 1.0) & (even < 1.01))
    assert flank.mean.sum(axis=(1, 2)) == pytest.approx(even, rel=1e-6)


@pytest.mark.law
@pytest.mark.parametrize("gear", ["pinion", "wheel"])
def test_to_take_material_away_never_brings_the_gears_closer_on_the_mean(gear, condensed):
    """Where patches and normals stay: at any point. Where they follow, of what fades more slowly.

    What is removed at a point tilts the gap to either side of it: to w m under a strip comes r m', m being
    removed and the arm r/w the way of the patch, R times twice the tilt under load: some 10 um, so that a
    single node may have either sign. With |m'| < m/l the sum is at least (1 - r/(w l)) w m.
    """
    bodies = condensed("helical")
    found = curve_derivatives(bodies, helical(), TORQUES, ["torque"])
    closing = replace(found._strips.closing, lag=0.0)
    turned = found._strips.turned
    turned = replace(turned, slice_force=0.0 * turned.slice_force, displacement=0.0)
    strips = replace(found._strips, following=None, closing=closing, turned=turned)
    staying = replace(found, _strips=strips).on_flank(gear, 9, 7)
    following = found.on_flank(gear, 9, 7)
    assert staying.mean.min() >= 0.0
    assert not np.allclose(following.mean, staying.mean, rtol=0.0, atol=5e-3 * staying.mean.max())
    cell = np.diff(staying.roll_length)[0]
    assert cell > 1e-3
    fading = np.exp(-np.abs(np.subtract.outer(np.arange(9), np.arange(9))))  # by e over a cell
    faded, smooth = (np.einsum("ij,fjz->fiz", fading, each.mean) for each in (staying, following))
    assert (smooth > (1.0 - 30e-6 / cell) * faded).all()


def test_quantities_change_as_their_derivatives_say(condensed):
    bodies, name, step = condensed("helical"), "wheel.helix_crowning", 2e-8
    found = curve_derivatives(bodies, helical(), TORQUES, [name])
    tables = [bodies.table(modified(helical(), {name: 6e-6 + way * step}), TORQUES) for way in (1.0, -1.0)]
    for k, torque in enumerate(TORQUES):
        above, below = (table.curve(torque=float(torque)) for table in tables)
        for by, one, other in (
            (found.mean[0, k], above.mean, below.mean),
            (found.peak_to_peak[0, k], above.peak_to_peak, below.peak_to_peak),
            (found.harmonics[0, 0, k], above.harmonics[0], below.harmonics[0]),
        ):
            assert by == pytest.approx((one.value - other.value) / (2.0 * step), rel=0.01, abs=1e-4)


def test_a_figure_that_is_zero_has_its_derivative_to_the_one_side(condensed):
    bodies = condensed("spur")
    plain = modified(spur(), {"pinion.profile_crowning": 0.0, "wheel.profile_crowning": 0.0})
    found = curve_derivatives(bodies, plain, TORQUES, ["pinion.profile_crowning"])
    step = 1e-8
    more = bodies.solve(modified(plain, {"pinion.profile_crowning": step}), TORQUES).solution.deflection
    off = np.abs(found.by[0] - (more - found.ste) / step)
    assert np.median(off) < 1e-2 * np.abs(found.by[0]).max()


def test_by_default_everything_that_acts_is_varied(condensed):
    over_face = curve_derivatives(condensed("helical"), helical(), TORQUES).names
    in_plane = curve_derivatives(condensed("spur"), spur(), TORQUES).names
    assert {"pinion.tip_relief_length", "wheel.flank_twist", "misalignment", "torque"} <= set(over_face)
    assert not any("helix" in name or name == "misalignment" for name in in_plane)
    assert not any("root_relief" in name for name in over_face)  # it has no length


@pytest.mark.parametrize(
    ("name", "bound"),
    [
        ("pinion.crown", "one of"),
        ("pinion.root_relief", "a relief that has a length"),
        ("pinion.helix_crowning", "a figure whose effect the table has"),
        ("misalignment", "a figure whose effect the table has"),
    ],
)
def test_what_cannot_be_varied_is_refused_by_name(name, bound, condensed):
    with pytest.raises(InputError, match=bound):
        curve_derivatives(condensed("spur"), spur(), TORQUES, [name])


@pytest.mark.parametrize("period", [1, 3])
def test_quantities_of_a_curve_are_linear_in_its_values(period):
    position = np.arange(64 * period) / 64.0
    orders = np.array([1.0 / period, 1.0, 2.0, 5.0])
    curve = (1e-6 / orders * np.cos(2.0 * np.pi * orders * position[:, None] + orders)).sum(axis=1)
    weights = quantity_derivatives(curve, period)
    assert weights.sum(axis=1) == pytest.approx(
        [1.0, *[0.0] * (len(weights) - 1)], abs=1e-12
    )  # a curve moved as a whole
    sizes = dict(zip(orders.tolist(), (1e-6 / orders).tolist(), strict=True))
    expected = [sizes.get(float(n), 0.0) for n in range(1, 21)]
    if period == 1:
        expected[0] = 2e-6  # two waves of the first order
    assert weights[FIRST_HARMONIC:] @ curve == pytest.approx(expected, abs=1e-18)  # of first degree: Euler
    assert weights[1] @ curve == pytest.approx(np.ptp(curve), rel=1e-12)


def test_harmonics_that_the_positions_do_not_resolve_have_no_derivatives():
    weights = quantity_derivatives(np.cos(2.0 * np.pi * np.arange(48) / 16.0), 3)
    resolved = FIRST_HARMONIC + 7  # 16 in a pitch: below order 8
    assert np.isfinite(weights[:resolved]).all() and np.isnan(weights[resolved:]).all()
