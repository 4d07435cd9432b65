"""What systems that the tests do not run on are requested, and what they are told."""

import pickle
import sys
from types import SimpleNamespace
from typing import Any

import pytest

import host
from host import windows


def test_windows_is_asked_through_psutil(monkeypatch):
    process = SimpleNamespace(memory_info=lambda: SimpleNamespace(peak_wset=7))
    memory = SimpleNamespace(total=9)
    asked = SimpleNamespace(Process=lambda: process, virtual_memory=lambda: memory)
    monkeypatch.setitem(sys.modules, "psutil", asked)
    assert (windows.peak_memory(), windows.physical_memory()) == (7, 9)
    assert (windows.children_peak_memory(), windows.children_cpu_seconds()) == (0, 0.0)


def test_a_lock_that_another_has_on_windows_is_the_error_of_posix(tmp_path, monkeypatch):
    held: list[Any] = []

    def locking(*file):
        if held:
            raise PermissionError(13, "Permission denied")
        held.append(file)

    monkeypatch.setattr("sys.platform", "win32")
    monkeypatch.setitem(sys.modules, "msvcrt", SimpleNamespace(locking=locking, LK_NBLCK=2))
    windows.lock(5)
    assert held == [(5, 2, 1)]
    with pytest.raises(BlockingIOError):
        windows.lock(5)
    with pytest.raises(host.Unavailable, match="waited for"):
        windows.lock(5, wait=True)


REFUSED = {
    "win32": (
        host.require_sessions,
        host.lead_session,
        host.kill_process_group,
        lambda: host.kill_group(0),
        lambda: host.kill(0),
        lambda: host.lower_priority(0),
        lambda: host.never_wait_at(0),
        lambda: host.has_exited(0),
        lambda: host.reap(0),
        lambda: host.limit_memory(0),
        lambda: host.limit_file_size(0, 0),
    ),
    "darwin": (lambda: host.limit_file_size(0, 0),),
}


@pytest.mark.parametrize("platform", REFUSED)
def test_what_a_system_has_not_is_refused_by_name(platform, monkeypatch):
    monkeypatch.setattr("sys.platform", platform)
    for act in REFUSED[platform]:
        with pytest.raises(host.Unavailable, match=rf"^[A-Z].* are not available on {platform}\. .*Linux"):
            act()


def test_without_proc_no_process_is_listed_and_no_figure_known(tmp_path):
    with pytest.raises(host.Unavailable, match="/proc"):
        host.processes_in(tmp_path, proc=tmp_path / "proc")
    assert host.memory_figure("VmHWM", proc=tmp_path / "proc") is None


def test_the_error_survives_a_process():
    error = host.Unavailable("Limits on memory")
    again = pickle.loads(pickle.dumps(error))
    assert (str(again), again.what) == (str(error), "Limits on memory")
