"""Instruments: what answers one kind of question on top of the core, and the command that takes one out.

`instruments.toml` lists each instrument with its paths. What names one from outside are rows: of the registry
of studies, of the families of verbs, of the page's scripts, and names that an `__init__` offers.
`retire` removes paths and rows, the tests that import what went, and links to pages that went.
"""

from __future__ import annotations

import ast
import shutil
import tomllib
from collections import defaultdict
from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import structure
from links import without_pages, without_scripts

ROOT = structure.ROOT
TABLE = Path(__file__).with_name("instruments.toml")
DOCS = "docs"
PAGE = "service/page/static"
"""Folder of the page's scripts."""
REGISTRY = "lineofaction.gearbox.registry"
REGISTRIES = (
    REGISTRY,
    "lineofaction.gearbox.computations",
    "lineofaction.cli.commands",
    "service.routes.offers",
)
"""Modules of rows: studies, their computations, families of verbs, routes that compute nothing."""
ROWS = "Studies"
"""Class of the registry whose attributes are the rows."""


@dataclass(frozen=True)
class Instrument:
    """A row of the table."""

    name: str
    paths: tuple[str, ...]
    """Folders and files of the tree, product and tests, relative to its root."""
    under: tuple[str, ...] = ()
    """Instruments that stand on this one and are retired before it."""
    pages: tuple[str, ...] = ()
    """Pages of the manual that nobody can follow without it, relative to `docs`; one may be of several."""

    def files(self, tree: Path = ROOT) -> Iterator[Path]:
        """Yield the files of a tree that belong to it."""
        for path in self.paths:
            whole = tree / path
            yield from (whole,) if whole.is_file() else (file for file in whole.rglob("*") if file.is_file())


@cache
def instruments() -> Mapping[str, Instrument]:
    """Read the table."""
    rows = tomllib.loads(TABLE.read_text("utf-8"))
    return {
        name: Instrument(name, *(tuple(row.get(key, ())) for key in ("paths", "under", "pages")))
        for name, row in rows.items()
    }


def with_dependents(names: Iterable[str]) -> list[str]:
    """Return instruments and those that depend on them, dependents first."""
    order: list[str] = []
    for name in names:
        for one in (*with_dependents(instruments()[name].under), name):
            if one not in order:
                order.append(one)
    return order


# modules and imports of a tree


@dataclass(frozen=True)
class Modules:
    """Python modules of a tree and their imports."""

    files: Mapping[str, Path]
    """File by module name; tests, benchmarks and scripts under their paths, which nobody imports by name."""
    imports: Mapping[str, Collection[str]]
    """Modules of the tree by importer; a name that a package offers counts as an import of its home."""

    def importers(self) -> Mapping[str, Collection[str]]:
        """Return who imports a module, by module."""
        found: dict[str, set[str]] = defaultdict(set)
        for importer, names in self.imports.items():
            for name in names:
                found[name].add(importer)
        return found

    def within(self, instrument: Instrument) -> set[str]:
        """Return the modules of an instrument."""
        files = set(instrument.files())
        return {name for name, file in self.files.items() if file in files}


@cache
def modules() -> Modules:
    """Look through the tree once."""
    files = {_name(file): file for folder in _folders() for file in sorted(folder.rglob("*.py"))}
    packages = {name: file for name, file in files.items() if file.name == "__init__.py"}
    offers = {
        name: {whole.rpartition(".")[2]: whole for whole in structure.imported(file)}
        for name, file in packages.items()
    }
    imports = {
        name: {home for whole in structure.imported(file) if (home := _home(whole, files, offers))} - {name}
        for name, file in files.items()
    }
    return Modules(files, imports)


def _folders() -> Iterator[Path]:
    houses = {house.partition(".")[0] for house in structure.HOUSES}
    yield from (ROOT / name for name in (*sorted(houses), "tests", "benchmarks", "examples", "scripts"))


