"""The mesh force that dynamics gets: its laws, and the table it is made from."""

from dataclasses import fields, replace

import numpy as np
import pytest

from fe_contact.errors import DatabaseError, InputError, SolveError
from fe_contact.ste import ForceTable, MeshForce, Validity
from fe_contact.types import Status

RNG = np.random.default_rng(11)
X = RNG.uniform(-2.0, 2.0, 3000)
F = np.concatenate([RNG.uniform(0.0, 14000.0, 2000), 10.0 ** RNG.uniform(-4.0, 3.0, 1000)])


@pytest.fixture(
    scope="module",
    params=[
        "plain",
        "helical",
        "relieved",
        "one load",
        "two loads",
        "square wave",
        "parallel",
        "three knots",
    ],
)
def table(request, make, helical):
    uneven = np.sort(np.concatenate([np.arange(20) / 20, 0.22 + 0.005 * np.arange(-5, 6) + 1e-3]))
    return {
        "plain": make,
        "helical": lambda: helical,
        "relieved": lambda: make(relief=10e-6, position=uneven),
        "one load": lambda: make(force=[2660.0]),
        "two loads": lambda: make(force=[266.0, 10640.0], relief=5e-6),
        "square wave": lambda: square_wave(make),
        "parallel": lambda: parallel(make),
        "three knots": lambda: make(position=[0.1, 0.5, 0.75]),
    }[request.param]()


def square_wave(make):
    """Stiffness jumps between two values from one knot to the next."""
    database = make()
    ratio = np.where(np.abs(database.position - 0.5) < 0.22, 1.0, 1.6)[:, None, None, None]
    levels = database.force[:, None, None] / 4e8 * ratio
    return make(
        static_transmission_error=levels,
        tangent_compliance=levels / database.force[:, None, None],
        no_load_transmission_error=np.zeros((64, 1, 1)),
    )


def parallel(make):
    """Loads so close that the curves differ by less than a thousandth of their ripple."""
    return make(force=2660.0 * (1.0 + 1e-4 * np.arange(6)))


def test_a_curve_at_a_stored_load_is_that_of_the_cubic_to_the_last_bit(table):
    for load in table.force:
        beside = table.ste(np.append(X, 0.5), np.append(np.full(X.size, load), 0.3 * load))
        assert np.array_equal(table.ste(X, load), beside[:-1])
    fresh = MeshForce(table.force_table())
    fresh.deflection_at(X, fresh.table.level[-1], table.misalignment[0], table.center_distance_change[0])
    assert "stiffnesses" not in vars(fresh)


def one_sided(table, x, d, dx):
    """Differences in position to the left and right."""
    here = table.force_at(x, d).force
    return (here - table.force_at(x - dx, d).force) / dx, (table.force_at(x + dx, d).force - here) / dx


def test_position_slope_is_the_derivative_at_random_points_knots_and_levels(table):
    deflection = table.ste(X, F)
    check_position_slope(table, X, deflection)
    x, f = (grid.ravel() for grid in np.meshgrid(table.position, np.linspace(10.0, 12000.0, 25)))
    check_position_slope(table, x, table.ste(x, f))
    x, f = (grid.ravel() for grid in np.meshgrid(X[:100], table.force))
    check_position_slope(table, x, table.ste(x, f))


def check_position_slope(table, x, d):
    """Both one-sided differences approach the stated slope, in proportion to the step."""
    slope = table.force_at(x, d).position_slope
    scale = np.abs(table.force_at(X, table.ste(X, F)).position_slope).max()
    coarse = max(np.abs(side - slope).max() for side in one_sided(table, x, d, 1e-5))
    fine = max(np.abs(side - slope).max() for side in one_sided(table, x, d, 1e-7))
    assert fine <= 1e-3 * scale
    assert fine <= 0.1 * coarse + 1e-6 * scale


