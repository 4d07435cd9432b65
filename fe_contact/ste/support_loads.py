"""Support loads of a table: further loads by which it interpolates between the requested ones."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fe_contact.ste.table_repair import Table
from fe_contact.types import FloatArray, IntArray


@dataclass(frozen=True)
class SupportLoads:
    """Solutions at further loads of a table."""

    force: FloatArray
    """Normal forces, N, increasing. Shape (S,)."""
    deflection: FloatArray
    tangent: FloatArray
    """`deflection`, `tangent`: STE in m, and its derivative in m/N. Shape (P, S, M, D) each."""
    pairs: IntArray
    """Number of pairs that carry load. (P, S, M, D) integer array."""


def with_support_loads(table: Table, loads: SupportLoads) -> Table:
    """Return a table with further support loads."""
    order = np.argsort(np.concatenate([table.support_force, loads.force]))

    def merged(stored: NDArray[Any], further: NDArray[Any]) -> NDArray[Any]:
        return np.concatenate([stored, further], axis=1)[:, order]

    return replace(
        table,
        support_force=np.concatenate([table.support_force, loads.force])[order],
        support_transmission_error=merged(table.support_transmission_error, loads.deflection),
        support_tangent_compliance=merged(table.support_tangent_compliance, loads.tangent),
        support_pairs_in_contact=merged(table.support_pairs_in_contact, loads.pairs),
    )
