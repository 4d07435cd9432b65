"""One warm process forks the workers of all services in a test process, from their first job on.

A service starts its first workers anew and a warm process beside the second; each imports and compiles all
that solves, which is most of what a small job costs. Bodies are condensed once in workers too. What a service
does by itself is in tests/unit/service/worker/test_warm_process.py and where services have processes of their
own.
"""

import os
import threading
from collections.abc import Iterator
from pathlib import Path

import pytest
from condensed_once import FOLDER
from running_service import until
from service_surroundings import FAKES

from host.children.launcher import ChildProcess, Ends, Launcher, WarmProcess

_ANALYSIS = "service.worker.simulation_work"


class _WarmProcesses:
    """The warm processes by what they have imported."""

    def __init__(self, log: Path) -> None:
        self._log = log
        self._found: dict[tuple[str, ...], WarmProcess] = {}
        self._starts = threading.Lock()

    def launch(self, launcher: Launcher, ends: Ends) -> ChildProcess:
        key = (launcher._work, *launcher._modules)
        with self._starts:
            server = self._found.get(key)
            if server is None or not server.usable:
                log = self._log / f"warm{len(self._found)}.log"
                first = ["condensed_once"] if _ANALYSIS in launcher._modules else []
                server = self._found[key] = WarmProcess(
                    launcher._work, [*first, *launcher._modules], log, launcher._warn
                )
        until(lambda: server.ready)
        return server.fork(ends)

    def close(self) -> None:
        for server in self._found.values():
            server.close()


@pytest.fixture(scope="session")
def warm_processes(tmp_path_factory: pytest.TempPathFactory) -> Iterator[_WarmProcesses]:
    made = _WarmProcesses(tmp_path_factory.mktemp("warm"))
    yield made
    made.close()


@pytest.fixture(scope="module", autouse=True)
def warm_once(warm_processes: _WarmProcesses, condensed_bodies: Path) -> Iterator[None]:
    def launch(launcher: Launcher, ends: Ends, _warm_within: float = 0.0) -> ChildProcess:
        return warm_processes.launch(launcher, ends)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Launcher, "launch", launch)
        patch.setenv("PYTHONPATH", os.pathsep.join([FAKES, os.environ.get("PYTHONPATH", "")]))
        patch.setenv(FOLDER, str(condensed_bodies))
        yield
