"""One thread at a time loads what is imported on demand.

Packages whose modules import each other, as numba's do, come out half loaded where two threads enter them
from different modules at once: a request then fails with an `ImportError`.
"""

from __future__ import annotations

import threading

LOADING = threading.RLock()
"""Held while modules are loaded that handlers import when they are called."""
