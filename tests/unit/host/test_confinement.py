"""A confined process keeps its own folder and Python's files, and nothing else a reader could be led to."""

import json
import platform
import signal
import subprocess
import sys
from collections.abc import Callable
from typing import Any, NamedTuple

import pytest
from running_service import lives, until

from host import ChildFailed, Limits, ask_child, child_environment, missing_protections

PRELUDE = """
import ctypes, fcntl, mmap, os, platform, resource, signal, socket, sys, termios, threading
libc = ctypes.CDLL(None, use_errno=True)
parent = os.getppid()
arm = platform.machine() == "aarch64"
def checked(outcome):
    if outcome < 0:
        raise OSError(ctypes.get_errno(), os.strerror(ctypes.get_errno()))
    return outcome
def call(name, *arguments):
    return checked(getattr(libc, name)(*arguments))
def number(by_x86, by_arm, *arguments):
    return checked(libc.syscall(by_arm if arm else by_x86, *arguments))
def mapped(flags, size=1 << 20, rights=3):
    libc.mmap.restype = ctypes.c_void_p
    libc.mmap.argtypes = [ctypes.c_void_p, ctypes.c_size_t, *[ctypes.c_int] * 3, ctypes.c_long]
    place = libc.mmap(None, size, rights, flags, -1, 0)
    return checked(-1 if place == ctypes.c_void_p(-1).value else 0)
def by_another_table():
    # i386, whose call 39 is mkdir: mov eax, 20; int 0x80; ret
    code = mmap.mmap(-1, 4096, mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS, 7)
    code.write(bytes.fromhex("b814000000cd80c3"))
    place = ctypes.addressof(ctypes.c_char.from_buffer(code))
    outcome = ctypes.CFUNCTYPE(ctypes.c_int)(place)()
    if outcome < 0:
        raise OSError(-outcome, os.strerror(-outcome))
def thread():
    try:
        threading.Thread(target=int).start()
    except RuntimeError as error:
        raise PermissionError(str(error))
"""

FILES = {
    "a file": "open({canary!r}).read()",
    "a link in its folder": "open('link').read()",
    "a way up": "open('../canary').read()",
    "its environment": "open('/proc/self/environ').read()",
    "another's environment": "open(f'/proc/{{parent}}/environ').read()",
    "another's memory": "open(f'/proc/{{parent}}/mem', 'rb').read(1)",
    "a list of files": "os.listdir({outside!r})",
    "a file elsewhere": "open({outside!r} + '/made', 'w')",
    "a file cut elsewhere": "os.truncate({canary!r}, 0)",
    "a file removed elsewhere": "os.unlink({canary!r})",
    "a folder": "os.mkdir('folder')",
    "a link": "os.symlink({canary!r}, 'way')",
    "a hard link": "os.link({canary!r}, 'way')",
    "a pipe with a name": "os.mkfifo('pipe')",
    "a device": "os.mknod('device', 0o20666, os.makedev(1, 1))",
    "rights of a file": "os.chmod('link', 0o777)",
    "rights of an open file": "os.fchmod(0, 0o777)",
    "owner of a file": "os.chown('own', 0, 0)",
    "times of a file elsewhere": "os.utime({canary!r}, (0, 0))",
    "attribute of a file": "os.setxattr('own', 'user.a', b'1')",
    "another root": "os.chroot('.')",
    "a mount": "call('mount', b'none', b'.', b'tmpfs', 0, None)",
    "a place on disk at once": "os.posix_fallocate(os.open('own', os.O_RDWR), 0, 1 << 30)",
}
PROCESSES = {
    "a program": "os.execv('/bin/sh', ['sh', '-c', 'cat ' + {canary!r}])",
    "a fork": "os.fork() or os._exit(0)",
    "a thread": "thread()",
    "clone": "number(56, 220, 17, None, None, None, None) or os._exit(0)",
    "clone3": "number(435, 435, ctypes.create_string_buffer(88), 88) or os._exit(0)",
    "another session": "os.setsid()",
    "another group": "os.setpgid(0, 0)",
    "a signal": "os.kill(parent, 0)",
    "a signal to all": "os.kill(-1, 0)",
    "a signal to another's thread": "number(234, 131, parent, parent, 0)",
    "a signal in a queue": "number(129, 138, parent, 0, ctypes.create_string_buffer(128))",
    "a signal through a file": "fcntl.fcntl(0, fcntl.F_SETOWN, parent)",
    "a handle of a process": "os.pidfd_open(parent)",
    "limits of another": "resource.prlimit(parent, resource.RLIMIT_NOFILE)",
    "new limits of another": "resource.prlimit(parent, resource.RLIMIT_CORE, (0, 0))",
    "a new limit of itself": "resource.prlimit(0, resource.RLIMIT_CORE, (0, 0))",
    "its alarm": "number(38, 103, 0, ctypes.create_string_buffer(32), None)",
    "its end with its parent": "call('prctl', 1, 0, 0, 0, 0)",
    "priority of another": "os.setpriority(os.PRIO_PROCESS, parent, 0)",
    "processors of another": "os.sched_setaffinity(parent, os.sched_getaffinity(0))",
    "a trace": "call('ptrace', 16, parent, 0, 0)",
    "memory of another": "call('process_vm_readv', parent, None, 0, None, 0, 0)",
    "a namespace": "call('unshare', 0x10000000)",
}
SYSTEM = {
    "a connection": "socket.create_connection(('127.0.0.1', 9), timeout=1.0)",
    "a datagram": "socket.socket(socket.AF_INET, socket.SOCK_DGRAM)",
    "a socket of the system": "socket.socket(socket.AF_UNIX)",
    "a pair of sockets": "socket.socketpair()",
    "memory shared by a key": "call('shmget', 0, 1 << 20, 0o1600)",
    "memory shared by a file": "os.memfd_create('memory')",
    "memory shared by a map": "mapped(mmap.MAP_SHARED | mmap.MAP_ANONYMOUS)",
    "memory that grows by itself": "mapped(mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS | 0x100)",
    "messages": "call('msgget', 0, 0o1600)",
    "semaphores": "call('semget', 0, 1, 0o1600)",
    "io_uring": "number(425, 425, 1, ctypes.create_string_buffer(120))",
    "a key": "number(250, 219, 0, -3, 1)",
    "a program of the kernel": "number(321, 280, 0, ctypes.create_string_buffer(120), 120)",
    "counters of the machine": "number(298, 241, ctypes.create_string_buffer(120), 0, -1, -1, 0)",
    "faults in hand": "number(323, 282, 0)",
    "events": "number(290, 19, 0, 0)",
    "news of files": "number(294, 26, 0)",
    "keys typed for another": "fcntl.ioctl(0, termios.TIOCSTI, b'x')",
    "another personality": "number(135, 92, 0x0040000)",
    "another filter": "number(317, 277, 1, 0, None)",
    "calls of the second table": "checked(libc.syscall(0x40000000 | 39))",
}
BY_32_BITS = "by_another_table()"
"""On x86-64 alone; a system without that table ends the process."""


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


