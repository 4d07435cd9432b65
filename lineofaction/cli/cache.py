"""``loa cache``: size and removal of the caches that make later work quicker."""

from __future__ import annotations

import os
import shutil
import time

from bounds import engineering
from host.directories import cache_home
from lineofaction.cli.output import console, print_json, table
from lineofaction.gearbox.problems import BadInput
from service.folder_size import DEFAULT_BYTES, UsedFile, evict, files_in

LIMIT = "LOA_CACHE_BYTES"
KINDS = {
    "compliance": "condensed gears",
    "housings": "meshes and modes of housings",
    "results": "results of services",
    "searches": "searches of optimizations",
    "studies": "tasks of studies",
    "tables": "STE tables of the meshes of scenes",
}
"""Folders of the cache, with descriptions of their contents."""
_DAY = 86_400.0
_GB = 1e9


def run_list(*, as_json: bool) -> None:
    """Print the contents of the cache."""
    by_kind = {kind: files_in(cache_home() / kind) for kind in KINDS}
    if as_json:
        kinds = {kind: {"files": len(files), "bytes": _bytes(files)} for kind, files in by_kind.items()}
        print_json({"folder": str(cache_home()), "limit_bytes": _limit_bytes(), "kinds": kinds})
        return
    rows = []
    for kind, files in by_kind.items():  # the files of a kind begin with the one that is unused longest
        age = f"{(time.time() - files[0].used) / _DAY:.1f}" if files else ""
        rows.append([kind, KINDS[kind], str(len(files)), _megabytes(files), age])
    out = console()
    out.print(table(["kind", "what", "files", "MB", "oldest use, days"], rows, text_columns=["kind", "what"]))
    size = _megabytes([file for files in by_kind.values() for file in files])
    limit = engineering(1e3 * _limit_bytes() / _GB, 4)
    out.print(f"{size} MB of {limit} MB in {cache_home()}", soft_wrap=True)


def run_limit(gigabytes: float | None, *, as_json: bool) -> None:
    """Remove the longest unused files until the rest fits."""
    maximum = _limit_bytes() if gigabytes is None else round(gigabytes * _GB)
    _print_removed(evict(cache_home(), maximum), as_json=as_json)


def run_clear(kinds: list[str], *, as_json: bool) -> None:
    """Remove all entries, or those of the named kinds."""
    for kind in kinds:
        if kind not in KINDS:
            raise BadInput.of("kind", kind, f"one of {', '.join(KINDS)}", "Or leave it out: all of them.")
    folders = [cache_home() / kind for kind in kinds or KINDS]
    removed = [file for folder in folders for file in files_in(folder)]
    for folder in folders:
        shutil.rmtree(folder, ignore_errors=True)
    _print_removed(removed, as_json=as_json)


def keep_small() -> None:
    """Keep the cache within its limit: after a verb that may have filled it."""
    evict(cache_home(), _limit_bytes())


def _limit_bytes() -> int:
    """Return the largest size of the cache in bytes: 2 GB, or the value of the environment.

    Raises `BadInput`: it says something else than a number of bytes.
    """
    text = os.environ.get(LIMIT, str(DEFAULT_BYTES))
    if not text.isdigit():
        raise BadInput.of(LIMIT, text, "a number of bytes", f"For example {DEFAULT_BYTES}.")
    return int(text)


def _print_removed(files: list[UsedFile], *, as_json: bool) -> None:
    if as_json:
        print_json({"removed_files": len(files), "removed_bytes": _bytes(files)})
    else:
        console().print(f"removed {len(files)} files, {_megabytes(files)} MB")


def _bytes(files: list[UsedFile]) -> int:
    return sum(file.size for file in files)


def _megabytes(files: list[UsedFile]) -> str:
    return engineering(_bytes(files) / 1e6, 4)
