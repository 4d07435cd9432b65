"""The mesh-force table: what dynamics gets."""

from __future__ import annotations

from dataclasses import fields, replace

import numpy as np
import pytest

from fe_contact.errors import DatabaseError, SolveError
from fe_contact.ste import ForceTable
from fe_contact.types import Status

ATTRIBUTES = {
    "position",
    "level",
    "misalignment",
    "center_distance_change",
    "deflection",
    "deflection_slope",
    "stiffness",
    "stiffness_slope",
    "period",
}
OPTIONAL = {
    "sliding_share",
    "sliding_lever",
    "deflection_derivative",
    "stiffness_derivative",
    "face_centroid",
}


def stored(table, database):
    """Indices of the stored loads among the levels."""
    index = np.searchsorted(table.level, database.force * np.cos(database.facts.base_helix_angle))
    assert np.array_equal(table.level[index], database.force * np.cos(database.facts.base_helix_angle))
    return index


def test_attributes_are_the_contract(spur):
    assert {entry.name for entry in fields(ForceTable)} == ATTRIBUTES | OPTIONAL
    table = spur.force_table()
    assert table.face_centroid.shape == table.deflection.shape
    assert table.deflection_derivative is None  # one place: the slopes say all
    assert table.stiffness_derivative is None
    shapes = {
        getattr(table, name).shape for name in ATTRIBUTES if name.startswith(("deflection", "stiffness"))
    }
    assert shapes == {(1, 1, 64, table.level.size)}
    assert np.all(np.diff(table.level) > 0.0)


def test_arrays_are_read_only(spur):
    table = spur.force_table()
    for name in ATTRIBUTES - {"period"}:
        with pytest.raises(ValueError, match="read-only"):
            getattr(table, name)[...] = 0.0


def test_axes_come_in_the_order_of_the_contract(four_axes):
    table = four_axes.force_table()
    assert table.deflection_derivative.shape == (2, 2, 2, *table.deflection.shape)
    assert np.array_equal(table.deflection_derivative[0, 0, 0], table.deflection)
    assert np.array_equal(table.deflection_derivative[0, 0, 1], table.deflection_slope)
    assert np.all(table.stiffness_derivative[0, 0, 0] <= table.stiffness)
    assert table.deflection.shape == (4, 3, 24, table.level.size)
    levels = table.deflection[2, 1, 5, stored(table, four_axes)]
    assert np.array_equal(levels, four_axes.static_transmission_error[5, :, 2, 1])


def test_levels_are_transverse_forces(helical):
    table = helical.force_table()
    assert table.level[0] == 0.0
    assert stored(table, helical)[-1] == table.level.size - 1


def test_level_zero_is_lift_off(helical):
    table = helical.force_table()
    assert np.array_equal(table.deflection[0, 0, :, 0], helical.no_load_transmission_error[:, 0, 0])
    assert not table.stiffness[..., 0].any()
    assert not table.stiffness_slope[..., 0].any()


def test_stiffness_is_the_inverse_tangent_compliance_in_the_transverse_plane(helical):
    table = helical.force_table()
    compliance = np.moveaxis(helical.tangent_compliance, 1, -1)[:, 0, 0]
    expected = np.cos(helical.facts.base_helix_angle) / compliance
    assert np.allclose(table.stiffness[0, 0][:, stored(table, helical)], expected, rtol=1e-14)


def test_stiffness_is_cut_to_three_times_the_secant(make):
    """A tangent that contradicts the neighboring levels must not make the force fall."""
    wild = make().tangent_compliance.copy()
    wild[7, 2] /= 100.0
    # with one and the same number of pairs everywhere no levels are inserted
    table = make(tangent_compliance=wild, pairs_in_contact=np.ones_like(wild)).force_table()
    secant = np.diff(table.level) / np.diff(table.deflection[0, 0], axis=-1)
    # between the knots the bound can be a little tighter than at them
    assert table.stiffness[0, 0, 7, 3] == pytest.approx(3.0 * secant[7, 2:4].min(), rel=1e-2)
    assert np.all(table.stiffness[0, 0, :, 1:] <= 3.0 * secant)


def test_slopes_in_position_are_those_of_the_contract_interpolant(spur):
    """d(x) by cubic Hermite from the table is what `ste` returns at the stored loads."""
    table = spur.force_table()
    t, h = 0.3, 1.0 / 64
    value, slope = table.deflection[0, 0], table.deflection_slope[0, 0]
    following, next_slope = np.roll(value, -1, axis=0), np.roll(slope, -1, axis=0)
    bends = h * (t * (1 - t) ** 2 * slope - t * t * (1 - t) * next_slope)
    curve = value * (1 + 2 * t) * (1 - t) ** 2 + following * t * t * (3 - 2 * t) + bends
    asked = spur.ste(spur.position[:, None] + t * h, spur.force)
    assert np.allclose(curve[:, stored(table, spur)], asked, rtol=1e-13)


def test_falling_transmission_error_is_refused_by_name(make):
    noisy = make().static_transmission_error.copy()
    noisy[3, 1] = noisy[3, 2] + 2e-9
    with pytest.raises(
        DatabaseError, match=r"at 1 of 320 steps, worst from force 1330 N to 2660 N at position 0\.046875"
    ):
        make(static_transmission_error=noisy).force_table()


def test_load_below_lift_off_is_refused(make):
    lifted = make().no_load_transmission_error + 1e-6
    with pytest.raises(DatabaseError, match="from no load to 266 N"):
        make(no_load_transmission_error=lifted).force_table()


def test_equal_levels_are_refused(make):
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
    table = failed.force_table(allow_failed=True)
    assert table.position.size * (table.level.size - 1) >= 62 * 5


def test_the_centroid_of_the_load_is_that_of_the_database_at_its_loads(four_axes):
    """At levels between two loads it is linear in the force; at lift-off that of the lowest load."""
    moved = np.random.default_rng(3).normal(size=four_axes.face_centroid.shape)
    table = replace(four_axes, face_centroid=moved).force_table()
    at_loads = table.face_centroid[..., stored(table, four_axes)]
    np.testing.assert_allclose(at_loads, np.moveaxis(moved, (0, 1), (2, 3)), rtol=1e-9, atol=1e-12)
    assert np.array_equal(table.face_centroid[..., 0], at_loads[..., 0])
