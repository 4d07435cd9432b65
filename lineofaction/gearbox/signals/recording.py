"""Recordings: files of channels, read by a confined process and checked."""

from __future__ import annotations

import shutil
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

import host  # children are started by readers of files alone: a client has none
from bounds.brief import brief
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.signals.channel import Channel
from lineofaction.gearbox.signals.endings import ENDINGS, FORMATS, UNIVERSAL
from lineofaction.gearbox.signals.limits import LARGEST_FILE, READING, SECONDS
from lineofaction.gearbox.signals.units import measured_unit

_EXTRAS = {"universal": ("pyuff", "uff"), "frequency_responses": ("pyuff", "uff"), "mdf": ("asammdf", "mdf")}
"""Module and extra of the readers that a base install lacks."""
_WORKER = Path(__file__).with_name("worker.py")
_LONGEST = 80  # most characters of a name in a message
_LISTED = 12  # names in a message
_OVER, _DIRECTIONS = ("time", "order", "frequency", ""), ("x", "y", "z", "")


@brief
@dataclass(frozen=True)
class Recording:
    """The channels of a file; `name` is the file's."""

    name: str
    channels: tuple[Channel, ...]

    def channel(self, field: str, name: str = "", quantities: Sequence[str] = ()) -> Channel:
        """Return the channel of a name, or without one the only channel over time of some quantities.

        A channel whose file states no unit counts as of all. Raises `BadInput`: there is none, or several.
        """
        if name:
            chosen = [channel for channel in self.channels if channel.name == name]
            bound = "one channel of that name"
        else:
            chosen = [one for one in self.channels if one.over == "time" and _may_be(one, quantities)]
            bound = f"the name of a channel: {len(chosen)} could be it"
        if len(chosen) != 1:
            names = [channel.name for channel in self.channels]
            more = f" and {len(names) - _LISTED} more" if len(names) > _LISTED else ""
            present = f"{self.name} has {', '.join(names[:_LISTED]) or 'no channels'}{more}."
            raise BadInput.of(field, name or None, bound, present)
        return chosen[0]


def _may_be(channel: Channel, quantities: Sequence[str]) -> bool:
    unit = measured_unit(channel.unit)
    return unit is None if channel.unit == "" else unit is not None and unit.quantity in quantities


def read_recording(path: Path, field: str, names: Sequence[str] = ()) -> Recording:
    """Return the channels of a file, only the named ones if any are named.

    Raises `BadInput`: the ending is not known, an extra or the file is missing, the file is too large, cannot
    be read within the limits, or holds something else.
    """
    if path.suffix.lower() not in FORMATS:
        raise BadInput.of(field, path.name, f"a file that ends in {', '.join(ENDINGS)}")
    return Recording(path.name, _channels(path, FORMATS[path.suffix.lower()], field, names))


def read_frequency_responses(path: Path, field: str) -> tuple[Channel, ...]:
    """Return the frequency responses of a universal file, in SI units, with their nodes.

    Raises `BadInput` as `read_recording`, and where one does not state its unit.
    """
    if path.suffix.lower() not in UNIVERSAL:
        raise BadInput.of(field, path.name, f"a file that ends in {', '.join(UNIVERSAL)}")
    return _channels(path, ("frequency_responses", "a universal file"), field, ())


def _check_file(path: Path, form: tuple[str, str], field: str) -> None:
    """Refuse a file that is missing or too large, or whose reader is not installed."""
    reader, noun = form
    module, extra = _EXTRAS.get(reader, ("numpy", ""))
    if find_spec(module) is None:
        remedy = f"pip install 'lineofaction[{extra}]'"
        raise BadInput.of(field, path.name, f"read where the extra {extra} is installed", remedy)
    try:
        size = path.stat().st_size
    except OSError:
        raise BadInput.of(field, str(path), noun, "Check the path.") from None
    if not path.is_file() or size > LARGEST_FILE:
        raise BadInput.of(field, str(path), f"{noun} of at most {LARGEST_FILE} bytes", "Export less of it.")


def _channels(path: Path, form: tuple[str, str], field: str, names: Sequence[str]) -> tuple[Channel, ...]:
    _check_file(path, form, field)
    reader, noun = form
    with TemporaryDirectory() as folder:
        copy = Path(folder) / f"recording{path.suffix.lower()}"
        shutil.copyfile(path, copy)
        request = {"file": copy.name, "format": reader, "channels": list(names)}
        try:
            command = sys.executable, "-P", str(_WORKER)
            answer = host.ask_child(request, SECONDS, command, copy.parent, READING)
        except host.ChildFailed as error:
            limits = f"{READING.memory_mb} MB of memory and {READING.cpu_seconds} s of CPU time"
            bound = f"{noun} that is read within {limits} (the reader: {error.cause})"
            raise BadInput.of(field, path.name, bound, "Export less of it, or as HDF5.") from None
        if (fault := answer.get("fault")) is not None:
            value, bound, remedy = (_printable(str(part), 300) for part in fault)
            raise BadInput.of(field, f"{path.name}: {value}" if value else path.name, bound, remedy)
        if "channels" not in answer:
            raise BadInput.of(field, path.name, f"{noun} that can be read", "Export it again.")
        with np.load(copy.with_name("channels.npz"), allow_pickle=False) as arrays:
            return tuple(_channel(fields, arrays, i) for i, fields in enumerate(answer["channels"]))


def _channel(fields: dict[str, Any], arrays: Any, index: int) -> Channel:
    """Return a channel from the child's output, which foreign bytes may have corrupted."""
    values = arrays[f"values_{index}"]
    if (even := fields["even"]) is None:
        abscissa = np.asarray(arrays[f"abscissa_{index}"], dtype=np.float64)
    else:
        abscissa = even[0] + even[1] * np.arange(values.size)
    name, unit, label = (_printable(str(fields[key])) for key in ("name", "unit", "label"))
    if values.ndim != 1 or values.shape != abscissa.shape or values.dtype.kind not in "iufc":
        raise BadInput.of("measured", name, "a channel with a number for each time", "Export it again.")
    over = fields["over"] if fields["over"] in _OVER else ""
    direction = fields["direction"] if fields["direction"] in _DIRECTIONS else ""
    nodes = tuple(map(int, fields["nodes"]))
    return Channel(name, unit, abscissa, values, over, label, direction, nodes)


def _printable(text: str, longest: int = _LONGEST) -> str:
    """Return a text of a file without characters that move a cursor or break a line."""
    return "".join(sign if sign.isprintable() else " " for sign in text[:longest]).strip()


def begins_with_time(file: Path) -> bool:
    """Whether the first column of a CSV file is a time: then it is a recording."""
    try:
        with file.open("rb") as stream:
            return stream.read(_LONGEST).removeprefix(b"\xef\xbb\xbf").lstrip().startswith(b"time_")
    except OSError:
        return False
