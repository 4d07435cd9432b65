"""The constant-torque technique: F = k(x) d with k = nominal force over STE."""

from dataclasses import replace

import numpy as np
import pytest
from geared_scenes import NOMINAL_FORCE, Table, repeated, square_wave_table

from dynamics.errors import InputError
from dynamics.meshes.packed_tables import pack_tables
from dynamics.meshes.table_lookup import table_deflection, table_force
from dynamics.meshes.technique import secant_table, table_at

TABLE = square_wave_table()


@pytest.mark.parametrize("force", [NOMINAL_FORCE, 2000.0, 15e3])
def test_force_is_proportional_and_meets_the_table_at_the_nominal_force(force):
    plain = table_at(TABLE, 0.0, 0.0)
    both = pack_tables([plain, secant_table(plain, force)])
    for x in np.linspace(0.0, 1.0, 200):
        ste = table_deflection(both, 0, x, force)
        # between knots the secant is interpolated, at the knots it is exact
        near = min(abs(x * 64 - round(x * 64)), 1.0)
        tolerance = 1e-9 if near < 1e-9 else 4e-4
        assert table_force(both, 1, x, ste, 0)[0] == pytest.approx(force, rel=tolerance)
        assert table_force(both, 1, x, 0.5 * ste, 0)[0] == pytest.approx(0.5 * force, rel=3e-3)
        assert table_force(both, 1, x, 2.0 * ste, 0)[0] == pytest.approx(2.0 * force, rel=3e-3)


def test_a_force_without_deflection_is_refused():
    lifted = replace(TABLE, deflection=TABLE.deflection - 20e-6)
    with pytest.raises(InputError, match="nominal_force"):
        secant_table(table_at(lifted, 0.0, 0.0), NOMINAL_FORCE)


def test_tables_with_axes_are_used_at_one_operating_point():
    def widened(values, gain):
        return np.concatenate([values, gain * values], axis=0)

    wide = Table(
        TABLE.position,
        TABLE.level,
        np.array([0.0, 20e-6]),
        np.zeros(1),
        *(
            widened(getattr(TABLE, n), 3.0)
            for n in ("deflection", "deflection_slope", "stiffness", "stiffness_slope")
        ),
    )
    np.testing.assert_array_equal(table_at(wide, 0.0, 0.0).deflection, TABLE.deflection)
    np.testing.assert_allclose(table_at(wide, 5e-6, 0.0).deflection, 1.5 * TABLE.deflection)
    at_end = table_at(wide, 20e-6, 0.0).deflection
    np.testing.assert_array_equal(table_at(wide, 20e-6 * (1.0 + 1e-12), 0.0).deflection, at_end)  # rounded
    with pytest.raises(InputError, match="misalignment"):
        table_at(wide, 20e-6 * (1.0 + 1e-6), 0.0)
    with pytest.raises(InputError, match="misalignment"):
        table_at(wide, 21e-6, 0.0)
    with pytest.raises(InputError, match="center_distance_change"):
        table_at(wide, 0.0, 1e-6)


def test_both_techniques_keep_the_period():
    plain = table_at(repeated(TABLE, 3), 0.0, 0.0)
    assert plain.period == secant_table(plain, NOMINAL_FORCE).period == 3
