"""Tables of long periods made of short ones, and scenes with them."""

from dataclasses import fields, replace

import numpy as np
from transferred_scenes import table, unit

ALONG = 2
"""Axis of the positions, of what varies along them."""


def repeated(own, times, errors=None):
    """The table `times` over; `errors` (times,) are added to the deflections of each pitch, m."""
    position = np.concatenate([own.position + k for k in range(times)])
    arrays = {each.name: getattr(own, each.name) for each in fields(own)}
    long = {
        name: np.tile(values, (1, 1, times, 1))
        for name, values in arrays.items()
        if isinstance(values, np.ndarray) and values.ndim == 4 and values.shape[ALONG] == own.position.size
    }
    if errors is not None:
        long["deflection"] = long["deflection"] + np.repeat(errors, own.position.size)[None, None, :, None]
    return replace(own, position=position, period=times, **long)


def deviating_unit(pitches):
    """The two-stage unit in its housing; pitches of its first stage differ in deflection and load arm."""
    drawn = np.random.default_rng(2).normal(size=(2, pitches))
    own = replace(table(), deflection_derivative=None, stiffness_derivative=None)
    long = repeated(own, pitches, 3e-7 * drawn[0])
    arm = 3e-4 * np.repeat(drawn[1], own.position.size)[None, None, :, None]
    return unit(replace(long, load_arm=long.load_arm + arm), own)
