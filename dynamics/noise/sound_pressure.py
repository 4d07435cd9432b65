"""Sound pressure of a housing at a microphone in the free field, under the forces of its bearings.

Panels are elemental radiators, which neither scatter nor shadow. Equivalent radiated power knows no phase and
no direction: it has no sound pressure.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from scipy.fft import irfft, next_fast_len, rfft

from dynamics.acoustics import Air, ElementalRadiators, outer_hull
from dynamics.acoustics.hull import ComplexArray
from dynamics.housing_modes.reduced_housing import ReducedHousing
from dynamics.noise.housing_radiation import resolved_frequency
from dynamics.noise.sound_paths import SoundPaths, sound_paths
from dynamics.types import FloatArray
from dynamics.vibration import MotionQuantity
from dynamics.vibration.modal_amplitudes import modal_amplitudes
from dynamics.vibration.time_signal import PIECE, motion_pieces

MONOPOLES = ElementalRadiators()


def pressure_transfer(
    housing: ReducedHousing,
    microphone: FloatArray,
    frequency: FloatArray,
    model: ElementalRadiators = MONOPOLES,
    air: Air | None = None,
) -> ComplexArray:
    """Return the sound pressure at a microphone per force on the seats.

    Parameters
    ----------
    housing : ReducedHousing
        With mass and a surface.
    microphone : (3,) array
        In the frame of the housing's mesh, m.
    frequency : (N,) array
        Hz; `sound_limit` says up to where the result is valid.
    model : ElementalRadiators
        Monopoles in free space, or in a rigid baffle.
    air : Air, optional

    Returns
    -------
    (N, s) complex array
        By the seats' motions, Pa/N and Pa/(N m).

    Raises
    ------
    InputError
        As `outer_hull`, `sound_paths` and `modal_amplitudes` do.
    """
    hertz = np.asarray(frequency, dtype=float)
    paths = _paths(housing, microphone, model, air)
    amplitude = modal_amplitudes(housing, hertz, np.eye(housing.motions, dtype=complex)[None])
    per_mode = paths.transfer(hertz) @ housing.modes[1]
    return np.asarray(-((2.0 * np.pi * hertz[:, None]) ** 2) * np.einsum("nsm,nm->ns", amplitude, per_mode))


def pressure_signal(
    housing: ReducedHousing,
    time: FloatArray,
    force: FloatArray,
    microphone: FloatArray,
    model: ElementalRadiators = MONOPOLES,
    air: Air | None = None,
) -> FloatArray:
    """Return the sound pressure at a microphone under forces over time, (T,), Pa.

    The modes follow the forces as in `motion_signal`, and each panel is heard r/c later. Nothing wraps: the
    modes are integrated, and the paths are a finite impulse response. The housing starts at rest: silence
    comes before the first sound.

    Parameters
    ----------
    housing, microphone, model, air
        As in `pressure_transfer`.
    time : (T,) array
        s, uniform. Delays are exact within 1e-4 up to a quarter of its rate.
    force : (T, s) array
        On the motions of the seats, N and N m (`run_seat_forces`).

    Raises
    ------
    InputError
        As `outer_hull`, `sound_paths` and `motion_signal` do.
    """
    paths = _paths(housing, microphone, model, air)
    rows = np.eye(len(housing.mass))
    acceleration = motion_pieces(housing, time, force, rows, MotionQuantity.ACCELERATION)
    times = np.asarray(time, dtype=float)
    response, first = paths.impulse_response((times.size - 1) / float(times[-1] - times[0]))
    return _convolved(acceleration, response, first, times.size)


def sound_limit(housing: ReducedHousing, air: Air | None = None) -> float:
    """Return the frequency in Hz up to which modes carry the motion and panels resolve the sound.

    Raises
    ------
    InputError
        As `outer_hull` does.
    """
    return min(housing.valid_frequency, resolved_frequency(outer_hull(housing), air or Air()))


def _paths(
    housing: ReducedHousing, microphone: FloatArray, model: ElementalRadiators, air: Air | None
) -> SoundPaths:
    """Return the paths from all panels of the outer hull."""
    outer = outer_hull(housing)
    return sound_paths(outer.hull, outer.shapes, microphone, model, air or Air())


def _convolved(pieces: Iterator[FloatArray], response: FloatArray, first: int, samples: int) -> FloatArray:
    """Return the sum of all columns through their impulse responses, (samples,), by overlap-add.

    `first` is the sample of the first value of the responses.
    """
    count = next_fast_len(PIECE + len(response) - 1, real=True)
    filters = rfft(response, count, axis=0)
    total, begin = np.zeros(samples + count), 0
    for piece in pieces:
        total[begin : begin + count] += irfft(np.sum(rfft(piece, count, axis=0) * filters, axis=1), count)
        begin += len(piece)
    heard = total[max(-first, 0) :][: max(samples - max(first, 0), 0)]
    return np.concatenate([np.zeros(samples - heard.size), heard])
