"""Steps over one common period, which end wherever a table has a knot."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dynamics.assembly.assemble import System
from dynamics.errors import InputError
from dynamics.forces.law import Law
from dynamics.linearize.common_period import CommonPeriod
from dynamics.types import FloatArray, IntArray

SAME = 1e-11  # of the period: nearer knots count as one, nearer step sizes as equal
MOST_STEPS = 1_000_000


@dataclass(frozen=True)
class PeriodGrid:
    """N steps of U different sizes, in common periods; the same at all speeds.

    Attributes
    ----------
    phase : (N + 1,) array
        Ends of the steps, from 0 to 1.
    size : (U,) array
        Of the steps, and 0 after them.
    level : (N,) int array
        Which size each step has.
    """

    phase: FloatArray
    size: FloatArray
    level: IntArray


def period_grid(system: System, period: CommonPeriod, largest: float) -> PeriodGrid:
    """Return steps of at most `largest` common periods, an equal number of them between any two knots.

    Tables have a kink in their second derivative at each knot (a jump of stiffness is a narrow interval
    between two of them): steps that end there keep the method's order.

    Raises
    ------
    InputError
        If that takes more than a million steps.
    """
    knots = _knots(system, period)
    counts = np.maximum(np.ceil(np.diff(knots) / largest * (1.0 - 1e-9)), 1.0)
    if np.sum(counts) > MOST_STEPS:
        bound = f"such that a period takes at most {MOST_STEPS} steps"
        suggestion = "Look at one stage or fewer different teeth, or at higher speeds."
        raise InputError("period", f"{period.revolutions} revolutions", bound, suggestion)
    inner = [
        np.linspace(start, end, int(count), endpoint=False)
        for start, end, count in zip(knots[:-1], knots[1:], counts, strict=True)
    ]
    phase = np.append(np.concatenate(inner), 1.0)
    key, level = np.unique(np.rint(np.diff(phase) / SAME), return_inverse=True)
    size = np.array([np.mean(np.diff(phase)[level == k]) for k in range(key.size)])
    return PeriodGrid(phase, np.append(size, 0.0), np.asarray(level, dtype=np.int64))


def refined(grid: PeriodGrid) -> PeriodGrid:
    """Return the grid with every step halved."""
    middle = 0.5 * (grid.phase[1:] + grid.phase[:-1])
    phase = np.sort(np.concatenate([grid.phase, middle]))
    return PeriodGrid(phase, 0.5 * grid.size, np.repeat(grid.level, 2))


def _knots(system: System, period: CommonPeriod) -> FloatArray:
    """Phases at which any flank passes a knot of its table, with 0 and 1."""
    elements, reference = system.arrays.elements, system.arrays.reference
    table = elements.laws.flank.table
    phases = [np.array([0.0, 1.0])]
    for law, entry, mesh in zip(elements.law, elements.entry, elements.mesh, strict=True):
        pitches = period.pitches[mesh] if law == Law.FLANK else 0
        if pitches == 0:
            continue
        first, span = table.offset[entry, 0], table.period[entry]
        last = int(np.searchsorted(table.knot[first:], span))
        knot = table.knot[first : first + last] + table.shift[entry] - reference.offset[mesh]
        cycles = abs(pitches) // round(span)
        passed = (knot[:, None] + span * np.arange(cycles)) / pitches
        phases.append(np.ravel(passed) % 1.0)
    phase = np.sort(np.concatenate(phases))
    kept = np.diff(phase, prepend=-1.0) > SAME
    phase = phase[kept]
    phase[-1] = 1.0
    return phase
