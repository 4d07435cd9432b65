"""One transmission-error curve over position, with its mean, peak-to-peak and harmonics."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bounds import Text, from_to
from bounds.brief import brief
from fe_contact.errors import InputError
from fe_contact.ste.curve_errors import all_sources, errors_by_source, source_places
from fe_contact.ste.curve_quantities import OFF_MESH, QUANTITIES
from fe_contact.ste.fields import SteFields
from fe_contact.ste.interpolation import Axis, interpolate
from fe_contact.ste.mesh_force import MeshForce
from fe_contact.ste.node_errors import error_band
from fe_contact.ste.operating_point import FARTHEST, OperatingPoint
from fe_contact.ste.plane_bias import OverFace, over_face, stored_bias
from fe_contact.ste.spectrum import Spectrum, even_positions, spectrum
from fe_contact.types import Estimate, FloatArray


def _pairs_seen(database: SteFields, position: FloatArray) -> NDArray[np.int64]:
    """List the pairs that can carry load at `position` (not wrapped).

    Where all teeth are alike (period 1) they are numbered as at phase 0: the pair j at phase 0 has the stored
    index j - n after n pitches, so that one number follows one pair of teeth through mesh. Longer periods
    count anew at every whole pitch: their pairs are always the stored ones.
    """
    if database.period > 1:
        return database.pair
    turns = np.floor(position)
    return np.arange(database.pair[0] - int(turns.max()), database.pair[-1] - int(turns.min()) + 1)


def _load_share(database: SteFields, position: FloatArray, point: OperatingPoint) -> FloatArray:
    """Return the share of each of `_pairs_seen` at (Q,) positions: (Q, pairs), >= 0, each row sums to 1.

    The share of a pair of teeth is one curve over its own phase, zero beyond the stored pairs; C1 and
    monotone between knots in phase. As many pairs as the period has pitches meet in turn. Below the smallest
    stored load the share is that load's.
    """
    stored = at_operating_point(database, database.load_share, point)
    pairs = _pairs_seen(database, position)
    pitch = np.floor(position).astype(np.int64)
    phase = (position - pitch if database.period > 1 else position)[:, None] + pairs
    # which of the pairs of teeth of a period each entry is; the entries of one pair are evaluated together
    teeth = (pairs - pitch[:, None]) % database.period
    share = np.empty(phase.shape)
    order = np.argsort(teeth, axis=None, kind="stable")
    numbers, first = np.unique(teeth.flat[order], return_index=True)
    for number, entries in zip(numbers.tolist(), np.split(order, first[1:]), strict=True):
        knots, shares = _over_phase(database, stored, number)
        share.flat[entries] = interpolate(Axis(knots), shares, phase.flat[entries])
    share = np.maximum(share, 0.0)
    return np.asarray(share / share.sum(axis=1, keepdims=True))


def at_operating_point(database: SteFields, values: FloatArray, point: OperatingPoint) -> FloatArray:
    """Reduce (P, F, M, D, ...) to (P, ...) at one load and alignment."""
    values = np.moveaxis(values, 0, 3)  # (F, M, D, P, ...): each step interpolates over the first axis
    for axis, at in (
        (database.force, point.force),
        (database.misalignment, point.misalignment),
        (database.center_distance_change, point.center_distance_change),
    ):
        values = interpolate(Axis(axis), values, np.array([at]))[0]
    return values


def _over_phase(database: SteFields, shares: FloatArray, teeth: int) -> tuple[FloatArray, FloatArray]:
    """Join the values of the pairs (P, N) of one pair of teeth into a curve over phase, zero at each end.

    `teeth` counts the pairs of teeth that meet in a period: it is pair j in whole pitch (j - teeth) modulo
    the period.
    """
    period, position = database.period, database.position
    phase, curve = [], []
    for column, pair in enumerate(database.pair):
        pitch = (pair - teeth) % period
        knots = slice(*np.searchsorted(position, [pitch, pitch + 1]))
        phase.append((pair - pitch) + position[knots])
        curve.append(shares[knots, column])
    before, after = _knot_before(database, teeth), _knot_after(database, teeth)
    return np.concatenate([[before], *phase, [after]]), np.concatenate([[0.0], *curve, [0.0]])


def _knot_before(database: SteFields, teeth: int) -> float:
    """Return the phase of the last knot before the first stored pair of `teeth`."""
    pitch = (database.pair[0] - teeth) % database.period
    first = int(np.searchsorted(database.position, pitch))
    turned = database.period if first == 0 else 0
    return float((database.pair[0] - pitch - turned) + database.position[first - 1])


def _knot_after(database: SteFields, teeth: int) -> float:
    """Return the phase of the first knot after the last stored pair of `teeth`."""
    pitch = (database.pair[-1] - teeth) % database.period
    knot, count = int(np.searchsorted(database.position, pitch + 1)), database.position.size
    turned = database.period if knot == count else 0
    return float((database.pair[-1] - pitch + turned) + database.position[knot % count])


@brief
@dataclass(frozen=True, eq=False)
class Curve:
    """Transmission error over position at one load and alignment."""

    point: OperatingPoint
    """Normal force in N, misalignment and center-distance change in m."""
    torque: float
    """Torque on gear 1 of the load, N m."""
    position: FloatArray
    """Position of the driving gear, base pitches, as requested (not wrapped). Shape (Q,)."""
    ste: FloatArray
    """Static transmission error, m. Shape (Q,)."""
    error: FloatArray
    """Half-width of the error band of the transmission error, m. Shape (Q,)."""
    interval_error: float
    """Part of the error band by interpolation of loads and alignments, m: 0 on nodes, NaN: not estimated."""
    pair: NDArray[np.int64]
    """Pair index of each column of `_load_share`; the stored pairs if all positions lie in [0, 1) or the
    period is longer than a pitch. Shape (N,).
    """
    load_share: FloatArray
    """Part of the load on each pair. Shape (Q, N)."""
    mean: Estimate
    peak_to_peak: Estimate
    """`mean`, `peak_to_peak`: Figures over one period, whatever `position` is. Error NaN: not estimated."""
    harmonics: tuple[Estimate, ...]
    """Mesh harmonics: amplitudes A_n of ste(x) = mean + sum A_n cos(2 pi n x + phi_n), n = 1 .. 20."""
    harmonic_phases: FloatArray
    """Phases phi_n of the mesh harmonics, rad. Shape (20,)."""
    spectrum: Spectrum
    """All orders up to the 20th mesh harmonic, over many pitches also those between the mesh harmonics."""
    period: int
    """Period of the table, base pitches."""
    over_face: OverFace | None = None
    """Mean and peak-to-peak of the gears of finite width, where the table is that of a plane without
    correction. The errors of the other fields are then those towards the plane model.
    """


def curve(database: SteFields, force: MeshForce, point: OperatingPoint, at: ArrayLike | None) -> Curve:
    """Evaluate the curve at positions `at` (the stored ones if None).

    The errors of mean, peak-to-peak and harmonics are those of all stored sources together
    (`curve_errors.all_sources`). A table without sources has bounds for any error inside the pointwise bands:
    for the mean the mean of the band, for peak-to-peak the sum of the bands at the two extremes, for an order
    twice the mean band. Raises `InputError`: `at` is no list of finite positions within 1000 periods.
    """
    position = database.position if at is None else _positions(at, FARTHEST * database.period)
    even = even_positions(database.period)
    everywhere = np.concatenate([even, database.position])  # extremes of a stored load lie on knots
    ste, band, below = _evaluate(database, force, point, everywhere)
    mean_error, ripple_error, *of_orders = _errors(database, point, band, below, ste, even.size)
    orders = spectrum(ste[: even.size], database.period, database.geometry.teeth, np.array(of_orders))
    mesh = slice(database.period - 1, None, database.period)  # the mesh orders among all orders
    stored = [part[even.size :] for part in (ste, band, below)]
    values, *error_parts = stored if at is None else _evaluate(database, force, point, position)
    mean = Estimate(float(np.mean(ste[: even.size])), mean_error, "m")
    ripple = Estimate(float(ste.max() - ste.min()), ripple_error, "m")
    bias = stored_bias(database.metadata.receipt)
    return Curve(
        point=point,
        torque=point.force * database.geometry.base_radius[0] * math.cos(database.geometry.base_helix_angle),
        position=position,
        ste=values,
        error=sum(error_parts, np.zeros(position.size)),
        interval_error=float(source_places(database, point).interval_error(database)[0]),
        pair=_pairs_seen(database, position),
        load_share=_load_share(database, position, point),
        mean=mean,
        peak_to_peak=ripple,
        harmonics=tuple(
            Estimate(float(size), float(error), "m")
            for size, error in zip(orders.amplitude[mesh], orders.error[mesh], strict=True)
        ),
        harmonic_phases=orders.phase[mesh],
        spectrum=orders,
        period=database.period,
        over_face=over_face(bias, mean, ripple) if bias else None,
    )


def _evaluate(
    database: SteFields, force: MeshForce, point: OperatingPoint, position: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return transmission error, its band, and the error below the smallest load, at the positions."""
    alignment = (point.misalignment, point.center_distance_change)
    transverse = math.cos(database.geometry.base_helix_angle)
    ste, _ = force.deflection_at(position, point.force * transverse, *alignment)
    error = error_band(database, position, source_places(database, point))
    smallest_load = min([database.force[0], *database.support_force[:1]])
    if point.force >= smallest_load:
        return ste, error, np.zeros_like(ste)
    # below the smallest load the law is a convention; the truth lies between lift-off and that load
    lift_off, _ = force.deflection_at(position, 0.0, *alignment)
    smallest, _ = force.deflection_at(position, smallest_load * transverse, *alignment)
    return ste, error, np.maximum(ste - lift_off, smallest - ste)


def _errors(
    database: SteFields,
    point: OperatingPoint,
    band: FloatArray,
    below: FloatArray,
    ste: FloatArray,
    even: int,
) -> list[float]:
    """Return the errors (23,) of mean, peak-to-peak and orders in m; NaN: a source was not estimated.

    The first `even` of the positions are equally spaced.
    """
    stored = database.curve_error.size > 0
    pointwise = below if stored else band + below
    extremes = pointwise[int(np.argmin(ste))] + pointwise[int(np.argmax(ste))]
    mean = float(np.mean(pointwise[:even]))
    bounds = np.array([mean, extremes, *[2.0 * mean] * (QUANTITIES - OFF_MESH)])
    total = bounds + all_sources(errors_by_source(database, point)) if stored else bounds
    return [float(error) for error in total]


def _positions(at: ArrayLike, farthest: int) -> FloatArray:
    """Return positions as a finite 1-D array of moderate reach."""
    position = np.atleast_1d(np.asarray(at, dtype=float))
    if position.ndim != 1 or position.size == 0 or not np.all(np.abs(position) <= farthest):
        reach = from_to(-farthest, farthest)
        raise InputError("at", at, Text.of("a non-empty list of positions ", reach, " base pitches"))
    return position
