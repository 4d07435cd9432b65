"""One thread at a time loads what is imported on demand.

Packages whose modules import each other, as numba's do, come out half loaded where two threads enter them
from different modules at once: a request then fails with an `ImportError`.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from importlib import import_module
from typing import Any

LOADING = threading.RLock()
"""Held while modules are loaded that handlers import when they are called."""


def load(entry: str) -> Any:
    """Return the object of the address ``"module:name"``, and import its module now.

    Used where a start was measured: `loa --help` and `import lineofaction` load neither studies nor the
    libraries that compute.
    """
    module, _, name = entry.partition(":")
    with LOADING:
        return getattr(import_module(module), name)


def on_demand(entry: str) -> Callable[..., Any]:
    """Return a function that calls ``"module:function"``, imported when it is called first."""

    def call(*arguments: object) -> Any:
        """Import, then call."""
        return load(entry)(*arguments)

    return call
