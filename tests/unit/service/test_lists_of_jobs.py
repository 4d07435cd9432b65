"""Lists of jobs: what the database keeps for them is right after any history; their work does not grow."""

import random
import uuid
from collections.abc import Callable, Sequence
from datetime import UTC, datetime, timedelta
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from alembic.migration import MigrationContext
from alembic.operations import Operations
from running_service import Bench
from sqlalchemy import Connection, delete, event, select, text, update

from service.queue.entry import BatchCase
from service.queue.job import Job, JobFilter, job_of, jobs_of_all_projects
from service.queue.submissions import Submissions
from service.queue.tables import computations, jobs, listings
from service.queue.terms import Label, Terms
from service.store import listing, migrations
from service.store.database import instant, now, open_database, reading, writing
from service.store.results import Mark


@pytest.fixture(scope="module", autouse=True)
def migrated_once():
    """Let migrations make all tables: an upgrade is part of what is tested here."""


# What a list shows, by a look at every job.


def lasted(job: Job, wanted: JobFilter) -> bool:
    """Whether the time a job has run is within bounds."""
    if not wanted.asks_duration:
        return True
    if job.started is None:
        return False
    end = datetime.now(UTC) if job.finished is None else datetime.fromisoformat(job.finished)
    seconds = (end - datetime.fromisoformat(job.started)).total_seconds()
    return (wanted.shortest_s or 0.0) <= seconds <= (wanted.longest_s or float("inf"))


def matches(job: Job, wanted: JobFilter) -> bool:
    return (
        job.parent == wanted.parent
        and set(wanted.tags) <= set(job.label.tags)
        and all(word.casefold() in job.label.title.casefold() for word in wanted.words)
        and (not wanted.statuses or job.status in wanted.statuses)
        and (not wanted.processes or job.process in wanted.processes)
        and (wanted.earliest or "") <= job.created <= (wanted.latest or "9")
        and lasted(job, wanted)
    )


def expected(machine: Bench, wanted: JobFilter) -> list[str]:
    """Return the identifiers of the wanted jobs, the newest first."""
    with reading(machine.engine) as connection:
        every = [job_of(row) for row in connection.execute(jobs_of_all_projects())]
    found = [job for job in every if matches(job, wanted)]
    if wanted.once:
        by_rank = sorted(found, key=lambda j: (j.status not in ("failed", "dismissed"), j.created, j.id))
        found = list({job.key if not job.children else job.id: job for job in by_rank}.values())
    return [job.id for job in sorted(found, key=lambda job: (job.created, job.id), reverse=True)]


def paged(machine: Bench, wanted: JobFilter, size: int) -> list[str]:
    """Return the identifiers of a list, read page by page."""
    names: list[str] = []
    after: Mark | None = None
    while page := machine.submissions.page(size, wanted, after):
        names += [job.id for job in page]
        after = Mark(page[-1].created, page[-1].id)
    return names


# Histories: jobs of few results, alone and in batches, that end in each way, are dismissed and go.


