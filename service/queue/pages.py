"""Pages of lists of jobs, whose work does not grow with the number of jobs.

A line is a narrow row on one job (`service.store.listing`). A page is chosen among the lines, and only its
jobs are read in full. For every wanted state a separate query, a branch, reads the newest lines by an index,
since no index has the time order of several states. Titles and tags have no index: lines are read one by one
until the page is full.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from typing import Any

from sqlalchemy import (
    ColumnElement,
    Connection,
    FromClause,
    Select,
    and_,
    func,
    null,
    select,
    tuple_,
    union_all,
)

from service.queue.job import JobFilter, jobs_of_all_projects
from service.queue.tables import jobs, listings
from service.store.database import instant
from service.store.listing import NEWEST
from service.store.results import Mark, behind

FEW = 300
"""Most lines with a duration within bounds that are sorted by time. With more lines the page is found by the
index in order of time."""


@dataclass(frozen=True)
class PageQuery:
    """Query for a page of a list: jobs of a project, up to `limit`, behind the mark `after`."""

    project: str
    job_filter: JobFilter
    limit: int
    after: Mark | None = None

    def rows(self, connection: Connection) -> Sequence[Any]:
        """Return the rows of the page, the newest first."""
        branches = [branch.subquery() for branch in self._branches(connection)]
        if not branches:
            return []
        page_lines = union_all(*(select(branch.c.job, branch.c.created) for branch in branches)).subquery()
        newest = (page_lines.c.created.desc(), page_lines.c.job.desc())
        page = select(page_lines.c.job).order_by(*newest).limit(self.limit).subquery()
        statement = jobs_of_all_projects().join(page, page.c.job == jobs.c.id)
        return connection.execute(statement.order_by(jobs.c.created.desc(), jobs.c.id.desc())).all()

    def _branches(self, connection: Connection) -> Iterator[Select[Any]]:
        """Yield the newest lines of each state, or of all, within the bounds of the run time."""
        for lines in self._lines(connection):
            for state in self.job_filter.statuses or (None,):
                newest = (lines.c.created.desc(), lines.c.job.desc())
                branch = select(lines.c.job, lines.c.created).where(*self._conditions(lines, state))
                yield branch.order_by(*newest).limit(self.limit)

    def _conditions(self, lines: FromClause, state: str | None) -> list[ColumnElement[bool]]:
        conditions = [*self._in_list(lines), *self._wanted(lines)]
        if state is not None:
            conditions.append(lines.c.state == state)
        if self.job_filter.once:
            conditions.append(self._once(lines))
        if self.after is not None:
            conditions.append(behind(self.after, lines.c.created, lines.c.job))
        return conditions

    def _in_list(self, lines: FromClause) -> tuple[ColumnElement[bool], ...]:
        return lines.c.project == self.project, lines.c.parent == (self.job_filter.parent or "")

    def _wanted(self, lines: FromClause) -> Iterator[ColumnElement[bool]]:
        """Yield the conditions of lines except those on state and run time."""
        job_filter = self.job_filter
        for tag in job_filter.tags:
            yield lines.c.tags.contains(f"\n{tag.lower()}\n", autoescape=True)
        for word in job_filter.words:
            yield lines.c.title_folded.contains(word.casefold(), autoescape=True)
        if len(job_filter.processes) == 1:  # an index has the order of one process
            yield lines.c.process == job_filter.processes[0]
        elif job_filter.processes:
            yield lines.c.process.in_(job_filter.processes)
        if job_filter.earliest is not None:
            yield lines.c.created >= job_filter.earliest
        if job_filter.latest is not None:
            yield lines.c.created <= job_filter.latest

    def _once(self, lines: FromClause) -> ColumnElement[bool]:
        """Return the condition that no other wanted line of the same result is better."""
        if self._wants_all:
            return lines.c.rank == NEWEST
        others = listings.alias()
        conditions = [*self._wanted(others), *self._ran(others), _is_better(others, lines)]
        if self.job_filter.statuses:
            conditions.append(others.c.state.in_(self.job_filter.statuses))
        rivals = select(others.c.job).where(others.c.key == lines.c.key, others.c.parent == lines.c.parent)
        return ~rivals.where(*conditions).exists()

    @property
    def _wants_all(self) -> bool:
        """Whether the filter has no conditions other than the batch."""
        return self.job_filter == JobFilter(parent=self.job_filter.parent, once=True)

    def _lines(self, connection: Connection) -> Iterator[FromClause]:
        """Yield the candidate lines: all, or the ended and running ones within bounds of the run time.

        A few are all read by the index of durations and then sorted. Many are searched in the order of time.
        """
        if not self.job_filter.asks_duration:
            yield listings
            return
        for column, low, high in self._bounds():
            within = select(listings).where(*self._in_list(listings), *_between(column, low, high))
            counted = select(func.count()).select_from(within.limit(FEW + 1).subquery())
            number = connection.execute(counted).scalar_one()
            if 0 < number <= FEW:
                yield within.limit(FEW).subquery()  # with a limit, planners do not merge it into the query
            elif number:
                unindexed = func.coalesce(column, null())  # equal values, but no index on durations
                yield select(listings).where(*_between(unindexed, low, high)).subquery()

    def _bounds(self) -> Iterator[tuple[ColumnElement[Any], Any, Any]]:
        """Yield the bounds of the run time: of ended jobs, and of the start of running ones."""
        shortest, longest = self.job_filter.shortest_s or 0.0, self.job_filter.longest_s
        yield listings.c.seconds, shortest, longest
        latest = _ago(shortest)
        yield listings.c.running_since, None if longest is None else _ago(longest), latest

    def _ran(self, lines: FromClause) -> Iterator[ColumnElement[bool]]:
        """Yield the condition of the run time, if it is bounded."""
        if self.job_filter.asks_duration:
            ended, running = (
                _between(lines.c[column.name], low, high) for column, low, high in self._bounds()
            )
            yield and_(*ended) | and_(*running)


def _is_better(other: FromClause, line: FromClause) -> ColumnElement[bool]:
    """Return the condition that a line comes before another of the same result, in the index by result."""
    # the texts are computed, by + "": from a plain column SQLite would not start within the index
    last = tuple_(line.c.rank, line.c.created + "", line.c.job + "")
    return tuple_(other.c.rank, other.c.created, other.c.job) > last


def _between(column: ColumnElement[Any], low: Any, high: Any) -> list[ColumnElement[bool]]:
    """Return the conditions of a column with a value between two bounds; None is no bound."""
    lowest = column.is_not(None) if low is None else column >= low
    return [lowest] if high is None else [lowest, column <= high]


def _ago(seconds: float) -> str:
    """Return the instant so many seconds ago."""
    return instant(datetime.now(UTC) - timedelta(seconds=seconds))
