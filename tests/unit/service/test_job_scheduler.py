"""The scheduler: work is done once, ends for a stated reason, and leaves no process behind."""

import errno
import itertools
import os
import signal
from pathlib import Path
from types import SimpleNamespace

import pytest
from running_service import Bench, bench, lives, until
from service_fake_work import SECRET
from service_fakes import REGISTRY

from host.children.launcher import Launcher, start_child
from host.directories import cache_home, data_home
from service.queue import claims
from service.queue.claims import MAX_LOST_RUNS, Claim
from service.queue.scheduler import Scheduler
from service.settings import MIN_MEMORY_MB, Settings
from service.store.results import ResultStore
from service.worker.usage import machine_memory_mb
from service.worker.worker import WORK


@pytest.fixture(params=["started anew", "forked"])
def machine(tmp_path, request, monkeypatch):
    """A started scheduler with two workers, started anew or forked from a warm process."""
    if request.param == "started anew":
        monkeypatch.setattr(Launcher, "launch", lambda _, ends: start_child(WORK, ends))
    made = bench(tmp_path, REGISTRY, workers=2)
    made.scheduler.start()
    yield made
    made.close()


def grandchild(machine: Bench, key: str) -> int:
    """Return the process id of the worker's own child, once it is there."""
    file = machine.settings.data_directory / f"grandchild_{key[:8]}"
    until(lambda: file.exists() and file.read_text() != "")
    return int(file.read_text())


def worker(machine: Bench, job_key: str) -> int:
    file = machine.settings.data_directory / f"started_{job_key[:8]}"
    return int(file.read_text().splitlines()[-1].split()[0])


def test_work_is_stored_under_its_key_and_the_workspace_is_gone(machine):
    job = machine.ended(machine.submit(text="hello"))
    assert (job.status, job.fraction, job.attempts) == ("successful", 1.0, 1)
    assert machine.store.verified(job.key, "database").path.read_text() == "hello"
    until(lambda: not list((machine.settings.data_directory / "work").iterdir()))


