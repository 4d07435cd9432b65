"""The start of a contact solution: the forces of another one that is near it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fe_contact.contact.problem import Candidates
from fe_contact.types import FloatArray


@dataclass(frozen=True)
class Start:
    """Forces of another solution, with bodies, slices, gaps or positions that are a little different.

    The solution is unique: its start changes it by rounding alone. The start saves the search for the
    carrying candidates, at least half of the iterations.
    """

    candidates: Candidates
    """Candidates on which the forces act."""
    force: FloatArray
    """Forces at the positions and loads to be solved, N; zeros where there is no solution to start from.
    Shape (P, L, n).
    """

    def on(self, candidates: Candidates) -> FloatArray:
        """Carry the forces over to other candidates (m,) of the same pairs: (P, L, m) in N.

        A candidate takes the line load of the nearest one of its pair; a pair that was not there starts
        unloaded.
        """
        known = self.candidates
        if np.array_equal(known.pair, candidates.pair) and np.array_equal(
            known.face_position, candidates.face_position
        ):
            return self.force
        alike = candidates.pair[:, None] == known.pair
        distance = np.where(alike, np.abs(candidates.face_position[:, None] - known.face_position), np.inf)
        nearest = alike & (distance == distance.min(axis=1)[:, None])
        share = nearest / np.maximum(nearest.sum(axis=1), 1)[:, None]
        return np.asarray(self.force @ share.T * (candidates.point_width / known.point_width))
