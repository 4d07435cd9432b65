"""Fakes for live questions: they answer, wait, die, fail or hog memory on request."""

import os
import signal
import time
from pathlib import Path
from typing import Any

from lineofaction.gearbox.problems import BadInput

_asked: list[str] = []


def echo(inputs: dict[str, Any]) -> dict[str, Any]:
    """Return what was asked, everything asked before, and who answers."""
    _asked.append(inputs["word"])
    time.sleep(inputs.get("seconds", 0.0))
    if "wait_for" in inputs:
        while not Path(inputs["wait_for"]).exists():
            time.sleep(0.005)
    return {"asked": list(_asked), "pid": os.getpid(), "nice": os.nice(0)}


def hang(_inputs: dict[str, Any]) -> dict[str, Any]:
    while True:
        time.sleep(0.05)


def load_slowly(_inputs: dict[str, Any]) -> dict[str, Any]:
    """Import a module that takes a while; return how often an import of it began."""
    from live_slow_import import attempts  # noqa: PLC0415 (the import is the work)

    return {"attempts": attempts()}


def plan(inputs: dict[str, Any]) -> dict[str, Any]:
    """Return a plan; never, where a budget is stated."""
    return hang(inputs) if inputs.get("time_budget_s") else {"prediction": {"stages": {"all": 0.5}}}


def deaf(_inputs: dict[str, Any]) -> dict[str, Any]:
    """Work where Python heeds nothing."""
    time.sleep(1000.0)
    return {}


def die(_inputs: dict[str, Any]) -> dict[str, Any]:
    os.kill(os.getpid(), signal.SIGKILL)
    return {}


def hog(_inputs: dict[str, Any]) -> dict[str, Any]:
    """Ask for more memory than there may be."""
    return {"length": len(bytearray(1 << 42))}


def refuse(_inputs: dict[str, Any]) -> dict[str, Any]:
    raise BadInput.of("torque_n_m[0]", 5.0, "at most 4", "Ask for less.")


def defect(_inputs: dict[str, Any]) -> dict[str, Any]:
    raise RuntimeError("secret text of a defect")


def speak(inputs: dict[str, Any]) -> dict[str, Any]:
    """Answer with a number that JSON may not have, and words of that name."""
    return {
        "number": float(inputs["number"]),
        "word": "NaN and Infinity",
        "list": [0.1, 1e-7, True, None, "µ"],
    }
