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

    Where all teeth are alike (period 1) these are the stored pairs inside [0, 1); elsewhere the pair that is
    j at phase 0 is j - n at n pitches, so that one index follows one pair of teeth through mesh. Longer
    periods count anew at every whole pitch: their pairs are always the stored ones.
    """
    if database.period > 1:
        return database.pair
    turns = np.floor(position)
    return np.arange(database.pair[0] - int(turns.max()), database.pair[-1] - int(turns.min()) + 1)


def load_share(database: SteFields, position: FloatArray, point: OperatingPoint) -> FloatArray:
    """Share of each of `pairs_seen` at (Q,) positions: (Q, pairs), >= 0, each row sums to 1.

    The share of a pair of teeth is one curve over its own phase, zero beyond the stored pairs; C1 and
    monotone between knots in phase. As many pairs as the period has pitches meet in turn. Below the smallest
    stored load the share is that load's.
    """
    stored = _at_operating_point(database, database.load_share, point)
    pitch, fraction = np.floor(position).astype(np.int64), position
    if database.period > 1:
        fraction = position - pitch
    query = fraction[:, None] + pairs_seen(database, position)
    met = (pairs_seen(database, position) - pitch[:, None]) % database.period
    share = np.empty(query.shape)
    for teeth in np.unique(met):
        of_teeth = met == teeth
        phase, shares = _over_phase(database, stored, int(teeth))
        share[of_teeth] = interpolate(Axis(phase), shares, query[of_teeth])
    share = np.maximum(share, 0.0)
    return np.asarray(share / share.sum(axis=1, keepdims=True))


def error_band(database: SteFields, position: FloatArray, point: OperatingPoint) -> FloatArray:
    """Interpolate the stored error estimate, (Q,) in m between the stored points."""
    stored = _at_operating_point(database, database.error_estimate, point)
    return interpolate(Axis(database.position, float(database.period)), stored, position)


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


def _over_phase(database: SteFields, shares: FloatArray, teeth: int) -> tuple[FloatArray, FloatArray]:
    """Join what the pairs (P, N) say of one pair of teeth into a curve over phase, zero at each end.

    `teeth` counts the pairs of teeth that meet in a period: it is pair j in whole pitch (j - teeth) modulo
    the period.
    """
    period, position = database.period, database.position
    phase, curve = [np.empty(0)], [np.empty(0)]
    for column, pair in enumerate(database.pair):
        pitch = (pair - teeth) % period
        knots = slice(*np.searchsorted(position, [pitch, pitch + 1]))
        phase.append((pair - pitch) + position[knots])
        curve.append(shares[knots, column])
    ends = _knot_before(database, teeth), _knot_after(database, teeth)
    return np.concatenate([ends[:1], *phase, ends[1:]]), np.concatenate([[0.0], *curve, [0.0]])


def _knot_before(database: SteFields, teeth: int) -> float:
    """Phase of the last knot before the first stored pair of `teeth`."""
    pitch = (database.pair[0] - teeth) % database.period
    first = int(np.searchsorted(database.position, pitch))
    turned = database.period if first == 0 else 0
    return float((database.pair[0] - pitch - turned) + database.position[first - 1])


def _knot_after(database: SteFields, teeth: int) -> float:
    """Phase of the first knot after the last stored pair of `teeth`."""
    pitch = (database.pair[-1] - teeth) % database.period
    next_one = int(np.searchsorted(database.position, pitch + 1))
    turned = database.period if next_one == database.position.size else 0
    return float((database.pair[-1] - pitch + turned) + database.position[next_one % database.position.size])
