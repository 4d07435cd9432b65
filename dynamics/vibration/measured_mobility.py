"""A housing by its measured mobilities, from bearing seats to points, in place of modes.

The forces of bearings are those of a scene whose ground does not move: the housing does not act back on the
shafts. Moments on seats, forces in directions that nobody measured and orders outside the measured band are
left out; the result says which.

References
----------
.. [1] ISO 7626-1:2011, Mechanical vibration and shock - Experimental determination of mechanical mobility.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from bounds import Quantity, Text
from dynamics.checks import distinct
from dynamics.errors import InputError
from dynamics.types import BoolArray, ComplexArray, FloatArray, IntArray
from dynamics.vibration.housing_motion import BearingHarmonics

ORTHONORMAL = 1e-9
"""Largest entry of A^T A - 1 of axes that are perpendicular and of length one."""
BLOCK = 1024
"""Number of frequencies whose mobilities are interpolated at a time."""


@dataclass(frozen=True)
class Direction:
    """A bearing or a point, and the axis along which it is pushed or measured: 0, 1, 2 for x, y, z."""

    name: str
    axis: int

    def __str__(self) -> str:
        """Return the name and the letter of the axis."""
        return f"{self.name} {'xyz'[self.axis]}"


@dataclass(frozen=True)
class MeasuredMobility:
    """Velocity of points per force on bearing seats at the lines of a measurement.

    Raises `InputError`: shapes differ, a value is not finite, lines do not rise, a direction is there twice,
    or the axes are not perpendicular, of length one and right-handed.
    """

    frequency: FloatArray
    """Lines in Hz, above 0, rising; at least two. Shape (n,)."""
    response: tuple[Direction, ...]
    """Points, q of them with their axes."""
    excitation: tuple[Direction, ...]
    """Bearings, e of them with their axes; positive is the force of the shaft on the seat."""
    mobility: ComplexArray
    """Mobilities, m/(N s): peak velocity per peak force for exp(2 pi i f t). Reciprocity is not assumed.
    Shape (n, q, e).
    """
    axes: FloatArray = field(default_factory=lambda: np.eye(3))
    """Columns: the axes x, y, z of the measurement in the scene's frame. Shape (3, 3)."""

    def __post_init__(self) -> None:
        lines = np.asarray(self.frequency, dtype=float)
        if lines.ndim != 1 or lines.size < 2:
            raise InputError("frequency", np.shape(lines), "at least two lines", "Export the whole band.")
        if not (np.all(np.isfinite(lines)) and lines[0] > 0.0 and np.all(np.diff(lines) > 0.0)):
            raise InputError("frequency", "not rising", "lines above 0 Hz that rise")
        for name in ("response", "excitation"):
            parts: tuple[Direction, ...] = getattr(self, name)
            if not parts:
                raise InputError(name, [], "at least one direction")
            distinct(name, [str(part) for part in parts])
        shape = lines.size, len(self.response), len(self.excitation)
        if np.shape(self.mobility) != shape:
            raise InputError("mobility", np.shape(self.mobility), f"shape {shape}")
        if not np.all(np.isfinite(self.mobility)):
            line, row, column = np.argwhere(~np.isfinite(self.mobility))[0]
            where = f"{self.response[row]} per {self.excitation[column]}"
            at = Text.of("finite at every line; it is not at ", Quantity(float(lines[line]), "Hz"))
            raise InputError(f"mobility {where}", "no number", at, "Measure or export it again.")
        axes = np.asarray(self.axes, dtype=float)
        skew = np.shape(axes) != (3, 3) or np.max(np.abs(axes.T @ axes - np.eye(3))) > ORTHONORMAL
        if skew or np.linalg.det(axes) < 0.0:
            raise InputError("axes", np.asarray(axes).tolist(), "perpendicular, of length 1, right-handed")

    @property
    def points(self) -> tuple[str, ...]:
        """Return the names of the points, once each."""
        return tuple(dict.fromkeys(part.name for part in self.response))

    @property
    def bearings(self) -> tuple[str, ...]:
        """Return the names of the bearings, once each."""
        return tuple(dict.fromkeys(part.name for part in self.excitation))

    def through(self, bearing: str) -> MeasuredMobility:
        """Return the mobilities from the seat of one bearing alone."""
        columns = [e for e, part in enumerate(self.excitation) if part.name == bearing]
        pushed = tuple(self.excitation[e] for e in columns)
        return replace(self, excitation=pushed, mobility=self.mobility[:, :, columns])

    def covers(self, frequency: FloatArray) -> BoolArray:
        """Whether frequencies in Hz lie between the first and the last line; shape as they have it."""
        hertz = np.asarray(frequency, dtype=float)
        return np.asarray((hertz >= self.frequency[0]) & (hertz <= self.frequency[-1]))

    def at(self, frequency: FloatArray) -> ComplexArray:
        """Return the mobilities (N, q, e) at frequencies (N,) in Hz; NaN outside the measured band.

        On a line it is the measured value. Between two lines a quotient of straight lines passes through
        both and through the next line on either side, which a single resonance follows exactly; the mean of
        both sides counts. Where three lines do not resolve a resonance, or are noise, it is a straight line
        in the complex plane.
        """
        hertz = np.asarray(frequency, dtype=float)
        mobility = np.full((hertz.size, *self.mobility.shape[1:]), np.nan, dtype=complex)
        inside = np.flatnonzero(self.covers(hertz))
        for first in range(0, inside.size, BLOCK):
            part = inside[first : first + BLOCK]
            mobility[part] = self._between(hertz[part])
        return mobility

    def _between(self, hertz: FloatArray) -> ComplexArray:
        """Return the mobilities (N, q, e) at frequencies inside the band."""
        lines, last = self.frequency, self.frequency.size - 1
        low = np.clip(np.searchsorted(lines, hertz, side="right") - 1, 0, last - 1)
        share = ((hertz - lines[low]) / (lines[low + 1] - lines[low]))[:, None, None]
        ends = self.mobility[low], self.mobility[low + 1]
        below, above = self._weight(low, low - 1), self._weight(low, low + 2)
        below, above = (
            np.where(np.isnan(side), np.where(np.isnan(other), 1.0, other), side)
            for side, other in ((below, above), (above, below))
        )
        return 0.5 * (_quotient(ends, share, below) + _quotient(ends, share, above))

    def _weight(self, low: IntArray, third: IntArray) -> ComplexArray:
        """Return the weight of the upper end of a span against the lower one, by a third line, (N, q, e).

        It is the quotient of the secants from the third line to both ends; 1 makes a straight line. NaN
        without a third line, and where it has no positive real part: then a pole could lie in the span.
        """
        line, value = self.frequency, self.mobility
        inside = (third >= 0) & (third < line.size)
        at = np.where(inside, third, 0)
        to_low, to_high = (
            (value[at] - value[end]) / np.where(inside, line[at] - line[end], 1.0)[:, None, None]
            for end in (low, low + 1)
        )
        nonzero = inside[:, None, None] & (to_high != 0.0)
        weight = np.divide(to_low, to_high, out=np.full(to_low.shape, np.nan, dtype=complex), where=nonzero)
        return np.where(np.isfinite(weight) & (weight.real > 0.0), weight, np.nan)


