"""Environment of a child process: the variables that it needs to compute, and no secrets."""

from __future__ import annotations

import os
from fnmatch import fnmatchcase
from pathlib import Path

from host.directories import ENVIRONMENT

ONE_THREAD = dict.fromkeys(
    ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"), "1"
)
"""Environment of a process that computes in one thread.

Matrices of a few hundred rows gain nothing by more: threads that wait for each other keep processors busy.
"""
INHERITED = (
    *("PATH", "HOME", "USER", "LOGNAME", "LANG", "LANGUAGE", "LC_*", "TZ", "TMPDIR", "TEMP", "TMP"),
    *("LD_LIBRARY_PATH", "DYLD_*", "PYTHON*", "VIRTUAL_ENV", "COVERAGE_*", "MPL*", "XDG_CACHE_HOME"),
    *("OMP_*", "OPENBLAS_*", "MKL_*", "VECLIB_*", "BLIS_*", "NUMBA_*", "DASK_*", "SSL_CERT_*"),
    *("AWS_ENDPOINT*", "AWS_REGION", "AWS_DEFAULT_REGION", "AWS_ROLE_*", "AWS_WEB_IDENTITY_TOKEN_FILE"),
    *("SYSTEMROOT", "SYSTEMDRIVE", "WINDIR", "COMSPEC", "PATHEXT", "USERPROFILE", "APPDATA", "LOCALAPPDATA"),
    f"{ENVIRONMENT}*",
)
"""Variables that children inherit, with ``*`` for any ending: none of them holds a secret."""
_ROOT = str(Path(__file__).resolve().parents[2])
"""Folder of our packages, installed or not."""


def child_environment(**further: str) -> dict[str, str]:
    """Return the environment of a child: what it inherits, one thread, our packages, `further` variables."""
    inherited = {
        name: value
        for name, value in os.environ.items()
        if any(fnmatchcase(name.upper(), pattern) for pattern in INHERITED)
    }
    modules = os.pathsep.join(filter(None, (os.environ.get("PYTHONPATH"), _ROOT)))
    return inherited | ONE_THREAD | {"PYTHONPATH": modules} | further


def keep_to_one_thread() -> None:
    """Set the environment so that libraries loaded later start no threads, unless it states their number."""
    if not any(name in os.environ for name in ONE_THREAD):
        os.environ.update(ONE_THREAD)
