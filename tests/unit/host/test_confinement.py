"""A confined process keeps its own folder and Python's files, and nothing else a reader could be led to."""

from __future__ import annotations

import json
import platform
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import pytest
from escapes import BY_32_BITS, FILES, PRELUDE, PROCESSES, SYSTEM
from running_service import lives, until

from host import ChildFailed, Limits, ask_child, child_environment, missing_protections

pytestmark = pytest.mark.skipif(bool(missing_protections()), reason="this system does not confine processes")

CHILD = """
import json, sys
from pathlib import Path
from host import Limits, confine
tries, limits, prelude = json.load(sys.stdin)
exec(prelude)
confine(Path.cwd(), Limits(**limits))
def outcome(text):
    try:
        eval(text)
        return "done"
    except MemoryError:
        return "MemoryError"
    except OSError as error:
        return type(error).__name__
print(json.dumps({name: outcome(text) for name, text in tries.items()}))
"""
PIPES: Any = dict.fromkeys(("stdin", "stdout", "stderr"), subprocess.PIPE) | {"text": True}


class Ended(NamedTuple):
    """How a child ended."""

    returncode: int
    stdout: str
    stderr: str


Run = Callable[..., Ended]


@pytest.fixture
def confined(tmp_path: Path) -> Run:
    """Run expressions in a confined child and return how it ended."""
    (tmp_path / "canary").write_text("canary")
    own = tmp_path / "own"
    own.mkdir()
    (own / "link").symlink_to(tmp_path / "canary")
    (own / "own").touch()

    def run(tries: dict[str, str], **limits: int) -> Ended:
        places = {"canary": str(tmp_path / "canary"), "outside": str(tmp_path)}
        expressions = {name: text.format(**places) for name, text in tries.items()}
        request = json.dumps([expressions, limits, PRELUDE])
        environment = child_environment()
        with subprocess.Popen((sys.executable, "-c", CHILD), cwd=own, env=environment, **PIPES) as child:
            answer, complaint = child.communicate(request)
        return Ended(child.returncode, answer, complaint)

    return run


def outcomes(ended: Ended) -> dict[str, Any]:
    assert ended.returncode == 0, ended.stderr
    return dict(json.loads(ended.stdout))


@pytest.mark.parametrize("escapes", [FILES, PROCESSES, SYSTEM], ids=["files", "processes", "system"])
def test_every_escape_is_refused(confined: Run, escapes: dict[str, str], tmp_path: Path) -> None:
    refusals = outcomes(confined(escapes))
    assert {name: outcome for name, outcome in refusals.items() if outcome != "PermissionError"} == {}
    assert len(refusals) == len(escapes)
    assert sorted(path.name for path in (tmp_path / "own").iterdir()) == ["link", "own"]


def test_there_are_forty_escapes() -> None:
    assert len(FILES) + len(PROCESSES) + len(SYSTEM) >= 40


@pytest.mark.skipif(platform.machine() != "x86_64", reason="a table of that processor")
def test_calls_of_32_bits_are_refused(confined: Run) -> None:
    ended = confined({"call": BY_32_BITS})
    assert ended.returncode == -signal.SIGSEGV or outcomes(ended) == {"call": "PermissionError"}


def test_a_process_with_other_threads_is_not_confined() -> None:
    """They would keep what the thread gives up that confines itself."""
    wait = "threading.Thread(target=threading.Event().wait, daemon=True).start()"
    code = f"import threading, pathlib, host; {wait}; host.confine(pathlib.Path.cwd())"
    done = subprocess.run(
        [sys.executable, "-c", code], env=child_environment(), capture_output=True, text=True, check=False
    )
    assert done.returncode == 1
    assert "1 other threads of this process would not be confined" in done.stderr


def test_its_own_folder_and_python_stay(confined: Run) -> None:
    own = {
        "writes": "open('made', 'w').write('x')",
        "reads": "open('made').read()",
        "imports": "__import__('scipy.linalg')",
        "imports ours": "__import__('lineofaction.gearbox.from_rexs.opened')",
        "reads its limits": "resource.prlimit(0, resource.RLIMIT_STACK)",
        "removes": "os.unlink('made')",
    }
    assert set(outcomes(confined(own)).values()) == {"done"}


def test_memory_and_sizes_of_files_end(confined: Run) -> None:
    tries = {"memory": "bytearray(200_000_000)", "file": "open('large', 'wb').write(bytes(2_000_000))"}
    ended = outcomes(confined(tries, memory_mb=150, file_bytes=1_000_000))
    assert ended == {"memory": "MemoryError", "file": "OSError"}


STARTER = """
import subprocess, sys, time
child = subprocess.Popen([sys.executable, "-c", sys.argv[1]])
print(child.pid, flush=True)
time.sleep(60.0)
"""
SLEEPER = """
import pathlib, signal, time, host
signal.signal(signal.SIGALRM, signal.SIG_IGN)
host.confine(pathlib.Path.cwd())
open("confined", "w").close()
time.sleep(1000.0)
"""


def test_it_ends_with_whoever_started_it(tmp_path: Path) -> None:
    command = (sys.executable, "-c", STARTER, SLEEPER)
    with subprocess.Popen(command, cwd=tmp_path, env=child_environment(), **PIPES) as starter:
        pid = int(starter.stdout.readline())
        until((tmp_path / "confined").exists)
        assert lives(pid)
        starter.kill()
    until(lambda: not lives(pid))


WRITES = {
    "bytes": ("open('a', 'wb').write(bytes(100_000)); os.unlink('a')", "more than 1 MB written"),
    "files": ("k += 1; open(str(k), 'w').close()", "more than 8 files written"),
}
ENDLESS = """
import os, pathlib, host
host.confine(pathlib.Path.cwd())
k = 0
while True:
    {}
"""


@pytest.mark.parametrize(("statement", "cause"), WRITES.values(), ids=WRITES)
def test_whoever_asks_ends_it_beyond_what_it_may_write(tmp_path: Path, statement: str, cause: str) -> None:
    """Each file is within its limit; of those that it removes none is left to be counted."""
    limits = Limits(written_bytes=1_000_000, files=8)
    with pytest.raises(ChildFailed, match=cause):
        ask_child({}, 60.0, (sys.executable, "-c", ENDLESS.format(statement)), tmp_path, limits)


@pytest.mark.law
def test_cpu_time_ends_the_process_and_says_so(confined: Run) -> None:
    assert confined({"loop": "[0 for _ in iter(int, 1)]"}, cpu_seconds=1).returncode == -24  # SIGXCPU


def test_a_child_inherits_no_secret(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("AWS_SECRET_ACCESS_KEY", "LOA_WEBHOOK_SECRET", "DATABASE_URL", "GITHUB_TOKEN"):
        monkeypatch.setenv(name, "canary")
    monkeypatch.setenv("NUMBA_DEBUG_CACHE", "0")
    environment = child_environment(EXTRA="1")
    assert "canary" not in environment.values()
    assert environment["NUMBA_DEBUG_CACHE"] == "0" and environment["EXTRA"] == "1"