class History:
    """Changes of a job table, drawn by a seed."""

    def __init__(self, machine: Bench, seed: int) -> None:
        self._machine, self._random = machine, random.Random(seed)
        self._actions: Sequence[Callable[[], None]] = (
            *[self._submit] * 4,
            *[self._work] * 6,
            self._batch,
            self._dismiss,
            self._relabel,
            self._forget,
            self._set_back,
        )

    def go_on(self, steps: int) -> None:
        for _ in range(steps):
            self._random.choice(self._actions)()

    def _case(self) -> BatchCase:
        number = self._random.randrange(6)
        return BatchCase(f"{number:064x}", {"wish": {"number": number}})

    def _label(self) -> Label:
        return Label.of(self._random.choice(["", "Großes Rad", "small pinion"]), self._random.sample("ab", 1))

    def _submit(self) -> None:
        case, terms = self._case(), Terms(label=self._label())
        process = self._random.choice(["fake", "other"])
        key = case.key if process == "fake" else case.key[::-1]
        self._machine.submissions.submit(process, key, case.inputs, stored=False, terms=terms)

    def _batch(self) -> None:
        cases = [self._case() for _ in range(self._random.randrange(2, 5))]
        self._machine.submissions.entry().batch("fake", cases, now())

    def _work(self) -> None:
        claims = self._machine.claims
        claim = claims.claim()
        end = self._random.randrange(4)
        if claim is not None and end == 0:
            claims.fail(claim, "no mesh")
        elif claim is not None and end == 1:
            claims.put_back(claim, "again", counted=True)
        elif claim is not None and end == 2:
            claims.succeed(claim)
        claims.advance_batches()

    def _any_job(self) -> str | None:
        with reading(self._machine.engine) as connection:
            names = list(connection.execute(select(jobs.c.id).order_by(jobs.c.created)).scalars())
        return self._random.choice(names) if names else None

    def _dismiss(self) -> None:
        if (name := self._any_job()) is not None:
            self._machine.submissions.dismiss(name)

    def _relabel(self) -> None:
        if (name := self._any_job()) is not None:
            label = self._label()
            self._machine.submissions.relabel(name, label.title, label.tags)

    def _forget(self) -> None:
        name = self._any_job()
        with writing(self._machine.engine) as connection:
            connection.execute(delete(jobs).where(jobs.c.id == name))

    def _set_back(self) -> None:
        """Let some computations have begun earlier; no bound of `FILTERS` is passed while this runs."""
        before = datetime.now(UTC) - timedelta(seconds=self._random.choice([0.000_321, 3.5, 200.25, 9000.0]))
        some = computations.c.started.is_not(None) & (computations.c.id < f"{self._random.randrange(16):x}")
        with writing(self._machine.engine) as connection:
            connection.execute(update(computations).where(some).values(started=instant(before)))


FILTERS = [
    JobFilter(),
    JobFilter(once=True),
    JobFilter(statuses=("failed", "dismissed")),
    JobFilter(statuses=("failed", "accepted"), once=True),
    JobFilter(processes=("fake",), once=True),
    JobFilter(processes=("fake", "other")),
    JobFilter(words=("GROSSES",), once=True),
    JobFilter(tags=("a",), once=True),
    JobFilter(shortest_s=60.0),
    JobFilter(longest_s=60.0, once=True),
    JobFilter(shortest_s=60.0, longest_s=2000.0, statuses=("successful", "running")),
]


@pytest.mark.parametrize("few", [0, 300])
def test_lists_are_those_of_a_look_at_every_job_after_any_history(machine, monkeypatch, few):
    """By either index of durations; page by page."""
    monkeypatch.setattr("service.queue.pages.FEW", few)
    history = History(machine, seed=few + 1)
    for _ in range(4):
        history.go_on(25)
        with reading(machine.engine) as connection:
            batches = connection.execute(select(jobs.c.id).where(jobs.c.children > 0)).scalars().all()
        within = [JobFilter(parent=name, once=once) for name in batches for once in (False, True)]
        for wanted in (*FILTERS, *within):
            assert paged(machine, wanted, 3) == expected(machine, wanted), wanted
    assert all(expected(machine, wanted) for wanted in FILTERS), "each list shows something"


def lines(connection: Connection) -> list[tuple[Any, ...]]:
    return [tuple(row) for row in connection.execute(select(listings).order_by(listings.c.job))]


def test_an_upgrade_makes_the_lines_that_the_database_keeps(machine):
    History(machine, seed=5).go_on(80)
    with writing(machine.engine) as connection:
        kept = lines(connection)
        dialect = connection.dialect.name
        for trigger in listing._triggers(dialect):
            table = trigger.event.rpartition(" ")[2]
            connection.execute(
                text(f"DROP TRIGGER {trigger.name}" + (f" ON {table}" if dialect != "sqlite" else ""))
            )
            if dialect != "sqlite":
                connection.execute(text(f"DROP FUNCTION loa_{trigger.name}()"))
        connection.execute(text("DROP TABLE listing"))
        listing.add_listing(Operations(MigrationContext.configure(connection)))
        assert lines(connection) == kept
        assert {line[listings.c.keys().index("rank")] for line in kept} == {0, 1, 2}


# The work of lists: instructions of SQLite's machine, which follow the rows and pages that it looks at.


