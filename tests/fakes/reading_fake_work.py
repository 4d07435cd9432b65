"""Fakes for readers of foreign bytes: they write, hang, loop, die, hog memory or fail on request."""

from __future__ import annotations

import os
import signal
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


def echo(inputs: Json, folder: Path) -> Json:
    _drafted(folder)
    until = time.monotonic() + inputs.get("seconds", 0.0)
    while time.monotonic() < until:
        time.sleep(0.005)
    return {"word": inputs["word"], "pid": os.getpid(), "folder": str(folder)}


def loop(_inputs: Json, folder: Path) -> Json:
    _drafted(folder)
    while True:
        pass


def hog(_inputs: Json, folder: Path) -> Json:
    """Ask for more memory than there may be."""
    _drafted(folder)
    return {"length": len(bytearray(1 << 30))}


def die(_inputs: Json, folder: Path) -> Json:
    _drafted(folder)
    os.kill(os.getpid(), signal.SIGSEGV)
    return {}


def swell(_inputs: Json, _folder: Path) -> Json:
    return {"text": "x" * 110_000_000}


def refuse(_inputs: Json, folder: Path) -> Json:
    _drafted(folder)
    raise BadInput.of("toml", 5.0, "at most 4", "Send less.")


def defect(inputs: Json, folder: Path) -> Json:
    """Fail as no code should, by a text that holds what was sent."""
    _drafted(folder)
    raise RuntimeError(inputs["word"])


def peek(inputs: Json, _folder: Path) -> Json:
    return {"content": Path(inputs["file"]).read_text("utf-8")}
