"""Measure a piece of Python in a process of its own, with single-threaded linear algebra."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from typing import Any

_EPILOGUE = """
import json as _json, resource as _resource
_used = [_resource.getrusage(w) for w in (_resource.RUSAGE_SELF, _resource.RUSAGE_CHILDREN)]
_cpu = sum(u.ru_utime + u.ru_stime for u in _used)
print(_json.dumps({"process_cpu_seconds": _cpu, **measured}))
"""


def as_installed() -> dict[str, str]:
    """Return the environment, with the bytecode of modules kept as that of installed ones is."""
    return {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}


def measure(code: str, **environment: str) -> dict[str, Any]:
    """Run `code`, which leaves its results in a dict called ``measured``; add the CPU seconds."""
    settings = as_installed() | {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "MKL_NUM_THREADS": "1"}
    done = subprocess.run(
        [sys.executable, "-c", code + _EPILOGUE],
        env=settings | environment,
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode:
        raise RuntimeError(f"the measured code failed:\n{done.stderr}")
    result: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
    return result
