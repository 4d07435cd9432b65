"""Transmission error over a revolution or a hunting cycle, by derivatives held against exact pitches."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np

from fe_contact.allowed_error import AllowedError
from fe_contact.analysis.cycle.envelope import BATCH, DRAWN, CycleContact, Envelope
from fe_contact.analysis.pairs.pair_contact import operating_points
from fe_contact.analysis.request.model_choice import Decided, decide
from fe_contact.analysis.request.request_check import check_request
from fe_contact.analysis.tables import condensed_bodies
from fe_contact.errors import InputError, within
from fe_contact.geometry import ParallelAxes
from fe_contact.options import AnalysisOptions, Run, TableAxes
from fe_contact.planning.cost_model import unit_work
from fe_contact.ste.curve_quantities import (
    BESIDE_MESH,
    HARMONICS,
    MEAN,
    PEAK_TO_PEAK,
    QUANTITIES,
    Spectrum,
    spectrum,
)
from fe_contact.types import BoolArray, FloatArray
from model_studies import in_unit
from model_studies.stage_clock import StageClock

POSITIONS = 64
"""In a base pitch where none are requested."""
WHOLE = 4
"""Where one in so many pitches is to be solved, all are."""
_TANGENT = 0.4
"""CPU time of the tangents about a pitch over that of its solution."""
_ADDED = 4e-9
"""CPU seconds to add what one tooth of one pair does to one point."""


class CycleSeconds(NamedTuple):
    """CPU seconds that the contact of a cycle is predicted to take: all pitches solved, or by derivatives.

    The latter with the fewest pitches that they are held against.
    """

    exact: float
    derivatives: float

    @classmethod
    def of(cls, decided: Decided) -> CycleSeconds:
        """Predict them on condensed bodies."""
        pair, plan, pitches = decided.checked.request.pair, decided.plan, decided.checked.model.period
        rows, loads = plan.positions or POSITIONS, plan.load.size
        work = unit_work(pair, plan, plan.discretization.slices)
        states = min(DRAWN + BATCH, pitches)
        solved = (1.0 + _TANGENT) * work.in_pitches(rows, (loads,), states)
        teeth = 0.5 * (pair.pinion.teeth + pair.wheel.teeth) * rows * work.pitch
        meeting = 2 * (math.ceil(pair.transverse_contact_ratio + pair.overlap_ratio) + 1)
        added = _ADDED * meeting * states * pitches * rows * loads
        return cls(work.in_pitches(rows, (loads,), pitches), solved + teeth + added)


@dataclass(frozen=True)
class DeviatingCycle:
    """Transmission error over T base pitches, P even positions in each, at L loads.

    Attributes
    ----------
    teeth : (int, int)
        Of the driving and the driven gear.
    load : ndarray, shape (L,)
        Normal forces, N.
    ste : ndarray, shape (T, P, L)
        m, positive = the driven gear lags.
    solved : ndarray of bool, shape (T,)
        Pitches whose contact was solved; the others are by derivatives.
    error : ndarray, shape (L,)
        Of a position in a pitch that was not solved, m: what derivatives miss, not what meshes do.
    quantity_error : ndarray, shape (23, L)
        The same of mean, peak-to-peak, orders beside the mesh orders, and mesh harmonics, m.
    predicted : CycleSeconds
    """

    teeth: tuple[int, int]
    load: FloatArray = field(metadata=in_unit("n", "force"))
    ste: FloatArray = field(metadata=in_unit("m", "pitch", "position", "force"))
    solved: BoolArray
    error: FloatArray = field(metadata=in_unit("m", "force"))
    quantity_error: FloatArray = field(metadata=in_unit("m", "quantity", "force"))
    predicted: CycleSeconds

    def orders(self, load: int = -1) -> Spectrum:
        """Return the orders of mesh and shafts at one of the loads, with the errors of `quantity_error`."""
        errors = self.quantity_error[BESIDE_MESH:, load]
        return spectrum(self.ste[..., load].ravel(), len(self.ste), self.teeth, errors)


def deviating_cycle(
    pair: ParallelAxes,
    axes: TableAxes,
    options: AnalysisOptions = AnalysisOptions(),  # noqa: B008 (frozen)
    run: Run = Run(),  # noqa: B008 (frozen)
) -> DeviatingCycle:
    """Compute the transmission error until the teeth of both gears repeat, or over the pitches requested.

    Drawn pitches are solved, then those furthest from all that are, until derivatives give the others within
    the tolerance. Short cycles are solved whole, and those of which that takes a quarter.

    Parameters
    ----------
    axes : TableAxes
        Loads at one misalignment and center distance, and the pitches.
    options : AnalysisOptions
        The tolerance is that of mean and peak-to-peak, without one 1 % or 20 nm. Positions are even.
    run : Run
        Its workers condense; this process solves.

    Raises
    ------
    InputError
        A value that cannot be used, by field name.
    SolveError
        A point of the contact has no solution.
    """
    contact, predicted = cycle_contact(pair, axes, options, run)
    ste, solved, errors = _solved(contact, predicted, options.allowed)
    teeth = pair.pinion.teeth, pair.wheel.teeth
    return DeviatingCycle(teeth, contact.load, ste, solved, errors[0], errors[1:], predicted)


def cycle_contact(
    pair: ParallelAxes, axes: TableAxes, options: AnalysisOptions, run: Run
) -> tuple[CycleContact, CycleSeconds]:
    """Condense the gears of a cycle and predict its contact; parameters and errors of `deviating_cycle`."""
    for name in ("misalignment", "center_distance_change"):
        if (count := getattr(axes, name).size) > 1:
            raise InputError(f"{name}s", count, "one value", "A cycle has one alignment.")
    positions = options.positions or POSITIONS
    options = replace(options, positions=positions)
    within("positions", positions, 2 * HARMONICS + 1, 4096, "They tell twenty mesh harmonics apart.")
    decided = decide(check_request(pair, axes, options, whole_table=False), run.cache)
    request, plan = decided.checked.request, decided.plan
    bodies = condensed_bodies(decided.checked, plan, StageClock(run.workers.cost), run)
    (point,) = operating_points(request.scene, request.choices, bodies).places
    return CycleContact(point, np.arange(positions) / positions, plan.load), CycleSeconds.of(decided)


def _solved(
    contact: CycleContact, predicted: CycleSeconds, allowed: AllowedError
) -> tuple[FloatArray, BoolArray, FloatArray]:
    """Return the transmission error (T, P, L) in m, the pitches solved, and errors (1 + 23, L) in m.

    Of a position in another pitch, and of the quantities.
    """
    every, none = np.arange(contact.pitches), np.zeros((1 + QUANTITIES, contact.load.size))
    if contact.pitches <= WHOLE * DRAWN or predicted.derivatives >= predicted.exact:
        return contact.exact(every), every >= 0, none
    envelope = Envelope.of(contact)
    envelope = envelope.about(contact, envelope.next)
    while not _within(allowed, envelope):
        if WHOLE * np.count_nonzero(envelope.solved) > contact.pitches:
            ste, rest = envelope.exact.copy(), every[~envelope.solved]
            ste[rest] = contact.exact(rest)
            return ste, every >= 0, none
        envelope = envelope.about(contact, envelope.next)
    return envelope.ste, envelope.solved, np.vstack([envelope.missed.error, envelope.quantity_errors])


def _within(allowed: AllowedError, envelope: Envelope) -> bool:
    """Whether derivatives give mean and peak-to-peak within what is allowed, at all loads.

    The mean is that of nominal gears: deviations turn the gears, and it may be zero.
    """
    ste, errors = envelope.ste, envelope.quantity_errors
    values = np.stack([envelope.nominal, np.ptp(ste, axis=(0, 1))])
    return bool(np.all(errors[[MEAN, PEAK_TO_PEAK]] <= allowed.of(values)))
