"""Number of tooth pairs that carry the load of a table, in words for the captions."""

from __future__ import annotations

import numpy as np

from fe_contact.ste import SteDatabase
from fe_contact.types import IntArray
from lineofaction.report.tables.aligned import aligned_index

_EQUAL = 1e-6


def pairs_in_words(database: SteDatabase, load: int) -> str:
    """Say how many tooth pairs carry one load of the aligned pair: "2 to 4 tooth pairs carry the load"."""
    low, high = pair_range(database, load)
    if low == high:
        return f"{low} tooth {'pair carries' if low == 1 else 'pairs carry'} the load at every position"
    joint = "or" if high == low + 1 else "to"
    return f"{low} {joint} {high} tooth pairs carry the load"


def pair_range(database: SteDatabase, load: int) -> tuple[int, int]:
    """Return the least and the largest number of pairs that carry one load of the aligned pair."""
    counts = _counts(database, load)
    return int(counts.min()), int(counts.max())


def steps_with_pairs(database: SteDatabase, load: int) -> bool:
    """Whether the deflection steps down where more pairs carry: of spur pairs, if flanks do not hide it."""
    counts = _counts(database, load)
    low, high = counts.min(), counts.max()
    if low == high or database.facts.base_helix_angle != 0.0:
        return False
    m, d = aligned_index(database)
    ste = database.static_transmission_error[:, load, m, d]
    means = [float(np.nanmean(ste[counts == number])) for number in (low, high)]
    return means[1] < (1.0 - _EQUAL) * means[0]


def _counts(database: SteDatabase, load: int) -> IntArray:
    """Return the number of pairs in contact over the positions."""
    m, d = aligned_index(database)
    return np.asarray(database.pairs_in_contact[:, load, m, d], dtype=int)
