"""Which tests a run has.

By default: all that are quick, those marked `law` that are not long, and of the others those that rest on
what changed since they last passed. A test rests on its file, on the fakes and scripts that file imports, on
the houses both import and those below, on what its file names in `RESTS_ON`, and on the versions of packages;
one that starts processes rests on all houses. Of a test with several cases on record a fifth runs by day,
with each version another, as of those marked `drawn`. Tests marked `chain` go on with what those before them
in their file left: they run all or none, by the cost of all. `tests/records` holds what each slow test costs
and what it rested on when it passed; the nightly run renews it. Files that are named on the command line run
whole, and with `--all` everything does.
"""

import ast
import csv
import hashlib
from collections import defaultdict
from collections.abc import Iterator, Sequence
from functools import cache
from itertools import accumulate
from pathlib import Path

import pytest
import structure
from drawn_cases import draw, turn

TESTS = Path(__file__).parents[1]
ROOT = TESTS.parent
RECORDS = TESTS / "records"
COSTS, PASSED = RECORDS / "cpu_seconds.csv", RECORDS / "passed.csv"
SLOW = 0.5
"""CPU seconds of a test from which on it is slow."""
LONG = 2.0
"""CPU seconds from which on a law, too, runs only when what it rests on changed; a fixture that costs as much
counts for each test of the file that shares it."""
BUDGET = 30.0
"""CPU seconds of slow tests of files that a run of the day takes because what they rest on changed."""
IMPORTED = (TESTS / "fakes", ROOT / "scripts")
"""Folders whose modules tests import by their names."""
VERSIONS = ROOT / "requirements-dev.lock"
STARTS_PROCESSES = ("subprocess", "multiprocessing")


def add_options(parser: pytest.Parser) -> None:
    parser.addoption("--all", action="store_true", help="slow tests too, whatever changed")
    parser.addoption(
        "--day", action="store_true", help="no slow tests but laws, whatever changed or is named"
    )
    parser.addoption("--house", help="tests of a house and of what stands on it: gearbox, dynamics ...")


def heed_named_files(config: pytest.Config) -> None:
    """Let what the command line names run whole; workers read the same command line."""
    if config.args_source is pytest.Config.ArgsSource.ARGS and not config.getoption("day"):
        config.option.all = True


def select(items: list[pytest.Item], config: pytest.Config) -> None:
    """Take from `items` what this run leaves to others."""
    kept = items
    if house := config.getoption("house"):
        above = houses_from(house)
        kept = [item for item in kept if above & rests_on(item.path)[1]]
    if not config.getoption("all"):
        kept = _of_the_day(kept, None if config.getoption("day") else read_passed())
    if len(kept) < len(items):
        staying = set(map(id, kept))
        config.hook.pytest_deselected(items=[item for item in items if id(item) not in staying])
        items[:] = kept


def _of_the_day(items: Sequence[pytest.Item], passed: dict[str, str] | None) -> list[pytest.Item]:
    """Return those that are quick, state a law, or rest on what changed; without `passed` nothing has."""
    costs = read_costs()
    own = {item.nodeid: costs.get(item.nodeid, 0.0) + _shared(item, costs) for item in items}
    chains = defaultdict[Path, float](float)
    for item in items:
        if item.get_closest_marker("chain"):
            chains[item.path] += own[item.nodeid]

    undrawn = _undrawn(items, own)

    def stays(item: pytest.Item) -> bool:
        cost = chains[item.path] if item.get_closest_marker("chain") else own[item.nodeid]
        if cost <= _limit(item) and item.nodeid not in undrawn:
            return True
        name = name_of(item.path)
        if passed is None or name in left_to_the_night():
            return False
        return passed.get(name) != digest(item.path)

    return [item for item in items if stays(item)]


def _limit(item: pytest.Item) -> float:
    """Return the CPU time (s) up to which a test runs whatever changed."""
    return LONG if item.get_closest_marker("law") else SLOW


def _undrawn(items: Sequence[pytest.Item], own: dict[str, float]) -> set[str]:
    """Return cases on record beyond a drawn fifth, of tests that have several and are slow by their sum."""
    tests = defaultdict[str, list[str]](list)
    for item in items:
        if own[item.nodeid] > 0.0 and own[item.nodeid] <= _limit(item) and not _chosen_otherwise(item):
            tests[item.nodeid.partition("[")[0]].append(item.nodeid)
    slow = [cases for cases in tests.values() if len(cases) > 1 and sum(own[case] for case in cases) > SLOW]
    return {case for cases in slow for case in set(cases) - draw(cases, turn())}


def _chosen_otherwise(item: pytest.Item) -> bool:
    return any(item.get_closest_marker(name) for name in ("chain", "drawn", "nightly"))


@cache
def left_to_the_night() -> frozenset[str]:
    """Return changed files of slow tests beyond `BUDGET`; those that cost least go first."""
    costs = defaultdict[str, float](float)
    for test, seconds in read_costs().items():
        costs[test.partition("::")[0]] += seconds if seconds > SLOW else 0.0
    changed = [name for name, was in read_passed().items() if _changed(name, was)]
    changed.sort(key=lambda name: (costs[name], name))
    spent = accumulate(costs[name] for name in changed)
    return frozenset(name for name, seconds in zip(changed, spent, strict=True) if seconds > BUDGET)


