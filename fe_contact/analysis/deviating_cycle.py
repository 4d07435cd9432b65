"""Transmission error of gears with deviating teeth over a revolution or a hunting cycle.

The hunting cycle ends when the same two teeth meet again. Contact is solved in some base pitches; in the
others the transmission error follows by its derivatives with respect to the deviations. Shapes: T base
pitches, P positions in each, L loads, 23 quantities of a curve.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from bounds.brief import brief
from fe_contact.allowed_error import AllowedError
from fe_contact.analysis.checks.cycle_law import check_cycle
from fe_contact.analysis.checks.table_laws import require_laws
from fe_contact.analysis.cycle.envelope import CycleContact, chosen
from fe_contact.analysis.pairs.operating_points import operating_points
from fe_contact.analysis.request.model_choice import decide
from fe_contact.analysis.request.request_check import check_request
from fe_contact.analysis.tables import condensed_bodies
from fe_contact.errors import InputError, within
from fe_contact.geometry import ParallelAxes
from fe_contact.options import AnalysisOptions, Run, TableAxes
from fe_contact.planning.cost_model import unit_work
from fe_contact.planning.cost_of_derivatives import CycleSeconds
from fe_contact.ste.curve_quantities import HARMONICS, OFF_MESH, QUANTITIES
from fe_contact.ste.spectrum import Spectrum, spectrum
from fe_contact.types import BoolArray, FloatArray
from model_studies import in_unit
from model_studies.stage_clock import StageClock

POSITIONS = 64
"""Positions in a base pitch of a request that names none."""
_MAX_POSITIONS = 4096
"""Most positions in a base pitch that a request may name."""


@brief
@dataclass(frozen=True)
class DeviatingCycle:
    """Transmission error over T base pitches, at P evenly spaced positions in each, at L loads."""

    teeth: tuple[int, int]
    """Numbers of teeth of the driving and the driven gear."""
    load: FloatArray = field(metadata=in_unit("n", "force"))
    """Normal forces, N. Shape (L,)."""
    ste: FloatArray = field(metadata=in_unit("m", "pitch", "position", "force"))
    """Transmission error, m, positive = the driven gear lags. Shape (T, P, L)."""
    solved: BoolArray
    """Pitches whose contact was solved; the others are by derivatives. Shape (T,)."""
    error: FloatArray = field(metadata=in_unit("m", "force"))
    """Error of a position in a pitch that was not solved, by the derivatives alone, without the error of the
    mesh, m. Shape (L,).
    """
    quantity_error: FloatArray = field(metadata=in_unit("m", "quantity", "force"))
    """Error of mean, peak-to-peak, orders other than mesh orders, and mesh harmonics, by the derivatives
    alone, m. Shape (23, L).
    """
    predicted: CycleSeconds
    """Cost predicted before the contact was solved."""

    def orders(self, load: int = -1) -> Spectrum:
        """Return the orders of mesh and shafts at one of the loads, with the errors of `quantity_error`."""
        errors = self.quantity_error[OFF_MESH:, load]
        return spectrum(self.ste[..., load].ravel(), len(self.ste), self.teeth, errors)


def deviating_cycle(
    pair: ParallelAxes,
    axes: TableAxes,
    options: AnalysisOptions = AnalysisOptions(),  # noqa: B008 (frozen)
    run: Run = Run(),  # noqa: B008 (frozen)
) -> DeviatingCycle:
    """Compute the transmission error until the teeth of both gears repeat, or over the pitches requested.

    First, pitches drawn at random are solved; then the pitches whose deviations differ most from those of all
    solved ones, until derivatives give the others within the tolerance. Every pitch is solved in short
    cycles, and where more than a quarter of the pitches would have to be.

    Parameters
    ----------
    axes : TableAxes
        Loads at one misalignment and center distance, and the pitches.
    options : AnalysisOptions
        The tolerance is that of mean and peak-to-peak; without one it is 1 % or 20 nm. Positions are evenly
        spaced.
    run : Run
        Its workers condense the gears; this process solves the contact.

    Raises
    ------
    InputError
        A value that cannot be used, by field name.
    SolveError
        A point of the contact has no solution, or the curve breaks a law of mechanics.
    """
    contact, predicted = cycle_contact(pair, axes, options, run)
    ste, solved, errors = _solved(contact, predicted, options.allowed)
    teeth = pair.pinion.teeth, pair.wheel.teeth
    cycle = DeviatingCycle(teeth, contact.load, ste, solved, errors[0], errors[1:], predicted)
    require_laws((check_cycle(contact, ste, errors[0]),), cycle)
    return cycle


def cycle_contact(
    pair: ParallelAxes, axes: TableAxes, options: AnalysisOptions, run: Run
) -> tuple[CycleContact, CycleSeconds]:
    """Condense the gears of a cycle and predict the cost of its contact.

    Parameters and exceptions are those of `deviating_cycle`.
    """
    for name in ("misalignment", "center_distance_change"):
        if (count := getattr(axes, name).size) > 1:
            raise InputError(f"{name}s", count, "one value", "A cycle has one alignment.")
    positions = options.positions or POSITIONS
    options = replace(options, positions=positions)
    within(
        "positions", positions, 2 * HARMONICS + 1, _MAX_POSITIONS, "They tell twenty mesh harmonics apart."
    )
    choice = decide(check_request(pair, axes, options, check_size=False), run.cache)
    request, plan = choice.checked.request, choice.plan
    bodies = condensed_bodies(choice.checked, plan, StageClock(run.workers.cost), run)
    (point,) = operating_points(request.scene, request.choices, bodies).places
    work = unit_work(request.pair, plan, plan.discretization.slices)
    predicted = CycleSeconds.of(work, request.pair, choice.checked.model.period, positions, (plan.load.size,))
    return CycleContact(point, np.arange(positions) / positions, plan.load), predicted


def _solved(
    contact: CycleContact, seconds: CycleSeconds, tolerance: AllowedError
) -> tuple[FloatArray, BoolArray, FloatArray]:
    """Return the transmission error (T, P, L) in m, whether each pitch is solved (T,), and errors in m.

    The errors are an array (1 + 23, L): first that of a position in a pitch that is not solved, then those of
    the quantities.
    """
    pitches, no_errors = np.arange(contact.pitches), np.zeros((1 + QUANTITIES, contact.load.size))
    envelope = chosen(contact, tolerance) if seconds.pays(contact.pitches) else None
    if envelope is None:
        return contact.exact(pitches), pitches >= 0, no_errors
    return envelope.ste, envelope.solved, np.vstack([envelope.drawn_errors.error, envelope.quantity_errors])
