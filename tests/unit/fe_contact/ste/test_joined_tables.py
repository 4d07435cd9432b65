"""Tables of single misalignments and center distances joined are the table over all of them."""

from __future__ import annotations

import pytest
from sliced_face import sliced_database

from fe_contact.errors import DatabaseError
from fe_contact.ste.joined import joined

M, D = (-20e-6, 0.0, 15e-6), (0.0, 30e-6)


def test_joined_tables_are_the_table_over_all() -> None:
    over = [joined([sliced_database((m,), (d,), 8) for m in M], "misalignment") for d in D]
    assert joined(over, "center_distance_change").identical(sliced_database(M, D, 8))


def test_values_that_do_not_increase_are_refused() -> None:
    single = [sliced_database((m,), positions=8) for m in reversed(M)]
    with pytest.raises(DatabaseError):
        joined(single, "misalignment")
