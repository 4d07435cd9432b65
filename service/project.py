"""Projects: groups of callers that see only their own jobs and results.

Equal work has the same content hash in every project. In the database, and among the files, it stands under
its address, which no two projects share: so each project computes and keeps its own.
"""

from __future__ import annotations

import re

COMMON = ""
"""The project of callers that belong to no other."""

PROJECT = re.compile(r"[a-z0-9][a-z0-9_-]{0,62}")
"""Names of projects: also parts of names of files, on systems that do not tell a from A."""


def address_of(project: str, key: str) -> str:
    """Return the address of a content hash in a project."""
    return key if project == COMMON else f"{project}.{key}"


def at_address(address: str) -> tuple[str, str]:
    """Return project and content hash of an address."""
    project, _, key = address.rpartition(".")
    return project, key
