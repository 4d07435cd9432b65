"""HDF5 files: vectors of numbers with their times or sample rate, by h5py."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from lineofaction.gearbox.signals.formats.raw import RawChannel, SampleBudget, UnusableFile, wanted
from lineofaction.gearbox.signals.units import unit_of_name
from model_studies.netcdf import UnreadableFile, value_size

EXTRA = ""
TIMES = ("time_s", "time", "t")
RATES = ("sample_rate_hz", "sample_rate", "fs")
_UNIT_ATTRIBUTES = ("unit", "units")
_DEPTH, _MAX_ENTRIES = 4, 4096  # largest depth of groups, and number of objects in all of them
_LONGEST = 256  # most characters of an attribute
_REMEDY = "Store a dataset time_s beside the vectors, or an attribute sample_rate_hz."


def channels(file: Path, names: Sequence[str]) -> Iterator[RawChannel]:
    """Yield the vectors of numbers of a file by their paths in it.

    Raises `UnusableFile`: the file holds links to other places, values that lie in other files or are packed
    in a foreign way, too much, or vectors without times.
    """
    import h5py  # noqa: PLC0415 (start-up time)

    while h5py.h5pl.size():  # no plug-ins from here on
        h5py.h5pl.remove(0)
    with h5py.File(file, "r") as content:
        yield from _Walk(names).vectors(content, (), 0)


class _Walk:
    """A walk through the groups of a file that counts the objects in them."""

    def __init__(self, names: Sequence[str]) -> None:
        self.names, self.budget, self.entries = names, SampleBudget(), 0

    def vectors(self, group: Any, path: tuple[str, ...], depth: int) -> Iterator[RawChannel]:
        """Yield the vectors of a group and of the groups in it."""
        import h5py  # noqa: PLC0415

        entries = list(self._entries(group))
        vectors = {
            name: part for name, part in entries if isinstance(part, h5py.Dataset) and _is_vector(part)
        }
        for name, part in vectors.items():
            path_name = "/".join((*path, name))
            if name.lower() in (*TIMES, *RATES) or part.size < 2 or not wanted(path_name, self.names):
                continue
            self.budget.take(_checked_size(path_name, part))
            abscissa = _abscissa(path_name, part, vectors, group)
            unit = next(filter(None, (_text(part, key) for key in _UNIT_ATTRIBUTES)), unit_of_name(name))
            yield RawChannel(path_name, _numbers(part), abscissa, unit)
        for name, part in entries:
            if isinstance(part, h5py.Group) and name != "#refs#":
                if depth >= _DEPTH:
                    raise UnusableFile(f"a file with at most {_DEPTH} groups inside each other", value=name)
                yield from self.vectors(part, (*path, name), depth + 1)

    def _entries(self, group: Any) -> Iterator[tuple[str, Any]]:
        import h5py  # noqa: PLC0415

        for name in group:
            self.entries += 1
            if self.entries > _MAX_ENTRIES:
                raise UnusableFile(f"a file of at most {_MAX_ENTRIES} entries", "Store fewer of them.")
            if not isinstance(group.get(name, getlink=True), h5py.HardLink):
                bound = "a file without links to other places or files"
                raise UnusableFile(bound, "Copy what they lead to.", name)
            yield name, group[name]


def _is_vector(part: Any) -> bool:
    """Whether a dataset holds real numbers along one direction; MATLAB writes rows or columns."""
    shape = part.shape or ()
    kind = getattr(part.dtype, "kind", "")
    return kind in "iuf" and part.dtype.names is None and bool(shape) and max(shape) == math.prod(shape)


def _checked_size(name: str, part: Any) -> int:
    """Return the number of values of a dataset that lies in the file, packed in a known way."""
    try:
        size = value_size(part.id, part.id.get_type())
    except UnreadableFile as error:
        bound = f"a file whose datasets lie in it as numbers; this one {error}"
        raise UnusableFile(bound, value=name) from None
    return int(size // part.dtype.itemsize)


def _numbers(part: Any) -> np.ndarray:
    return np.ravel(np.asarray(part[()], dtype=np.float64))


def _text(part: Any, key: str) -> str:
    """Return a short text among the attributes; empty if there is none."""
    if key not in part.attrs or part.attrs.get_id(key).get_storage_size() > _LONGEST:
        return ""
    value = part.attrs[key]
    value = value.decode("utf-8", "replace") if isinstance(value, bytes) else value
    return value[:_LONGEST].strip() if isinstance(value, str) else ""


def _abscissa(name: str, part: Any, vectors: dict[str, Any], group: Any) -> Any:
    """Return the times of a vector, or its first time and its time step."""
    lower = {key.lower(): vector for key, vector in vectors.items()}
    time = next((lower[key] for key in TIMES if key in lower), None)
    if time is not None and time.size == part.size:
        _checked_size("time", time)
        return _numbers(time)
    rates = [_rate(owner, key) for owner in (part, group, group.file) for key in RATES]
    rates += [float(lower[key][()].flat[0]) for key in RATES if key in lower and lower[key].size == 1]
    rate = next((value for value in rates if value and 0.0 < value < math.inf), None)
    if rate is None:
        raise UnusableFile("a file with a time for each sample, or a sample rate above 0", _REMEDY, name)
    return 0.0, 1.0 / rate


def _rate(owner: Any, key: str) -> float | None:
    """Return a number among the attributes; None if there is none."""
    if key not in owner.attrs or owner.attrs.get_id(key).get_storage_size() > _LONGEST:
        return None
    value = np.asarray(owner.attrs[key])
    return float(value.flat[0]) if value.dtype.kind in "iuf" and value.size == 1 else None