FILLED = """
WITH RECURSIVE number(n) AS (SELECT 0 UNION ALL SELECT n + 1 FROM number WHERE n + 1 < :count)
INSERT INTO computation (id, process, key, inputs, state, created, started, finished, updated,
    stage, stage_fraction, fraction, message, faults, reference, attempts)
SELECT printf('%08x-0000-4000-8000-000000000000', n), iif(n = 9, 'other', 'fake'),
    printf('%064x', min(n, :count - :count / 20)), '{"wish": {}}',
    iif(n % (:count / 5) = 3, 'failed', 'successful'),
    strftime('%Y-%m-%dT%H:%M:%S.000000Z', '2026-01-01', '+' || n || ' seconds'),
    '2026-02-01T00:00:00.000000Z',
    strftime('%Y-%m-%dT%H:%M:%S.000000Z', '2026-02-01', '+' || iif(n < 20, 9000, n % 97) || ' seconds'),
    '2026-03-01', '', 0, 1, '', '[]', '', 1 FROM number
"""
ENTERED = """
INSERT INTO job (id, computation_id, created, delivery, parent)
SELECT id, id, created, 'raw value', iif(key < printf('%064x', 50), 'b', NULL) FROM computation
"""


def filled(file: Path, count: int) -> Submissions:
    """Return jobs of a database with so many of them, the newest twentieth of one result.

    They are upgraded from the schema without lines.
    """
    former = dict(list(migrations.STEPS.items())[: migrations.REVISIONS.index("0017")])
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(migrations, "STEPS", former)
        patch.setattr("service.store.database.REVISIONS", tuple(former))
        engine = open_database(file)
    with writing(engine) as connection:
        connection.execute(text(FILLED), {"count": count})
        connection.execute(text(ENTERED))
    engine.dispose()
    return Submissions(open_database(file), 100)


@pytest.fixture(scope="module")
def small_and_large(tmp_path_factory):
    folder = tmp_path_factory.mktemp("growth")
    small, large = (filled(folder / f"{count}.sqlite3", count) for count in (10_000, 100_000))
    yield small, large
    for made in (small, large):
        made._engine.dispose()


def work_of(submissions: Submissions, ask: Callable[[], object]) -> int:
    """Return the instructions of SQLite that a question takes, in tens."""
    tens = [0]

    def count():
        tens[0] += 1
        return 0

    def counted(connection, _record):
        connection.set_progress_handler(count, 10)

    event.listen(submissions._engine, "connect", counted)
    try:
        ask()
    finally:
        event.remove(submissions._engine, "connect", counted)
    return tens[0]


MIDDLE = Mark("2026-01-01T01:00:00.000000Z", str(uuid.UUID(int=0)))


@pytest.mark.parametrize(
    ("wanted", "after"),
    [
        (JobFilter(), None),
        (JobFilter(), MIDDLE),
        (JobFilter(once=True), None),
        (JobFilter(once=True, parent="b"), None),
        (JobFilter(statuses=("failed",)), None),
        (JobFilter(statuses=("failed", "dismissed", "running")), MIDDLE),
        (JobFilter(statuses=("failed",), once=True), None),
        (JobFilter(processes=("other",)), None),
        (JobFilter(processes=("other",), once=True), None),
        (JobFilter(shortest_s=5000.0), None),
        (JobFilter(shortest_s=50_000.0), None),
        (JobFilter(shortest_s=50.0), None),
        (JobFilter(longest_s=50.0), None),
        (JobFilter(shortest_s=50.0, statuses=("successful",)), MIDDLE),
    ],
    ids=str,
)
def test_the_work_of_a_list_does_not_grow(small_and_large, wanted, after):
    """From 10 000 jobs to 100 000: a look at each would be ten times the work."""
    small, large = (work_of(made, partial(made.page, 13, wanted, after)) for made in small_and_large)
    assert 0 < large < 1.3 * small + 20
    assert large < 10_000, "a tenth of an instruction a job"


def test_the_work_of_a_submission_does_not_grow(small_and_large):
    """The computation that an equal one shares is found among all by an index."""
    work = ("fake", "f" * 64, {"wish": {}})
    numbers = [work_of(made, partial(made.submit, *work, stored=False)) for made in small_and_large]
    assert 0 < numbers[1] < 1.3 * numbers[0] + 20
