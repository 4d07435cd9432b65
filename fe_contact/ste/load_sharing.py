"""Load shares and error bands between the stored points."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fe_contact.ste.fields import SteFields
from fe_contact.ste.interpolation import Axis, interpolate
from fe_contact.ste.loads import OperatingPoint
from fe_contact.types import FloatArray


def pairs_seen(database: SteFields, position: FloatArray) -> NDArray[np.int64]:
    """List the pairs that can carry load at `position` (not wrapped).

    Inside [0, 1) these are the stored pairs. Elsewhere the pair that is j at phase 0 is j - n at n pitches,
    so that one index follows one pair of teeth through mesh.
    """
    turns = np.floor(position)
    return np.arange(database.pair[0] - int(turns.max()), database.pair[-1] - int(turns.min()) + 1)


def load_share(database: SteFields, position: FloatArray, point: OperatingPoint) -> FloatArray:
    """Share of each of `pairs_seen` at (Q,) positions: (Q, pairs), >= 0, each row sums to 1.

    The share of a pair is one curve over its own phase `position` + j, zero beyond the stored pairs; C1 and
    monotone between knots in phase. Below the smallest stored load it is that load's.
    """
    phase, shares = _over_phase(database, _at_operating_point(database, database.load_share, point))
    asked = position[:, None] + pairs_seen(database, position)
    share = np.maximum(interpolate(Axis(phase), shares, asked.ravel()).reshape(asked.shape), 0.0)
    return np.asarray(share / share.sum(axis=1, keepdims=True))


def error_band(database: SteFields, position: FloatArray, point: OperatingPoint) -> FloatArray:
    """Interpolate the stored error estimate, (Q,) in m between the stored points."""
    stored = _at_operating_point(database, database.error_estimate, point)
    return interpolate(Axis(database.position, 1.0), stored, position)


def _at_operating_point(database: SteFields, values: FloatArray, point: OperatingPoint) -> FloatArray:
    """Reduce (P, F, M, D, ...) to (P, ...) at one load and alignment."""
    along_force = np.moveaxis(values, (1, 2, 3), (0, 1, 2))
    for axis, at in (
        (database.force, point.force),
        (database.misalignment, point.misalignment),
        (database.center_distance_change, point.center_distance_change),
    ):
        along_force = interpolate(Axis(axis), along_force, np.array([at]))[0]
    return along_force


def _over_phase(database: SteFields, shares: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Join the columns (P, N) of all pairs into one curve over phase, closed with a zero at each end."""
    phase = (database.pair[:, None] + database.position).ravel()
    before = database.pair[0] - 1 + database.position[-1]
    after = database.pair[-1] + 1 + database.position[0]
    return np.concatenate([[before], phase, [after]]), np.concatenate([[0.0], shares.T.ravel(), [0.0]])
