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

from host import child_environment, missing_protections

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
