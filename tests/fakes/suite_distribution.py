"""How workers share a run out: by files, and those of the browser as one by day.

The first test of a worker that opens a page starts a service, has it analyze a pair, and starts Chromium. By
day that is half of what the tests of the browser take; at night they take long enough for all workers.
"""

import pytest
from xdist.remote import Producer
from xdist.scheduler import LoadFileScheduling

BROWSER = "tests/browser/"


class OneBrowserScheduling(LoadFileScheduling):
    """Files stay with one worker, and all files of the browser with the same one."""

    def _split_scope(self, nodeid: str) -> str:
        return scope_of(nodeid)


def scope_of(nodeid: str) -> str:
    """Return the name of the part of the run that a test goes with."""
    return BROWSER if nodeid.startswith(BROWSER) else nodeid.partition("::")[0]


def scheduler(config: pytest.Config, log: Producer) -> LoadFileScheduling | None:
    """Return the scheduler of a run by day; None leaves the choice to the command line."""
    if config.getoption("all") or config.getvalue("dist") != "loadfile":
        return None
    return OneBrowserScheduling(config, log)
