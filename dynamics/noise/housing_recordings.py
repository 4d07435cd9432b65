"""Sound pressure of a housing by boundary elements: the check of that by its panels as monopoles."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import cast

import numpy as np

from bounds import at_least
from dynamics.acoustics import (
    Air,
    ElementalRadiators,
    Hull,
    Recording,
    exterior_pressure,
    outer_hull,
    principal_direction,
    series_recording,
)
from dynamics.acoustics.recording import LOWEST, SAMPLE_RATE, unit_vector
from dynamics.checks import positive
from dynamics.errors import InputError
from dynamics.housings.reduced_housing import ReducedHousing, SurfaceHousing
from dynamics.noise.coarse_hull import radiating_hull
from dynamics.noise.estimated_radiation import EstimatedRadiation, estimated_radiation
from dynamics.noise.housing_radiation import cached_radiation, resolved_frequency
from dynamics.orders.resampling import low_passed
from dynamics.results import RunResult
from dynamics.types import ComplexArray, FloatArray
from dynamics.vibration import MotionQuantity, finer_seat_forces, point_signal
from dynamics.vibration.housing_motion import modal_amplitudes
from dynamics.vibration.time_signal import PIECE, motion_pieces
from host.optional_modules import fft, sparse
from model_studies.progress import Progress, silent

NEAREST = 2.0
"""Least distance of a microphone over the longest edge of a panel: nearer it is no point source."""
HALF_LENGTH, KAISER = 12, 8.0
"""Half length in samples, and parameter of the Kaiser window, of the interpolation between samples: up to a
quarter of their rate delays are exact within 1e-4.
"""
BLOCK = 4_000_000  # phases that are held at a time
MONOPOLES = ElementalRadiators()
RESOLUTION = 20.0
"""Hz, of gains over frequency in time: they change by parts of an octave."""
FINER = 4
"""Times the run's rate, at which the force is a cubic spline."""


