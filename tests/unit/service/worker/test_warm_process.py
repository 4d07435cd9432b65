"""Children forked from a warm process are as those started anew, and nothing is lost if it dies."""

import os
import signal
import time
from pathlib import Path

import pytest
from running_service import Bench, bench, lives, until
from service_fakes import REGISTRY

from host.children.launcher import Launcher
from service.worker.worker import WORK


@pytest.fixture(scope="module", autouse=True)
def warm_once():
    """Share no warm process: what becomes of one is what is tested here."""


@pytest.fixture
def machine(tmp_path):
    made = bench(tmp_path, REGISTRY)
    made.scheduler.start()
    yield made
    made.close()


def warm_process(machine: Bench) -> int:
    """Return the process id of the warm process, once it is warm."""
    launcher = machine.scheduler._crew._launcher
    until(lambda: launcher.warm)
    return launcher._server._process.pid


def parent_of_last(machine: Bench, key: str) -> int:
    """Return the parent of the process that works on a key."""
    file = machine.settings.data_directory / f"started_{key[:8]}"
    until(lambda: file.exists() and file.read_text() != "")
    pid = file.read_text().splitlines()[-1].split()[0]
    return int(Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[1])


def test_the_first_child_is_forked(machine, monkeypatch):
    """It waits for what it would have to load itself."""
    monkeypatch.setattr(Launcher.launch, "__defaults__", (600.0,))
    job = machine.submit(mode="hang")
    parent = parent_of_last(machine, job.key)
    assert parent == warm_process(machine)
    machine.submissions.dismiss(job.id)
    machine.scheduler.wake()
    until(lambda: machine.submissions.find(job.id).ended)
    second = machine.ended(machine.submit(text="second"))
    assert machine.store.verified(second.key, "database").path.read_text() == "second"


def test_a_child_outlives_the_warm_process_and_others_follow(machine):
    machine.scheduler._crew._launcher.warm_up()
    warm = warm_process(machine)
    slow = machine.submit(mode="slow", text="slow")
    assert parent_of_last(machine, slow.key) == warm
    os.kill(warm, signal.SIGKILL)
    assert machine.ended(slow).status == "successful"
    assert len(machine.starts(slow)) == 1
    until(lambda: not lives(warm))
    for text in ("a", "b"):
        assert machine.ended(machine.submit(text=text)).status == "successful"
    assert warm_process(machine) != warm


def test_a_stop_does_not_wait_for_a_warm_process(tmp_path, monkeypatch):
    monkeypatch.setattr(Launcher.launch, "__defaults__", (600.0,))
    (tmp_path / "long_to_load.py").write_text("import time\ntime.sleep(600)\n")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path), prepend=os.pathsep)
    machine = bench(tmp_path / "data", REGISTRY)
    machine.scheduler._crew._launcher._modules.append("long_to_load")
    machine.scheduler.start()
    launcher, jobs = (
        machine.scheduler._crew._launcher,
        [machine.submit(mode=mode) for mode in ("hang", "die")],
    )
    until(lambda: launcher._server is not None)
    time.sleep(1.0)
    launcher.hurry()
    until(lambda: machine.starts(jobs[0]) != [])
    machine.submissions.dismiss(jobs[0].id)
    assert machine.ended(jobs[1]).status == "failed"  # nor does what begins after it
    assert not launcher.warm
    machine.close()


def test_a_stop_ends_the_warm_process(machine):
    machine.scheduler._crew._launcher.warm_up()
    warm = warm_process(machine)
    machine.scheduler.stop()
    assert not lives(warm)


def test_after_so_many_children_another_takes_its_place(machine, monkeypatch):
    monkeypatch.setattr("host.children.launcher.MAX_FORKS", 2)
    machine.scheduler._crew._launcher.warm_up()
    warm = warm_process(machine)
    for text in ("a", "b", "c"):
        assert machine.ended(machine.submit(text=text)).status == "successful"
    assert warm_process(machine) != warm
    until(lambda: not lives(warm))


def test_nobody_waits_for_a_warm_process_that_forks_no_more(tmp_path, monkeypatch):
    """As long as one of its children lives it has no successor."""
    monkeypatch.setattr("host.children.launcher.MAX_FORKS", 1)
    monkeypatch.setattr(Launcher.launch, "__defaults__", (600.0,))
    machine = bench(tmp_path, REGISTRY, workers=2)
    machine.scheduler.start()
    try:
        hangs = machine.submit(mode="hang")
        assert parent_of_last(machine, hangs.key) != os.getpid()
        assert machine.ended(machine.submit(text="beside it")).status == "successful"
    finally:
        machine.close()


def test_modules_that_cannot_be_imported_leave_a_warm_process(tmp_path):
    launcher = Launcher(WORK, ["no_such_module", "service_fake_work"], tmp_path / "log", print)
    launcher.warm_up()
    try:
        until(lambda: launcher.warm)
        assert "no_such_module" in (tmp_path / "log").read_text()
    finally:
        launcher.close()
