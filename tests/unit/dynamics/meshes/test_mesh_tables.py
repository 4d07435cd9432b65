"""Tables of meshes: their laws, look-up, decimation, and the force of a flank."""

import math
from dataclasses import replace

import numpy as np
import pytest
from geared_scenes import repeated, spring_table, square_wave_table
from scipy.interpolate import CubicHermiteSpline
from scipy.optimize import brentq

from dynamics.errors import InputError
from dynamics.meshes.flank_force import FlankLaws, flank_force
from dynamics.meshes.grid_tables import GridTables
from dynamics.meshes.mesh_table import FIELDS, check_table
from dynamics.meshes.packed_tables import pack_tables
from dynamics.meshes.stiffness_table import PeriodicCurve, stiffness_table, straight_table
from dynamics.meshes.table_energy import table_energy
from dynamics.meshes.table_lookup import deflection_slope, table_deflection, table_force

# Tables that break the protocol are refused, each by its field.


TABLE = square_wave_table()


def broken():
    falling = TABLE.deflection.copy()
    falling[0, 0, 5, 3] = falling[0, 0, 5, 2]
    hole = TABLE.stiffness.copy()
    hole[0, 0, 7, 7] = np.nan
    soft = TABLE.stiffness.copy()
    soft[..., -1] = 0.0
    return [
        ("table", object()),
        ("table.position", replace(TABLE, position=TABLE.position + 0.1)),
        ("table.position", replace(TABLE, position=TABLE.position[::-1].copy())),
        ("table.position", replace(repeated(TABLE, 3), period=2)),
        ("table.period", replace(TABLE, period=0)),
        ("table.period", replace(TABLE, period=1.5)),
        ("table.level", replace(TABLE, level=TABLE.level + 1.0)),
        ("table.deflection", replace(TABLE, deflection=TABLE.deflection[..., :-1])),
        ("table.deflection", replace(TABLE, deflection=falling)),
        ("table.stiffness", replace(TABLE, stiffness=hole)),
        ("table.stiffness", replace(TABLE, stiffness=soft)),
    ]


@pytest.mark.parametrize(("field", "table"), broken())
def test_a_broken_table_is_refused(field, table):
    with pytest.raises(InputError) as caught:
        check_table(table, "table")
    assert caught.value.field == field


# Tables in closed form: force and stiffness of k(x) (d - e(x)), curves of one period, bad input.


POSITIONS = np.concatenate([[0.0, 0.999999], np.random.default_rng(3).uniform(-2.0, 3.0, 60)])
MEAN, SIZES, PHASES = 4e8, (6e7, -2e7, 1e7), (0.3, 1.2, -2.0)
ERROR = 5e-6


def stiffness(x: float) -> float:
    orders = range(1, 4)
    return MEAN + sum(
        a * math.cos(2 * math.pi * n * x + p) for a, p, n in zip(SIZES, PHASES, orders, strict=True)
    )


def test_a_harmonic_mesh_has_the_force_of_the_closed_form():
    curve = PeriodicCurve.harmonic(MEAN, SIZES, PHASES)
    table = stiffness_table(curve, PeriodicCurve.harmonic(0.0, (ERROR,), (0.0,)))
    check_table(table, "table")
    packed = pack_tables([table])
    for x in POSITIONS:
        error = ERROR * math.cos(2.0 * math.pi * x)
        for pressed in (1e-7, 2e-6, 7e-5):
            force, tangent = table_force(packed, 0, x, error + pressed, 0)[:2]
            assert force == pytest.approx(stiffness(x) * pressed, rel=3e-7, abs=MEAN * ERROR * 3e-7)
            assert tangent == pytest.approx(stiffness(x), rel=3e-7)
        assert table_force(packed, 0, x, error - 1e-7, 0)[0] == 0.0