def test_lift_off_is_smooth_and_above_the_table_the_tangent_goes_on(table):
    """Force and both derivatives vanish at lift-off, and below it."""
    lift_off = table.ste(X, 0.0)
    first = table.ste(X, table.force[0]) - lift_off
    for fraction in (-1.0, -1e-9, 0.0):
        sample = table.force_at(X, lift_off + fraction * first)
        assert np.all(sample.force <= 1e-12 * table.force[0])
        assert np.all(sample.stiffness <= 1e-6 * table.force[0] / first)
    just_above = table.force_at(X, lift_off + 1e-4 * first)
    assert np.all(just_above.force > 0.0)
    assert np.all(just_above.force <= 3e-8 * table.force[0] * 1.01)
    assert np.all(just_above.stiffness <= 6e-4 * table.force[0] / first * 1.01)
    top = table.ste(X, table.force[-1])
    edge = table.force_at(X, top)
    far = table.force_at(X, top + 1e-4)
    assert np.allclose(far.force, edge.force + edge.stiffness * 1e-4, rtol=1e-12)
    assert np.allclose(far.stiffness, edge.stiffness, rtol=1e-12)
    assert np.all(far.validity == Validity.ABOVE_TABLE)


def test_validity_of_deflections_and_axes(spur):
    low, top = float(spur.ste(0.3, 0.0)), float(spur.ste(0.3, spur.force[-1]))
    asked = [low - 1e-9, low + 1e-9, 0.5 * (low + top), top, top * 1.001]
    expected = [Validity.LIFTED_OFF, Validity.INSIDE, Validity.INSIDE, Validity.INSIDE, Validity.ABOVE_TABLE]
    assert spur.force_at(0.3, asked).validity.tolist() == [flag.value for flag in expected]
    deflection = float(spur.ste(0.3, 2660.0))
    inside = spur.force_at(0.3, deflection, misalignment=0.0, center_distance_change=0.0)
    outside = spur.force_at(0.3, deflection, misalignment=1e-6, center_distance_change=-1e-5)
    assert inside.validity == Validity.INSIDE
    assert outside.validity == Validity.OUTSIDE_MISALIGNMENT | Validity.OUTSIDE_CENTER_DISTANCE
    assert outside.force == inside.force
    for bad in (np.nan, np.inf):
        with pytest.raises(InputError, match=r"position = .*must be finite"):
            spur.force_at([0.0, bad], 1e-6)
        with pytest.raises(InputError, match="deflection"):
            spur.force_at(0.0, bad)
    with pytest.raises(InputError, match="force = -1"):
        spur.ste(0.0, [5.0, -1.0])


def test_flags_add_up_and_shapes_broadcast(four_axes):
    sample = four_axes.force_at(0.2, -1.0, misalignment=[0.0, 1.0], center_distance_change=0.0)
    lifted, both = Validity.LIFTED_OFF, Validity.LIFTED_OFF | Validity.OUTSIDE_MISALIGNMENT
    assert sample.validity.tolist() == [lifted.value, both.value]
    sample = four_axes.force_at(np.zeros((5, 1)), np.full(7, 9e-6), 1e-6)
    shapes = {sample.force.shape, sample.stiffness.shape, sample.position_slope.shape, sample.validity.shape}
    assert shapes == {(5, 7)}
    assert four_axes.ste(0.0, 2660.0).shape == ()


def test_an_axis_that_does_not_hold_zero_defaults_to_its_only_value(make):
    database = make(misalignment=[30e-6])
    assert np.array_equal(
        database.ste(database.position, 2660.0), database.static_transmission_error[:, 2, 0, 0]
    )


class TestFourAxes:
    """The same laws with misalignment and center distance as axes."""

    m = RNG.uniform(-30e-6, 60e-6, X.size)
    c = RNG.uniform(-2e-4, 1.5e-4, X.size)

    @pytest.mark.parametrize("axis", ["x", "m", "c"])
    def test_c1_in_every_axis(self, four_axes, axis):
        """At random points and on all knots, left and right differences close up with the step."""
        x = np.r_[X[:400], RNG.choice(four_axes.position, 400)]
        m = np.r_[self.m[:400], RNG.choice(four_axes.misalignment[1:-1], 400)]
        c = np.r_[self.c[:400], RNG.choice(four_axes.center_distance_change[1:-1], 400)]
        d = four_axes.ste(x, F[:800], m, c)
        unit = {"x": 1.0, "m": 90e-6, "c": 3.5e-4}[axis]

        def gap(step):
            by = {name: step * unit if name == axis else 0.0 for name in "xmc"}
            left, here, right = (
                four_axes.force_at(x + k * by["x"], d, m + k * by["m"], c + k * by["c"]).force
                for k in (-1, 0, 1)
            )
            return np.abs(left + right - 2.0 * here).max() / step

        slope = abs(gap(1e-3))
        assert gap(1e-6) <= 0.02 * slope


