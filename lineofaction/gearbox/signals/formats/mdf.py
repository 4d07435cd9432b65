"""MDF4 files of measuring systems, by asammdf."""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from lineofaction.gearbox.signals.formats.raw import RawChannel, SampleBudget, UnusableFile, wanted

EXTRA = "mdf"


def channels(file: Path, names: Sequence[str]) -> Iterator[RawChannel]:
    """Yield the channels of numbers of a file in physical values, without channels of time.

    Raises `UnusableFile`: it is of another version.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        from asammdf import MDF  # noqa: PLC0415 (an extra)

        # by its name it would be mapped as shared memory and unpacked by threads, which a reader lacks
        with file.open("rb") as stream, MDF(stream) as content:
            if not str(content.version).startswith("4"):
                raise UnusableFile("an MDF file of version 4", "Convert it to MDF4.")
            yield from _channels(content, names)


def _channels(content: Any, names: Sequence[str]) -> Iterator[RawChannel]:
    budget = SampleBudget()
    masters = set(content.masters_db.items())
    for name, places in content.channels_db.items():
        for group, index in places:
            if (group, index) in masters or not wanted(name, names):
                continue
            budget.take(int(content.groups[group].channel_group.cycles_nr))
            signal = content.get(name, group, index)
            samples = signal.samples
            if samples.ndim == 1 and samples.dtype.names is None and samples.dtype.kind in "iuf":
                times = np.asarray(signal.timestamps, dtype=np.float64)
                yield RawChannel(name, samples.astype(np.float64), times, str(signal.unit or ""))
