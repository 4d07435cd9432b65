"""Halving of the intervals of an axis until the table meets the solutions held out between its nodes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TypeVar

import numpy as np

from fe_contact.ste.curve_quantities import FIRST_HARMONIC, OFF_MESH, quantity_changes
from fe_contact.types import FloatArray

Axis = TypeVar("Axis")
"""An axis of a table with what is solved on it."""


def halved(
    axis: Axis,
    middles: Callable[[Axis], Sequence[float] | FloatArray],
    with_nodes: Callable[[Axis, FloatArray], Axis | None],
    limit: int,
    failure: str,
) -> tuple[Axis, str]:
    """Return an axis whose intervals meet a goal, or the reason why they do not; the reason is else empty.

    `middles` are the middles of the intervals that miss the goal. `with_nodes` makes them nodes, or returns
    None where one has no solution: the reason is then `failure`. `limit`: halvings.
    """
    halvings = 0
    while len(nodes := middles(axis)):
        if halvings == limit:
            return axis, f"the limit of {limit} halvings is reached"
        refined = with_nodes(axis, np.asarray(nodes))
        if refined is None:
            return axis, failure
        axis, halvings = refined, halvings + 1
    return axis, ""


def curve_differences(
    position: FloatArray, curves: FloatArray, truth: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the largest differences (...) of curves (R, ...) from solutions over one base pitch, m.

    With them come the changes of mean, peak-to-peak and harmonics (23, ...), m. `position`: shape (R,).
    """
    columns = curves.reshape(len(curves), -1), truth.reshape(len(truth), -1)
    change = quantity_changes(position, *columns, 1).reshape(-1, *truth.shape[1:])
    # one pitch has no orders beside the mesh: they count as the harmonic that changes most
    change[OFF_MESH] = change[FIRST_HARMONIC:].max(axis=0)
    return np.abs(curves - truth).max(axis=0), change
