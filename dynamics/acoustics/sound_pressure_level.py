"""Level of a recorded sound pressure."""

from __future__ import annotations

import numpy as np

from dynamics.acoustics.levels import FLOOR, REFERENCE_PRESSURE, a_weighting
from dynamics.acoustics.recording import Recording
from dynamics.errors import InputError


def sound_pressure_level(recording: Recording, *, weighted: bool = False) -> float:
    """Return the level of the root mean square over a recording re 20 uPa, dB or dB(A); at least `FLOOR`.

    The equivalent continuous level of ISO 1996-1.

    Parameters
    ----------
    weighted : bool
        Whether A-weighted.

    Raises
    ------
    InputError
        It is no sound pressure in Pa.
    """
    if recording.unit != "Pa":
        raise InputError("unit", recording.unit, "Pa", "Its level is that of a sound pressure.")
    samples = recording.samples
    lines = np.abs(np.fft.rfft(samples) / samples.size) ** 2
    lines[1 : (samples.size + 1) // 2] *= 2.0  # Parseval: all but the mean and the Nyquist line stand for two
    if weighted:
        lines *= 10.0 ** (a_weighting(np.fft.rfftfreq(samples.size, 1.0 / recording.sample_rate)) / 10.0)
    lowest = 10.0 ** (FLOOR / 10.0)
    return float(10.0 * np.log10(max(lines.sum() / REFERENCE_PRESSURE**2, lowest)))
