"""The tolerance of a request compared with the errors of a table at and between its nodes."""

from __future__ import annotations

import numpy as np

from fe_contact.allowed_error import AllowedError
from fe_contact.analysis.estimates.interval_goal import MIN_SHARE, IntervalGoal
from fe_contact.analysis.request.request import Request
from fe_contact.ste import SteDatabase
from fe_contact.ste.curve_errors import AT_NODES, BETWEEN_NODES, METHOD, PLANE, SOURCES, all_sources
from fe_contact.ste.curve_quantities import MEAN, PEAK_TO_PEAK, mean_of_curves
from fe_contact.ste.plane_bias import PlaneBias, stored_bias
from fe_contact.types import FloatArray, Json


def error_shares(table: SteDatabase, tolerance: AllowedError) -> FloatArray:
    """Return the errors of mean and peak-to-peak by source, relative to the tolerance.

    A plane that the program chose errs by its whole bias; the one of the caller is the model that was
    requested.

    Returns
    -------
    ndarray, shape (9, 2, F, M, D)
        Sources in the order of `SOURCES`; those between nodes stand at the lower node of their interval, in
        parts of what is allowed at the end where that is less. NaN where not estimated and at failed points.
    """
    errors = _with_bias(table, table.curve_error, stored_bias(table.metadata.receipt))
    shares = errors / allowed_errors(table, tolerance)
    for axis, source in enumerate(range(len(AT_NODES), len(SOURCES)), start=1):
        minimum = _with_next(allowed_errors(table, tolerance), axis, np.fmin)
        shares[source] = table.curve_error[source, [MEAN, PEAK_TO_PEAK]] / minimum
    return np.asarray(shares)


def allowed_errors(table: SteDatabase, tolerance: AllowedError) -> FloatArray:
    """Return the errors of mean and peak-to-peak that are allowed at the nodes, (2, F, M, D) in m."""
    return tolerance.of(_mean_and_ripple(table))


def _mean_and_ripple(table: SteDatabase) -> FloatArray:
    ste = table.static_transmission_error
    return np.stack([mean_of_curves(table.position, ste, table.period), np.ptp(ste, axis=0)])


def _with_bias(table: SteDatabase, curve_error: FloatArray, bias: PlaneBias | None) -> FloatArray:
    """Return errors of mean and peak-to-peak by source, that of the plane its whole bias; m."""
    errors = curve_error[:, [MEAN, PEAK_TO_PEAK]]
    if bias is not None:
        errors[AT_NODES.index(PLANE)] = bias.largest(*_mean_and_ripple(table))
    return errors


def reducible_shares(shares: FloatArray, request: Request) -> tuple[FloatArray, FloatArray]:
    """Split the errors at nodes into those that more computation lowers and those that it does not.

    Both are (6, ...), with zeros for the others. The error of the method cannot be lowered. Nor can that of
    the plane where the caller chose the model.
    """
    lasting = (METHOD, PLANE) if request.model_chosen else (METHOD,)
    is_lasting = np.isin(AT_NODES, lasting).reshape(-1, *[1] * (shares.ndim - 1))  # (6, 1, ...)
    at_nodes = shares[: len(AT_NODES)]
    return np.where(is_lasting, 0.0, at_nodes), np.where(is_lasting, at_nodes, 0.0)


def used_at_nodes(shares: FloatArray, request: Request) -> FloatArray:
    """Return the part of the tolerance (F, M, D) that errors at nodes use of mean or peak-to-peak."""
    reducible, _ = reducible_shares(shares, request)
    return np.asarray(all_sources(np.concatenate([reducible, shares[len(SOURCES) :]])).max(axis=0))


def interval_goal(
    table: SteDatabase, at_nodes: FloatArray, request: Request, bias: PlaneBias | None
) -> IntervalGoal:
    """Return the share of a tolerance that errors at nodes (6, 23, F, M, D), m, leave to intervals."""
    tolerance = request.options.allowed
    shares = _with_bias(table, at_nodes, bias) / allowed_errors(table, tolerance)
    return IntervalGoal(tolerance, used_at_nodes(shares, request))


