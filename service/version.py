"""The version of the program and of its solver."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path

from lineofaction.gearbox.program_version import solver_version

__all__ = ["modules_digest", "program_tag", "solver_version"]

_PACKAGES = ("bounds", "dynamics", "fe_contact", "host", "lineofaction", "model_studies", "service")


@lru_cache(maxsize=1)
def program_tag() -> str:
    """Return a name of this program that changes with every edit of a module, not only with a release."""
    return f"{solver_version()}-{modules_digest(Path(__file__).parents[1])}"


def modules_digest(root: Path) -> str:
    """Return a digest of the modules of the packages in a folder, 16 hexadecimal digits."""
    digest = hashlib.sha256()
    for package in filter(Path.is_dir, (root / name for name in _PACKAGES)):
        for path in sorted(_modules(str(package))):
            with open(path, "rb", buffering=0) as file:  # noqa: PTH123 (a third of the time)
                digest.update(file.read())
    return digest.hexdigest()[:16]


def _modules(folder: str) -> Iterator[str]:
    """Yield the paths of the modules below a folder, fast: every command looks at a thousand."""
    with os.scandir(folder) as entries:
        for entry in entries:
            if entry.name.endswith(".py"):
                yield entry.path
            elif entry.is_dir() and entry.name != "__pycache__":
                yield from _modules(entry.path)
