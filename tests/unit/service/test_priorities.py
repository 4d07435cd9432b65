"""Turns of jobs: the oldest of the highest priority is next, shared work has its highest; bounds of keys."""

import pytest
from running_service import Bench

from lineofaction.gearbox.problems import BadInput
from service.access.holder import Holder
from service.access.key_file import KeyFile
from service.queue.job import Job
from service.queue.terms import KEYLESS_CALLER, Terms, check_priority


def entered(machine: Bench, text: str, priority: int = 0) -> Job:
    inputs = {"wish": {"text": text}}
    return machine.submissions.submit("fake", text, inputs, stored=False, terms=Terms(priority=priority))


def turns(machine: Bench) -> str:
    claims = iter(machine.claims.claim, None)
    return "".join(claim.key for claim in claims if claim is not None)


def test_the_oldest_of_the_highest_is_next(machine):
    for text, priority in (("a", 0), ("b", -3), ("c", 2), ("d", 0), ("e", 2), ("f", -9)):
        assert entered(machine, text, priority).priority == priority
    assert turns(machine) == "ceadbf"


def test_a_job_that_waits_says_behind_how_many(machine):
    first, urgent, low = entered(machine, "a"), entered(machine, "b", 2), entered(machine, "c", -1)
    shared = entered(machine, "a")

    def ahead():
        listed = {job.id: job.ahead for job in machine.submissions.page(9)}
        single = {name: machine.submissions.find(name).ahead for name in listed}
        assert single == listed
        return [listed[job.id] for job in (urgent, first, shared, low)]

    assert ahead() == [0, 1, 1, 2]
    claim = machine.claimed()
    assert ahead() == [None, 1, 1, 2]  # what runs is waited for
    machine.claims.succeed(claim)
    machine.submissions.dismiss(shared.id)
    assert ahead() == [None, 0, None, 1]


def test_shared_work_has_the_highest_priority_of_its_jobs(machine):
    low = entered(machine, "a", -1)
    entered(machine, "b", 1)
    entered(machine, "a", 2)
    assert entered(machine, "a", 0).priority == machine.submissions.find(low.id).priority == 2
    assert turns(machine) == "ab"


def test_work_that_is_put_back_keeps_its_turn(machine):
    entered(machine, "a")
    entered(machine, "b", 3)
    claim = machine.claimed()
    machine.claims.put_back(claim, "Waits.", counted=False)
    assert turns(machine) == "ba"


def test_a_key_bounds_the_priority(tmp_path):
    file = KeyFile(tmp_path / "keys.json")
    file.add("ann", highest_priority=-2)
    with pytest.raises(BadInput, match="at least -9"):
        file.add("ben", highest_priority=-10)
    (key,) = file.read()
    caller = Holder(name=key.name, highest_priority=key.highest_priority)
    check_priority(-2, caller)
    check_priority(9, KEYLESS_CALLER)
    with pytest.raises(BadInput, match="at most -2, the limit of key 'ann'"):
        check_priority(-1, caller)
