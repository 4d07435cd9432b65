"""Tables of single misalignments as one table over all of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from fe_contact.ste.database import SteDatabase

AXIS = "misalignment"


def joined_over_misalignment(tables: Sequence[SteDatabase]) -> SteDatabase:
    """Return the table over the misalignments of `tables`, in their order.

    Facts and metadata are those of the first.

    Parameters
    ----------
    tables : sequence of SteDatabase
        Alike but for their misalignments, which increase from one to the next.

    Raises
    ------
    DatabaseError
        If their other axes have different sizes or the misalignments do not increase.
    """
    along = {
        name: dimensions.index(AXIS) for name, dimensions in tables[0].stored.items() if AXIS in dimensions
    }
    joined: dict[str, Any] = {
        name: np.concatenate([getattr(table, name) for table in tables], axis=axis)
        for name, axis in along.items()
    }
    return replace(tables[0], **joined)