def test_tabulated_values_are_met_and_never_overshot():
    """A rectangular stiffness whose flanks take a hundredth of a pitch."""
    position, value = (0.1, 0.59, 0.6, 0.99), (3e8, 3e8, 2e8, 2e8)
    curve = PeriodicCurve.tabulated(position, value)
    np.testing.assert_allclose(curve(np.array(position))[0], value, rtol=1e-14)
    np.testing.assert_allclose(curve(np.array([0.3, 0.8, 1.3, -0.2]))[0], (3e8, 2e8, 3e8, 2e8), rtol=1e-14)
    everywhere = curve(np.linspace(0.0, 1.0, 1001))[0]
    assert (np.min(everywhere), np.max(everywhere)) == pytest.approx((2e8, 3e8), rel=1e-14)
    packed = pack_tables([stiffness_table(curve)])
    assert table_force(packed, 0, 0.3, 1e-5, 0)[0] == pytest.approx(3e3, rel=1e-12)


def test_a_curve_continues_into_the_next_period():
    curve = PeriodicCurve.tabulated((0.05, 0.2, 0.4, 0.7), (1.0, 3.0, 2.0, -1.0))
    for x in (0.0, 0.05, 0.63):
        assert curve(np.array([x + 1.0]))[0] == pytest.approx(curve(np.array([x]))[0], rel=1e-12)
    below, above = (curve(np.array([x]))[1] for x in (0.05 - 1e-9, 0.05 + 1e-9))
    assert below == pytest.approx(above, abs=1e-5)


def test_a_constant_mesh_is_straight():
    packed = pack_tables([straight_table(3e8), stiffness_table(PeriodicCurve.constant(3e8))])
    for x in POSITIONS[:5]:
        for d in (-1e-6, 1e-9, 1e-5, 1e-3):
            assert table_force(packed, 0, x, d, 0)[0] == pytest.approx(3e8 * max(d, 0.0), rel=1e-12)
            assert table_force(packed, 1, x, d, 0) == table_force(packed, 0, x, d, 0)


@pytest.mark.parametrize(
    ("field", "make"),
    [
        ("value", lambda: stiffness_table(PeriodicCurve.harmonic(1.0, (1.5,), (0.0,)))),
        ("stiffness", lambda: straight_table(0.0)),
        ("phase", lambda: PeriodicCurve.harmonic(1.0, (0.5,), ())),
        ("position", lambda: PeriodicCurve.tabulated((0.0, 1.0), (1.0, 2.0))),
        ("position", lambda: PeriodicCurve.tabulated((0.0,), (1.0,))),
        ("value", lambda: PeriodicCurve.tabulated((0.0, 0.5), (1.0,))),
        ("value", lambda: PeriodicCurve.constant(math.nan)),
    ],
)
def test_what_is_no_curve_is_named(field, make):
    with pytest.raises(InputError) as caught:
        make()
    assert caught.value.field == field


# The compiled look-up: an independent evaluation, smoothness, periodicity, energy, inverse.


rng = np.random.default_rng(7)


def uneven_table():
    """Knots bunched near the handovers, the first not at 0, 40 levels."""
    knots = np.sort(np.concatenate([np.linspace(0.03, 0.9, 23), 0.22 + np.linspace(-0.02, 0.02, 60)]))
    level = np.concatenate([[0.0], np.geomspace(1.0, 1e4, 39)])
    height = 1e-6 * (2.0 + np.sin(2 * np.pi * knots))[:, None]
    deflection = height * level**0.9 / 100.0 + height
    slope = 1e-6 * 2 * np.pi * np.cos(2 * np.pi * knots)[:, None] * (1.0 + level**0.9 / 100.0)
    with np.errstate(divide="ignore"):
        stiffness = np.where(level > 0.0, 100.0 * level**0.1 / (0.9 * height), 0.0)
    return replace(
        TABLE,
        position=knots,
        level=level,
        deflection=deflection[None, None],
        deflection_slope=slope[None, None],
        stiffness=stiffness[None, None],
        stiffness_slope=0.0 * stiffness[None, None],
    )


def hunting_table(period):
    """`uneven_table` over many pitches, each higher or lower than the last."""
    table = repeated(uneven_table(), period)
    phase = 2 * np.pi * table.position[:, None] / period
    height, slope = 1e-6 * np.cos(phase), -1e-6 * np.sin(phase) * 2 * np.pi / period
    return replace(
        table,
        deflection=table.deflection + height,
        deflection_slope=table.deflection_slope + slope,
    )


