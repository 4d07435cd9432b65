"""Share of a tolerance that is left for interpolation between the nodes of a table's axes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fe_contact.allowed_error import AllowedError
from fe_contact.ste import SteDatabase
from fe_contact.ste.curve_errors import BETWEEN_NODES
from fe_contact.types import FloatArray

MIN_SHARE = 0.1
"""Part of a tolerance that an interval may always take: errors at nodes that leave less are refined first."""


@dataclass(frozen=True)
class IntervalGoal:
    """Goal of the intervals of all axes."""

    tolerance: AllowedError
    """Allowed error of mean and peak-to-peak STE."""
    used: FloatArray
    """Part of the tolerance that the errors at the nodes use. Shape (F, M, D)."""

    def shares(self, axis: str) -> FloatArray:
        """Return the part of the tolerance (I,) that interpolation may take in every interval of an axis.

        Errors of nodes and of all axes add up by squares at a point that is between the nodes of each.
        Where nodes alone use more than the tolerance, intervals may use as much as that.
        """
        number = BETWEEN_NODES.index(axis)
        others = tuple(i for i in range(3) if i != number)
        by_node = np.nan_to_num(self.used, nan=1.0).max(axis=others)
        by_interval = np.maximum(by_node[1:], by_node[:-1])
        several = sum(size > 1 for size in self.used.shape)
        left = np.sqrt(np.maximum(1.0 - by_interval**2, 0.0) / several)
        return np.where(by_interval < 1.0, np.maximum(left, MIN_SHARE), 1.0)


GoalOf = Callable[[SteDatabase], IntervalGoal]
"""Function that returns the goal of a table. Inserted nodes have errors too, so that the goal follows the
table.
"""
