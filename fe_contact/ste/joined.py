"""Tables of single operating points of an axis as one table over all of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, Literal

import numpy as np

from fe_contact.ste.database import SteDatabase
from fe_contact.ste.fields import CURVE_ERROR, DIMENSIONS


def joined(
    tables: Sequence[SteDatabase], axis: Literal["misalignment", "center_distance_change"]
) -> SteDatabase:
    """Return the table over the values of an axis in `tables`, in their order.

    Facts and metadata are those of the first.

    Parameters
    ----------
    tables : sequence of SteDatabase
        Alike but for their values of the axis, which increase from one to the next.
    axis : str

    Raises
    ------
    DatabaseError
        If their other axes have different sizes or the values do not increase.
    """
    along = {name: dimensions.index(axis) for name, dimensions in DIMENSIONS.items() if axis in dimensions}
    along["curve_error"] = CURVE_ERROR.index(axis)
    whole: dict[str, Any] = {
        name: np.concatenate([getattr(table, name) for table in tables], axis=place)
        for name, place in along.items()
    }
    return replace(tables[0], **whole)