def _quotient(
    ends: tuple[ComplexArray, ComplexArray], share: FloatArray, weight: ComplexArray
) -> ComplexArray:
    """Return the weighted mean of both ends of a span; its denominator has a positive real part."""
    low, high = 1.0 - share, share * weight
    return np.asarray((low * ends[0] + high * ends[1]) / (low + high))


@dataclass(frozen=True)
class MeasuredVibration:
    """Vibration at S speeds in H orders of k points, by measured mobilities."""

    point: tuple[str, ...]
    """k names."""
    speed: FloatArray
    order: FloatArray
    frequency: FloatArray
    """`speed`, `order`, `frequency`: Speed of the leading drive, rad/s; multiple of the frequency of the
    first mesh that turns; frequency, Hz. (S,), (H,), (S, H) arrays.
    """
    velocity: ComplexArray
    """Peak amplitudes along the axes of the measurement, m/s; NaN outside the measured band and along axes
    that nobody measured. Shape (k, 3, S, H).
    """
    covered: BoolArray
    """Whether the frequency lies inside the measured band. Shape (S, H)."""
    omitted: tuple[Direction, ...]
    """Forces of bearings without a mobility, by the axes of the measurement."""
    omitted_force: FloatArray
    """Share of the omitted forces in the sum of the squared forces of all bearings, 0 to 1; 0 without forces.
    Shape (S, H).
    """
    moments: bool
    """Whether the bearings press moments on their seats, which are left out."""
    floor: bool
    """Whether the response has lines of a long period that are not listed, which are left out."""

    @property
    def rms(self) -> FloatArray:
        """Root mean square of each point's velocity, (k, S, H), m/s: the measured directions together."""
        square = 0.5 * np.nansum(np.abs(self.velocity) ** 2, axis=1)
        return np.asarray(np.where(self.covered, np.sqrt(square), np.nan))

    @property
    def overall(self) -> FloatArray:
        """Root mean square velocity of the orders inside the band, (k, S), m/s; NaN if none is."""
        square = np.nansum(np.square(self.rms), axis=-1)
        return np.asarray(np.where(np.any(self.covered, axis=-1), np.sqrt(square), np.nan))


