"""What each test costs in CPU time, recorded: `pytest --record-cpu FILE`.

Counted is the time of this process, of its children and of theirs, from set-up to tear-down.
Set-up that tests share (a fixture of a file or of the run) counts for none of them: it would only move to the
next.
"""

from __future__ import annotations

import csv
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import psutil
import pytest

LEAST = 0.2
"""Tests below this (s) are not written: they are as good as free."""
_PROPERTY = "cpu_seconds"


class CpuRecorder:
    """Measures each test, in the worker that runs it, and writes the file where the run is led."""

    def __init__(self, file: Path) -> None:
        self.file = file
        self.shared = 0.0
        self.seconds: dict[str, float] = {}

    @pytest.hookimpl(hookwrapper=True)
    def pytest_fixture_setup(self, fixturedef: pytest.FixtureDef[Any]) -> Iterator[None]:
        """Take what is shared apart."""
        start = _cpu_seconds()
        yield
        if fixturedef.scope != "function":
            self.shared += _cpu_seconds() - start

    @pytest.hookimpl(hookwrapper=True, tryfirst=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Iterator[None]:
        """Note the time at which a test begins."""
        self.shared, self.start = 0.0, _cpu_seconds()
        yield

    @pytest.hookimpl(hookwrapper=True)
    def pytest_runtest_makereport(self, item: pytest.Item, call: pytest.CallInfo[None]) -> Iterator[None]:
        """Give the last report of a test its cost."""
        if call.when == "teardown":
            item.user_properties.append((_PROPERTY, _cpu_seconds() - self.start - self.shared))
        yield

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Keep what a worker measured."""
        if report.when == "teardown":
            self.seconds[report.nodeid] = float(dict(report.user_properties).get(_PROPERTY, 0.0))  # type: ignore[arg-type]

    def pytest_sessionfinish(self, session: pytest.Session) -> None:
        """Write the file, where the run is led."""
        if hasattr(session.config, "workerinput"):
            return
        with self.file.open("w", encoding="utf-8", newline="") as stream:
            rows = csv.writer(stream)
            rows.writerow(("test", "cpu_seconds"))
            rows.writerows((test, f"{s:.2f}") for test, s in sorted(self.seconds.items()) if s >= LEAST)


def _cpu_seconds() -> float:
    """Return the CPU time (s) of this process and of all below it, those that ended included."""
    here = psutil.Process()
    own = here.cpu_times()
    total = time.process_time() + own.children_user + own.children_system
    for below in here.children(recursive=True):
        try:
            total += sum(below.cpu_times()[:4])
        except psutil.Error:  # ended since
            continue
    return total
