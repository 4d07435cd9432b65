"""MATLAB files: vectors of numbers with times or a sample rate, by SciPy, from 7.3 on by h5py."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from lineofaction.gearbox.signals.formats import hdf5
from lineofaction.gearbox.signals.formats.raw import RawChannel, SampleBudget, UnusableFile, wanted
from lineofaction.gearbox.signals.units import unit_of_name

EXTRA = ""
_HDF5 = b"\x89HDF\r\n\x1a\n"
_AT = 512  # size in bytes of the user block that MATLAB puts in front of HDF5
TIMES = ("time_s", "time", "t")
RATES = ("sample_rate_hz", "sample_rate", "fs")
_REMEDY = "Save vectors of numbers beside time_s, or beside the number sample_rate_hz."


def channels(file: Path, names: Sequence[str]) -> Iterator[RawChannel]:
    """Yield the vectors of numbers of a file; structures, cells, texts and objects are passed over.

    Raises `UnusableFile`: no vector of times and no sample rate stands beside them.
    """
    with file.open("rb") as stream:
        head = stream.read(_AT + len(_HDF5))
    if _HDF5 in (head[: len(_HDF5)], head[_AT:]):
        return hdf5.channels(file, names)
    return _vectors(_loaded(file), names)


def _loaded(file: Path) -> Mapping[str, Any]:
    from scipy.io import loadmat  # noqa: PLC0415 (start-up time)

    return dict(loadmat(file, squeeze_me=False, struct_as_record=True, chars_as_strings=True))


def _vectors(content: Mapping[str, Any], names: Sequence[str]) -> Iterator[RawChannel]:
    vectors = {
        name: np.ravel(values)
        for name, values in content.items()
        if isinstance(values, np.ndarray) and values.dtype.kind in "iuf" and values.size == max(values.shape)
    }
    lower = {name.lower(): vector for name, vector in vectors.items()}
    time = next((lower[name] for name in TIMES if name in lower), None)
    rate = next((float(lower[name][0]) for name in RATES if name in lower and lower[name].size == 1), None)
    budget = SampleBudget()
    for name, values in vectors.items():
        if name.lower() in (*TIMES, *RATES) or values.size < 2 or not wanted(name, names):
            continue
        budget.take(values.size)
        yield RawChannel(
            name, values.astype(np.float64), _abscissa(name, time, rate, values.size), unit_of_name(name)
        )


def _abscissa(name: str, time: Any, rate: float | None, size: int) -> Any:
    if time is not None and time.size == size:
        return time.astype(np.float64)
    if rate is not None and np.isfinite(rate) and rate > 0.0:
        return 0.0, 1.0 / rate
    raise UnusableFile("a file with a time for each sample, or a sample rate above 0", _REMEDY, name)
