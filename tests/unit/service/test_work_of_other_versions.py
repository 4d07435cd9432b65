"""What another version left in the job table: it runs under the name of this one, or says why not."""

import json
from typing import Any

import pytest
from named_run import put_named_run
from running_service import Bench
from sqlalchemy import update

from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas.reading import validated
from service.queue.entry import BatchCase
from service.queue.job import Job
from service.queue.tables import computations
from service.queue.terms import Terms
from service.schemas.examples import INPUTS, SCENE
from service.store.database import now, writing
from service.version import solver_version
from service.webhooks.calls import Calls
from service.worker.process import default_registry

OLDER = "0.0.9"


def entered_by(machine: Bench, job: Job, version: str, **columns: Any) -> Job:
    """Let a job be one that a version entered, which names its result otherwise."""
    values = {"program": version, "key": job.key[::-1], **columns}
    with writing(machine.engine) as connection:
        mine = computations.c.id == job.computation
        connection.execute(update(computations).where(mine).values(**values))
    return job


@pytest.mark.parametrize("version", ["", OLDER])
def test_waiting_work_of_an_older_version_keeps_its_identifier_and_runs(machine, version):
    jobs = [entered_by(machine, machine.submit(text=text), version) for text in "ab"]
    left = machine.settings.data_directory / "work" / jobs[0].computation
    left.mkdir(parents=True)
    (left / "result.nc").write_text("a block of another solver")
    machine.scheduler.start()
    ended = [machine.ended(job) for job in jobs]
    assert [(job.status, job.attempts, job.key) for job in ended] == [
        ("successful", 1, job.key) for job in jobs
    ]
    assert [machine.store.verified(job.key, "database").path.read_text() for job in jobs] == ["a", "b"]


def test_what_an_older_version_ran_runs_again(machine):
    job = machine.submit(text="a")
    machine.claims.put_back(machine.claimed(), "The worker was ended by SIGKILL.", counted=True)
    machine.claimed()  # for its last attempt
    entered_by(machine, job, OLDER)
    machine.scheduler.start()
    assert (machine.ended(job).status, machine.ended(job).attempts) == ("successful", 2)


def test_work_that_this_version_refuses_ends_with_field_and_reason(machine):
    refused = {"wish": {"mode": "write", "text": "a", "number": 11.0}}
    one, gone, good = (machine.submit(text=text) for text in ("one", "gone", "good"))
    entered_by(machine, one, OLDER, inputs=json.dumps(refused))
    entered_by(machine, gone, OLDER, process="forgotten")
    machine.scheduler.start()
    found = machine.ended(one)
    assert (found.status, found.attempts, found.started) == ("failed", 0, None)
    assert found.message.startswith(f"Version {OLDER} entered the job; {solver_version()} refuses it: ")
    assert [(fault["field"], fault["value"]) for fault in found.faults] == [("wish.number", 11.0)]
    assert "There is no process 'forgotten'." in machine.ended(gone).message
    assert machine.ended(good).status == "successful"


def test_a_field_that_is_gone_is_forgiven_where_the_caller_did_not_state_it(machine):
    """Normalized inputs name every field of their version."""
    stated = {"wish": {"text": "as stated"}}
    former = {"wish": {"mode": "write", "text": "as stated", "number": 0.0, "color": "red"}}
    terms = Terms(stated=json.dumps(stated))
    job = machine.submissions.submit("fake", "c" * 64, former, stored=False, terms=terms)
    entered_by(machine, job, OLDER)
    other = entered_by(machine, machine.submit(text="b"), OLDER, inputs=json.dumps(former))
    machine.scheduler.start()
    assert machine.ended(job).status == "successful"
    assert machine.store.verified(machine.ended(job).key, "database").path.read_text() == "as stated"
    assert [fault["field"] for fault in machine.ended(other).faults] == ["wish.color"]


def test_renewed_work_joins_its_equal_of_this_version(machine):
    """Also one that has the result already; priority and limit are those of the more generous."""
    older = [
        entered_by(machine, machine.submit(text="same"), version, key=key * 64)
        for version, key in ((OLDER, "a"), ("", "b"))
    ]
    with writing(machine.engine) as connection:
        mine = computations.c.id == older[0].computation
        connection.execute(update(computations).where(mine).values(priority=3))
    newer = machine.submit(text="same")
    claim = machine.claims.claim()
    assert claim is not None and claim.program == OLDER
    for _ in range(2):  # a step that is repeated changes nothing
        machine.scheduler._renewal.renew(claim)
    assert machine.submissions.find(older[0].id).computation == newer.computation
    assert machine.submissions.find(newer.id).priority == 3
    machine.scheduler.start()
    assert {machine.ended(job).status for job in (*older, newer)} == {"successful"}
    assert len(machine.starts(newer)) == 1


def test_a_batch_of_an_older_version_is_done_and_who_subscribed_is_told(machine):
    cases = [BatchCase(key * 64, {"wish": {"text": key}}) for key in "ab"]
    batch = machine.submissions.entry().batch("fake", cases, now())
    for job in machine.submissions.children(batch):
        entered_by(machine, job, OLDER, key=job.key)
    calls = Calls(machine.engine)
    calls.enter(batch, {"success": "https://hooks.example/"})
    machine.scheduler.start()
    found = machine.ended(machine.submissions.find(batch))
    assert (found.status, found.message) == ("successful", "2 of 2 jobs have ended.")
    call = calls.claim()
    assert call is not None and (call.job, call.event) == (batch, "success")


def test_work_of_one_name_in_both_versions_goes_on_for_who_submits_it_to_the_newer(machine):
    """A table has the same hash in all versions with one solver: its end would end the new job too."""
    older = machine.submit(text="same")
    entered_by(machine, older, OLDER, key=older.key)
    newer = machine.submit(text="same")
    assert newer.computation == older.computation
    claim = machine.claims.claim()
    assert claim is not None and (claim.id, claim.program) == (older.computation, solver_version())


def test_a_request_repeated_after_an_upgrade_is_the_same_job(machine):
    def named(key):
        return machine.submissions.submit("fake", key, {}, stored=False, name="mine").id

    first = named("a" * 64)
    with pytest.raises(BadInput):
        named("b" * 64)
    with writing(machine.engine) as connection:
        connection.execute(update(computations).values(program=""))
    assert named("b" * 64) == first


@pytest.mark.drawn
@pytest.mark.parametrize("name", [*INPUTS, *(f"{name} of a scene" for name in ("ablate", "frontier"))])
def test_normalized_inputs_are_inputs_of_the_same_work(machine, name):
    """A job is submitted again with the inputs that it shows: that is the same work."""
    process = default_registry()[name.partition(" ")[0]]
    sent = INPUTS[process.id] if name in INPUTS else {"scene": SCENE}
    put_named_run(machine.store)
    inputs = process.prepare(validated(process.inputs, sent), machine.store)
    assert process.prepare(validated(process.inputs, inputs), machine.store) == inputs
