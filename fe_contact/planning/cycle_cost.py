"""Prediction of the cost of a table over several base pitches."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass

from bounds import at_most, engineering
from fe_contact.errors import InputError
from fe_contact.geometry import ParallelAxes
from fe_contact.planning.plan import Plan
from fe_contact.types import Json

MOST_ROWS = 150_000
"""Positions x alignments that a table may have: about 1 GB with its force table."""

# measured on tables of 4 to 186 candidates, 3 to 109 us a point
_SECONDS_PER_POINT, _SECONDS_PER_CANDIDATE = 3e-6, 0.55e-6
_BYTES_PER_ROW = 7000
# the search for the positions solves the assessed pitches and their neighbors about four times
_SEARCH = 12
# where positions are placed adaptively, teeth out of their places ask for about three times the least number
_ADAPTIVE = 3
_JUDGED_ALIGNMENTS = 3


@dataclass(frozen=True)
class CycleCost:
    """Size of a table and what it costs.

    Attributes
    ----------
    pitches : int
        Base pitches of the period.
    positions : int
        In each of them; the least number where they are placed adaptively.
    alignments : int
        Misalignments x center distances.
    cpu_seconds : float
        Predicted for the contact with its error estimate; right to a factor of two.
    """

    pitches: int
    positions: int
    alignments: int
    cpu_seconds: float

    @property
    def rows(self) -> int:
        """Positions over the whole period, at all alignments."""
        return self.pitches * self.positions * self.alignments

    def to_json(self) -> Json:
        """Return plain JSON."""
        return asdict(self)


def cycle_cost(pair: ParallelAxes, plan: Plan, pitches: int, alignments: int) -> CycleCost:
    """Predict the cost of a table over `pitches` base pitches."""
    positions = plan.positions or plan.nodes.start
    pairs = math.ceil(pair.transverse_contact_ratio + pair.overlap_ratio) + 2
    candidates = pairs * plan.discretization.slices
    assessed = min(alignments, _JUDGED_ALIGNMENTS) * plan.load.size
    solves = pitches * alignments * (2 * plan.load.size + plan.support.size)  # the loads on both meshes
    solves += assessed * (2 * pitches + _SEARCH * min(plan.nodes.assessed_pitches, pitches))
    per_point = _SECONDS_PER_POINT + _SECONDS_PER_CANDIDATE * candidates
    return CycleCost(
        pitches, positions, alignments, _expected(plan, pitches * alignments) * solves * per_point
    )


def _expected(plan: Plan, times: int) -> int:
    """Positions in a pitch that a table of so many pitches and alignments will probably have."""
    if plan.positions is not None:
        return plan.positions
    return max(min(_ADAPTIVE * plan.nodes.start, MOST_ROWS // times), plan.nodes.start)


def refuse_long_cycle(cost: CycleCost) -> None:
    """Refuse a table of more than `MOST_ROWS` rows, saying what it would cost and what to ask for.

    Raises
    ------
    InputError
        Of the field "pitches".
    """
    if cost.rows <= MOST_ROWS:
        return
    longest = MOST_ROWS // (cost.positions * cost.alignments)
    note = f" with {cost.positions} positions a pitch and {cost.alignments} alignments"
    gigabytes = cost.rows * _BYTES_PER_ROW / 1e9
    advice = (
        f"The table would have {cost.rows} rows, about "
        f"{engineering(cost.cpu_seconds, 2)} CPU s and {engineering(gigabytes, 2)} GB. "
        "Request fewer pitches (for example the teeth of one gear), positions or alignments, or give the "
        "deviations of one gear only."
    )
    raise InputError("pitches", cost.pitches, at_most(longest, note=note), advice)
