"""Keys of source files: hashes of a file and of all files of the project that it imports, directly or not.

Compiled code contains the functions that its loop calls, so it is current while none of these files has
changed. To read the 450 files of both libraries takes 0.1 s. A manifest beside the compiled code stores their
keys with the state of each source file (times of change, size and inode). While all states are the same, the
keys are valid.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
from collections.abc import Iterator
from contextlib import suppress
from functools import cache
from pathlib import Path

from host.directories import atomic_file

PROJECT = Path(__file__).resolve().parents[1]
"""The folder of the packages, in a clone as installed."""
PACKAGES = frozenset({"host", "bounds", "model_studies", "fe_contact", "dynamics", "lineofaction", "service"})

_IMPORT = re.compile(
    r"""^[ \t]*(?:
        from[ \t]+(?P<module>[\w.]+)[ \t]+import[ \t]*
            (?P<names>\((?:[^)\#]|\#[^\n]*)*\)|(?:\\\n|[^\n\#])*)
        |import[ \t]+(?P<modules>(?:\\\n|[^\n\#])+)
    )""",
    re.MULTILINE | re.VERBOSE,
)
"""Import statements at the start of a line. A line of a text that looks like one counts too; it can only add
a file to a key.
"""

State = tuple[int, int, int, int]
"""State of a file: times of change of content and of entry, size, inode."""


class Sources:
    """Files below a folder in the state of their first reading, and the files of this project.

    Parameters
    ----------
    root : Path
        Folder of packages, of this project or of an installation.
    packages : frozenset of str, optional
        Names of the packages in `root` whose files count; None: all.
    """

    def __init__(self, root: Path = PROJECT, packages: frozenset[str] | None = None) -> None:
        self._root = root
        self._packages = packages
        self._roots: dict[str, Path | None] = {}  # folder by package
        self._states: dict[str, State | None] = {}  # by the path of a file or folder
        self._hashes: dict[str, str] = {}  # of the content, by file
        self._imports: dict[str, frozenset[str]] = {}  # imported files by file
        self._keys: dict[str, str] = {}  # by file
        self._files: dict[str, tuple[str, ...]] = {}  # by module

    def key(self, file: Path, manifest: Path | None = None) -> str:
        """Return the key of a file.

        The keys of all files of its package are read from `manifest`, or computed and written there.
        """
        name = file.relative_to(self._root).as_posix()
        if manifest and name not in self._keys:
            self._read(manifest)
        if name not in self._keys:
            if manifest:
                package = self._root / Path(name).parts[0]
                self._hash_all(path.relative_to(self._root).as_posix() for path in package.rglob("*.py"))
                self._write(manifest)
            self._hash_all([name])
        return self._keys[name]

    def unchanged(self) -> bool:
        """Whether all files are in the state of their first reading."""
        files = (entry for entry in self._states.items() if entry[0].endswith(".py"))
        return all(_state(path) == state for path, state in files)

    def files(self, name: str) -> frozenset[str]:
        """Return a file and all that it imports, directly or not, as paths below their folder."""
        files, waiting = {name}, [name]
        while waiting:
            imports = self._imported(waiting.pop()) - files
            files |= imports
            waiting.extend(imports)
        return frozenset(files)

    def _hash_all(self, names: Iterator[str] | list[str]) -> None:
        for name in names:
            if name not in self._keys:
                parts = (f"{part}\0{self._hashes[part]}" for part in sorted(self.files(name)))
                self._keys[name] = hashlib.sha256("\0".join(parts).encode()).hexdigest()

    def _imported(self, name: str) -> frozenset[str]:
        if name not in self._imports:
            path = f"{self._root_of(name.partition('/')[0].removesuffix('.py'))}/{name}"
            folder = path.rpartition("/")[0]  # its state changes with the list of its files
            for watched in (path, folder):
                self._states.setdefault(watched, _state(watched))
            content = Path(path).read_bytes()
            self._hashes[name] = hashlib.sha256(content).hexdigest()
            modules = _imported_names(content.decode("utf-8", "replace"), name)
            self._imports[name] = frozenset(file for module in modules for file in self._files_of(module))
        return self._imports[name]

    def _files_of(self, module: str) -> tuple[str, ...]:
        """Return the files of a module or of the parent of an imported name; none of other projects."""
        if module not in self._files:
            root, path = self._root_of(module.partition(".")[0]), module.replace(".", "/")
            candidates = (f"{path}.py", f"{path}/__init__.py") if root else ()
            files = tuple(file for file in candidates if root and (root / file).is_file())
            parent = module.rpartition(".")[0]
            self._files[module] = files or (self._files_of(parent) if parent else ())
        return self._files[module]

    def _root_of(self, package: str) -> Path | None:
        """Return the folder that has a package or a module, None for those of other projects."""
        if package not in self._roots:
            is_below = (self._root / package).is_dir() or (self._root / f"{package}.py").is_file()
            if is_below and (self._packages is None or package in self._packages):
                self._roots[package] = self._root
            else:
                self._roots[package] = PROJECT if package in PACKAGES else None
        return self._roots[package]

    def _read(self, manifest: Path) -> None:
        """Read the keys of a manifest if all of its files are in the recorded state."""
        try:
            content = json.loads(manifest.read_bytes())
            states: dict[str, State | None] = {path: tuple(s) for path, s in content["states"].items()}
            keys = dict(content["keys"])
        except (OSError, ValueError, TypeError, KeyError, AttributeError):
            return
        if any(_state(path) != state for path, state in states.items()):
            return
        self._states = states | self._states
        self._keys = keys | self._keys

    def _write(self, manifest: Path) -> None:
        content = {"states": self._states, "keys": self._keys}
        with suppress(OSError):
            manifest.parent.mkdir(parents=True, exist_ok=True)
            with atomic_file(manifest) as draft:
                draft.write_text(json.dumps(content), encoding="utf-8")


def _imported_names(code: str, file: str) -> Iterator[str]:
    """Yield the full names of modules and of their members that a file imports, also inside functions."""
    for statement in _IMPORT.finditer(code):
        if modules := statement["modules"]:
            yield from (part.split()[0] for part in modules.replace("\\\n", " ").split(",") if part.split())
            continue
        module = _absolute(statement["module"], file)
        lines = (line.partition("#")[0] for line in statement["names"].split("\n"))
        names = " ".join(lines).strip(" ()\\").replace("\\", " ").split(",")
        yield module
        yield from (f"{module}.{name.split()[0]}" for name in names if name.split())


def _absolute(module: str, file: str) -> str:
    """Return the full name of a module; leading dots count from the package of the file that imports it."""
    name = module.lstrip(".")
    dots = len(module) - len(name)
    if not dots:
        return name
    package = file.split("/")[:-dots]
    return ".".join([*package, name] if name else package)


def _state(path: str) -> State | None:
    """Return a state that changes with a file or with the list of files of a folder; None without it."""
    try:
        status = os.stat(path)  # noqa: PTH116 - called for each file of the project
    except OSError:
        return None
    return status.st_mtime_ns, status.st_ctime_ns, status.st_size, status.st_ino


@cache
def sources(root: Path, package: str) -> Sources:
    """Return the files that loops of a package in a folder may import, in their state at the first call.

    Of an installation, only the package itself counts, or all packages of this project. Equal arguments of
    the caches below give one object, so that files are read once.
    """
    if root.name not in {"site-packages", "dist-packages"}:
        return _of_folder(root)
    return _of_installation(
        root, PACKAGES if root == PROJECT and package in PACKAGES else frozenset({package})
    )


_of_folder = cache(Sources)
_of_installation = cache(Sources)
