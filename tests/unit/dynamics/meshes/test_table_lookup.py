"""The compiled look-up: an independent evaluation, smoothness, periodicity, energy, inverse."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from geared_scenes import repeated, spring_table, square_wave_table
from scipy.interpolate import CubicHermiteSpline
from scipy.optimize import brentq

from dynamics.meshes.packed_tables import pack_tables
from dynamics.meshes.table_lookup import deflection_slope, table_deflection, table_energy, table_force

rng = np.random.default_rng(7)
TABLE = square_wave_table()


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
