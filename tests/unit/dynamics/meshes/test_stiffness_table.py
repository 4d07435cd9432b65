"""Tables in closed form: force and stiffness of k(x) (d - e(x)), curves of one period, bad input."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from dynamics.errors import InputError
from dynamics.meshes.mesh_table import check_table
from dynamics.meshes.packed_tables import pack_tables
from dynamics.meshes.stiffness_table import PeriodicCurve, stiffness_table, straight_table
from dynamics.meshes.table_lookup import table_force

POSITIONS = np.concatenate([[0.0, 0.999999], np.random.default_rng(3).uniform(-2.0, 3.0, 60)])
MEAN, SIZES, PHASES = 4e8, (6e7, -2e7, 1e7), (0.3, 1.2, -2.0)
ERROR = 5e-6


def stiffness(x: float) -> float:
    orders = range(1, 4)
    return MEAN + sum(
        a * math.cos(2 * math.pi * n * x + p) for a, p, n in zip(SIZES, PHASES, orders, strict=True)
    )


def test_a_harmonic_mesh_has_the_force_of_the_closed_form() -> None:
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


def test_tabulated_values_are_met_and_never_overshot() -> None:
    """A rectangular stiffness whose flanks take a hundredth of a pitch."""
    position, value = (0.1, 0.59, 0.6, 0.99), (3e8, 3e8, 2e8, 2e8)
    curve = PeriodicCurve.tabulated(position, value)
    np.testing.assert_allclose(curve(np.array(position))[0], value, rtol=1e-14)
    np.testing.assert_allclose(curve(np.array([0.3, 0.8, 1.3, -0.2]))[0], (3e8, 2e8, 3e8, 2e8), rtol=1e-14)
    everywhere = curve(np.linspace(0.0, 1.0, 1001))[0]
    assert (np.min(everywhere), np.max(everywhere)) == pytest.approx((2e8, 3e8), rel=1e-14)
    packed = pack_tables([stiffness_table(curve)])
    assert table_force(packed, 0, 0.3, 1e-5, 0)[0] == pytest.approx(3e3, rel=1e-12)


def test_a_curve_continues_into_the_next_period() -> None:
    curve = PeriodicCurve.tabulated((0.05, 0.2, 0.4, 0.7), (1.0, 3.0, 2.0, -1.0))
    for x in (0.0, 0.05, 0.63):
        assert curve(np.array([x + 1.0]))[0] == pytest.approx(curve(np.array([x]))[0], rel=1e-12)
    below, above = (curve(np.array([x]))[1] for x in (0.05 - 1e-9, 0.05 + 1e-9))
    assert below == pytest.approx(above, abs=1e-5)


def test_a_constant_mesh_is_straight() -> None:
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
def test_what_is_no_curve_is_named(field: str, make: Any) -> None:
    with pytest.raises(InputError) as caught:
        make()
    assert caught.value.field == field
