"""Rebuilding the index of results from their files, after its database was lost or restored from a backup."""

from __future__ import annotations

import contextlib
import json
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

from model_studies.netcdf import opened
from service.store.database import instant, now
from service.store.deployment import Deployment
from service.store.files import ResultName
from service.store.results import IndexLine, ResultStore


@dataclass(frozen=True)
class _Reindexed:
    """The result of rebuilding the index: its files and lines."""

    known: int
    entered: int
    """`known`, `entered`: Files that the index named already; files that it names now."""
    damaged: tuple[str, ...]
    doubled: tuple[str, ...]
    """`damaged`, `doubled`: Files whose bytes do not agree with their names; second files of one result.
    Both are left where they are.
    """
    struck: tuple[str, ...]
    """Files that lines named and that are gone."""


def reindex(store: ResultStore, deployment: Deployment) -> _Reindexed:
    """Claim the files for this deployment, enter those that no line names, strike lines without a file.

    Lists date a result by the time of its file. Retention counts from now on, since the time of a file may be
    that of a copy.

    Raises `BadInput`: the files belong to another deployment, and the index has results of its own.
    """
    deployment.take_over()
    missing_lines = (line for line in store.lines() if not store.files.has(line.file))
    struck = tuple(line.file for line in missing_lines if store.strike(line))
    indexed = {line.file for line in store.lines()}
    entered, damaged, doubled = 0, [], []
    for file in list(store.files.files()):
        name = ResultName.of(file.name)
        if name is None or file.name in indexed:
            continue
        with contextlib.suppress(FileNotFoundError):  # another was quicker
            sha256 = store.files.digest(file.name)
            if not (name.agrees(sha256) and _opens(store.files.local(file.name, sha256))):
                damaged.append(file.name)
                continue
            modified = instant(datetime.fromtimestamp(file.modified, UTC))
            line = IndexLine(name.key, name.kind, sha256, file.size, file.name, now(), project=name.project)
            if store.enter(line, made=min(modified, line.used)).file == file.name:
                entered += 1
            else:
                doubled.append(file.name)
    return _Reindexed(len(indexed), entered, tuple(damaged), tuple(doubled), struck)


def _opens(path: Path) -> bool:
    """Whether a file is complete in its format; names by older versions do not contain the digest."""
    try:
        if path.suffix == ".json":
            json.loads(path.read_bytes())
        else:
            with opened(path):
                pass
    except (OSError, ValueError):
        return False
    return True
