"""Named points of a reduced housing."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dynamics.errors import InputError
from dynamics.housing_modes.reduced_housing import PointMotion, ReducedHousing
from dynamics.types import FloatArray


def named_points(housing: ReducedHousing, names: Sequence[str] | None = None) -> tuple[PointMotion, ...]:
    """Return points by their names, by default all.

    Raises
    ------
    InputError
        The housing has no such point, or none at all.
    """
    if not housing.points:
        raise InputError(
            "points", [], "at least one named point", "Name points where the housing is reduced."
        )
    point_of = {point.name: point for point in housing.points}
    for index, name in enumerate(names or ()):
        if name not in point_of:
            raise InputError(f"points[{index}]", name, f"one of {', '.join(point_of)}")
    return tuple(point_of.values()) if names is None else tuple(point_of[name] for name in names)


def point_rows(housing: ReducedHousing, names: Sequence[str] | None = None) -> FloatArray:
    """Return the motion of named points per reduced coordinate, (k, 3, r); by default of all, even none."""
    points = named_points(housing, names) if housing.points or names else ()
    return np.array([point.motion for point in points]).reshape(-1, 3, len(housing.mass))