def _changed(name: str, rested_on: str) -> bool:
    return (ROOT / name).exists() and digest(ROOT / name) != rested_on


def _shared(item: pytest.Item, costs: dict[str, float]) -> float:
    """Return what the dear ones of the fixtures cost that a test shares with others of its file."""
    names = item.fixturenames
    file = item.nodeid.partition("::")[0]
    return sum(cost for name in names if (cost := costs.get(f"{file}::{name}", 0.0)) > LONG)


def houses_from(name: str) -> frozenset[str]:
    """Return a house and those above it; `name` is that of its folder."""
    for number, floor in enumerate(structure.FLOORS):
        for house in floor:
            if name in (house, house.removeprefix("lineofaction.")):
                return frozenset({house}.union(*structure.FLOORS[:number]))
    known = ", ".join(house.removeprefix("lineofaction.") for house in structure.HOUSES)
    raise pytest.UsageError(f"--house {name}: no house; there are {known}")


def name_of(file: Path) -> str:
    return file.relative_to(ROOT).as_posix()


def read_costs() -> dict[str, float]:
    """Return the CPU time (s) of each test, and of each fixture of a file, that has one on record."""
    return {test: float(seconds) for test, seconds in _rows(COSTS)}


def read_passed() -> dict[str, str]:
    """Return the digest of what each file of slow tests rested on when it passed."""
    return dict(_rows(PASSED))


def _rows(file: Path) -> list[tuple[str, str]]:
    if not file.exists():
        return []
    with file.open(encoding="utf-8", newline="") as stream:
        return [(name, value) for name, value in list(csv.reader(stream))[1:]]


@cache
def digest(file: Path) -> str:
    own, houses = rests_on(file)
    sums = hashlib.sha256(VERSIONS.read_bytes())
    for path in sorted({*own, *_named_in(file)}):
        sums.update(path.read_bytes() + b"\0")
    for house in sorted(houses):
        sums.update(_of_house(house))
    return sums.hexdigest()[:16]


@cache
def rests_on(file: Path) -> tuple[frozenset[Path], frozenset[str]]:
    """Return the files of the tests, and the houses that a test file rests on, those below included."""
    files, houses, waiting = set[Path](), set[str](), {file, *_conftests(file)}
    while waiting:
        path = waiting.pop()
        files.add(path)
        helpers, named = _imported(path)
        waiting |= helpers - files
        houses |= named
    return frozenset(files), frozenset(houses)


@cache
def _imported(path: Path) -> tuple[frozenset[Path], frozenset[str]]:
    """Return the fakes and scripts that a file imports, and the houses, those below included."""
    helpers, houses = set[Path](), set[str]()
    for module in structure.imported(path):
        name = module.removeprefix("tests.fakes.").split(".")[0]
        candidates = (folder / f"{name}.py" for folder in IMPORTED)
        if helper := next(filter(Path.exists, candidates), None):
            helpers.add(helper)
        elif house := structure.house_of(module):
            houses.update(_with_those_below(house))
        elif name in (*STARTS_PROCESSES, "lineofaction"):
            houses.update(structure.HOUSES)
    return frozenset(helpers), frozenset(houses)


@cache
def _with_those_below(house: str) -> frozenset[str]:
    """Return a house and all that it may import; references may import all, and rest on what they do."""
    if house not in structure.PRODUCT:
        below = (_with_those_below(other) for one, other in structure.arrows() if one == house)
        return frozenset({house}.union(*below))
    (level,) = (number for number, floor in enumerate(structure.FLOORS) if house in floor)
    return frozenset({house}.union(*structure.FLOORS[level + 1 :]))


def _named_in(file: Path) -> Iterator[Path]:
    """Yield the files that a test file names in `RESTS_ON`, and those in folders it names there."""
    text = file.read_text("utf-8")
    for statement in ast.parse(text).body if "RESTS_ON" in text else ():
        match statement:
            case ast.Assign(targets=[ast.Name("RESTS_ON")], value=value):
                for name in ast.literal_eval(value):
                    if not (ROOT / name).exists():
                        raise pytest.UsageError(f"{name_of(file)}: RESTS_ON names {name}, which is not there")
                    yield from _files_of(ROOT / name)


def _files_of(path: Path) -> list[Path]:
    """Return a file, or those in a folder without what Python compiled of them."""
    inner = (part for part in path.rglob("*") if part.is_file() and "__pycache__" not in part.parts)
    return [path] if path.is_file() else sorted(inner)


def _conftests(file: Path) -> Iterator[Path]:
    folder = file.parent
    while folder not in (TESTS, folder.parent):
        if (path := folder / "conftest.py").exists():
            yield path
        folder = folder.parent


@cache
def _of_house(house: str) -> bytes:
    sums = hashlib.sha256()
    for path in _files_of(ROOT / house.replace(".", "/")):
        sums.update(name_of(path).encode() + b"\0" + path.read_bytes() + b"\0")
    return sums.digest()
