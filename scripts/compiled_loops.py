"""Keep what numba has compiled from one run of the tests to the next, in other clones too.

Usage: compiled_loops.py restore | keep

numba takes a compiled function for current while the file of the function is as it was, whatever becomes of
what it calls. Here all compiled functions of a file are kept under a hash of the file, of all files of the
project that it imports, directly or not, and of the versions that compile. `restore` removes what stands in
the tree and brings what is kept of files as they are; `keep` keeps what the tree has afterwards, but for
files that changed in between.
"""

from __future__ import annotations

import fcntl
import hashlib
import json
import os
import shutil
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.metadata import version
from pathlib import Path

from structure import HOUSES, ROOT, imported

KEPT_S = 30 * 86400.0
"""Since its last use."""
KEYS = Path("out", "compiled_loops.json")


def store() -> Path:
    """Return the folder in which compiled functions are kept."""
    caches = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(os.environ.get("LOA_COMPILED_LOOPS") or Path(caches, "lineofaction-tests", "compiled-loops"))


def restore(root: Path = ROOT, kept: Path | None = None) -> int:
    """Bring what is kept of the files of a tree; returns of how many."""
    kept, count = kept or store(), 0
    now = keys(root)
    with _locked(kept):
        for source, key in now.items():
            for file in compiled(root / source):
                file.unlink(missing_ok=True)
            entry = kept / key
            if entry.is_dir():
                cached = (root / source).parent / "__pycache__"
                cached.mkdir(exist_ok=True)
                for file in entry.iterdir():
                    shutil.copy(file, cached)
                os.utime(entry)
                count += 1
    (root / KEYS).parent.mkdir(exist_ok=True)
    (root / KEYS).write_text(json.dumps(now), encoding="utf-8")
    return count


def keep(root: Path = ROOT, kept: Path | None = None) -> int:
    """Keep what a tree has of files that are as they were at `restore`; returns of how many it is new."""
    kept, count = kept or store(), 0
    before = json.loads((root / KEYS).read_text(encoding="utf-8"))
    with _locked(kept):
        for source, key in keys(root).items():
            files, entry = compiled(root / source), kept / key
            if files and before.get(source) == key and len(files) > _size(entry):
                draft = kept / f"{key}.draft"
                shutil.rmtree(draft, ignore_errors=True)
                draft.mkdir()
                for file in files:
                    shutil.copy(file, draft)
                shutil.rmtree(entry, ignore_errors=True)
                draft.rename(entry)
                count += 1
        _clean(kept)
    return count


def compiled(source: Path) -> list[Path]:
    """Return the files that numba keeps of a module, beside it."""
    return sorted(source.parent.glob(f"__pycache__/{source.stem}.*.nb[ic]"))


def keys(root: Path = ROOT) -> dict[str, str]:
    """Return the key of each file of the project that names numba or a compiler of the kernels."""
    files = [path for house in HOUSES for path in (root / house.replace(".", "/")).rglob("*.py")]
    naming = ("numba", "host.loops", "import compiled")
    looped = [path for path in files if any(name in _text(path) for name in naming)]
    return {path.relative_to(root).as_posix(): _key(path, root) for path in sorted(looped)}


def _text(path: Path) -> str:
    return path.read_text(encoding="utf-8")


def _key(source: Path, root: Path) -> str:
    """Return the hash of a file, of what it imports, and of what compiles it."""
    seen: set[Path] = set()
    waiting = [source]
    while waiting:
        path = waiting.pop()
        if path not in seen:
            seen.add(path)
            waiting.extend(file for name in imported(path) if (file := _file_of(name, root)) is not None)
    facts = [sys.version, *(version(name) for name in ("numba", "llvmlite", "numpy"))]
    sums = hashlib.sha256("\0".join(facts).encode())
    for path in sorted(seen):
        sums.update(f"\0{path.relative_to(root).as_posix()}\0{_text(path)}".encode())
    return sums.hexdigest()


def _file_of(name: str, root: Path) -> Path | None:
    """Return the file of a module, or of that which holds an imported name."""
    for module in (name, name.rpartition(".")[0]):
        place = root / module.replace(".", "/")
        for file in (place.with_suffix(".py"), place / "__init__.py"):
            if module and file.is_file():
                return file
    return None


def _size(entry: Path) -> int:
    return len(list(entry.iterdir())) if entry.is_dir() else 0


def _clean(kept: Path) -> None:
    """Remove what nobody has taken for long."""
    for entry in kept.iterdir():
        if entry.is_dir() and entry.stat().st_mtime < time.time() - KEPT_S:
            shutil.rmtree(entry, ignore_errors=True)


@contextmanager
def _locked(kept: Path) -> Iterator[None]:
    """Let one run at a time read or write the folder."""
    kept.mkdir(parents=True, exist_ok=True)
    with (kept / ".lock").open("wb") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield


if __name__ == "__main__":
    print({"restore": restore, "keep": keep}[sys.argv[1]](), "files of compiled loops")
