"""Laws of the extracted force: C1, monotone, zero below lift-off, straight above, invertible."""

from __future__ import annotations

import numpy as np
import pytest

from fe_contact.errors import InputError
from fe_contact.ste import ForceTable, MeshForce, Validity

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


def test_stored_points_come_back_exactly(table):
    asked = table.ste(table.position[:, None], table.force)
    assert np.array_equal(asked, table.static_transmission_error[:, :, 0, 0])


def test_force_of_the_inverse_is_the_force(table):
    deflection = table.ste(X, F)
    sample = table.force_at(X, deflection)
    to_transverse = np.cos(table.facts.base_helix_angle)
    # a deflection is a float: its rounding times the stiffness is beyond any inverse
    rounding = 4.0 * np.spacing(np.abs(deflection)) * sample.stiffness
    assert np.all(np.abs(sample.force - F * to_transverse) <= 1e-10 * F + rounding)


def test_force_rises_with_deflection(table):
    for x in (0.0, 0.1234, 0.22, 0.7501):
        top = float(table.ste(x, table.force[-1]))
        low = float(table.ste(x, 0.0))
        deflection = np.linspace(low - 1e-7, top + 0.5 * (top - low), 5000)
        sample = table.force_at(x, deflection)
        pressed = deflection > low + 1e-6 * (top - low)
        assert np.all(np.diff(sample.force) >= -1e-10)
        assert np.all(np.diff(sample.force[pressed]) > 0.0)
        assert np.all(sample.stiffness >= 0.0)


def test_stiffness_is_the_derivative_in_deflection(table):
    deflection = table.ste(X, F + 1.0)
    step = 1e-5 * (table.ste(X, table.force[-1]) - table.ste(X, 0.0))
    sample = table.force_at(X, deflection)
    rise = table.force_at(X, deflection + step).force - table.force_at(X, deflection - step).force
    assert np.all(np.abs(rise / (2 * step) - sample.stiffness) <= 2e-3 * np.abs(sample.stiffness).max())


def one_sided(table, x, d, dx):
    """Differences in position to the left and right."""
    here = table.force_at(x, d).force
    return (here - table.force_at(x - dx, d).force) / dx, (table.force_at(x + dx, d).force - here) / dx


def test_position_slope_is_the_derivative_in_position_from_both_sides(table):
    deflection = table.ste(X, F)
    check_position_slope(table, X, deflection)


def test_position_slope_is_continuous_at_the_knots(table):
    x, f = (grid.ravel() for grid in np.meshgrid(table.position, np.linspace(10.0, 12000.0, 25)))
    check_position_slope(table, x, table.ste(x, f))


def test_position_slope_is_continuous_on_the_levels(table):
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


def test_lift_off_is_smooth(table):
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


def test_above_the_table_the_tangent_goes_on(table):
    top = table.ste(X, table.force[-1])
    edge = table.force_at(X, top)
    far = table.force_at(X, top + 1e-4)
    assert np.allclose(far.force, edge.force + edge.stiffness * 1e-4, rtol=1e-12)
    assert np.allclose(far.stiffness, edge.stiffness, rtol=1e-12)
    assert np.all(far.validity == Validity.ABOVE_TABLE)


def test_validity_of_deflections(spur):
    low, top = float(spur.ste(0.3, 0.0)), float(spur.ste(0.3, spur.force[-1]))
    asked = [low - 1e-9, low + 1e-9, 0.5 * (low + top), top, top * 1.001]
    expected = [Validity.LIFTED_OFF, Validity.INSIDE, Validity.INSIDE, Validity.INSIDE, Validity.ABOVE_TABLE]
    assert spur.force_at(0.3, asked).validity.tolist() == [flag.value for flag in expected]


def test_no_such_axis_flags_every_other_value(spur):
    deflection = float(spur.ste(0.3, 2660.0))
    inside = spur.force_at(0.3, deflection, misalignment=0.0, center_distance_change=0.0)
    outside = spur.force_at(0.3, deflection, misalignment=1e-6, center_distance_change=-1e-5)
    assert inside.validity == Validity.INSIDE
    assert outside.validity == Validity.OUTSIDE_MISALIGNMENT | Validity.OUTSIDE_CENTER_DISTANCE
    assert outside.force == inside.force


def test_flags_add_up(four_axes):
    sample = four_axes.force_at(0.2, -1.0, misalignment=[0.0, 1.0], center_distance_change=0.0)
    lifted, both = Validity.LIFTED_OFF, Validity.LIFTED_OFF | Validity.OUTSIDE_MISALIGNMENT
    assert sample.validity.tolist() == [lifted.value, both.value]


def test_an_axis_that_does_not_hold_zero_defaults_to_its_only_value(make):
    database = make(misalignment=[30e-6])
    assert np.array_equal(
        database.ste(database.position, 2660.0), database.static_transmission_error[:, 2, 0, 0]
    )


def test_broadcasting_keeps_shapes(four_axes):
    sample = four_axes.force_at(np.zeros((5, 1)), np.full(7, 9e-6), 1e-6)
    shapes = {sample.force.shape, sample.stiffness.shape, sample.position_slope.shape, sample.validity.shape}
    assert shapes == {(5, 7)}
    assert four_axes.ste(0.0, 2660.0).shape == ()


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_what_is_not_finite_is_refused(spur, bad):
    with pytest.raises(InputError, match=r"position = .*must be finite"):
        spur.force_at([0.0, bad], 1e-6)
    with pytest.raises(InputError, match="deflection"):
        spur.force_at(0.0, bad)


def test_pulling_is_refused(spur):
    with pytest.raises(InputError, match="force = -1"):
        spur.ste(0.0, [5.0, -1.0])


class TestFourAxes:
    """The same laws with misalignment and center distance as axes."""

    m = RNG.uniform(-30e-6, 60e-6, X.size)
    c = RNG.uniform(-2e-4, 1.5e-4, X.size)

    def test_stored_points_come_back_exactly(self, four_axes):
        grid = np.meshgrid(
            four_axes.position,
            four_axes.force,
            four_axes.misalignment,
            four_axes.center_distance_change,
            indexing="ij",
        )
        assert np.array_equal(four_axes.ste(*grid), four_axes.static_transmission_error)

    def test_force_of_the_inverse_is_the_force(self, four_axes):
        deflection = four_axes.ste(X, F, self.m, self.c)
        sample = four_axes.force_at(X, deflection, self.m, self.c)
        rounding = 4.0 * np.spacing(deflection) * sample.stiffness
        assert np.all(np.abs(sample.force - F) <= 1e-10 * F + rounding)

    def test_levels_keep_their_order(self, four_axes):
        levels = four_axes.ste(X[:, None], np.r_[0.0, four_axes.force], self.m[:, None], self.c[:, None])
        assert np.all(np.diff(levels, axis=1) > 0.0)

    def test_force_is_monotone(self, four_axes):
        deflection = np.linspace(-1e-6, 60e-6, 600)
        x, m, c = X[:60, None], self.m[:60, None], self.c[:60, None]
        sample = four_axes.force_at(x, deflection, m, c)
        assert np.all(np.diff(sample.force, axis=1) >= -1e-9)
        assert np.all(sample.stiffness >= 0.0)

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