def measured_vibration(response: BearingHarmonics, housing: MeasuredMobility) -> MeasuredVibration:
    """Return the vibration of points under the forces of bearings, by measured mobilities.

    The housing does not act back on the shafts: a stiffness of the seats has to be in the bearings of the
    scene. Raises `InputError`: a bearing of the measurement is not in the response, or no order at any
    speed lies inside the measured band.

    Parameters
    ----------
    response : BearingHarmonics
        A forced response, or the orders of a run, in the scene's frame.
    """
    for index, part in enumerate(housing.excitation):
        if part.name not in response.bearing:
            known = f"one of {', '.join(response.bearing)}"
            raise InputError(f"excitation[{index}]", part.name, known, "Name bearings as the scene does.")
    covered = housing.covers(response.frequency)
    if not np.any(covered):
        ends = (Quantity(float(value), "Hz") for value in (housing.frequency[0], housing.frequency[-1]))
        bound = Text.of("a band that orders reach; it is measured from ", next(ends), " to ", next(ends))
        raise InputError("frequency", "no order", bound, "Choose other speeds or more orders.")
    force = np.einsum("ca,bcsh->bash", housing.axes, response.bearing_force[:, :3])
    square = np.abs(force) ** 2
    measured = {(response.bearing.index(part.name), part.axis) for part in housing.excitation}
    omitted = [at for at in np.ndindex(*square.shape[:2]) if at not in measured and np.any(square[at])]
    omitted_square = np.sum([square[at] for at in omitted], axis=0) + np.zeros(covered.shape)
    total = square.sum(axis=(0, 1))
    return MeasuredVibration(
        point=housing.points,
        speed=response.speed,
        order=response.order,
        frequency=response.frequency,
        velocity=_velocity(housing, response, force),
        covered=covered,
        omitted=tuple(Direction(response.bearing[bearing], axis) for bearing, axis in omitted),
        omitted_force=np.divide(omitted_square, total, out=np.zeros(covered.shape), where=total > 0.0),
        moments=bool(np.any(response.bearing_force[:, 3:])),
        floor=response.floor is not None,
    )


def _velocity(housing: MeasuredMobility, response: BearingHarmonics, force: ComplexArray) -> ComplexArray:
    """Return the velocities of points (k, 3, S, H) under forces along the measured axes, (b, 3, S, H)."""
    shape = response.frequency.shape
    excitation = np.array(
        [force[response.bearing.index(part.name), part.axis] for part in housing.excitation]
    )
    hertz, loads = response.frequency.ravel(), excitation.reshape(len(excitation), -1)
    responses = np.empty((len(housing.response), hertz.size), dtype=complex)
    for first in range(0, hertz.size, BLOCK):
        part = slice(first, first + BLOCK)
        responses[:, part] = np.einsum("nqe,en->qn", housing.at(hertz[part]), loads[:, part])
    velocity = np.full((len(housing.points), 3, *shape), np.nan, dtype=complex)
    for row, point in zip(responses, housing.response, strict=True):
        velocity[housing.points.index(point.name), point.axis] = row.reshape(shape)
    return velocity


def bearing_shares(response: BearingHarmonics, housing: MeasuredMobility) -> FloatArray:
    """Return the contribution of each measured bearing to the mean square velocity of points, (e, k, S, H).

    In the order of `MeasuredMobility.bearings`. They add up to 1, as in `Parts.shares`; a negative one acts
    against the sum. NaN outside the measured band and where nothing moves. Raises `InputError` as
    `measured_vibration`.
    """
    total = measured_vibration(response, housing).velocity
    square = np.nansum(np.abs(total) ** 2, axis=1)
    shares = []
    for bearing in housing.bearings:
        part = measured_vibration(response, housing.through(bearing)).velocity
        in_phase = np.nansum((total.conj() * part).real, axis=1)  # the part's velocity along the total's
        shares.append(np.divide(in_phase, square, out=np.full(square.shape, np.nan), where=square > 0.0))
    return np.array(shares)
