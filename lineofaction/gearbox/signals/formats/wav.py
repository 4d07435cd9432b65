"""WAV files: channels of samples in parts of the full scale, or in numbers of the caller, by SciPy."""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from lineofaction.gearbox.signals.formats.raw import RawChannel, SampleBudget, UnusableFile, wanted

EXTRA = ""


def channels(file: Path, names: Sequence[str]) -> Iterator[RawChannel]:
    """Yield ``channel 1``, ``channel 2`` ...: integers over the full scale, numbers with a point as they are.

    Raises `UnusableFile`: the file ends before its samples do.
    """
    from scipy.io import wavfile  # noqa: PLC0415 (start-up time)

    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warnings.filterwarnings("ignore", message=r"Chunk \(non-data\) not understood")
        rate, samples = wavfile.read(file)
    if samples.ndim == 1:
        samples = samples[:, None]
    if rate <= 0 or samples.shape[0] < 1:
        raise UnusableFile("a WAV file with samples and a sample rate")
    budget = SampleBudget()
    for index in range(samples.shape[1]):
        name = f"channel {index + 1}"
        if wanted(name, names):
            budget.take(samples.shape[0])
            yield RawChannel(name, _numbers(samples[:, index]), (0.0, 1.0 / rate))


def _numbers(samples: np.ndarray) -> np.ndarray:
    """Return samples as parts of the full scale; 24 bits come in the upper bytes of 32."""
    if samples.dtype.kind == "f":
        return samples.astype(np.float64)
    if samples.dtype == np.uint8:
        return (samples.astype(np.float64) - 128.0) / 128.0
    return samples.astype(np.float64) / -float(np.iinfo(samples.dtype).min)
