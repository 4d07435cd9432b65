"""Projects: each computes, keeps, finds and lists its own, whatever others have."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import h5py
import pytest
from running_service import Bench, bench
from service_fakes import REGISTRY
from small_table import small_table
from sqlalchemy import text

from lineofaction.gearbox.problems import NoSuchJob, NotFound
from lineofaction.gearbox.schemas.reading import validated
from lineofaction.gearbox.schemas.scene import SceneInput
from service.access.holder import Holder
from service.project import COMMON, PROJECT, address_of, at_address
from service.queue.attempt import begun
from service.queue.claims import Claim
from service.queue.job import Job
from service.queue.worker_figures import WorkerFigures
from service.schemas.examples import SCENE
from service.store.database import writing
from service.store.deployment import Deployment
from service.store.files import ResultName, new_name
from service.store.maintenance import verify_store
from service.store.reindex import reindex
from service.store.results import Mark
from service.worker.order import WorkOrder
from service.worker.process import SIMULATE
from service.worker.simulation_work import _table

KEY = "ab" * 32
PROJECTS = (COMMON, "axle", "drum")


def enter(machine: Bench, project: str, name: str | None = None, wish: str = "same") -> Job:
    """Enter work for a project, as the execution route does."""
    inputs = {"wish": {"mode": "write", "text": wish, "number": 0.0}}
    key = REGISTRY["fake"].key(inputs)
    stored = machine.store.within(project).find(key, "database") is not None
    jobs, bench_3 = machine.submissions.within(project), Holder(name="bench-3")
    return jobs.submit("fake", key, inputs, stored=stored, name=name, caller=bench_3)


def file_with(machine: Bench, content: str) -> Path:
    file = machine.settings.data_directory / "product.nc"
    file.write_text(content)
    return file


@pytest.mark.parametrize("project", PROJECTS)
def test_an_address_is_read_as_it_was_written(project):
    assert at_address(address_of(project, KEY)) == (project, KEY)
    name = new_name(project, KEY, "database", "12" * 32)
    assert ResultName.of(name) == ResultName("database", KEY, "12" * 8, project)


@pytest.mark.parametrize("name", ["", "A", "a.b", "a/b", "..", "a" * 64, "-a", "a b", "ä"])
def test_a_name_that_could_be_part_of_another_address_is_none(name):
    assert PROJECT.fullmatch(name) is None


def test_equal_work_is_one_computation_a_project(machine):
    jobs = [enter(machine, project) for project in PROJECTS for _ in range(2)]
    assert machine.submissions.counts() == {"accepted": len(PROJECTS)}
    assert len({job.computation for job in jobs}) == len(PROJECTS)
    assert len({job.key for job in jobs}) == 1, "callers see the hash of their input"
    claims = [machine.claims.claim() for _ in PROJECTS]
    assert [claim and claim.project for claim in claims] == list(PROJECTS)
    assert {claim and claim.key for claim in claims} == {jobs[0].key}


def test_a_result_of_another_project_answers_nobody_at_once(machine):
    machine.scheduler.start()
    first = enter(machine, "axle")
    assert _ended(machine, "axle", first).status == "successful"
    assert enter(machine, "axle").status == "successful", "the project has it"
    other = enter(machine, "drum")
    assert other.status == "accepted"
    assert _ended(machine, "drum", other).status == "successful"
    assert len(machine.starts(first)) == 2
    lines = [machine.store.within(project).find(first.key, "database") for project in ("axle", "drum")]
    assert lines[0] and lines[1] and lines[0].file != lines[1].file
    assert machine.store.find(first.key, "database") is None, "the common project has none"


def _ended(machine: Bench, project: str, job: Job) -> Job:
    jobs = SimpleNamespace(submissions=machine.submissions.within(project))
    return Bench.ended(jobs, job)


def test_jobs_are_found_listed_and_dismissed_in_their_project_alone(machine):
    job = enter(machine, "axle")
    for project in (COMMON, "drum"):
        jobs = machine.submissions.within(project)
        assert jobs.page(10) == []
        for call in (jobs.find, jobs.dismiss):
            with pytest.raises(NoSuchJob):
                call(job.id)
    mine = machine.submissions.within("axle")
    assert [found.id for found in mine.page(10)] == [job.id]
    assert mine.dismiss(job.id).status == "dismissed"


def test_a_name_of_a_request_is_that_of_a_project(machine):
    jobs = [enter(machine, project, "request-1") for project in PROJECTS]
    assert len({job.id for job in jobs}) == len(PROJECTS)
    assert [enter(machine, project, "request-1").id for project in PROJECTS] == [job.id for job in jobs]


def test_results_are_listed_page_by_page_in_their_project(machine):
    keys = [f"{number:064x}" for number in range(5)]
    for project in PROJECTS:
        for key in keys:
            machine.store.within(project).put(key, "database", file_with(machine, project + key))
    for project in PROJECTS:
        store, seen, last = machine.store.within(project), [], None
        while page := store.page("database", 2, last):
            seen += [line for _, line in page]
            last = page[-1][0]
            assert isinstance(last, Mark) and "." not in last.name, "a cursor names no project"
        assert [line.key for line in seen] == keys[::-1]
        assert {line.project for line in seen} == {project}
        assert [store.verified(key, "database").path.read_text() for key in keys] == [
            project + k for k in keys
        ]


def test_upkeep_is_of_all_projects(machine):
    for project in PROJECTS:
        file = file_with(machine, "")
        with h5py.File(file, "w") as content:
            content.attrs["project"] = project
        machine.store.within(project).put(KEY, "database", file)
    assert verify_store(machine.store).sound == len(PROJECTS)
    with writing(machine.engine) as connection:
        connection.execute(text("DELETE FROM result"))
    rebuilt = reindex(machine.store, Deployment(machine.engine, machine.store))
    assert (rebuilt.entered, rebuilt.damaged, rebuilt.doubled) == (len(PROJECTS), (), ())
    for project in PROJECTS:
        with h5py.File(machine.store.within(project).verified(KEY, "database").path) as content:
            assert content.attrs["project"] == project
    lines = {line.project: line for line in machine.store.lines()}
    machine.store.strike(lines["axle"])
    found = [machine.store.within(project).find(KEY, "database") is not None for project in PROJECTS]
    assert found == [True, False, True]


def test_a_job_is_compared_with_former_ones_of_its_project(machine):
    job = enter(machine, "axle")
    found = [
        machine.submissions.within(project).newest(Holder(name="bench-3"), "fake") for project in PROJECTS
    ]
    assert [former and former[0] for former in found] == [None, job.id, None]


def test_what_a_former_program_enters_is_common(machine):
    """It names no column of ours."""
    machine.store.put(KEY, "database", file_with(machine, "former"))
    with writing(machine.engine) as connection:
        connection.execute(
            text(
                "INSERT INTO result (key, kind, sha256, size, created, file, used) "
                "SELECT 'cd' || substr(key, 3), kind, sha256, size, created, file, used FROM result"
            )
        )
        row = connection.execute(text("SELECT id FROM job")).all()
        assert row == []
    assert [line.key[:2] for _, line in machine.store.page("database", 9)] == ["cd", "ab"]
    assert machine.store.within("axle").page("database", 9) == []


def test_a_job_reads_tables_of_its_project_alone(tmp_path):
    machine = bench(tmp_path, REGISTRY)
    file = tmp_path / "table.nc"
    small_table().to_netcdf(file)
    machine.store.within("axle").put(KEY, "database", file)
    mesh: Any = SimpleNamespace(case=None, database_hash=KEY)
    of_table = {name: value for name, value in SCENE["meshes"][0].items() if name != "case"}
    scene = validated(SceneInput, {**SCENE, "meshes": [{**of_table, "database_hash": KEY}]})
    claim = Claim("c", "simulate", "k", {"scene": scene.model_dump(mode="json")}, 1)

    def table(project):
        orders: list[WorkOrder] = []
        crew: Any = SimpleNamespace(
            begin=lambda order, *_: orders.append(order) or SimpleNamespace(log_fields={})
        )
        mine = replace(claim, project=project)
        begun(machine.settings, SIMULATE, mine, crew, machine.store, WorkerFigures())
        return _table(WorkOrder.from_line(orders[0].line()), 0, mesh, [], lambda _fraction: None)

    assert table("axle").geometry == small_table().geometry
    for project in (COMMON, "drum"):
        with pytest.raises(NotFound):
            table(project)
    machine.close()
