"""Contact state of a mesh: which flanks touch."""

from __future__ import annotations

from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from dynamics.results.run_result import RunResult


class ContactState(IntEnum):
    """The flanks of a mesh that carry."""

    OFF = 0
    DRIVING = 1
    COAST = 2
    BOTH = 3


def contact_state(result: RunResult) -> NDArray[np.int8]:
    """Return a `ContactState` per mesh and sample, (m, T)."""
    return result.contact.astype(np.int8)


def contact_shares(result: RunResult) -> list[dict[str, float]]:
    """Return per mesh the share of the samples in each state, by its name in lower case."""
    states = contact_state(result)
    return [{state.name.lower(): float(np.mean(row == state)) for state in ContactState} for row in states]
