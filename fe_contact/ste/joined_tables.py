"""Tables of single misalignments as one table over all of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from fe_contact.ste.database import SteDatabase
from fe_contact.ste.table_repair import AXIS
from fe_contact.types import FloatArray


def joined_over_misalignment(tables: Sequence[SteDatabase]) -> SteDatabase:
    """Return the table over the misalignments of `tables`, in their order.

    Geometry and metadata are those of the first. `tables`: alike but for their misalignments, which increase
    from one to the next. Raises `DatabaseError`: their other axes have different sizes or the misalignments
    do not increase.
    """
    along = {
        name: dimensions.index(AXIS) for name, dimensions in tables[0].stored.items() if AXIS in dimensions
    }
    joined: dict[str, Any] = {
        name: np.concatenate(_of_all_sources([getattr(table, name) for table in tables], name), axis=axis)
        for name, axis in along.items()
    }
    return replace(tables[0], **joined)


def _of_all_sources(errors: list[FloatArray], name: str) -> list[FloatArray]:
    """Return arrays with as many sources of errors: one that a table lacks adds none to it."""
    if name not in ("curve_error", "load_arm_error"):
        return errors
    count = max(len(array) for array in errors)
    return [np.concatenate([array, np.zeros((count - len(array), *array.shape[1:]))]) for array in errors]