def test_a_data_directory_may_be_named_from_where_one_is(tmp_path, monkeypatch):
    """Workers work in other folders, where the same name would mean another place."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("HOME", str(tmp_path))
    assert Settings(data_directory=Path("~/data"), keys_file=Path("keys.json")).data_directory.is_absolute()
    found = bench(Path("data"), REGISTRY)
    found.scheduler.start()
    try:
        assert found.ended(found.submit(text="hello")).status == "successful"
    finally:
        found.close()


def test_base_directories_that_are_relative_are_ignored(tmp_path, monkeypatch):
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setenv("XDG_DATA_HOME", "data")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "elsewhere"))
    assert data_home() == tmp_path / ".local" / "share" / "lineofaction"
    assert cache_home() == tmp_path / "elsewhere" / "lineofaction"
    monkeypatch.setenv("XDG_CACHE_HOME", "cache")
    assert cache_home() == tmp_path / ".cache" / "lineofaction"


def test_workers_are_nice_and_keep_to_one_thread(machine):
    job = machine.ended(machine.submit())
    _, niceness, threads = machine.starts(job)[0].split()
    nicest = 19  # where these tests are niced themselves
    assert (int(niceness), threads) == (min(os.nice(0) + 10, nicest), "1")


def test_progress_is_reported_by_stage(machine):
    job = machine.submit(mode="hang")
    until(lambda: machine.submissions.find(job.id).stage == "first")
    seen = machine.submissions.find(job.id)
    assert (seen.status, seen.stage_fraction, seen.fraction) == ("running", 0.5, 0.125)


def test_a_dying_worker_gets_a_second_attempt(machine):
    job = machine.ended(machine.submit(mode="die_once", text="late"))
    assert (job.status, job.attempts) == ("successful", 2)
    assert machine.store.verified(job.key, "database").path.read_text() == "late"


def test_a_second_attempt_finds_what_the_first_left(machine):
    job = machine.ended(machine.submit(mode="leave_and_die"))
    assert (job.status, job.attempts) == ("successful", 2)
    assert machine.store.verified(job.key, "database").path.read_text() == "left behind"
    until(lambda: not list((machine.settings.data_directory / "work").iterdir()))


def test_attempts_are_limited_and_the_reason_is_stated(machine):
    job = machine.ended(machine.submit(mode="die"))
    assert (job.status, job.attempts, len(machine.starts(job))) == ("failed", 2, 2)
    assert job.message == "The worker ended early with exit code 7. That was attempt 2 of 2."


def test_a_worker_that_is_killed_from_outside_costs_no_attempt(machine, monkeypatch):
    """It is killed as often as there are attempts, and once more."""
    monkeypatch.setattr(claims, "wait_s", lambda _lost_runs: 0.0)
    job = machine.submit(mode="hang_thrice", text="late")
    for run in range(3):
        until(lambda: len(machine.starts(job)) == run + 1)  # noqa: B023 (within this run)
        until(lambda: machine.submissions.find(job.id).stage == "first")
        os.kill(worker(machine, job.key), signal.SIGKILL)
    ended = machine.ended(job)
    assert (ended.status, ended.attempts) == ("successful", 1)


def test_a_worker_that_the_system_kills_for_memory_costs_an_attempt(machine, monkeypatch):
    """Here as its count of such kills says."""
    counts = itertools.count()
    monkeypatch.setattr("host.children.child.memory_kills", lambda: next(counts))
    job = machine.submit(mode="hang")
    for run in range(2):
        until(lambda: len(machine.starts(job)) == run + 1)  # noqa: B023 (within this run)
        until(lambda: machine.submissions.find(job.id).stage == "first")
        os.kill(worker(machine, job.key), signal.SIGKILL)
    ended = machine.ended(job)
    text = "The worker was ended by SIGKILL (it may have run out of memory). That was attempt 2 of 2."
    assert (ended.status, ended.message) == ("failed", text)


def test_failures_raised_on_purpose_are_told_and_not_retried(machine):
    job = machine.ended(machine.submit(mode="mesh"))
    assert (job.status, job.attempts, job.message) == ("failed", 1, "element 7 has a negative Jacobian")


def test_bad_input_found_by_the_work_is_named_as_the_user_wrote_it(machine):
    job = machine.ended(machine.submit(mode="input"))
    assert job.status == "failed"
    assert job.faults == (
        {
            "field": "pair.pinion.bore_diameter_mm",
            "value": 95.0,
            "bound": "below the root diameter 70 mm",
            "suggestion": "Lower the bore.",
        },
    )


@pytest.mark.law
def test_the_text_of_a_defect_stays_in_the_log(machine):
    job = machine.ended(machine.submit(mode="defect"))
    logs = "".join(file.read_text() for file in (machine.settings.data_directory / "log").iterdir())
    assert SECRET in logs
    assert SECRET not in job.message
    assert job.reference and job.reference in job.message


def test_dismissal_ends_the_worker_and_its_children(machine):
    job = machine.submit(mode="hang")
    sleeper = grandchild(machine, job.key)
    child = worker(machine, job.key)
    assert lives(sleeper) and lives(child)
    assert machine.submissions.dismiss(job.id).status == "dismissed"
    machine.scheduler.wake()
    until(lambda: not lives(sleeper) and not lives(child))
    assert machine.submissions.find(job.id).status == "dismissed"


def test_shared_work_goes_on_until_nobody_wants_it(machine):
    one, other = machine.submit(mode="hang"), machine.submit(mode="hang")
    sleeper = grandchild(machine, one.key)
    machine.submissions.dismiss(one.id)
    machine.scheduler.wake()
    assert machine.submissions.find(one.id).status == "dismissed"
    assert machine.submissions.find(other.id).status == "running"
    assert lives(sleeper)
    machine.submissions.dismiss(other.id)
    machine.scheduler.wake()
    until(lambda: not lives(sleeper))


def test_the_deadline_ends_the_work(tmp_path):
    machine = bench(tmp_path, REGISTRY, deadline_s=2.0)
    machine.scheduler.start()
    job = machine.submit(mode="hang")
    ended = machine.ended(job)
    machine.scheduler.stop()
    assert ended.status == "failed"
    assert ended.message.startswith("The deadline of 2 s (LOA_DEADLINE_S) passed. Select a coarser level")
    for file in tmp_path.glob("grandchild_*"):  # on a busy machine the worker may not have come that far
        assert not lives(int(file.read_text()))


@pytest.mark.law
def test_work_beyond_its_memory_fails_with_the_limit_and_what_to_try(tmp_path):
    """300 MB are refused to one that may have 256, and had by one that may have 1000."""
    for limit, status in ((256, "failed"), (1000, "successful")):
        machine = bench(tmp_path / str(limit), REGISTRY, memory_limit_mb=limit)
        machine.scheduler.start()
        job = machine.ended(machine.submit(mode="hog"))
        machine.scheduler.stop()
        assert (job.status, job.attempts) == (status, 1)
        assert ("256 MB (LOA_MEMORY_LIMIT_MB). Select a coarser level" in job.message) == (limit == 256)


def test_a_library_that_gives_up_is_told_with_its_signal(machine):
    job = machine.ended(machine.submit(mode="abort"))
    assert (job.status, job.attempts) == ("failed", 2)
    assert job.message.startswith("The worker was ended by SIGABRT (it may have run out of memory).")


def test_work_that_finds_no_room_fails_with_the_cause_and_serves_nothing(machine):
    job = machine.ended(machine.submit(mode="full", text="long"))
    assert (job.status, job.attempts) == ("failed", 1)
    assert "no space left in the data directory" in job.message
    assert machine.store.find(job.key, "database") is None


@pytest.mark.law
@pytest.mark.parametrize("number", [errno.ENOSPC, errno.EIO])
def test_a_result_that_cannot_be_stored_never_leaves_its_job_running(machine, monkeypatch, number):
    """It fails, for want of room or under a number in the log, and those behind it have their turn."""
    put, failed = ResultStore.put, []

    def full_once(store, *arguments):
        if failed:
            return put(store, *arguments)
        failed.append(1)
        raise OSError(number, os.strerror(number))

    monkeypatch.setattr(ResultStore, "put", full_once)
    job = machine.ended(machine.submit(text="hello"))
    assert (job.status, job.attempts) == ("failed", 1)
    assert ("no space left" if number == errno.ENOSPC else "The log has the details") in job.message
    assert machine.ended(machine.submit(text="next")).status == "successful"


def test_memory_is_the_machine_s_or_what_its_control_group_leaves(tmp_path):
    group = tmp_path / "memory.max"
    whole = machine_memory_mb(group)  # no such file
    group.write_text("max\n")
    assert machine_memory_mb(group) == whole > MIN_MEMORY_MB
    group.write_text(f"{300 << 20}\n")
    assert machine_memory_mb(group) == 300


def test_a_stop_kills_the_workers_and_loses_no_job(machine):
    job = machine.submit(mode="hang")
    sleeper, child = grandchild(machine, job.key), worker(machine, job.key)
    machine.scheduler.stop()
    assert not lives(sleeper) and not lives(child)
    waiting = machine.submissions.find(job.id)
    assert (waiting.status, waiting.attempts) == ("accepted", 0)


def test_what_a_dead_service_left_running_is_taken_up_again(tmp_path):
    dead = bench(tmp_path, REGISTRY)
    job = dead.submit(text="found again")
    dead.claimed()  # it died right after this
    assert dead.submissions.find(job.id).status == "running"
    alive = dead.again()
    alive.scheduler.start()
    ended = alive.ended(job)
    alive.scheduler.stop()
    assert (ended.status, ended.attempts) == ("successful", 1)
    assert alive.store.verified(job.key, "database").path.read_text() == "found again"


# Ends of the server: they are no attempts; what ends it again and again is known by who ran.


@pytest.fixture
def at_once(monkeypatch):
    """Let nothing wait after a run that was lost."""
    monkeypatch.setattr(claims, "wait_s", lambda _lost_runs: 0.0)


def fall(server: Bench, *, begun: bool = True) -> list[str]:
    """Let a server do a turn and end without notice while children run; return whose they are.

    `begun`: they had said so before.
    """
    scheduler = server.scheduler
    scheduler._take_up()
    runs: list[Claim] = []
    while len(runs) < scheduler.maximum and (claim := _next_beside(scheduler, runs)) is not None:
        runs.append(claim)
    if begun:
        server.claims.note_runs(runs)
    return [claim.id for claim in runs]


def _next_beside(scheduler: Scheduler, runs: list[Claim]) -> Claim | None:
    scheduler._running = {claim.id: SimpleNamespace(claim=claim) for claim in runs}
    try:
        return scheduler._next()
    finally:
        scheduler._running = {}


@pytest.mark.usefixtures("at_once")
def test_ends_of_the_server_are_no_attempts(tmp_path):
    machine = bench(tmp_path, REGISTRY)
    job = machine.submit(text="done")
    for _ in range(MAX_LOST_RUNS - 1):
        assert fall(machine) == [job.computation]
        assert machine.submissions.find(job.id).attempts == 1
    machine.scheduler.start()
    ended = machine.ended(job)
    machine.close()
    assert (ended.status, ended.attempts) == ("successful", 1)


@pytest.mark.usefixtures("at_once")
def test_work_that_had_not_begun_has_no_part_in_the_end_of_a_server(tmp_path):
    machine = bench(tmp_path, REGISTRY)
    job = machine.submit(text="done")
    for _ in range(3 * MAX_LOST_RUNS):
        assert fall(machine, begun=False) == [job.computation]
    machine.scheduler._take_up()
    assert "before it had begun" in machine.submissions.find(job.id).message
    assert machine.claimed().lost_runs == 0
    machine.close()


@pytest.mark.usefixtures("at_once")
def test_what_ends_its_server_again_and_again_is_known_by_who_ran(tmp_path):
    """Others that ran beside it are done, as soon as suspects run without others."""
    machine = bench(tmp_path, REGISTRY, workers=4)
    jobs = [machine.submit(text=text) for text in ("a", "b", "fatal", "c", "waits")]
    fatal = jobs.pop(2)
    falls = 0
    while not machine.submissions.find(fatal.id).ended:
        if fatal.computation in fall(machine):
            falls += 1
        else:  # the server does not end: what runs is done
            for claim in machine.claims.running():
                machine.claims.succeed(claim)
    assert falls == MAX_LOST_RUNS
    message = machine.submissions.find(fatal.id).message
    assert message.startswith("The service ended while it ran. So ended 10 of its runs in a row, the last 7 ")
    assert "with no other job beside it" in message
    machine.scheduler.start()
    assert [machine.ended(job).status for job in jobs] == ["successful"] * 4
    machine.close()


def test_what_was_lost_waits_longer_each_time_and_others_go_on(tmp_path):
    machine = bench(tmp_path, REGISTRY)
    lost, other = machine.submit(text="lost"), machine.submit(text="other")
    assert fall(machine) == [lost.computation]
    machine.scheduler._take_up()
    assert machine.claimed().id == other.computation
    assert machine.claims.claim() is None
    until(lambda: machine.claims.claim() is not None)
    waits = [claims.wait_s(number) for number in range(MAX_LOST_RUNS)]
    assert waits == [0.0, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 60.0, 60.0, 60.0]
    machine.close()


def test_the_end_of_a_child_by_itself_breaks_the_row(tmp_path):
    machine = bench(tmp_path, REGISTRY)
    machine.submit(text="a")
    claim = machine.claimed()
    machine.claims.note_runs([claim])
    assert [claim.lost_runs for claim in machine.claims.running()] == [1]
    machine.claims.put_back(claim, "died", counted=True)
    again = machine.claimed()
    assert (again.lost_runs, again.attempts) == (0, 2)
    machine.claims.note_runs([again])
    machine.claims.put_back(again, "Waits: the service was stopped.", counted=False)
    assert machine.claimed().lost_runs == 0
    machine.close()


def test_a_child_that_ends_before_it_begins_costs_no_attempt(tmp_path, monkeypatch):
    """Here the first one finds no program."""
    launched: list[int] = []

    def launch(_launcher, ends):
        launched.append(1)
        return start_child("no.such.module" if len(launched) == 1 else WORK, ends)

    monkeypatch.setattr(Launcher, "launch", launch)
    machine = bench(tmp_path, REGISTRY, attempts=1)
    machine.scheduler.start()
    job = machine.ended(machine.submit(text="late"))
    machine.close()
    assert (job.status, job.attempts, len(launched)) == ("successful", 1, 2)
