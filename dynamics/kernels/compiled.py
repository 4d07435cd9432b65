"""Compilation of the inner loops to machine code, cached on disk, without the interpreter's lock."""

from __future__ import annotations

from functools import partial
from typing import Any

from host import loops
from host.loops import njit

# error_model="numpy": a division by zero gives an infinity, which the step control sees, and no branch at
# every division. _nrt=False: compiled functions allocate nothing and count no references; they write into
# what they are given. forceinline: what they call is part of them, so that addresses and lengths of arrays
# are read once; what is too large for that is a `Routine`.
_OPTIONS: dict[str, Any] = {"error_model": "numpy", "nogil": True, "_nrt": False, "forceinline": True}

# Callable from Python. The first call compiles, or reads what was compiled of the same sources
# (`host.loop_cache`). Tuples of arrays go in `by_address`, arrays are C-contiguous float64 and int64, so each
# function has one signature and one cache entry serves every process.
compiled = partial(njit, **_OPTIONS)(cache=True)

# Part of the compiled functions that call them, compiled with those; from Python compiled once more.
inner = loops.inner(**_OPTIONS)

# The same for sums of many products, which may be taken in any order: side by side in vector registers.
inner_sums = loops.inner(**_OPTIONS, fastmath={"reassoc", "contract"})
