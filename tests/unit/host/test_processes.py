"""Costs, locks, limits and ends of processes, by laws that hold on every POSIX system."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

import host

PYTHON = (sys.executable, "-I", "-S", "-c")


@pytest.mark.law
def test_the_peak_follows_what_is_held_in_bytes():
    """256 MiB that are written show as that, in bytes: not as KiB, nor a thousandfold.

    And not as what the process that started it holds: here twice as much.
    """
    code = "import host as s; x = b'x' * 2**28; print(s.peak_memory())"
    held = b"x" * 2**29
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    del held
    assert 2**28 < int(done.stdout) < 1.5 * 2**28
    assert host.peak_memory() < host.physical_memory()


FAULTS = """
import resource, host
{setting}
def pages():
    before = resource.getrusage(resource.RUSAGE_SELF).ru_minflt
    for _ in range(6):
        blocks = [bytearray({mib} * 2**20) for _ in range({blocks})]
        del blocks
    return resource.getrusage(resource.RUSAGE_SELF).ru_minflt - before
pages()
print(pages())
"""
"""Pages that a task gets which allocates blocks of so many MiB again and again, and frees them."""


@pytest.mark.skipif(sys.platform != "linux", reason="a setting of the C library of Linux")
@pytest.mark.parametrize(
    ("setting", "blocks", "mib"),
    [("host.keep_freed_memory()", 8, 1), ("host.keep_freed_memory(to_the_end=True)", 1, 40)],
)
def test_memory_that_is_kept_is_there_again(setting, blocks, mib):
    kept, given_back = (
        int(
            subprocess.run(
                [sys.executable, "-c", FAULTS.format(setting=line, blocks=blocks, mib=mib)],
                capture_output=True,
                check=True,
            ).stdout
        )
        for line in (setting, "")
    )
    assert kept < 0.1 * given_back


def test_children_count_once_they_have_ended():
    before, whole = host.children_cpu_seconds(), host.cpu_seconds()
    code = "import time\nwhile time.process_time() < 0.2: pass"
    subprocess.run([*PYTHON, code], check=True)
    assert 0.2 <= host.children_cpu_seconds() - before < 1.0
    assert host.cpu_seconds() - whole >= 0.2
    assert host.children_peak_memory() > 2**20


def test_a_lock_lasts_until_its_file_is_closed(tmp_path):
    first, second = (os.open(tmp_path / "lock", os.O_RDWR | os.O_CREAT) for _ in range(2))
    host.lock(first)
    with pytest.raises(BlockingIOError):
        host.lock(second)
    os.close(first)
    host.lock(second, wait=True)
    os.close(second)


@pytest.mark.parametrize("waitid", [True, False])
def test_an_ended_child_is_seen_before_it_is_reaped(waitid, monkeypatch):
    """Also as macOS sees it before Python 3.13."""
    if not waitid:
        monkeypatch.delattr("os.waitid")
    child = subprocess.Popen([*PYTHON, "input()"], stdin=subprocess.PIPE)
    assert not host.has_exited(child.pid)
    child.stdin.close()
    latest = time.monotonic() + 10.0
    while not host.has_exited(child.pid) and time.monotonic() < latest:
        time.sleep(0.01)
    assert host.has_exited(child.pid)
    ended = host.reap(child.pid)
    child.returncode = ended.code
    assert ended.code == 1 and ended.cpu_seconds > 0.0 and ended.peak_memory > 2**20


def test_a_group_ends_with_all_its_processes():
    code = "import os, subprocess; print(subprocess.Popen(['sleep', '60']).pid, flush=True); input()"
    leader = subprocess.Popen(
        [*PYTHON, code], stdin=subprocess.PIPE, stdout=subprocess.PIPE, start_new_session=True
    )
    assert leader.stdout is not None and leader.stdin is not None
    grandchild = int(leader.stdout.readline())
    host.kill_group(leader.pid)
    assert host.ending_signal(leader.wait(10)) == "SIGKILL"
    latest = time.monotonic() + 10.0
    while _runs(grandchild) and time.monotonic() < latest:
        time.sleep(0.01)
    assert not _runs(grandchild)
    leader.stdin.close()
    leader.stdout.close()


def _runs(pid: int) -> bool:
    """Whether a process is there and no zombie."""
    shown = subprocess.run(["ps", "-o", "stat=", "-p", str(pid)], capture_output=True, text=True, check=False)
    return shown.stdout.strip()[:1] not in {"", "Z"}


def test_a_process_ends_after_its_time_and_one_of_windows_too():
    for module in ("host", "host.windows"):
        code = f"import time; from {module} import end_after; end_after(1); time.sleep(20)"
        begun = time.monotonic()
        done = subprocess.run([sys.executable, "-c", code], check=False, timeout=15)
        assert done.returncode != 0 and 0.9 < time.monotonic() - begun < 10.0


@pytest.mark.skipif(sys.platform != "linux", reason="Linux alone limits other processes and has /proc")
def test_limits_and_processes_of_linux(tmp_path):
    code = "print(flush=True); input(); open('file', 'w').write('x')"
    quiet = subprocess.DEVNULL
    with subprocess.Popen(
        [*PYTHON, code], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=quiet, cwd=tmp_path
    ) as child:
        assert child.stdout is not None and child.stdout.readline()  # Python has begun
        assert host.processes_in(tmp_path, "input()") == [child.pid]
        assert host.processes_in(tmp_path, "another command") == []
        assert (host.memory_figure("VmHWM", child.pid) or 0) > 2**20
        host.limit_file_size(child.pid, 0)
    assert child.returncode != 0
    assert host.memory_figure("VmHWM", child.pid) is None


@pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="this system has no /proc")
def test_the_cpu_time_of_a_family_counts_the_living_and_the_dead():
    """A shell has one busy child after the other: while both live, and once the first is dead."""
    dies = "i=0; while [ $i -lt 200000 ]; do i=$((i+1)); done"
    script = f"sh -c '{dies}'; sh -c 'while :; do :; done'; :"
    family = subprocess.Popen(["sh", "-c", script], start_new_session=True)
    try:
        spent = [0.0]
        while spent[-1] < 1.0:
            spent.append(host.family_cpu_seconds(family.pid) or 0.0)
            time.sleep(0.02)
        assert spent == sorted(spent)
        assert spent[-1] < 2.0
    finally:
        os.killpg(family.pid, signal.SIGKILL)
        family.wait()
    assert host.family_cpu_seconds(family.pid) is None
