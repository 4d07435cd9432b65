"""Positions that were solved for several contacts together, and the tables made of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from verification.full_contact.table import FullContactPoint, FullContactTable

Loads = tuple[FullContactPoint, ...]
"""One position of one contact under all torques."""


@dataclass(frozen=True)
class SolvedPosition:
    """Points of each contact under all torques, the unknowns of both bodies, and CPU seconds."""

    contacts: tuple[Loads, ...]
    unknowns: int
    cpu_seconds: float = 0.0

    def with_error(self, coarse: SolvedPosition) -> SolvedPosition:
        """Return the points with errors: their differences from those of a coarser mesh."""
        pairs = zip(self.contacts, coarse.contacts, strict=True)
        return replace(self, contacts=tuple(_with_differences(point, other) for point, other in pairs))


def _with_differences(fine: Loads, coarse: Loads) -> Loads:
    return tuple(
        replace(point, error_estimate=abs(point.transmission_error - other.transmission_error))
        if point.status.usable
        else point
        for point, other in zip(fine, coarse, strict=True)
    )


def tables_of(
    positions: Sequence[float], torques: Sequence[float], solved: Sequence[SolvedPosition]
) -> tuple[FullContactTable, ...]:
    """Return a table for each contact; they share CPU seconds evenly."""
    count = len(solved[0].contacts)
    return tuple(
        FullContactTable(
            position=np.array(positions, dtype=float),
            torque=np.array(torques, dtype=float),
            points=tuple(position.contacts[number] for position in solved),
            unknowns=np.array([position.unknowns for position in solved], dtype=np.int64),
            cpu_seconds=np.array([position.cpu_seconds for position in solved]) / count,
        )
        for number in range(count)
    )