def reference_force(table, x, d):
    """The rule of docs/reference/contracts.md by SciPy: levels over position, then force over deflection."""
    knots = np.append(table.position, table.position[0] + table.period)
    phase = (x - knots[0]) % table.period + knots[0]

    def over_position(values, slopes):
        wrap = [np.concatenate([a[0, 0], a[0, 0][:1]]) for a in (values, slopes)]
        return CubicHermiteSpline(knots, *wrap)(phase)

    levels = over_position(table.deflection, table.deflection_slope)
    stiffness = over_position(table.stiffness, table.stiffness_slope)
    if d < levels[0]:
        return 0.0
    if d >= levels[-1]:
        return table.level[-1] + stiffness[-1] * (d - levels[-1])
    return float(CubicHermiteSpline(levels, table.level, stiffness)(d))


@pytest.mark.parametrize(
    "table",
    [TABLE, uneven_table(), spring_table(4e8, 1e-6), hunting_table(7)],
    ids=["square", "uneven", "spring", "hunting"],
)
def test_it_equals_the_stated_rule(table):
    packed = pack_tables([spring_table(1e6), table])  # second entry: the offsets matter
    top = 1.3 * table.deflection.max()
    for x, d in zip(rng.uniform(-9, 9, 400), rng.uniform(-0.1 * top, top, 400), strict=True):
        force, _, _ = table_force(packed, 1, x, d, int(rng.integers(-5, 60)))
        assert force == pytest.approx(reference_force(table, x, d), rel=1e-9, abs=1e-7)


def test_it_passes_through_the_knots():
    packed = pack_tables([TABLE])
    for i, k in ((0, 3), (17, 6), (63, 8)):
        found = table_force(packed, 0, TABLE.position[i], TABLE.deflection[0, 0, i, k], 0)
        assert found[0] == pytest.approx(TABLE.level[k])
        assert found[1] == pytest.approx(TABLE.stiffness[0, 0, i, k])


def test_whole_pitches_change_nothing():
    packed = pack_tables([TABLE])
    for x in (0.0, 0.25, 0.999, 0.5 - 1e-12):
        exact = table_force(packed, 0, x, 6e-6, 0)
        for turns in (-4, 1, 1000):
            assert table_force(packed, 0, x + turns, 6e-6, 0)[0] == pytest.approx(exact[0], rel=1e-9)
    assert np.isfinite(table_force(packed, 0, -1e-18, 6e-6, 0)[0])


@pytest.mark.parametrize("period", [2, 20, 1560])
def test_equal_pitches_written_out_give_the_forces_of_one(period):
    packed = pack_tables([TABLE, repeated(TABLE, period)])
    slope = np.abs(TABLE.stiffness).max() * np.abs(TABLE.deflection_slope).max()
    for x, d in zip(rng.uniform(0.0, 1.0, 200), rng.uniform(0.0, 30e-6, 200), strict=True):
        one = table_force(packed, 0, x, d, 0)
        for turns in (0, 1, period - 1):
            many = table_force(packed, 1, x + turns, d, 0)
            # 1e-12 of the force, beside the rounding of the position itself
            rounding = np.spacing(x + turns) * slope
            assert many[0] == pytest.approx(one[0], rel=1e-12, abs=2.0 * rounding)


def test_whole_periods_change_nothing_and_other_pitches_do():
    packed = pack_tables([hunting_table(7)])
    for x in (0.0, 0.25, 6.75, 3.5):
        here = table_force(packed, 0, x, 60e-6, 0)[0]
        for periods in (-3, 1, 1000):
            again = table_force(packed, 0, x + 7 * periods, 60e-6, 0)[0]
            assert again == pytest.approx(here, rel=1e-9)
        assert abs(table_force(packed, 0, x + 1, 60e-6, 0)[0] / here - 1.0) > 1e-4