def _name(file: Path) -> str:
    return ".".join(file.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")


def _home(whole: str, files: Mapping[str, Path], offers: Mapping[str, Mapping[str, str]]) -> str | None:
    """Return the module that defines an imported name; None of foreign ones."""
    package, _, name = whole.rpartition(".")
    if whole in files or not package:
        return whole if whole in files else None
    offered = offers.get(package, {}).get(name)
    if offered and offered != whole:
        return _home(offered, files, offers)
    return package if package in files else None


def is_product(module: str) -> bool:
    """Whether a module is part of the product, and not of references, tests or benchmarks."""
    return module.partition(".")[0] in {house.partition(".")[0] for house in structure.PRODUCT}


def is_row(module: str) -> bool:
    """Whether imports of a module are rows, which `retire` removes: the registries and `__init__` files."""
    package = modules().files[module].name == "__init__.py" and is_product(module) and "." in module
    return package or module in REGISTRIES or module in structure.HOUSES


# taking an instrument out of a tree


def retire(names: Iterable[str], tree: Path) -> list[str]:
    """Remove instruments from a tree, with their dependents and the tests that import them.

    Returns the names of the instruments, in order.
    """
    gone = with_dependents(names)
    inside = {module for name in gone for module in modules().within(instruments()[name])}
    importers = {one for module in inside for one in modules().importers().get(module, ())}
    for name in gone:
        for path in _paths(name):
            _remove(tree / path)
    for module in importers - inside:
        file = tree / modules().files[module].relative_to(ROOT)
        if is_row(module):
            _without_rows(file, module, inside)
        elif not is_product(module):
            _remove(file)
    _without_studies(tree / modules().files[REGISTRY].relative_to(ROOT), gone)
    without_scripts(tree / PAGE, {Path(path).name for name in gone for path in _paths(name)})
    without_pages(tree, {tree / path for name in gone for path in _paths(name)})
    return gone


def _paths(name: str) -> tuple[str, ...]:
    """Return the paths of an instrument with its pages of the manual."""
    row = instruments()[name]
    return (*row.paths, *(f"{DOCS}/{page}" for page in row.pages))


def lines_of(name: str) -> tuple[int, int]:
    """Return the lines of an instrument: of the product, and of tests and benchmarks that go with it."""
    inside = modules().within(instruments()[name])
    importers = {one for module in inside for one in modules().importers().get(module, ())}
    product, others = (
        sum(modules().files[module].read_bytes().count(b"\n") for module in names)
        for names in (inside, {module for module in importers if not is_product(module)})
    )
    return product, others


def _remove(path: Path) -> None:
    if path.is_dir():
        shutil.rmtree(path)
    else:
        path.unlink(missing_ok=True)


def _without_rows(file: Path, module: str, inside: Collection[str]) -> None:
    """Remove the names of modules `inside` from a file of rows: their imports, and lines that name them."""
    code = file.read_text("utf-8")
    lines = code.split("\n")
    names: set[str] = set()
    for node in ast.walk(ast.parse(code)):
        if isinstance(node, ast.ImportFrom) and node.module:
            gone = [alias for alias in node.names if _is_of(node.module, alias.name, inside)]
            names |= {alias.asname or alias.name for alias in gone}
            names |= {node.module, node.module.removeprefix(f"{module}.")} if gone else set()
            _without_aliases(lines, node, gone)
    row = tuple(f'"{name}"' for name in names)
    single = {f"{name}{part}," for name in names for part in ("", ".router")}
    rest = (line for line in lines if not (line.strip().startswith(row) or line.strip() in single))
    file.write_text("\n".join(line for line in rest if line != DROPPED), "utf-8")


DROPPED = "# dropped"
"""Line in place of one that goes: line numbers of the others stay."""


def _is_of(package: str, name: str, inside: Collection[str]) -> bool:
    return package in inside or f"{package}.{name}" in inside


def _without_aliases(lines: list[str], node: ast.ImportFrom, gone: Collection[ast.alias]) -> None:
    """Replace an import by one without some of its names, in the lines that it takes."""
    if not gone:
        return
    left = [alias for alias in node.names if alias not in gone]
    last = node.end_lineno or node.lineno
    text = [ast.unparse(ast.ImportFrom(node.module, left, 0))] if left else []
    text = [" " * node.col_offset + line for line in text]
    lines[node.lineno - 1 : last] = text + [DROPPED] * (last - node.lineno + 1 - len(text))


def _without_studies(registry: Path, names: Collection[str]) -> None:
    """Remove the rows of studies, and their names, from the registry."""
    code = registry.read_text("utf-8")
    body = ast.parse(code).body
    rows = next(node for node in body if isinstance(node, ast.ClassDef) and node.name == ROWS)
    doomed: set[int] = set()
    for node in (*rows.body, *body):  # the row, and the study as a function
        target = node.targets[0] if isinstance(node, ast.Assign) else None
        if isinstance(target, ast.Name) and target.id in names:
            doomed |= set(range(node.lineno - 1, node.end_lineno or node.lineno))
    quoted = {f'"{name}",' for name in names}
    lines = enumerate(code.split("\n"))
    rest = [line for number, line in lines if number not in doomed and line.strip() not in quoted]
    registry.write_text("\n".join(rest), "utf-8")
