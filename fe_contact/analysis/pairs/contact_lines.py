"""Lines of a table, cut into blocks for workers and put together again.

A line is one center distance at some misalignments: they share the compliance between the candidates, which
costs most. It is cut between positions (see `contact_block`), by what its blocks are predicted to cost: by
the case alone, not by who works.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, fields, is_dataclass, replace
from itertools import groupby
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from fe_contact.analysis.pairs.pair_contact import Bodies, PairContact
from fe_contact.contact import (
    Candidates,
    ContactModel,
    ContactProblem,
    ContactSolution,
    Start,
    solve_contact,
)
from fe_contact.contact.problem import condition_numbers
from fe_contact.geometry import ParallelAxes
from fe_contact.planning.cost_model import unit_work
from fe_contact.planning.plan import Plan
from fe_contact.types import FloatArray, IntArray
from fe_contact.workers import Workers
from model_studies.progress import Report, unreported

# Some positions of a line of the table: the task that workers are given.


@dataclass(frozen=True)
class _ContactBlock:
    """One block.

    Attributes
    ----------
    pair : GearPair or InternalGearPair
        At the center distance of the line.
    plan : Plan
    candidates : Candidates
        Of plain involutes at the positions of the block.
    models : tuple of ContactModel
        Of the misalignments; they share one compliance.
    pitches : ndarray of int, shape (T,), or None
        Whole base pitches to put the positions into, as `PairContact.solve` takes them.
    loads : tuple of ndarray
        Sets of normal forces in N; each is solved by itself.
    conditioned : bool
        Whether condition numbers are wanted.
    starts : tuple of ndarray, shape (rows, L, n), optional
        Forces in N on the candidates that each model starts from; default: each load from the one below it.
    assembled : ContactProblem, optional
        Of the candidates, with the compliance between them, where that is known: it need not be assembled.
    """

    pair: ParallelAxes
    plan: Plan
    candidates: Candidates
    models: tuple[ContactModel, ...]
    pitches: IntArray | None
    loads: tuple[FloatArray, ...]
    conditioned: bool = False
    starts: tuple[FloatArray, ...] | None = None
    assembled: ContactProblem | None = None

    @property
    def pitch(self) -> IntArray | None:
        """The base pitch of every row."""
        return None if self.pitches is None else np.repeat(self.pitches, self.candidates.position.size)

    def start(self, model: int) -> Start | None:
        """Return what the solution of a model is started from."""
        return None if self.starts is None else Start(self.candidates, self.starts[model])


@dataclass(frozen=True)
class _SolvedBlock:
    """The solution at the positions of a block.

    Attributes
    ----------
    problems : tuple of ContactProblem
        Of each model.
    solutions : tuple of tuple of ContactSolution
        Of each model, for each set of loads.
    condition : ndarray or None
        Condition numbers of the compliance at the positions, if they were wanted.
    """

    problems: tuple[ContactProblem, ...]
    solutions: tuple[tuple[ContactSolution, ...], ...]
    condition: FloatArray | None


def _solve_block(bodies: Bodies, block: _ContactBlock) -> _SolvedBlock:
    """Assemble and solve a block: one task."""
    contact = PairContact.of_bodies(block.pair, block.plan, bodies)
    if block.assembled is None:
        contact.assemble(block.models[0], block.candidates)
    else:
        contact.take(block.models[0], block.assembled)
    where, pitch = block.candidates.position, block.pitch
    problems = tuple(contact.problem(model, where, pitch) for model in block.models)
    solutions = tuple(
        tuple(solve_contact(problem, load, block.start(k)) for load in block.loads)
        for k, problem in enumerate(problems)
    )
    condition = condition_numbers(problems[0].compliance) if block.conditioned else None
    return _SolvedBlock(problems, solutions, condition)


def _deflect_block(bodies: Bodies, block: _ContactBlock) -> tuple[tuple[FloatArray, ...], ...]:
    """Return the STE (rows, L) in m of each model for each set of loads alone: one task."""
    solved = _solve_block(bodies, block).solutions
    return tuple(tuple(solution.deflection for solution in each) for each in solved)


TASK_SECONDS = 0.1
"""CPU seconds that a block is predicted to take: five times what it costs Dask to hand it out."""

FEWEST_ROWS = 2
"""Of a block: a single row is contiguous either way, and cannot be laid out as many are."""

R = TypeVar("R")
Arrays = TypeVar("Arrays", bound=Any)


@dataclass(frozen=True)
class Line:
    """Places of one compliance.

    Attributes
    ----------
    contact : PairContact
    models : tuple of ContactModel
        Of the misalignments; the same but for their gaps.
    candidates : Candidates
        Of plain involutes at all positions of the line.
    pitches : ndarray of int, shape (T,), or None
    loads : tuple of ndarray
        Sets of normal forces in N.
    starts : tuple of ndarray, shape (P, L, n), optional
        As those of `_ContactBlock`, at all positions of the line; without pitches.
    assembled : ContactProblem, optional
        As that of `_ContactBlock`.
    """

    contact: PairContact
    models: tuple[ContactModel, ...]
    candidates: Candidates
    pitches: IntArray | None
    loads: tuple[FloatArray, ...]
    starts: tuple[FloatArray, ...] | None = None
    assembled: ContactProblem | None = None

    @property
    def seconds_a_position(self) -> float:
        """CPU seconds that one position is predicted to take."""
        work = unit_work(self.contact.pair, self.contact.plan, self.contact.plan.discretization.slices)
        pitches = 1 if self.pitches is None else self.pitches.size
        return work.of(1, len(self.models) * pitches * sum(load.size for load in self.loads))

    def blocks(self, *, conditioned: bool) -> Iterator[_ContactBlock]:
        """Cut it."""
        pair, plan = self.contact.pair, self.contact.plan
        whole = _ContactBlock(pair, plan, self.candidates, self.models, self.pitches, self.loads, conditioned)
        count = self.candidates.position.size
        parts = min(math.ceil(count * self.seconds_a_position / TASK_SECONDS), count // FEWEST_ROWS)
        for rows in np.array_split(np.arange(count), max(parts, 1)):
            yield replace(whole, **self._rows(rows))

    def _rows(self, rows: IntArray) -> dict[str, Any]:
        """Return what a block of some positions has of its own."""
        candidates = _laid_out_alike(self.candidates.rows(rows), self.candidates)
        own: dict[str, Any] = {"candidates": candidates}
        if self.starts is not None:
            own["starts"] = tuple(forces[rows] for forces in self.starts)
        if self.assembled is not None:
            own["assembled"] = replace(self.assembled.rows(rows), candidates=candidates)
        return own


@dataclass(frozen=True)
class SolvedLine:
    """A line put together; attributes as those of `_SolvedBlock`."""

    problems: tuple[ContactProblem, ...]
    solutions: tuple[tuple[ContactSolution, ...], ...]
    condition: FloatArray | None


def solved_lines(
    lines: Sequence[Line], workers: Workers, *, conditioned: bool = False, report: Report = unreported
) -> list[SolvedLine]:
    """Solve lines; their contacts keep what was assembled for them. `report` is called after each line."""
    solved: list[SolvedLine] = []
    for line, blocks in zip(lines, _by_line(lines, workers, _solve_block, conditioned), strict=True):
        whole = _joined(line, blocks)
        plain = replace(whole.problems[0], candidates=line.candidates)
        line.contact.take(line.models[0], plain)
        solved.append(whole)
        report(len(solved) / len(lines))
    return solved


def deflections(lines: Sequence[Line], workers: Workers) -> list[list[FloatArray]]:
    """Solve lines of one set of loads; of each line the STE (T P, L) in m of every model."""
    return [
        [_rows([block[k][0] for block in blocks], line) for k in range(len(line.models))]
        for line, blocks in zip(lines, _by_line(lines, workers, _deflect_block, False), strict=True)
    ]


def _by_line(
    lines: Sequence[Line],
    workers: Workers,
    function: Callable[[Bodies, _ContactBlock], R],
    conditioned: bool,
) -> Iterator[list[R]]:
    """Yield the results of the blocks of every line; lines of the same bodies go out together."""
    for _, group in groupby(lines, key=lambda line: id(line.contact.bodies)):
        together = list(group)
        cut = [list(line.blocks(conditioned=conditioned)) for line in together]
        results = workers.run(
            function, together[0].contact.bodies, [block for blocks in cut for block in blocks]
        )
        for blocks in cut:
            yield [next(results) for _ in blocks]


def _laid_out_alike(part: Arrays, whole: Arrays) -> Arrays:
    """Return a dataclass of arrays and of such, its arrays in memory as those they are rows of.

    Compiled sums along a row round otherwise where its numbers stand apart.
    """
    alike: Arrays = replace(
        part,
        **{
            field.name: _alike(getattr(part, field.name), getattr(whole, field.name))
            for field in fields(part)
        },
    )
    return alike


def _alike(part: Any, whole: Any) -> Any:
    """Lay out one value as another."""
    if is_dataclass(part):
        return _laid_out_alike(part, whole)
    if not isinstance(part, np.ndarray):
        return part
    return np.ascontiguousarray(part) if whole.flags.c_contiguous else np.asfortranarray(part)


def _joined(line: Line, blocks: list[_SolvedBlock]) -> SolvedLine:
    """Put the blocks of a line together; all models share one compliance."""
    compliance = np.concatenate([block.problems[0].compliance for block in blocks])
    problems, solutions = [], []
    for k in range(len(line.models)):
        parts = [block.problems[k] for block in blocks]
        candidates = _joined_candidates([part.candidates for part in parts], line)
        problems.append(replace(parts[0], candidates=candidates, compliance=compliance))
        sets = zip(*(block.solutions[k] for block in blocks), strict=True)
        solutions.append(tuple(_joined_arrays(list(each), line, ("load",)) for each in sets))
    known = [block.condition for block in blocks if block.condition is not None]
    return SolvedLine(tuple(problems), tuple(solutions), np.concatenate(known) if known else None)


def _joined_candidates(parts: list[Candidates], line: Line) -> Candidates:
    """Put candidates together; their slices do not go through pitches."""
    slices = [part.slices for part in parts]
    once = replace(line, pitches=None)
    return replace(
        parts[0],
        position=_rows([part.position for part in parts], line),
        touch=_joined_arrays([part.touch for part in parts], line),
        width=_rows([part.width for part in parts], line),
        slices=replace(
            slices[0],
            present=_rows([part.present for part in slices], once),
            touch=_joined_arrays([part.touch for part in slices], once),
            patch_1=_joined_arrays([part.patch_1 for part in slices], once),
            patch_2=_joined_arrays([part.patch_2 for part in slices], once),
        ),
    )


def _joined_arrays(parts: list[Arrays], line: Line, same: tuple[str, ...] = ()) -> Arrays:
    """Put dataclasses of arrays over the rows together; those that are the `same` in all stay."""
    joined: Arrays = replace(
        parts[0],
        **{
            field.name: _rows([getattr(part, field.name) for part in parts], line)
            for field in fields(parts[0])
            if field.name not in same and isinstance(getattr(parts[0], field.name), np.ndarray)
        },
    )
    return joined


def _rows(parts: list[NDArray[Any]], line: Line) -> NDArray[Any]:
    """Put rows together that go through the positions of a block pitch by pitch."""
    pitches = 1 if line.pitches is None else line.pitches.size
    by_pitch = [part.reshape(pitches, len(part) // pitches, *part.shape[1:]) for part in parts]
    joined = np.concatenate(by_pitch, axis=1)
    return joined.reshape(len(joined) * joined.shape[1], *joined.shape[2:])