def test_positions_just_below_a_period_stay_in_the_table():
    packed = pack_tables([hunting_table(7)])
    seam = packed.shift[0]
    at = table_force(packed, 0, seam, 60e-6, 0)[0]
    for x in (seam - 1e-18, np.nextafter(seam, 0.0), seam + 7.0, np.nextafter(seam + 7.0, 0.0), -1e-300):
        found = table_force(packed, 0, x, 60e-6, 0)[0]
        assert found == pytest.approx(at if x != -1e-300 else table_force(packed, 0, 0.0, 60e-6, 0)[0])


@pytest.mark.law
def test_the_tangent_is_the_derivative_and_continuous_everywhere():
    packed = pack_tables([TABLE])
    for x in rng.uniform(0, 1, 10):
        d = np.concatenate([np.linspace(-1e-6, 1e-6, 8001), np.linspace(1.01e-6, 40e-6, 4001)])
        force = np.array([table_force(packed, 0, x, value, 0)[0] for value in d])
        tangent = np.array([table_force(packed, 0, x, value, 0)[1] for value in d])
        chord = np.diff(force) / np.diff(d)
        np.testing.assert_allclose(0.5 * (tangent[1:] + tangent[:-1]), chord, atol=2e-3 * tangent.max())
        assert np.abs(np.diff(tangent)).max() < 0.2 * tangent.max()  # no jump, not at lift-off either


def test_no_force_below_lift_off():
    packed = pack_tables([spring_table(1e8, 2e-6)])
    assert table_force(packed, 0, 0.0, 1.99e-6, 0)[:2] == (0.0, 0.0)
    assert table_force(packed, 0, 0.5, -1.99e-6, 0)[0] > 0.0


def test_energy_is_the_integral_of_force_and_its_slope_in_position():
    packed = pack_tables([uneven_table()])
    for x, d in zip(rng.uniform(0, 1, 40), rng.uniform(1e-6, 130e-6, 40), strict=True):
        energy, slope = table_energy(packed, 0, x, d, 0)
        grid = np.linspace(0.5e-6, d, 20001)
        force = np.array([table_force(packed, 0, x, value, 0)[0] for value in grid])
        assert energy == pytest.approx(np.trapezoid(force, grid), rel=2e-5, abs=1e-12)
        ahead, behind = (table_energy(packed, 0, x + s, d, 0)[0] for s in (1e-7, -1e-7))
        assert slope == pytest.approx((ahead - behind) / 2e-7, rel=1e-3, abs=1e-4 * abs(energy) + 1e-12)


def test_deflection_inverts_force_and_slopes_along():
    packed = pack_tables([TABLE])
    for x, force in zip(rng.uniform(0, 1, 60), rng.uniform(1.0, 15e3, 60), strict=True):
        d = table_deflection(packed, 0, x, force)
        bracket = brentq(
            lambda v, x=x, force=force: table_force(packed, 0, x, v, 0)[0] - force, 0, 80e-6, xtol=1e-18
        )
        assert d == pytest.approx(bracket, rel=1e-11)
        change = (
            table_deflection(packed, 0, x + 1e-7, force) - table_deflection(packed, 0, x - 1e-7, force)
        ) / 2e-7
        assert deflection_slope(packed, 0, x, force) == pytest.approx(change, rel=1e-4, abs=1e-10)
    assert table_deflection(packed, 0, 0.3, 0.0) == table_deflection(packed, 0, 0.3, -5.0) == 0.0


# Tables on every second position: the Hermite interpolant of the nodes that stay.


def each(table, every):
    """The table of every n-th node, written out."""
    kept = {name: getattr(table, name)[:, :, ::every] for name in FIELDS}
    return replace(table, position=table.position[::every], **kept)


def uneven(positions=31):
    """An odd number of uneven nodes, the first not at 0."""
    table = square_wave_table(positions)
    return replace(table, position=0.03 + 0.9 * table.position**1.3)


