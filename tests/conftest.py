"""What all tests share: bodies condensed once, and the recorder of figures for the page of validation."""

import gc
import json
import os
import re
import signal
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from coarse_sectors import coarse_sectors
from condensed_once import condensed_bodies, condensed_once
from drawn_cases import leave_to_the_night
from hypothesis import settings
from quick_tests import is_quick
from suite_records import SuiteRecords
from suite_selection import add_options, heed_named_files, left_to_the_night, select

TESTS = Path(__file__).parent
FIGURES = TESTS.parent / "out" / "validation"
SERVICES = ("flow", "browser", "api")
"""In this order: a file stays with one worker, so those that take longest do not come last."""

RecordFigure = Callable[..., None]

os.environ.pop("COLUMNS", None)  # workers of tests have it; a terminal that is piped has not
gc.disable()  # until all is collected: next to nothing of that is garbage

__all__ = ["coarse_sectors", "condensed_bodies", "condensed_once"]

# The same examples on every machine with every change; random ones, and more of them, at night.
settings.register_profile("suite", deadline=None, derandomize=True, max_examples=12)
settings.register_profile("nightly", deadline=None, max_examples=160)
settings.load_profile("suite")


def pytest_configure(config: pytest.Config) -> None:
    """Share what is compiled, record costs, and heed interrupts again, which may have been ignored for good.

    A shell ignores them for what it starts with ``&``, and all its children inherit it; tests that interrupt
    a program would wait for ever.
    """
    heed_named_files(config)
    if config.getoption("record"):
        if config.getoption("keyword") or config.getoption("markexpr") not in ("", "not nightly"):
            raise pytest.UsageError("--record renews whole files: without -k, and no -m but -m ''")
        config.pluginmanager.register(SuiteRecords())
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)


def pytest_addoption(parser: pytest.Parser) -> None:
    """Let the command line choose."""
    what = "tests whose file imports nothing that meshes, marches in time, draws or serves"
    parser.addoption("--quick", action="store_true", help=what)
    parser.addoption("--record", action="store_true", help="renew tests/records by this run")
    add_options(parser)


def pytest_report_header(config: pytest.Config) -> list[str]:
    """Name the changed files of slow tests that are left to the night."""
    if config.getoption("all") or config.getoption("day"):
        return []
    return [
        f"left to the night, beyond the budget of the day: {name}" for name in sorted(left_to_the_night())
    ]


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Let whole services come last: what all their processes need is compiled by then, once."""
    if not config.getoption("all"):
        leave_to_the_night(items)
    if config.getoption("quick"):
        config.hook.pytest_deselected(items=[item for item in items if not is_quick(item)])
        items[:] = filter(is_quick, items)
    select(items, config)
    items.sort(key=_turn)


def _turn(item: pytest.Item) -> int:
    """Return the place of a test's folder: 0 without services."""
    folder = item.path.relative_to(TESTS).parts[0]
    return SERVICES.index(folder) + 1 if folder in SERVICES else 0


@pytest.hookimpl(optionalhook=True)  # there is none where a run has one process
def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> Any:
    """Share the files out over workers."""
    from suite_distribution import scheduler  # noqa: PLC0415 (needs xdist)

    return scheduler(config, log)


def pytest_collection_finish() -> None:
    """Spare the collector of garbage what lives as long as the tests: modules, and the tests themselves."""
    gc.freeze()
    gc.enable()


@pytest.fixture
def record_figure(request):
    """Return `record_figure(name, value, target, unit, source)`, which keeps one measured figure.

    `name` says what was measured, `value` is the number, `target` the criterion in words or a number
    ("at most 0.3 %", 755.9), `unit` the unit of `value`, `source` where the target comes from. Each figure
    becomes one JSON file in out/validation; `scripts/validation-page` makes a page of them.
    The fixture records and asserts nothing: the test does.
    """

    def record(name, value, target, unit, source):
        test = request.node.nodeid
        kind = Path(str(request.node.path)).relative_to(TESTS).parts[0]
        figure = {
            "name": name,
            "value": float(value),
            "target": target,
            "unit": unit,
            "source": source,
            "kind": kind,
            "test": test,
        }
        FIGURES.mkdir(parents=True, exist_ok=True)
        slug = re.sub(r"[^a-z0-9]+", "-", f"{request.node.path.stem} {name}".lower()).strip("-")
        draft = FIGURES / f".{slug}.{os.getpid()}"
        draft.write_text(json.dumps(figure, indent=1), encoding="utf-8")
        draft.replace(FIGURES / f"{slug}.json")

    return record
