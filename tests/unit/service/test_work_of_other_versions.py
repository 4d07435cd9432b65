"""What another version left in the job table: no result gets its name, and no job waits in vain."""

from __future__ import annotations

import pytest
from named_run import put_named_run
from running_service import Bench, until
from sqlalchemy import update

from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas.reading import validated
from service.queue.claims import Claims
from service.queue.entry import BatchCase
from service.queue.job import Job
from service.queue.tables import computations
from service.schemas.examples import INPUTS, SCENE
from service.store.database import now, writing
from service.version import solver_version
from service.webhooks.calls import Calls
from service.worker.process import default_registry

NEWER, OLDER = "9.0.0", "0.0.9"


def claims_of(machine: Bench, version: str) -> Claims:
    return Claims(machine.engine, version)


def test_work_of_an_older_version_ends_with_the_reason(machine: Bench) -> None:
    jobs = [machine.submit(text=text) for text in "ab"]
    assert claims_of(machine, NEWER).claim() is None
    for job in jobs:
        found = machine.submissions.find(job.id)
        text = f"The job was entered by version {solver_version()}; submit it again."
        assert (found.status, found.message, found.attempts) == ("failed", text, 0)
        assert found.finished is not None
    assert machine.submissions.counts() == {"failed": 2}


def test_a_scheduler_ends_what_an_older_version_left_and_goes_on(machine: Bench) -> None:
    old, new = machine.submit(text="old"), machine.submit(text="new")
    entered_by(machine, old, "")
    left = machine.settings.data_directory / "work" / old.computation
    left.mkdir(parents=True)
    machine.scheduler.start()
    assert machine.ended(old).message == "The job was entered by version 0.2.0 or older; submit it again."
    assert machine.ended(new).status == "successful" and machine.starts(old) == []
    until(lambda: not left.exists())


def entered_by(machine: Bench, job: Job, version: str) -> Job:
    """Let a job be one that a version entered."""
    with writing(machine.engine) as connection:
        mine = computations.c.id == job.computation
        connection.execute(update(computations).where(mine).values(program=version))
    return job


def test_what_an_older_version_ran_ends_with_the_reason(machine: Bench) -> None:
    job = machine.submit(text="a")
    machine.claims.put_back(machine.claimed(), "The service ended while it ran.", counted=True)
    machine.claimed()  # for its last attempt
    entered_by(machine, job, OLDER)
    machine.scheduler.start()
    found = machine.ended(job)
    text = f"The job was entered by version {OLDER}; submit it again."
    assert (found.status, found.message, found.attempts) == ("failed", text, 2)


def test_a_batch_of_an_older_version_ends_with_its_jobs_and_who_subscribed_is_told(machine: Bench) -> None:
    cases = [BatchCase(key * 64, {}) for key in "ab"]
    batch = machine.submissions.entry().batch("fake", cases, now())
    calls = Calls(machine.engine)
    calls.enter(batch, dict.fromkeys(("inProgress", "success", "failed"), "https://hooks.example/"))
    newer = claims_of(machine, NEWER)
    assert newer.claim() is None
    newer.advance_batches()
    found = machine.submissions.find(batch)
    assert (found.status, found.message) == ("failed", "2 of 2 jobs have ended, 2 failed.")
    call = calls.claim()
    assert call is not None and (call.job, call.event) == (batch, "failed")
    assert calls.claim() is None


def test_work_of_one_name_in_both_versions_goes_on_for_who_submits_it_to_the_newer(machine: Bench) -> None:
    """A table has the same hash in all versions with one solver: its end would end the new job too."""
    older = entered_by(machine, machine.submit(text="same"), OLDER)
    newer = machine.submit(text="same")
    assert newer.computation == older.computation
    claim = claims_of(machine, solver_version()).claim()
    assert claim is not None and claim.id == older.computation


def test_equal_work_of_an_older_version_is_computed_anew(machine: Bench) -> None:
    """The older version has another hash for it; its end keeps no job of the newer one waiting."""
    old, new = (machine.submissions.submit("fake", key * 64, {}, stored=False) for key in "ab")
    entered_by(machine, new, NEWER)
    claim = claims_of(machine, NEWER).claim()
    assert claim is not None and claim.id == new.computation
    assert machine.submissions.find(old.id).status == "failed"


def test_a_request_repeated_after_an_upgrade_is_the_same_job(machine: Bench) -> None:
    def named(key: str) -> str:
        return machine.submissions.submit("fake", key, {}, stored=False, name="mine").id

    first = named("a" * 64)
    with pytest.raises(BadInput):
        named("b" * 64)
    with writing(machine.engine) as connection:
        connection.execute(update(computations).values(program=""))
    assert named("b" * 64) == first


@pytest.mark.drawn
@pytest.mark.parametrize("name", [*INPUTS, *(f"{name} of a scene" for name in ("ablate", "frontier"))])
def test_normalized_inputs_are_inputs_of_the_same_work(machine: Bench, name: str) -> None:
    """A job is submitted again with the inputs that it shows: that is the same work."""
    process = default_registry()[name.partition(" ")[0]]
    sent = INPUTS[process.id] if name in INPUTS else {"scene": SCENE}
    put_named_run(machine.store)
    inputs = process.prepare(validated(process.inputs, sent), machine.store)
    assert process.prepare(validated(process.inputs, inputs), machine.store) == inputs