def test_closed_form_table_of_two_levels():
    """F = k (d - e): two levels of equal stiffness give a straight line from lift-off."""
    position = np.arange(8) / 8
    stiffness, lift_off, top = 3e8, 1e-6, 1000.0
    deflection = np.broadcast_to([lift_off, lift_off + top / stiffness], (1, 1, 8, 2))
    flat = np.zeros((1, 1, 8, 2))
    table = ForceTable(position, [0.0, top], [0.0], [0.0], deflection, flat, flat + stiffness, flat)
    d = np.linspace(0.0, 9e-6, 100)
    sample = MeshForce(table).force_at(0.37, d, 0.0, 0.0)
    assert np.allclose(sample.force, np.maximum(stiffness * (d - lift_off), 0.0), rtol=1e-12, atol=1e-9)


SLOPES = {"deflection", "deflection_slope", "stiffness", "stiffness_slope"}
ATTRIBUTES = {"position", "level", "misalignment", "center_distance_change", "period"} | SLOPES
OPTIONAL = {"sliding_share", "sliding_lever", "load_arm"} | {
    "deflection_derivative",
    "stiffness_derivative",
}


def stored(made, database):
    """Indices of the stored loads among the levels."""
    index = np.searchsorted(made.level, database.force * np.cos(database.geometry.base_helix_angle))
    assert np.array_equal(made.level[index], database.force * np.cos(database.geometry.base_helix_angle))
    return index


def test_attributes_are_the_contract_and_read_only(spur):
    assert {entry.name for entry in fields(ForceTable)} == ATTRIBUTES | OPTIONAL
    made = spur.force_table()
    assert made.load_arm.shape == made.deflection.shape
    assert made.deflection_derivative is None  # one place: the slopes say all
    assert made.stiffness_derivative is None
    shapes = {
        getattr(made, name).shape for name in ATTRIBUTES if name.startswith(("deflection", "stiffness"))
    }
    assert shapes == {(1, 1, 64, made.level.size)}
    assert np.all(np.diff(made.level) > 0.0)
    for name in ATTRIBUTES - {"period"}:
        with pytest.raises(ValueError, match="read-only"):
            getattr(made, name)[...] = 0.0


def test_axes_come_in_the_order_of_the_contract(four_axes):
    made = four_axes.force_table()
    assert made.deflection_derivative.shape == (2, 2, 2, *made.deflection.shape)
    assert np.array_equal(made.deflection_derivative[0, 0, 0], made.deflection)
    assert np.array_equal(made.deflection_derivative[0, 0, 1], made.deflection_slope)
    assert np.all(made.stiffness_derivative[0, 0, 0] <= made.stiffness)
    assert made.deflection.shape == (4, 3, 24, made.level.size)
    levels = made.deflection[2, 1, 5, stored(made, four_axes)]
    assert np.array_equal(levels, four_axes.static_transmission_error[5, :, 2, 1])
    # At levels between two loads it is linear in the force; at lift-off that of the lowest load.
    moved = np.random.default_rng(3).normal(size=four_axes.face_centroid.shape)
    made = replace(four_axes, load_arm=moved).force_table()
    at_loads = made.load_arm[..., stored(made, four_axes)]
    np.testing.assert_allclose(at_loads, np.moveaxis(moved, (0, 1), (2, 3)), rtol=1e-9, atol=1e-12)
    assert np.array_equal(made.load_arm[..., 0], at_loads[..., 0])


def test_a_table_without_load_arms_has_the_centroid_that_belonged_to_its_helix_slope(four_axes):
    made, bare = four_axes.force_table(), replace(four_axes, load_arm=np.empty((0, 0, 0, 0)))
    by_centroid = replace(four_axes, load_arm=four_axes.face_centroid).force_table()
    assert np.array_equal(bare.force_table().load_arm, by_centroid.load_arm)
    assert made.load_arm.shape == by_centroid.load_arm.shape