class Ended(NamedTuple):
    """How a child ended."""

    returncode: int
    stdout: str
    stderr: str


Run = Callable[..., Ended]


@pytest.fixture
def confined(tmp_path):
    (tmp_path / "canary").write_text("canary")
    own = tmp_path / "own"
    own.mkdir()
    (own / "link").symlink_to(tmp_path / "canary")
    (own / "own").touch()

    def run(tries, **limits):
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
def test_every_escape_is_refused(confined, escapes, tmp_path):
    refusals = outcomes(confined(escapes))
    assert {name: outcome for name, outcome in refusals.items() if outcome != "PermissionError"} == {}
    assert len(refusals) == len(escapes)
    assert sorted(path.name for path in (tmp_path / "own").iterdir()) == ["link", "own"]


def test_there_are_forty_escapes():
    assert len(FILES) + len(PROCESSES) + len(SYSTEM) >= 40


@pytest.mark.skipif(platform.machine() != "x86_64", reason="a table of that processor")
def test_calls_of_32_bits_are_refused(confined):
    ended = confined({"call": BY_32_BITS})
    assert ended.returncode == -signal.SIGSEGV or outcomes(ended) == {"call": "PermissionError"}


def test_a_process_with_other_threads_is_not_confined():
    """They would keep what the thread gives up that confines itself."""
    wait = "threading.Thread(target=threading.Event().wait, daemon=True).start()"
    code = f"import threading, pathlib, host; {wait}; host.confine(pathlib.Path.cwd())"
    done = subprocess.run(
        [sys.executable, "-c", code], env=child_environment(), capture_output=True, text=True, check=False
    )
    assert done.returncode == 1
    assert "1 other threads of this process would not be confined" in done.stderr


def test_its_own_folder_and_python_stay(confined):
    own = {
        "writes": "open('made', 'w').write('x')",
        "reads": "open('made').read()",
        "imports": "__import__('scipy.linalg')",
        "imports ours": "__import__('lineofaction.gearbox.from_rexs.opened')",
        "reads its limits": "resource.prlimit(0, resource.RLIMIT_STACK)",
        "removes": "os.unlink('made')",
    }
    assert set(outcomes(confined(own)).values()) == {"done"}


def test_memory_and_sizes_of_files_end(confined):
    tries = {"memory": "bytearray(200_000_000)", "file": "open('large', 'wb').write(bytes(2_000_000))"}
    ended = outcomes(confined(tries, memory_mb=150, file_bytes=1_000_000))
    assert ended == {"memory": "MemoryError", "file": "OSError"}


def test_it_ends_with_whoever_started_it(tmp_path):
    command = (sys.executable, "-c", STARTER, SLEEPER)
    with subprocess.Popen(command, cwd=tmp_path, env=child_environment(), **PIPES) as starter:
        pid = int(starter.stdout.readline())
        until((tmp_path / "confined").exists)
        assert lives(pid)
        starter.kill()
    until(lambda: not lives(pid))


@pytest.mark.parametrize(("statement", "cause"), WRITES.values(), ids=WRITES)
def test_whoever_asks_ends_it_beyond_what_it_may_write(tmp_path, statement, cause):
    """Each file is within its limit; of those that it removes none is left to be counted."""
    limits = Limits(written_bytes=1_000_000, files=8)
    with pytest.raises(ChildFailed, match=cause):
        ask_child({}, 60.0, (sys.executable, "-c", ENDLESS.format(statement)), tmp_path, limits)


@pytest.mark.law
def test_cpu_time_ends_the_process_and_says_so(confined):
    assert confined({"loop": "[0 for _ in iter(int, 1)]"}, cpu_seconds=1).returncode == -24  # SIGXCPU


def test_a_child_inherits_no_secret(monkeypatch):
    for name in ("AWS_SECRET_ACCESS_KEY", "LOA_WEBHOOK_SECRET", "DATABASE_URL", "GITHUB_TOKEN"):
        monkeypatch.setenv(name, "canary")
    monkeypatch.setenv("NUMBA_DEBUG_CACHE", "0")
    environment = child_environment(EXTRA="1")
    assert "canary" not in environment.values()
    assert environment["NUMBA_DEBUG_CACHE"] == "0" and environment["EXTRA"] == "1"