def tolerance_receipt(table: SteDatabase, tolerance: AllowedError, request: Request) -> Json:
    """Hold the errors of mean and peak-to-peak at and between all nodes of a table against the tolerance.

    Returns
    -------
    dict
        `relative`, `floor_m`: the tolerance. `used`: the largest error that work lowers, over what is
        allowed, at any node or between nodes of all axes; `used_at_nodes`: at nodes alone. `met`: whether
        `used` is at most 1. They are None where errors were not estimated; a failed point and an interval
        that cannot be interpolated keep nothing. `lasting`: the largest error that no mesh lowers, in parts
        of the sizes that the tolerance counts by; a bias is none. `between_nodes`: the worst interval of
        every axis that takes the table beyond the tolerance.
    """
    shares = error_shares(table, tolerance)
    _, lasting = reducible_shares(shares, request)
    if table.metadata.receipt.get("bias"):
        lasting[AT_NODES.index(PLANE)] = 0.0
    nodes = used_at_nodes(shares, request)
    limits = {"relative": tolerance.relative, "floor_m": tolerance.floor}
    if np.isnan(nodes).all():
        return limits | {"used": None, "used_at_nodes": None, "met": None}
    cells, between = _cells(nodes, shares)
    used = float(np.sqrt(cells**2 + np.square(between).sum(axis=0)).max())
    use = {"used": used if np.isfinite(used) else None, "met": used <= 1.0}
    use["used_at_nodes"] = float(nodes.max()) if np.isfinite(nodes).all() else None
    use["lasting"] = tolerance.relative * float(np.nanmax(all_sources(lasting)))
    return limits | use | {"between_nodes": _failing_intervals(table, cells, between)}


def _cells(nodes: FloatArray, shares: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the largest shares over the corners of each cell of nodes, which stands at its lowest corner.

    Those at nodes (F, M, D), and between them along each axis (3, F, M, D).
    """
    between = shares[len(AT_NODES) : len(SOURCES)].max(axis=1)
    for axis in range(3):
        nodes = _with_next(nodes, axis, np.maximum)
        for other in (i for i in range(3) if i != axis):
            between[axis] = _with_next(between[axis], other, np.maximum)
    return nodes, between


def _with_next(values: FloatArray, axis: int, chosen: np.ufunc) -> FloatArray:
    """Return the chosen one of values at every node of an axis and at the next; the last stays."""
    after = np.roll(values, -1, axis=axis)
    last = [slice(None)] * values.ndim
    last[axis] = slice(-1, None)
    after[tuple(last)] = values[tuple(last)]
    return np.asarray(chosen(values, after))


def _failing_intervals(table: SteDatabase, cells: FloatArray, between: FloatArray) -> list[Json]:
    """Return the worst interval of each axis by which a table misses the tolerance, and why it stays so."""
    total = np.sqrt(cells**2 + np.square(between).sum(axis=0))
    validation = table.metadata.receipt.get("held_out", {})
    axes = zip(BETWEEN_NODES, (table.force, table.misalignment, table.center_distance_change), strict=True)
    intervals = []
    for i, (name, nodes) in enumerate(axes):
        share, used, nodes_alone = (np.moveaxis(values, i, 0)[:-1] for values in (between[i], total, cells))
        # where the nodes alone miss it, only an interval that does so by itself is named
        named = (used > 1.0) & (share > MIN_SHARE) & ((nodes_alone <= 1.0) | (share > 1.0))
        beyond = np.where(named, share, 0.0).max(axis=(1, 2), initial=0.0)
        if beyond.size and beyond.max() > 0.0:
            k = int(np.argmax(beyond))
            interval = [float(nodes[k]), float(nodes[k + 1])]
            limit = validation.get(name, {}).get("limit") or "add a value there"
            intervals.append({"axis": name, "used": float(beyond[k]), "between": interval, "limit": limit})
    return intervals
