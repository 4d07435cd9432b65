"""Fakes for readers of foreign bytes: they write, hang, loop, die, hog memory or fail on request."""

import ctypes
import os
import time
from pathlib import Path
from typing import Any

from lineofaction.gearbox.problems import BadInput

Json = dict[str, Any]


def _drafted(folder: Path) -> Path:
    """Leave a file behind."""
    file = folder / "draft"
    file.write_bytes(bytes(1000))
    return file


def echo(inputs: Json, folder: Path, _announce: Any) -> Json:
    _drafted(folder)
    until = time.monotonic() + inputs.get("seconds", 0.0)
    while time.monotonic() < until:
        time.sleep(0.005)
    return {"word": inputs["word"], "pid": os.getpid(), "folder": str(folder)}


def loop(_inputs: Json, folder: Path, _announce: Any) -> Json:
    _drafted(folder)
    while True:
        pass


def hog(_inputs: Json, folder: Path, _announce: Any) -> Json:
    """Ask for more memory than there may be."""
    _drafted(folder)
    return {"length": len(bytearray(1 << 30))}


def die(_inputs: Json, folder: Path, _announce: Any) -> Json:
    """Read where nothing is, as a native library does that a file leads astray."""
    _drafted(folder)
    return {"content": ctypes.string_at(0).decode()}


def die_at(inputs: Json, folder: Path, announce: Any) -> Json:
    """Read two files, of which the second ends the reader."""
    for field in inputs["fields"]:
        announce(field)
    return die(inputs, folder, announce)


def leave(_inputs: Json, folder: Path, _announce: Any) -> Json:
    """End as a native library does that calls exit."""
    _drafted(folder)
    os._exit(3)


def fill(_inputs: Json, folder: Path, _announce: Any) -> Json:
    """Write files without end, of which one exists at a time: each is within its limit."""
    while True:
        file = folder / "large"
        file.write_bytes(bytes(10_000_000))
        file.unlink()


def scatter(_inputs: Json, folder: Path, _announce: Any) -> Json:
    """Make empty files without end."""
    number = 0
    while True:
        number += 1
        (folder / str(number)).touch()


def swell(_inputs: Json, _folder: Path, _announce: Any) -> Json:
    return {"text": "x" * 110_000_000}


def refuse(_inputs: Json, folder: Path, _announce: Any) -> Json:
    _drafted(folder)
    raise BadInput.of("toml", 5.0, "at most 4", "Send less.")


def defect(inputs: Json, folder: Path, _announce: Any) -> Json:
    """Fail as no code should, by a text that holds what was sent."""
    _drafted(folder)
    raise RuntimeError(inputs["word"])


def peek(inputs: Json, _folder: Path, _announce: Any) -> Json:
    return {"content": Path(inputs["file"]).read_text("utf-8")}
