"""Tables over all axes: joined, compiled to the same bits, and where the load slides."""

import math
from dataclasses import replace

import numpy as np
import pytest
from sliced_face import sliced_database
from small_table import small_table

from fe_contact.errors import DatabaseError, SolveError
from fe_contact.ste.compiled_force import CompiledForce
from fe_contact.ste.extraction import sliding_sums
from fe_contact.ste.joined_tables import joined_over_misalignment
from fe_contact.ste.load_levels import SMOOTHING

M = (-20e-6, 0.0, 15e-6)


def test_joined_tables_are_the_table_over_all_misalignments():
    single = [sliced_database((m,), positions=8) for m in M]
    assert joined_over_misalignment(single).identical(sliced_database(M, positions=8))


def test_misalignments_that_do_not_increase_are_refused():
    single = [sliced_database((m,), positions=8) for m in reversed(M)]
    with pytest.raises(DatabaseError):
        joined_over_misalignment(single)


def test_a_single_pair_slides_by_its_distance_from_the_pitch_point():
    """It approaches before x = 0 (pair -1 just before the next whole pitch) and recedes after."""
    database = sliced_database((0.0,), (0.0,), positions=40)
    for pair, sign in ((0, 1.0), (-1, -1.0)):
        direction, arm = (a[:, 0, 0, 0] for a in sliding_sums(replace(database, pair=np.array([pair]))))
        y = (database.position + pair) * database.geometry.base_pitch
        far = np.abs(y) > 0.1 * database.geometry.base_pitch
        np.testing.assert_allclose(direction[far], sign, atol=0.5 * (SMOOTHING / 0.1) ** 2)
        np.testing.assert_allclose(arm[far], np.abs(y[far]), rtol=0.5 * (SMOOTHING / 0.1) ** 2)
        assert np.all(arm >= 0.0)
    assert sliding_sums(replace(database, pair=np.array([0])))[0][0, 0, 0, 0] == 0.0  # at the pitch point


@pytest.mark.parametrize("angle", [1e-4, 0.2, 0.5])
def test_helical_teeth_have_the_mean_over_their_line_of_contact(angle):
    database = sliced_database((0.0,), (0.0,), positions=8)
    geometry = replace(database.geometry, base_helix_angle=angle, helix_hand=1)
    torque = database.torque * math.cos(angle)
    found = sliding_sums(replace(database, geometry=geometry, torque=torque, pair=np.array([0])))
    along = np.linspace(-0.5, 0.5, 20001) * geometry.face_width * math.tan(angle)
    y = database.position[:, None] * geometry.base_pitch + along
    sign = y / np.sqrt(y**2 + (SMOOTHING * geometry.base_pitch) ** 2)
    for values, exact in zip(found, (sign, sign * y), strict=True):
        mean = np.trapezoid(exact, dx=1.0 / (along.size - 1), axis=1)
        np.testing.assert_allclose(values[:, 0, 0, 0], mean, rtol=1e-5, atol=1e-5 * np.abs(mean).max())


COUNT = 4000
TABLES = {
    "one axis": small_table,
    "misalignment": lambda: sliced_database(positions=7, forces=(300.0, 2660.0)),
    "distance": lambda: sliced_database((0.0,), (-1e-4, 0.0, 3e-5), positions=5),
    "all axes": lambda: sliced_database((-2e-5, 0.0, 1e-5), (-1e-4, 0.0, 1e-4), positions=6),
    "one position": lambda: sliced_database((-2e-5, 0.0, 1e-5), positions=1),
    "one number": lambda: sliced_database((0.0,), positions=1),
}


@pytest.fixture(params=TABLES)
def database(request):
    return TABLES[request.param]()


def points(database):
    """Questions between, on and beyond the knots of every axis, from lift-off to far above the table."""
    random = np.random.default_rng(7)
    knots = [database.position, database.misalignment, database.center_distance_change]
    reach = (3.0, 4e-5, 2e-4)
    x, m, c = (
        np.where(random.random(COUNT) < 0.3, random.choice(knot, COUNT), random.uniform(-far, far, COUNT))
        for knot, far in zip(knots, reach, strict=True)
    )
    d = random.uniform(-1e-5, 1.2 * database.static_transmission_error.max(), COUNT)
    return np.array([x, m, c, d])


@pytest.mark.law
def test_forces_stiffnesses_and_flags_are_those_of_the_database(database):
    x, m, c, d = at = points(database)
    found, wanted = CompiledForce.of(database).force_at(at), database.force_at(x, d, m, c)
    assert np.array_equal(found.force, wanted.force)
    assert np.array_equal(found.stiffness, wanted.stiffness)
    assert np.array_equal(found.validity, wanted.validity)


def test_every_answer_is_asked_for(database):
    flags = CompiledForce.of(database).force_at(points(database)).validity
    assert {0, 1, 2} <= {int(flag) & 3 for flag in flags}
    outside = 4 * (database.misalignment.size > 1) + 8 * (database.center_distance_change.size > 1)
    assert outside == 0 or {int(flag) & outside for flag in flags} >= {0, outside}


def test_a_table_with_failed_points_is_refused():
    table = small_table()
    fields = {name: np.array(getattr(table, name)) for name in ("status", "static_transmission_error")}
    fields["status"][3, 1], fields["static_transmission_error"][3, 1] = 1, np.nan
    with pytest.raises(SolveError):
        CompiledForce.of(replace(table, **fields))
