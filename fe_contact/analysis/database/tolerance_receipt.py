"""The tolerance that was requested, held against the errors that were measured."""

from __future__ import annotations

import numpy as np

from fe_contact.allowed_error import AllowedError
from fe_contact.ste import SteDatabase
from fe_contact.ste.curve_errors import AT_NODES, BETWEEN_NODES, all_sources
from fe_contact.ste.curve_quantities import MEAN, PEAK_TO_PEAK, mean_of_curves
from fe_contact.types import FloatArray, Json


def error_shares(table: SteDatabase, allowed: AllowedError) -> FloatArray:
    """Return the errors of mean and peak-to-peak by source in parts of what is allowed.

    Returns
    -------
    ndarray, shape (9, 2, F, M, D)
        Sources in the order of `SOURCES`; those between nodes stand at the lower node of their interval. NaN
        where not estimated and at failed points.
    """
    ste = table.static_transmission_error
    values = np.stack([mean_of_curves(table.position, ste, table.period), np.ptp(ste, axis=0)])
    return np.asarray(table.curve_error[:, [MEAN, PEAK_TO_PEAK]] / allowed.of(values))


def tolerance_receipt(table: SteDatabase, allowed: AllowedError) -> Json:
    """Hold the errors of mean and peak-to-peak at all nodes of a table against the tolerance.

    Returns
    -------
    dict
        `relative`, `floor_m`: the tolerance. `used`: the largest error over what is allowed. `met`: whether
        that is at most 1. Both are None where errors were not estimated; a failed point keeps nothing.
        `between_nodes`: the axes between whose nodes interpolation alone takes more than is allowed.
    """
    shares = error_shares(table, allowed)
    total = all_sources(shares[: len(AT_NODES)])
    used = float(np.max(total))
    limits = {"relative": allowed.relative, "floor_m": allowed.floor}
    if np.isnan(total).all():
        return limits | {"used": None, "met": None}
    kept = {"used": used if np.isfinite(used) else None, "met": used <= 1.0}
    return limits | kept | {"between_nodes": _between_nodes(table, shares)}


def _between_nodes(table: SteDatabase, shares: FloatArray) -> list[Json]:
    """Return the worst interval of each axis that takes more than is allowed; more nodes are the caller's."""
    axes = zip(BETWEEN_NODES, (table.force, table.misalignment, table.center_distance_change), strict=True)
    beyond = []
    for i, (name, nodes) in enumerate(axes):
        by_interval = np.moveaxis(shares[len(AT_NODES) + i], 1 + i, 0)[:-1]
        worst = np.nan_to_num(by_interval).max(axis=(1, 2, 3), initial=0.0)
        if worst.size and worst.max() > 1.0:
            k = int(np.argmax(worst))
            interval = [float(nodes[k]), float(nodes[k + 1])]
            beyond.append({"axis": name, "used": float(worst[k]), "between": interval})
    return beyond
