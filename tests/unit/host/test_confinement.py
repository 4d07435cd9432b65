"""A confined process keeps its own folder and Python's files, and nothing else a reader could be led to."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import pytest

from host import child_environment, missing_protections

pytestmark = pytest.mark.skipif(bool(missing_protections()), reason="this system does not confine processes")

TRIES: dict[str, str] = {
    "a file": "open({canary!r}).read()",
    "a link in its folder": "open('link').read()",
    "a hard way up": "open('../canary').read()",
    "its environment": "open('/proc/self/environ').read()",
    "another's environment": "open(f'/proc/{{os.getppid()}}/environ').read()",
    "a list of files": "os.listdir({outside!r})",
    "a file elsewhere": "open({outside!r} + '/made', 'w')",
    "a program": "os.execv('/bin/sh', ['sh', '-c', 'cat ' + {canary!r}])",
    "a connection": "socket.create_connection(('127.0.0.1', 9), timeout=1.0)",
    "a datagram": "socket.socket(socket.AF_INET, socket.SOCK_DGRAM)",
    "a socket of the system": "socket.socket(socket.AF_UNIX)",
    "a signal": "os.kill(os.getppid(), 0)",
}
"""What a reader may be led to, by an expression that does it."""
CHILD = """
import json, os, socket, sys
from pathlib import Path
from host import Limits, confine
tries, limits = json.load(sys.stdin)
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

    def run(tries: dict[str, str], **limits: int) -> Ended:
        places = {"canary": str(tmp_path / "canary"), "outside": str(tmp_path)}
        request = json.dumps([{name: text.format(**places) for name, text in tries.items()}, limits])
        environment = child_environment()
        with subprocess.Popen((sys.executable, "-c", CHILD), cwd=own, env=environment, **PIPES) as child:
            answer, complaint = child.communicate(request)
        return Ended(child.returncode, answer, complaint)

    return run


def outcomes(ended: Ended) -> dict[str, Any]:
    assert ended.returncode == 0, ended.stderr
    return dict(json.loads(ended.stdout))


def test_nothing_outside_is_reached(confined: Run) -> None:
    assert set(outcomes(confined(TRIES)).values()) == {"PermissionError"}


def test_its_own_folder_and_python_stay(confined: Run) -> None:
    own = {
        "writes": "open('made', 'w').write('x')",
        "reads": "open('made').read()",
        "imports": "__import__('scipy.linalg')",
        "imports ours": "__import__('lineofaction.gearbox.from_rexs.opened')",
        "pipes": "socket.socketpair()",
    }
    assert set(outcomes(confined(own)).values()) == {"done"}


def test_memory_and_sizes_of_files_end(confined: Run) -> None:
    tries = {"memory": "bytearray(200_000_000)", "file": "open('large', 'wb').write(bytes(2_000_000))"}
    ended = outcomes(confined(tries, memory_mb=150, file_bytes=1_000_000))
    assert ended == {"memory": "MemoryError", "file": "OSError"}


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