def test_levels_are_transverse_forces_from_lift_off(helical):
    made = helical.force_table()
    assert made.level[0] == 0.0
    assert stored(made, helical)[-1] == made.level.size - 1
    assert np.array_equal(made.deflection[0, 0, :, 0], helical.no_load_transmission_error[:, 0, 0])
    assert not made.stiffness[..., 0].any()
    assert not made.stiffness_slope[..., 0].any()
    compliance = np.moveaxis(helical.tangent_compliance, 1, -1)[:, 0, 0]
    expected = np.cos(helical.geometry.base_helix_angle) / compliance
    assert np.allclose(made.stiffness[0, 0][:, stored(made, helical)], expected, rtol=1e-14)


def test_stiffness_is_cut_to_three_times_the_secant(make):
    """A tangent that contradicts the neighboring levels must not make the force fall."""
    wild = make().tangent_compliance.copy()
    wild[7, 2] /= 100.0
    database = make(tangent_compliance=wild, pairs_in_contact=np.ones_like(wild))
    made = database.force_table()
    secant = np.diff(made.level) / np.diff(made.deflection[0, 0], axis=-1)
    at = stored(made, database)[2]
    # between the knots the bound is tighter than at them
    assert made.stiffness[0, 0, 7, at] > 0.75 * 3.0 * secant[7, at - 1 : at + 1].min()
    assert made.stiffness[0, 0, 7, at] < np.cos(database.geometry.base_helix_angle) / wild[7, 2]
    assert np.all(made.stiffness[0, 0, :, 1:] <= 3.0 * secant * (1.0 + 1e-9))


def test_slopes_in_position_are_those_of_the_contract_interpolant(spur):
    """d(x) by cubic Hermite from the table is what `ste` returns at the stored loads."""
    made = spur.force_table()
    t, h = 0.3, 1.0 / 64
    value, slope = made.deflection[0, 0], made.deflection_slope[0, 0]
    following, next_slope = np.roll(value, -1, axis=0), np.roll(slope, -1, axis=0)
    bends = h * (t * (1 - t) ** 2 * slope - t * t * (1 - t) * next_slope)
    curve = value * (1 + 2 * t) * (1 - t) ** 2 + following * t * t * (3 - 2 * t) + bends
    asked = spur.ste(spur.position[:, None] + t * h, spur.force)
    assert np.allclose(curve[:, stored(made, spur)], asked, rtol=1e-13)


def test_transmission_errors_that_fall_with_load_are_refused_by_name(make):
    noisy = make().static_transmission_error.copy()
    noisy[3, 1] = noisy[3, 2] + 2e-9
    with pytest.raises(
        DatabaseError, match=r"at 1 of 320 steps, worst from force 1330 N to 2660 N at position 0\.046875"
    ):
        make(static_transmission_error=noisy).force_table()
    lifted = make().no_load_transmission_error + 1e-6
    with pytest.raises(DatabaseError, match="from no load to 266 N"):
        make(no_load_transmission_error=lifted).force_table()
    level = make().static_transmission_error.copy()
    level[0, 1] = level[0, 0]
    with pytest.raises(DatabaseError, match="falls with load at 1 of"):
        make(static_transmission_error=level).force_table()


def test_failed_points_are_refused_by_number_and_name(make):
    database = make()
    ste, status = database.static_transmission_error.copy(), database.status.copy()
    for place, outcome in (((5, 1), Status.ITERATION_LIMIT), ((9, 4), Status.SINGULAR)):
        ste[place], status[place] = np.nan, outcome
    failed = replace(database, static_transmission_error=ste, status=status)
    with pytest.raises(
        SolveError, match=r"2 of 320 points FAILED .*position 0.078125, force 1330 N.*ITERATION_LIMIT"
    ) as caught:
        failed.force_table()
    assert caught.value.partial is failed
    made = failed.force_table(allow_failed=True)
    assert made.position.size * (made.level.size - 1) >= 62 * 5
