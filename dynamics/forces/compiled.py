"""How the inner loops are compiled: to machine code, cached on disk, without the interpreter's lock."""

from __future__ import annotations

from functools import partial

from numba import njit

# error_model="numpy": a division by zero gives an infinity, which the step control sees, and no branch at
# every division. forceinline with _nrt=False: arrays travel in named tuples, and without these two each call
# copies the tuples and counts references to all their arrays, which made a step ten times slower (18 us
# against 1.9 us). So compiled functions allocate nothing; they write into what they are given.
_numba = partial(njit, error_model="numpy", nogil=True, _nrt=False, forceinline=True)

# Callable from Python. The first call compiles or reads the cache beside the source (in NUMBA_CACHE_DIR
# where that cannot be written). All callers pass C-contiguous float64 and int64 arrays, so each function has
# one signature and one cache entry serves every process. numba renews an entry when the function's own file
# changes, not when a function it calls does: after editing a kernel, clear the cache.
compiled = _numba(cache=True)

# Callable from compiled functions only: no wrappers, no cache entry of its own, which halves the compile
# time.
inner = _numba(no_cpython_wrapper=True, no_cfunc_wrapper=True)

# Callable from compiled functions only, and not copied into each of them: for large functions, whose many
# copies would take the compiler longer than a call takes the run.
shared = partial(_numba, forceinline=False)(no_cpython_wrapper=True, no_cfunc_wrapper=True)
