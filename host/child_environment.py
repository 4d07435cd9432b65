"""What a child process gets of this one's environment: what it needs to compute, and no secrets."""

from __future__ import annotations

import os
from fnmatch import fnmatchcase
from pathlib import Path

from host.directories import ENVIRONMENT
from host.threads import ONE_THREAD

_ROOT = str(Path(__file__).resolve().parents[1])
INHERITED = (
    *("PATH", "HOME", "USER", "LOGNAME", "LANG", "LANGUAGE", "LC_*", "TZ", "TMPDIR", "TEMP", "TMP"),
    *("LD_LIBRARY_PATH", "DYLD_*", "PYTHON*", "VIRTUAL_ENV", "COVERAGE_*", "MPL*", "XDG_CACHE_HOME"),
    *("OMP_*", "OPENBLAS_*", "MKL_*", "VECLIB_*", "BLIS_*", "NUMBA_*", "DASK_*", "SSL_CERT_*"),
    *("AWS_ENDPOINT*", "AWS_REGION", "AWS_DEFAULT_REGION", "AWS_ROLE_*", "AWS_WEB_IDENTITY_TOKEN_FILE"),
    *("SYSTEMROOT", "SYSTEMDRIVE", "WINDIR", "COMSPEC", "PATHEXT", "USERPROFILE", "APPDATA", "LOCALAPPDATA"),
    f"{ENVIRONMENT}*",
)
"""Variables that children inherit, with ``*`` for any ending: none of them holds a secret."""


def child_environment(**further: str) -> dict[str, str]:
    """Return the environment of a child: one thread, modules found where we find them, installed or not.

    Parameters
    ----------
    **further : str
        Variables beside those inherited.
    """
    inherited = {
        name: value
        for name, value in os.environ.items()
        if any(fnmatchcase(name.upper(), pattern) for pattern in INHERITED)
    }
    modules = os.pathsep.join(filter(None, (os.environ.get("PYTHONPATH"), _ROOT)))
    return inherited | ONE_THREAD | {"PYTHONPATH": modules} | further
