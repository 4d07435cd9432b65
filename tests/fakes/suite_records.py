"""What each test costs in CPU time, and what it rested on when it passed: `pytest --all --record`.

Counted is the time of this process, of its children and of theirs, from set-up to tear-down. Set-up that
tests share (a fixture of a file or of the run) counts for none of them: it would only move to the next. That
of a file is on record by the fixture's own name. What tests share without a fixture the first of them pays: a
test that had it from another keeps half of what it cost before.

A run without `--all` renews what it runs: slow tests that it leaves out stay on record, and so does what
their file rested on when they passed.
"""

import csv
import time
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import psutil
import pytest
from suite_selection import COSTS, PASSED, ROOT, SLOW, digest, read_costs, read_passed

MIN = 0.3
"""Tests below this (s) are not on record: they are as good as free."""
_PROPERTY, _SHARED = "cpu_seconds", "shared_cpu_seconds"


class SuiteRecords:
    def __init__(self) -> None:
        self.shared = self.start = 0.0
        self.fixtures: dict[str, float] = {}
        self.seconds: dict[str, float] = {}
        self.failed: set[str] = set()

    @pytest.hookimpl(hookwrapper=True)
    def pytest_fixture_setup(
        self, fixturedef: pytest.FixtureDef[Any], request: pytest.FixtureRequest
    ) -> Iterator[None]:
        """Take what is shared apart."""
        start = _cpu_seconds()
        yield
        if fixturedef.scope != "function":
            seconds = _cpu_seconds() - start
            self.shared += seconds
            if fixturedef.scope == "module":
                self.fixtures[f"{_file(request.node.nodeid)}::{fixturedef.argname}"] = seconds

    @pytest.hookimpl(hookwrapper=True, tryfirst=True)
    def pytest_runtest_protocol(self) -> Iterator[None]:
        """Note the time at which a test begins."""
        self.shared, self.start = 0.0, _cpu_seconds()
        self.fixtures = {}
        yield

    @pytest.hookimpl(hookwrapper=True)
    def pytest_runtest_makereport(self, item: pytest.Item, call: pytest.CallInfo[None]) -> Iterator[None]:
        """Give the last report of a test its cost."""
        if call.when == "teardown":
            item.user_properties.append((_PROPERTY, _cpu_seconds() - self.start - self.shared))
            item.user_properties.append((_SHARED, self.fixtures))
        yield

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Keep what a worker measured, and which files have a test that failed."""
        if report.when == "teardown":
            told: dict[str, Any] = dict(report.user_properties)
            self.seconds[report.nodeid] = told[_PROPERTY]
            for fixture, seconds in told[_SHARED].items():  # the dearest of its values
                self.seconds[fixture] = max(seconds, self.seconds.get(fixture, 0.0))
        if report.failed:
            self.failed.add(_file(report.nodeid))

    def pytest_sessionfinish(self, session: pytest.Session) -> None:
        """Renew the records of what was run, where the run is led."""
        if hasattr(session.config, "workerinput") or not self.seconds:
            return
        ran = set(map(_file, self.seconds))
        gone = ran if session.config.getoption("all") else frozenset()  # else what did not run was left out
        before = read_costs()
        left = {t: s for t, s in before.items() if t not in self.seconds and _file(t) not in gone}
        now = {test: max(s, before.get(test, 0.0) / 2) for test, s in self.seconds.items()}
        costs = left | {test: s for test, s in now.items() if s >= MIN}
        _write(COSTS, ("test", "cpu_seconds"), ((test, f"{s:.1f}") for test, s in costs.items()))
        slow = {_file(test) for test, s in costs.items() if s > SLOW}
        whole = ran - {_file(test) for test, s in left.items() if s > SLOW}
        passed = read_passed() | {file: digest(ROOT / file) for file in whole & slow - self.failed}
        there = {file: sums for file, sums in passed.items() if file in slow and (ROOT / file).exists()}
        _write(PASSED, ("file", "rested_on"), there.items())


def _file(test: str) -> str:
    return test.partition("::")[0]


def _write(file: Path, head: tuple[str, str], rows: Iterable[tuple[str, str]]) -> None:
    file.parent.mkdir(exist_ok=True)
    with file.open("w", encoding="utf-8", newline="") as stream:
        csv.writer(stream, lineterminator="\n").writerows([head, *sorted(rows)])


def _cpu_seconds() -> float:
    """Return the CPU time (s) of this process and of all below it, those that ended included."""
    here = psutil.Process()
    own = here.cpu_times()
    total: float = time.process_time() + own.children_user + own.children_system
    for below in here.children(recursive=True):
        try:
            total += sum(below.cpu_times()[:4])
        except psutil.Error:  # ended since
            continue
    return total
