"""Tables of single misalignments joined are the table over all of them."""

from __future__ import annotations

import pytest
from sliced_face import sliced_database

from fe_contact.errors import DatabaseError
from fe_contact.ste.database import joined_over_misalignment

M = (-20e-6, 0.0, 15e-6)


def test_joined_tables_are_the_table_over_all_misalignments() -> None:
    single = [sliced_database((m,), positions=8) for m in M]
    assert joined_over_misalignment(single).identical(sliced_database(M, positions=8))


def test_misalignments_that_do_not_increase_are_refused() -> None:
    single = [sliced_database((m,), positions=8) for m in reversed(M)]
    with pytest.raises(DatabaseError):
        joined_over_misalignment(single)
