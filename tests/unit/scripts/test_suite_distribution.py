"""Workers share a run out by files; by day all files of the browser go to one."""

from types import SimpleNamespace
from typing import Any

import pytest
from suite_distribution import OneBrowserScheduling, scheduler
from xdist.remote import Producer

PAGES = [f"tests/browser/test_page_{page}.py::test_{law}" for page in ("flanks", "typing") for law in "ab"]
OTHERS = [
    "tests/api/test_traces.py::test_a",
    "tests/api/test_oidc.py::test_a",
    "tests/api/test_oidc.py::test_b",
]


def _config(*, night: bool, dist: str = "loadfile") -> Any:
    options = {"all": night, "dist": dist, "tx": ["popen"] * 3, "maxschedchunk": None, "verbose": 0}
    return SimpleNamespace(
        getoption=options.get, getvalue=options.get, option=SimpleNamespace(loadscopereorder=False)
    )


class _Worker:
    """Takes the tests that it is sent."""

    def __init__(self) -> None:
        self.gateway = SimpleNamespace(id=f"gw{id(self)}")
        self.workerinput: dict[str, Any] = {}
        self.shutting_down = False
        self.tests: list[int] = []

    def send_runtest_some(self, tests: list[int]) -> None:
        self.tests += tests

    def shutdown(self) -> None:
        self.shutting_down = True


def test_by_day_one_worker_opens_pages():
    collected = [OTHERS[0], *PAGES, *OTHERS[1:]]
    chosen = scheduler(_config(night=False), Producer("test", enabled=False))
    assert isinstance(chosen, OneBrowserScheduling)
    workers: list[Any] = [_Worker() for _ in range(3)]
    for worker in workers:
        chosen.add_node(worker)
        chosen.add_node_collection(worker, collected)
    chosen.schedule()
    sent = [{collected[test].partition("::")[0] for test in worker.tests} for worker in workers]
    assert {"tests/browser/test_page_flanks.py", "tests/browser/test_page_typing.py"} in sent
    assert sum(any("browser" in file for file in files) for files in sent) == 1
    assert sorted(test for worker in workers for test in worker.tests) == list(range(len(collected)))


@pytest.mark.parametrize("options", [{"night": True}, {"night": False, "dist": "load"}])
def test_at_night_and_by_another_rule_the_command_line_decides(options):
    assert scheduler(_config(**options), Producer("test", enabled=False)) is None
