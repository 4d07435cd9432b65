"""Errors of a table that was solved on a condensed pair, at a part of the cost of solving it.

The rougher discretizations are those of an analysis, at half of the positions or fewer, and the errors are
the same parts of their changes. The error between the positions is estimated from half of them. Where no
coarse meshes are cached, none are computed: the usual error of the mesh level is stated instead.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fe_contact.analysis.estimates.assessed_table import AssessedTable, interval_errors, table_bias
from fe_contact.analysis.estimates.curve_errors import curve_errors, load_arm_errors
from fe_contact.analysis.estimates.error_sources import estimate_errors
from fe_contact.analysis.estimates.half_position_errors import errors_by_halves
from fe_contact.analysis.estimates.table_sample import Nested, TableSample
from fe_contact.analysis.live.condensed_contacts import CondensedContacts
from fe_contact.analysis.pairs.pair_contact import PairContact
from fe_contact.analysis.request.solved_run import SolvedOperatingPoint
from fe_contact.planning.expected_error import usual_mesh_error
from fe_contact.planning.plan import Plan
from fe_contact.ste import SteDatabase
from fe_contact.ste.curve_errors import AT_NODES
from fe_contact.ste.curve_quantities import MEAN, PEAK_TO_PEAK, QUANTITIES
from fe_contact.types import FloatArray

OVER_MEDIAN = 2.0
"""Expected error over the median error of a level: nine runs of ten have less."""

BY_MESH = AT_NODES.index("discretisation")


def condensed_errors(
    table: SteDatabase, run: SolvedOperatingPoint, contacts: CondensedContacts, sample: TableSample
) -> AssessedTable:
    """Estimate the errors of a table of one alignment.

    `contacts` have the same flanks on rougher discretizations, assembled at the `sample`, whose points are
    solved again. Errors between the loads are not estimated (NaN): the table is for its loads alone.
    """
    points, solution, plan = run.places, run.solution, run.plan
    start = sample.start(run.problem, solution)
    starts = None if start is None else [start]

    def solved(rougher: PairContact | None, otherwise: FloatArray) -> FloatArray:
        if rougher is None:
            return otherwise
        return sample.solved(points.on(rougher), points, starts)

    nominal = sample.taken(table)
    plane = solved(contacts.plane, nominal)
    patched = solved(contacts.patched, nominal)
    coarse = solved(contacts.coarse, patched)
    nested = Nested(sample, nominal, plane, patched, coarse, solved(contacts.sliced, nominal))
    positions = errors_by_halves(table.position, solution.deflection, points.period)
    ste, arms = nested.parts
    measured = points, [(run.problem, solution)], ste, positions, plan
    sources, errors = estimate_errors(*measured), curve_errors(*measured)
    if contacts.coarse is None:
        errors[BY_MESH], band = _expected(table, plan, contacts.fine)
        sources = replace(sources, discretization=np.broadcast_to(band, sources.contact.shape))
    _, between_nodes = interval_errors(errors.shape[2:], {})  # not assessed: NaN
    return AssessedTable(
        band=sources.total,
        curve_error=np.concatenate([errors, between_nodes]),
        load_arm_error=load_arm_errors(points, table, arms, plan),
        interval_error=np.empty((0,) * 4),  # no point between nodes is assessed
        inserted=None,
        by_source=sources.to_json(),
        validation={},
        bias=table_bias(table, points, plan),
    )


def _expected(table: SteDatabase, plan: Plan, contact: PairContact) -> tuple[FloatArray, FloatArray]:
    """Return the known errors of the level of the meshes, (23, F, 1, 1), and its band (1, F, 1, 1), m.

    A harmonic has the error of peak-to-peak. Without load the transmission error of a misaligned pair is
    negative, so that its mean under load may be small: then the error is a part of the deflection by load.
    """
    ste = np.nan_to_num(table.static_transmission_error)
    added = (ste - np.nan_to_num(table.no_load_transmission_error)[:, None]).mean(axis=0)
    mean = np.maximum(ste.mean(axis=0), added)
    mean_error, ripple_error = usual_mesh_error(contact.pair, plan)
    errors = np.empty((QUANTITIES, *mean.shape))
    errors[:] = OVER_MEDIAN * ripple_error * mean
    errors[MEAN] = OVER_MEDIAN * mean_error * mean
    return errors, errors[MEAN][None] + 0.5 * errors[PEAK_TO_PEAK][None]