@dataclass(frozen=True)
class _SoundPaths:
    """Paths from T panels to a microphone."""

    delay: FloatArray
    """Travel time r/c, s. Shape (T,)."""
    gain: FloatArray
    """Sound pressure per acceleration of each coordinate, Pa s^2/m (per m/s^2 of a coordinate in m). Shape
    (T, r).
    """

    def transfer(self, frequency: FloatArray) -> ComplexArray:
        """Return the sound pressure per acceleration of each coordinate, (N, r), at (N,) in Hz."""
        omega = 2.0 * np.pi * np.asarray(frequency, dtype=float)
        pressure = np.empty((omega.size, self.gain.shape[1]), dtype=complex)
        step = max(BLOCK // self.delay.size, 1)
        for first in range(0, omega.size, step):
            part = slice(first, first + step)
            pressure[part] = np.exp(-1j * np.outer(omega[part], self.delay)) @ self.gain
        return pressure

    def of_modes(self, shape: FloatArray) -> _SoundPaths:
        """Return the paths per acceleration of modes, the columns of `shape` (r, m)."""
        return replace(self, gain=self.gain @ shape)

    def impulse_response(self, rate: float) -> tuple[FloatArray, int]:
        """Return the sound pressure after an acceleration of one sample, (L, r), and its first sample.

        Each delay is spread over samples by a windowed sinc. The response is finite: it ends with the longest
        path. `rate` in Hz.
        """
        at = self.delay * rate
        nearest = np.floor(at).astype(int) + np.arange(1 - HALF_LENGTH, HALF_LENGTH + 1)[:, None]
        off = (nearest - at) / HALF_LENGTH
        window = np.i0(KAISER * np.sqrt(np.maximum(1.0 - off**2, 0.0))) / np.i0(KAISER)
        weight = window * np.sinc(nearest - at)
        first, last = int(nearest.min()), int(nearest.max())
        panel = np.broadcast_to(np.arange(at.size), nearest.shape)
        entries = weight.ravel(), ((nearest - first).ravel(), panel.ravel())
        spread = sparse.csr_array(entries, shape=(last - first + 1, at.size))
        return np.asarray(spread @ self.gain), first


def sound_paths(
    hull: Hull, shapes: FloatArray, microphone: FloatArray, model: ElementalRadiators, air: Air
) -> _SoundPaths:
    """Return the paths from a hull that moves in shapes to a microphone.

    Raises `InputError`: the microphone is no point of the air: inside a closed hull, or too near to a panel.

    Parameters
    ----------
    shapes : (T, r) array
        Mean outward displacement of the panels per coordinate.
    microphone : (3,) array
        m, in the frame of the hull.
    """
    at = np.asarray(microphone, dtype=float)
    if at.shape != (3,) or not np.all(np.isfinite(at)):
        raise InputError("microphone", np.shape(microphone), "three finite coordinates")
    distance = np.linalg.norm(hull.centers - at, axis=1)
    if hull.closed and _solid_angle(hull, at) > 2.0 * np.pi:
        raise InputError("microphone", at.tolist(), "a point outside of the housing")
    minimum, nearest = NEAREST * hull.longest_edge, float(distance.min())
    if nearest < minimum:
        bound = at_least(minimum, "m", note=" from the surface, two of its longest edges")
        raise InputError("microphone", nearest, bound, "Move it away, or use smaller elements.")
    volume = air.density / model.solid_angle * hull.areas / distance
    return _SoundPaths(distance / air.sound_speed, volume[:, None] * shapes)


def _solid_angle(hull: Hull, point: FloatArray) -> float:
    """Return the solid angle under which a closed hull is seen, sr: 4 pi from inside, 0 from outside.

    A. van Oosterom, J. Strackee, IEEE Transactions on Biomedical Engineering 30 (1983) 125-126.
    """
    a, b, c = np.moveaxis(hull.corners - point, 1, 0)
    la, lb, lc = (np.linalg.norm(corner, axis=1) for corner in (a, b, c))
    volume = np.sum(a * np.cross(b, c), axis=1)
    cosines = la * lb * lc + np.sum(a * b, 1) * lc + np.sum(a * c, 1) * lb + np.sum(b * c, 1) * la
    return float(2.0 * np.arctan2(volume, cosines).sum())


def pressure_transfer(
    housing: ReducedHousing,
    microphone: FloatArray,
    frequency: FloatArray,
    model: ElementalRadiators = MONOPOLES,
    air: Air | None = None,
    estimate: EstimatedRadiation | None = None,
) -> ComplexArray:
    """Return the sound pressure at a microphone per force on the seats.

    Raises `InputError` as `outer_hull`, `sound_paths` and `modal_amplitudes` do.

    Parameters
    ----------
    housing : ReducedHousing
        Housing with mass and a surface.
    microphone : (3,) array
        Position of the microphone in the frame of the housing's mesh, m.
    frequency : (N,) array
        Frequencies, Hz; the result is valid up to `sound_limit`.
    model : ElementalRadiators
        Monopoles in free space, or in a rigid baffle.
    estimate : EstimatedRadiation, optional
        Estimate that corrects the level of each mode; the sound power through a far sphere is then its power.

    Returns
    -------
    (N, s) complex array
        Pressure by forces on the seats' motions, Pa/N and Pa/(N m).
    """
    hertz = np.asarray(frequency, dtype=float)
    paths = _paths(housing, microphone, model, air)
    amplitude = modal_amplitudes(housing, hertz, np.eye(housing.motions, dtype=complex)[None])
    per_mode = paths.transfer(hertz)
    if estimate is not None:
        per_mode = per_mode * estimate.gains(housing, hertz)
    return np.asarray(-((2.0 * np.pi * hertz[:, None]) ** 2) * np.einsum("nsm,nm->ns", amplitude, per_mode))


def pressure_signal(
    housing: ReducedHousing,
    time: FloatArray,
    force: FloatArray,
    microphone: FloatArray,
    model: ElementalRadiators = MONOPOLES,
    air: Air | None = None,
    estimate: EstimatedRadiation | None = None,
) -> FloatArray:
    """Return the sound pressure at a microphone under forces over time, (T,), Pa.

    The modes follow the forces as in `motion_pieces`, and each panel is heard r/c later. Nothing wraps: the
    modes are integrated, and the paths are a finite impulse response. The housing starts at rest: silence
    comes before the first sound. Raises `InputError`: there is one time alone, or as `outer_hull`,
    `sound_paths` and `motion_pieces` do.

    Parameters
    ----------
    housing, microphone, model, air, estimate
        As in `pressure_transfer`.
    time : (T,) array
        s, uniform. Delays are exact within 1e-4 up to a quarter of its rate.
    force : (T, s) array
        Forces on the motions of the seats, N and N m (`run_seat_forces`).
    """
    paths = _paths(housing, microphone, model, air)
    rows = housing.modes[1].T @ housing.mass
    acceleration = motion_pieces(housing, time, force, rows, MotionQuantity.ACCELERATION)
    times = np.asarray(time, dtype=float)
    if times.size < 2:
        raise InputError("time", times.size, "at least two times", "Let the run last longer.")
    rate = (times.size - 1) / float(times[-1] - times[0])
    response, first = paths.impulse_response(rate)
    if estimate is not None:
        taps = 2 ** int(np.ceil(np.log2(rate / RESOLUTION)))
        gains = estimate.gains(housing, fft.rfftfreq(taps, 1.0 / rate))
        response, first = _amplified(response, gains, taps), first - taps // 2
    return _convolved(acceleration, response, first, times.size)


def _amplified(response: FloatArray, gains: FloatArray, taps: int) -> FloatArray:
    """Return responses (L, m) with real gains (taps/2 + 1, m) over frequency, delayed by half of the taps."""
    window = 0.5 - 0.5 * np.cos(2.0 * np.pi * np.arange(taps) / taps)
    kernel = window[:, None] * np.roll(fft.irfft(gains, taps, axis=0), taps // 2, axis=0)
    length = len(response) + taps - 1
    count = fft.next_fast_len(length, real=True)
    return np.asarray(
        fft.irfft(fft.rfft(response, count, axis=0) * fft.rfft(kernel, count, axis=0), count, axis=0)[:length]
    )


def sound_limit(housing: ReducedHousing, air: Air | None = None) -> float:
    """Return the frequency in Hz up to which modes carry the motion and panels resolve the sound.

    Raises `InputError` as `outer_hull` does.
    """
    return min(housing.valid_frequency, resolved_frequency(outer_hull(housing), air or Air()))


def _paths(
    housing: ReducedHousing, microphone: FloatArray, model: ElementalRadiators, air: Air | None
) -> _SoundPaths:
    outer = outer_hull(housing)
    return sound_paths(outer.hull, outer.shapes, microphone, model, air or Air()).of_modes(housing.modes[1])


def _convolved(pieces: Iterator[FloatArray], response: FloatArray, first: int, samples: int) -> FloatArray:
    """Return the sum of all columns through their impulse responses, (samples,), by overlap-add.

    `first` is the sample of the first value of the responses.
    """
    count = fft.next_fast_len(PIECE + len(response) - 1, real=True)
    filters = fft.rfft(response, count, axis=0)
    total, begin = np.zeros(samples + count), 0
    for piece in pieces:
        total[begin : begin + count] += fft.irfft(
            np.sum(fft.rfft(piece, count, axis=0) * filters, axis=1), count
        )
        begin += len(piece)
    signal = total[max(-first, 0) :][: max(samples - max(first, 0), 0)]
    return np.concatenate([np.zeros(samples - signal.size), signal])


def velocity_recording(
    housing: ReducedHousing,
    run: RunResult,
    point: str,
    direction: FloatArray | None = None,
    bearings: Sequence[str] | None = None,
    to_rate: int = SAMPLE_RATE,
) -> Recording:
    """Return the velocity of a point of a housing under the bearing forces of a run, in m/s.

    Its orders are those of the forces through the transfer functions within 0.1 dB, up to the pass frequency
    of the run's output. The housing may be one that the scene of the run does not have; the forces of its
    bearings then lack what it does to them. Raises `InputError` as `run_seat_forces`, `point_signal` and
    `series_recording`; or the direction is zero.

    Parameters
    ----------
    housing : ReducedHousing
        Housing with mass.
    point : str
        Name of one of its points.
    direction : (3,) array, optional
        Direction in the frame of the housing's mesh, of any length above zero; by default the
        `principal_direction`.
    bearings : sequence of str, optional
        Bearings in the order of the seats; by default those with the names of the seats.
    """
    rate = FINER * run.sample_rate
    time, force = finer_seat_forces(run, housing, bearings, FINER)
    velocity = point_signal(housing, time, force, [point])[:, 0].T
    axis = principal_direction(velocity, rate)[0] if direction is None else unit_vector(direction)
    x, y, z = axis
    quantity = f"velocity of point {point} along ({x:.3f}, {y:.3f}, {z:.3f}); no sound pressure"
    return series_recording(np.asarray(axis @ velocity), rate, quantity, "m/s", to_rate)


def pressure_recording(
    housing: ReducedHousing,
    run: RunResult,
    microphone: FloatArray,
    bearings: Sequence[str] | None = None,
    model: ElementalRadiators = MONOPOLES,
    air: Air | None = None,
    to_rate: int = SAMPLE_RATE,
    estimate: EstimatedRadiation | None = None,
) -> Recording:
    """Return the sound pressure at a microphone in the free field over a run, in Pa.

    Its orders are those of the forces through `pressure_transfer` within 0.1 dB, delayed by the way through
    the air. It holds nothing above `sound_limit`, where modes or panels are missing, nor above the pass
    frequency of the run's output; its quantity states the lower. As in `velocity_recording`, the run may have
    moved in another housing. Raises `InputError` as `run_seat_forces`, `pressure_signal` and
    `series_recording`; or the housing has no modes.

    Parameters
    ----------
    housing : ReducedHousing
        Housing with mass and a surface.
    microphone : (3,) array
        Position of the microphone in the frame of the housing's mesh, m.
    estimate : EstimatedRadiation, optional
        Estimate by `recording_estimate`, as in `pressure_transfer`.
    bearings : sequence of str, optional
        Bearings in the order of the seats; by default those with the names of the seats.
    """
    rate, valid = FINER * run.sample_rate, positive("valid_frequency", sound_limit(housing, air))
    limit = min(valid, float(run.receipt["sampling"]["pass_frequency"]))
    time, force = finer_seat_forces(run, housing, bearings, FINER)
    pressure = pressure_signal(housing, time, force, microphone, model, air, estimate)
    x, y, z = np.asarray(microphone, dtype=float)
    levels = "" if estimate is None else " with the levels of the estimate"
    where = f"({x:.3f}, {y:.3f}, {z:.3f}) m in the free field"
    quantity = f"sound pressure at {where}, panels as {model.model_name}{levels}, up to {limit:.0f} Hz"
    return series_recording(low_passed(pressure, limit / rate), rate, quantity, "Pa", to_rate)


def check_microphone(housing: ReducedHousing, microphone: FloatArray) -> None:
    """Refuse a microphone that is no point of the air, as `pressure_transfer` does."""
    _paths(housing, microphone, MONOPOLES, None)


def scene_pressure(
    surfaces: Sequence[SurfaceHousing],
    run: RunResult,
    microphone: FloatArray,
    cache: Path | None = None,
    progress: Progress = silent,
) -> Recording:
    """Return the sound pressure at a microphone over a run, the sum over the housings.

    Each radiates as its estimate. Raises `InputError` as `pressure_recording` of any housing.

    Parameters
    ----------
    surfaces : sequence of SurfaceHousing
        Housings with their surfaces, at least one.
    microphone : (3,) array
        Position of the microphone in the frame of the scene, m.
    cache, progress
        Arguments of `recording_estimate`.
    """
    for housing in surfaces:  # before any radiation is computed
        check_microphone(housing.body, microphone)
    parts = []
    for housing in surfaces:
        estimate = recording_estimate(housing.body, run, cache, progress)
        parts.append(pressure_recording(housing.body, run, microphone, housing.bearings, estimate=estimate))
    quantity = "; ".join(dict.fromkeys(part.quantity for part in parts))
    return replace(parts[0], samples=np.sum([part.samples for part in parts], axis=0), quantity=quantity)


def recording_estimate(
    housing: ReducedHousing, run: RunResult, cache: Path | None = None, progress: Progress = silent
) -> EstimatedRadiation:
    """Return the estimate of the radiation up to where `pressure_recording` of a run ends.

    It takes what monopoles take, 10 to 60 CPU s; `cache` and `progress` as of `cached_radiation`, whose
    errors it raises.
    """
    highest = min(sound_limit(housing), float(run.receipt["sampling"]["pass_frequency"]))
    ends = [LOWEST, max(highest, LOWEST)]
    return estimated_radiation(housing, cached_radiation(housing, MONOPOLES, ends, None, cache, progress))


def scattered_pressure_transfer(
    housing: ReducedHousing, microphones: FloatArray, frequency: float, air: Air | None = None
) -> ComplexArray:
    """Return the sound pressure at microphones per force on the seats, scattering of the housing included.

    What `pressure_transfer` neglects. Each frequency takes 10 to 60 CPU s. Raises `InputError`,
    `MissingExtra`, `SolveError` as `outer_hull`, `modal_amplitudes` and `exterior_pressure` do.

    Parameters
    ----------
    housing : ReducedHousing
        Housing with mass and a surface.
    microphones : (P, 3) array
        Position of the microphone in the frame of the housing's mesh, m.
    frequency : float
        Frequency, Hz.

    Returns
    -------
    (P, s) complex array
        Pressure by forces on the seats' motions, Pa/N and Pa/(N m).
    """
    air = air or Air()
    hull = radiating_hull(outer_hull(housing), frequency, air.sound_speed)
    shapes = cast(ComplexArray, hull.shapes @ housing.modes[1])
    per_mode = exterior_pressure(hull.hull, frequency, shapes, np.atleast_2d(microphones), air)
    unit = np.eye(housing.motions, dtype=complex)[None]
    amplitude = modal_amplitudes(housing, np.array([frequency]), unit)[0]
    return np.asarray(2j * np.pi * frequency * per_mode @ amplitude.T)
