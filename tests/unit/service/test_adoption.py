"""Two versions of the program on one job table: no result gets the other's name, and no job is lost."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from named_run import put_named_run
from running_service import Bench, bench
from service_fakes import FAKE, REGISTRY
from sqlalchemy import update

from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas.reading import validated
from service.queue.adoption import Adoption
from service.queue.claims import Claim, Claims
from service.queue.tables import computations
from service.schemas.request_examples import INPUTS, SCENE
from service.store import writing
from service.version import solver_version
from service.worker.catalogue import default_registry
from service.worker.process import Registry

NEWER, OLDER = "9.0.0", "0.0.9"


@pytest.fixture
def machine(tmp_path: Path, database_url: str | None) -> Iterator[Bench]:
    """The table without a running scheduler, on each database; its jobs are of the installed version."""
    found = bench(tmp_path, REGISTRY, database_url=database_url)
    yield found
    found.close()


def of_version(monkeypatch: pytest.MonkeyPatch, version: str) -> None:
    """Let results be named as this version of the program names them."""
    monkeypatch.setattr("service.worker.process.solver_version", lambda: version)


def adoption(machine: Bench, version: str, registry: Registry = REGISTRY) -> Adoption:
    """Return what a scheduler of a version takes computations over with."""
    claims = Claims(machine.engine, version, 60.0, version)
    return Adoption(claims, registry, machine.store, machine.settings.data_directory / "work")


def taken(by: Adoption) -> Claim | None:
    """Claim and adopt."""
    claim = by.claims.claim()
    return None if claim is None else by.adopted(claim)


def test_a_newer_program_names_older_work_anew(machine: Bench, monkeypatch: pytest.MonkeyPatch) -> None:
    job = machine.submit(text="a")
    left = machine.settings.data_directory / "work" / job.computation
    left.mkdir(parents=True)
    of_version(monkeypatch, NEWER)
    claim = taken(adoption(machine, NEWER))
    assert claim is not None
    seen = machine.submissions.find(job.id)
    assert claim.key == seen.key == FAKE.key(json.loads(seen.inputs)) != job.key
    assert (seen.status, claim.id, claim.program) == ("running", job.computation, NEWER)
    assert not left.exists()  # what an older solver has begun is not continued


def test_own_work_stays_as_it_is(machine: Bench) -> None:
    job = machine.submit(text="a")
    claim = taken(adoption(machine, solver_version()))
    assert claim is not None and claim.key == job.key


def test_an_older_program_leaves_newer_work(machine: Bench) -> None:
    newer = machine.submit(text="newer")
    older = machine.submit(text="older")
    with writing(machine.engine) as connection:
        mine = computations.c.id == older.computation
        connection.execute(update(computations).where(mine).values(program=OLDER))
    by = adoption(machine, OLDER)
    claim = taken(by)
    assert claim is not None and claim.id == older.computation
    assert by.claims.claim() is None
    assert machine.submissions.find(newer.id).status == "accepted"


def test_equal_work_of_two_versions_becomes_one(machine: Bench, monkeypatch: pytest.MonkeyPatch) -> None:
    old = machine.submit(text="same")
    of_version(monkeypatch, NEWER)
    new = machine.submit(text="same")
    assert old.computation != new.computation
    assert taken(adoption(machine, NEWER)) is None
    found = machine.submissions.find(old.id)
    assert (found.computation, found.key) == (new.computation, new.key)
    assert machine.submissions.counts() == {"accepted": 1}


def test_the_former_name_is_free_for_servers_of_the_older_version(
    machine: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    first = machine.submit(text="same")
    with monkeypatch.context() as newer:
        of_version(newer, NEWER)
        taken(adoption(machine, NEWER))
    second = machine.submit(text="same")
    assert second.computation != first.computation
    of_version(monkeypatch, NEWER)
    assert taken(adoption(machine, NEWER)) is None
    assert machine.submissions.find(second.id).computation == first.computation


def test_work_that_the_newer_version_refuses_fails_with_the_reason(machine: Bench) -> None:
    job = machine.submit(text="a")

    def refuse(_inputs: object, _store: object) -> dict[str, Any]:
        raise BadInput.of("text", "a", "at least two letters")

    strict = Registry(replace(FAKE, prepare=refuse))
    assert taken(adoption(machine, NEWER, strict)) is None
    found = machine.submissions.find(job.id)
    assert found.status == "failed" and found.faults[0]["field"] == "text"
    assert "9.0.0 of the program refuses this job of an older one" in found.message


def test_a_request_repeated_at_a_server_of_another_version_is_the_same_job(machine: Bench) -> None:
    def named(key: str) -> str:
        return machine.submissions.submit("fake", key, {}, stored=False, name="mine").id

    first = named("a" * 64)
    with pytest.raises(BadInput):
        named("b" * 64)
    with writing(machine.engine) as connection:
        connection.execute(update(computations).values(program=""))
    assert named("b" * 64) == first


@pytest.mark.parametrize("name", [*INPUTS, *(f"{name} of a scene" for name in ("ablate", "frontier"))])
def test_normalized_inputs_are_inputs_of_the_same_work(machine: Bench, name: str) -> None:
    """What is adopted is prepared again: that must change nothing where the versions agree."""
    process = default_registry()[name.partition(" ")[0]]
    sent = INPUTS[process.id] if name in INPUTS else {"scene": SCENE}
    put_named_run(machine.store)
    inputs = process.prepare(validated(process.inputs, sent), machine.store)
    assert process.prepare(validated(process.inputs, inputs), machine.store) == inputs
