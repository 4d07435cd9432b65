"""Child process that reads a recording, and does nothing else.

Run as a script by `signals.recording`, in a folder of its own, which is all that it can reach
(`host.confine`). It reads one JSON object from standard input, writes one to standard output, and arrays
as ``channels.npz``::

    {"file": "recording.mf4", "format": "mdf", "channels": ["speed"], "seconds": 60}
    {"channels": [{"name": "speed", "unit": "rpm", "over": "time", "label": "", "direction": "",
                   "nodes": [], "even": null}]}
    {"fault": ["value", "bound", "advice"]}   or   {"unreadable": true}   or   {"missing": true}

Arrays: ``values_0``, ``abscissa_0`` ...; of an even abscissa ``even`` has the first value and the step.
"""

from __future__ import annotations

import json
import os
import sys
import tempfile
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from host import confine, end_after
from lineofaction.gearbox.signals.formats.raw import RawChannel, UnusableFile
from lineofaction.gearbox.signals.limits import READING

_FORMATS = "lineofaction.gearbox.signals.formats"


def _answer(request: dict[str, Any]) -> dict[str, Any]:
    """Return the content of a file; its arrays are written to files."""
    try:
        reader = import_module(f"{_FORMATS}.{request['format']}")
        channels = list(reader.channels(Path(request["file"]), request["channels"]))
        written = [_written(index, channel) for index, channel in enumerate(channels)]
        arrays = {name: values for _, parts in written for name, values in parts.items()}
        np.savez("channels.npz", allow_pickle=False, **arrays)
        return {"channels": [fields for fields, _ in written]}
    except UnusableFile as error:
        return {"fault": [error.value, error.bound, error.remedy]}
    except MemoryError:
        return {"error": "MemoryError"}
    except ModuleNotFoundError:
        return {"missing": True}
    # what readers of foreign or damaged files raise is not one class
    except Exception:  # noqa: BLE001
        return {"unreadable": True}


def _written(index: int, channel: RawChannel) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return the fields of a channel as JSON, and its arrays by name."""
    even = list(map(float, channel.abscissa)) if isinstance(channel.abscissa, tuple) else None
    arrays = {f"values_{index}": channel.values}
    if even is None:
        arrays[f"abscissa_{index}"] = channel.abscissa
    fields = {
        name: getattr(channel, name) for name in ("name", "unit", "over", "label", "direction", "nodes")
    }
    return fields | {"even": even}, arrays


def _main() -> None:
    """Answer the one request on standard input."""
    answer_to = os.dup(1)
    os.dup2(2, 1)  # whatever a library prints must not mix with the answer
    request = json.load(sys.stdin)
    end_after(int(request["seconds"]) + 1)
    tempfile.tempdir = str(Path.cwd())
    os.environ["HOME"] = os.environ["TMPDIR"] = tempfile.tempdir
    confine(Path.cwd(), READING)
    answer = _answer(request)
    with os.fdopen(answer_to, "w") as stream:
        json.dump(answer, stream)


if __name__ == "__main__":
    _main()
