"""The version of the program and of its solver."""

from __future__ import annotations

import hashlib
from contextlib import suppress
from functools import lru_cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

_PACKAGES = ("bounds", "dynamics", "fe_contact", "host", "lineofaction", "model_studies", "service")


@lru_cache(maxsize=1)
def solver_version() -> str:
    """Return the version of the installed project; code that runs uninstalled says so."""
    for distribution in ("lineofaction", "lineofaction-client"):
        with suppress(PackageNotFoundError):
            return version(distribution)
    return "uninstalled"


@lru_cache(maxsize=1)
def program_tag() -> str:
    """Return a name of this very program: another one where a module was edited, not just released."""
    return f"{solver_version()}-{modules_digest(Path(__file__).parents[1])}"


def modules_digest(root: Path) -> str:
    """Return a digest of the modules of the packages in a folder, 16 hexadecimal digits."""
    digest = hashlib.sha256()
    for package in _PACKAGES:
        for path in sorted((root / package).rglob("*.py")):
            digest.update(path.read_bytes())
    return digest.hexdigest()[:16]
