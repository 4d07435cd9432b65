"""Whether a table keeps the tolerance that was asked for, by the errors that were measured."""

from __future__ import annotations

import numpy as np

from fe_contact.allowed_error import AllowedError
from fe_contact.ste import SteDatabase
from fe_contact.ste.curve_errors import AT_NODES, all_sources
from fe_contact.ste.curve_quantities import MEAN, PEAK_TO_PEAK, mean_of_curves
from fe_contact.types import Json


def tolerance_receipt(table: SteDatabase, allowed: AllowedError) -> Json:
    """Hold the errors of mean and peak-to-peak at all nodes of a table against the tolerance.

    Returns
    -------
    dict
        `relative`, `floor_m`: the tolerance. `used`: the largest error over what is allowed. `met`: whether
        that is at most 1. Both are None where errors were not estimated; a failed point keeps nothing.
    """
    ste = table.static_transmission_error
    values = np.stack([mean_of_curves(table.position, ste, table.period), np.ptp(ste, axis=0)])
    errors = all_sources(table.curve_error[: len(AT_NODES), [MEAN, PEAK_TO_PEAK]])
    used = float(np.max(errors / allowed.of(values)))
    asked = {"relative": allowed.relative, "floor_m": allowed.floor}
    if np.isnan(errors).all():
        return asked | {"used": None, "met": None}
    return asked | {"used": used if np.isfinite(used) else None, "met": used <= 1.0}
