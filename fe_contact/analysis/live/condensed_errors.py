"""Errors of a table that was solved on a condensed pair, at a part of the cost of solving it.

The rougher discretizations are those of an analysis, at half of the positions or fewer, and the parts of
their changes that are left are the same. What is between the positions is told by half of them. Coarse
meshes that are not at hand are no reason to compute any: the error known of the level stands in. Wide load
patches, which the mesh asks for, count with it.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fe_contact.analysis.estimates.assessed_table import AssessedTable
from fe_contact.analysis.estimates.curve_error_estimate import curve_errors, with_axes
from fe_contact.analysis.estimates.error_estimate import Nested, estimate_errors
from fe_contact.analysis.estimates.halved_positions import errors_by_halves
from fe_contact.analysis.estimates.solved_again import TableSample
from fe_contact.analysis.live.condensed_contacts import CondensedContacts
from fe_contact.analysis.pairs.operating_points import OperatingPoints
from fe_contact.analysis.pairs.pair_contact import PairContact
from fe_contact.contact import ContactSolution
from fe_contact.planning import Plan, usual_mesh_error
from fe_contact.ste import SteDatabase
from fe_contact.ste.curve_errors import AT_NODES
from fe_contact.ste.curve_quantities import MEAN, QUANTITIES, quantity_changes
from fe_contact.types import FloatArray

OVER_MEDIAN = 2.0
"""Factor on the median error of a level: nine runs of ten state less."""
BY_MESH = AT_NODES.index("discretisation")


def condensed_errors(
    table: SteDatabase,
    points: OperatingPoints,
    solution: ContactSolution,
    contacts: CondensedContacts,
    sample: TableSample,
    plan: Plan,
) -> AssessedTable:
    """Estimate the errors of a table of one alignment.

    Parameters
    ----------
    table : SteDatabase
    points : OperatingPoints
        Its one place, on the discretization of the table.
    solution : ContactSolution
    contacts : CondensedContacts
        The same flanks on rougher discretizations, assembled at the sample.
    sample : TableSample
        Points that are solved again.
    plan : Plan

    Returns
    -------
    AssessedTable
        Between the loads nothing is estimated (NaN): the table is of the loads asked.
    """

    def solved(rougher: PairContact | None, otherwise: FloatArray) -> FloatArray:
        """Solve the sample on a rougher discretization, (T R, f, 1, 1) in m."""
        if rougher is None:
            return otherwise
        return sample.solved(points.on(rougher), points)

    own = sample.taken([solution])
    plane = solved(contacts.plane, own)
    nested = Nested(sample, own, plane, solved(contacts.coarse, plane), solved(contacts.sliced, own))
    positions = errors_by_halves(table.position, solution.deflection, points.period)
    measured = points, [solution], nested, positions, plan
    sources, errors = estimate_errors(*measured), curve_errors(*measured)
    if contacts.coarse is None:
        errors[BY_MESH], band = _expected(table, plan, contacts.own)
        sources = replace(sources, discretization=np.broadcast_to(band, sources.contact.shape))
    if contacts.patched is not None:
        wider, part = solved(contacts.patched, own), contacts.left_by_patches
        errors[BY_MESH] = np.hypot(errors[BY_MESH], _changed(sample, own, wider, part))
        band = sample.spread_points(part * np.nan_to_num(np.abs(own - wider)))
        sources = replace(sources, discretization=sources.discretization + band)
    return AssessedTable(sources.total, with_axes(errors, {}), sources.to_json(), {})


def _changed(sample: TableSample, own: FloatArray, other: FloatArray, part: float) -> FloatArray:
    """Return a part of the changes of the quantities of curves (T R, f, 1, 1), (22, F, 1, 1) in m."""
    first, second = (values.reshape(sample.knots.size, -1) for values in (own, other))
    change = part * quantity_changes(sample.knots, first, second, sample.period)
    return sample.spread(change.reshape(QUANTITIES, *own.shape[1:]))


def _expected(table: SteDatabase, plan: Plan, contact: PairContact) -> tuple[FloatArray, FloatArray]:
    """Return what the level of the meshes is known to leave, (22, F, 1, 1), and its band (1, F, 1, 1), m.

    A harmonic may be wrong by as much as peak-to-peak. A misaligned pair leads at no load, and so may its
    mean: what the meshes are wrong by then hangs on what the load adds.
    """
    ste = np.nan_to_num(table.static_transmission_error)
    added = (ste - np.nan_to_num(table.no_load_transmission_error)[:, None]).mean(axis=0)
    mean = np.maximum(ste.mean(axis=0), added)
    errors = np.empty((QUANTITIES, *mean.shape))
    of_mean, of_ripple = usual_mesh_error(contact.pair, plan)
    errors[:] = OVER_MEDIAN * of_ripple * mean
    errors[MEAN] = OVER_MEDIAN * of_mean * mean
    return errors, errors[MEAN][None] + 0.5 * errors[MEAN + 1][None]
