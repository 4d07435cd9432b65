"""The compiled evaluation is that of the database to the last bit, wherever the question lies."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from sliced_face import sliced_database
from small_table import small_table

from fe_contact.errors import SolveError
from fe_contact.ste.compiled_force import CompiledForce

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
def test_forces_stiffnesses_and_flags_are_those_of_the_database(database) -> None:
    x, m, c, d = at = points(database)
    found, wanted = CompiledForce.of(database).force_at(at), database.force_at(x, d, m, c)
    assert np.array_equal(found.force, wanted.force)
    assert np.array_equal(found.stiffness, wanted.stiffness)
    assert np.array_equal(found.validity, wanted.validity)


def test_every_answer_is_asked_for(database) -> None:
    flags = CompiledForce.of(database).force_at(points(database)).validity
    assert {0, 1, 2} <= {int(flag) & 3 for flag in flags}
    outside = 4 * (database.misalignment.size > 1) + 8 * (database.center_distance_change.size > 1)
    assert outside == 0 or {int(flag) & outside for flag in flags} >= {0, outside}


def test_a_table_with_failed_points_is_refused() -> None:
    table = small_table()
    fields = {name: np.array(getattr(table, name)) for name in ("status", "static_transmission_error")}
    fields["status"][3, 1], fields["static_transmission_error"][3, 1] = 1, np.nan
    with pytest.raises(SolveError):
        CompiledForce.of(replace(table, **fields))