@pytest.mark.parametrize("every", [2, 4])
def test_decimating_packed_tables_is_packing_decimated_ones(every):
    tables = [uneven(), square_wave_table(64), spring_table(4e8, 1e-6, positions=16)]
    found, expected = pack_tables(tables).decimated(every), pack_tables([each(t, every) for t in tables])
    for name in found._fields:
        if name not in ("row", "energy"):
            np.testing.assert_allclose(getattr(found, name), getattr(expected, name), rtol=1e-12)
    for columns in (slice(0, 4), slice(4, 8)):  # deflections, stiffnesses
        size = np.abs(expected.row[:, columns]).max()
        np.testing.assert_allclose(found.row[:, columns], expected.row[:, columns], atol=1e-14 * size)
    np.testing.assert_allclose(found.energy, expected.energy, atol=1e-14 * expected.energy.max())
    for flank in range(3):
        for x in np.linspace(-1.0, 2.0, 61):
            one, other = (table_force(packed, flank, x, 6e-6, 0)[0] for packed in (found, expected))
            assert one == pytest.approx(other, rel=1e-9, abs=1e-9)


def test_flanks_of_one_table_share_its_rows_and_have_its_forces():
    first, second = uneven(), square_wave_table(64)
    for every in (1, 2):
        alone = [pack_tables([table]).decimated(every) for table in (first, second)]
        shared = pack_tables([first, second, first]).decimated(every)
        assert len(shared.row) == len(shared.energy) == sum(len(packed.row) for packed in alone)
        for flank, packed in enumerate([*alone, alone[0]]):
            for x in np.linspace(-1.0, 2.0, 31):
                assert table_force(shared, flank, x, 6e-6, 0) == table_force(packed, 0, x, 6e-6, 0)
    grids = GridTables.packed([first, second, first]).decimated()
    np.testing.assert_array_equal(grids.number, GridTables.packed([first, second]).decimated().number)
    assert grids.first[2] == grids.first[0] != grids.first[1]


def test_grids_keep_the_same_nodes():
    tables = [uneven(), square_wave_table(64)]
    found, expected = GridTables.packed(tables).decimated(), GridTables.packed([each(t, 2) for t in tables])
    for name in ("shape", "first", "channels"):
        np.testing.assert_array_equal(getattr(found, name), getattr(expected, name))
    per_level = found.number.reshape(-1, int(found.channels[0]) * 2)[:, :4]  # levers have slopes of their own
    np.testing.assert_allclose(per_level, expected.number.reshape(per_level.shape[0], -1)[:, :4], rtol=1e-12)


def test_a_table_of_few_nodes_stays_as_it_is():
    packed = pack_tables([spring_table(4e8, 1e-6, positions=4)])
    np.testing.assert_array_equal(packed.decimated().row, packed.row)


# Damping acts in contact only, in full under load, and never pulls.


LAW = FlankLaws(pack_tables([square_wave_table()]), np.array([2000.0]), np.array([133.0]))


def test_in_full_contact_it_is_viscous():
    elastic = flank_force(LAW, 0, 0.1, 6e-6, 0.0, 0)[0]
    assert elastic > 133.0
    for rate in (-0.01, 0.02):
        assert flank_force(LAW, 0, 0.1, 6e-6, rate, 0)[0] == pytest.approx(elastic + 2000.0 * rate)


def test_out_of_contact_there_is_none():
    assert flank_force(LAW, 0, 0.1, -1e-9, 10.0, 0)[0] == 0.0


def test_it_never_pulls():
    rates = np.linspace(-50.0, 50.0, 101)
    for d in np.linspace(-1e-6, 8e-6, 50):
        forces = np.array([flank_force(LAW, 0, 0.3, d, rate, 0)[0] for rate in rates])
        assert np.all(forces >= 0.0)
        assert np.all(np.diff(forces) >= 0.0)  # damping takes energy at every rate


def test_derivatives_are_those_of_the_force():
    h = 1e-12
    for d, rate in ((0.2e-6, 0.01), (0.1e-6, -0.002), (6e-6, 0.05)):
        _, _, tangent, viscous, _ = flank_force(LAW, 0, 0.4, d, rate, 0)
        up, down = (flank_force(LAW, 0, 0.4, d + s, rate, 0)[0] for s in (h, -h))
        assert tangent == pytest.approx((up - down) / (2 * h), rel=1e-3)
        up, down = (flank_force(LAW, 0, 0.4, d, rate + s, 0)[0] for s in (1e-6, -1e-6))
        assert viscous == pytest.approx((up - down) / 2e-6, rel=1e-6)
