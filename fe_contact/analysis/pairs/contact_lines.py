"""Lines of a table, cut into blocks for workers and put together again.

A line is one center distance at some misalignments: they share the compliance between the candidates, which
costs most. It is cut between positions (see `_ContactBlock`), by what its blocks are predicted to cost: by
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

from fe_contact.analysis.pairs.pair_contact import Bodies, OperatingPoint, OperatingPoints, PairContact
from fe_contact.contact import (
    Candidates,
    ContactModel,
    ContactProblem,
    ContactSolution,
    Start,
    load_arm,
    solve_contact,
)
from fe_contact.contact.assembly import together
from fe_contact.contact.problem import condition_numbers
from fe_contact.geometry import ParallelAxes
from fe_contact.planning.cost_model import unit_work
from fe_contact.planning.plan import Plan
from fe_contact.types import FloatArray, IntArray
from model_studies.progress import Report, unreported
from model_studies.workers import InProcess, Workers

# Some positions of a line of the table: the task that workers are given.


@dataclass(frozen=True)
class _ContactBlock:
    """One block.

    Attributes
    ----------
    pair : GearPair or InternalGearPair
        At the center distance of the line.
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
    """The problem of each model of a block, its solution for each set of loads, and condition numbers.

    The latter are of the compliance at the positions, if they were wanted.
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
    """Return the curves (rows, L, 2) of each model for each set of loads alone: one task."""
    solved = _solve_block(bodies, block)
    return tuple(
        tuple(_curves(block.pair, problem, solution) for solution in each)
        for problem, each in zip(solved.problems, solved.solutions, strict=True)
    )


def _curves(pair: ParallelAxes, problem: ContactProblem, solution: ContactSolution) -> FloatArray:
    """Return transmission error and load arm of a solution, (rows, L, 2) in m."""
    return np.stack([solution.deflection, load_arm(pair, problem, solution)], axis=-1)


TASK_SECONDS = 0.1
"""CPU seconds that a block is predicted to take: five times what it costs Dask to hand it out."""

R = TypeVar("R")
Arrays = TypeVar("Arrays", bound=Any)


@dataclass(frozen=True)
class _Line:
    """Places of one compliance: their contact, and all positions as one block without its bodies."""

    contact: PairContact
    whole: _ContactBlock

    @property
    def pitches(self) -> int:
        """Base pitches that every position is put into."""
        return 1 if self.whole.pitches is None else self.whole.pitches.size

    @property
    def seconds_a_position(self) -> float:
        """CPU seconds that one position is predicted to take."""
        whole = self.whole
        work = unit_work(whole.pair, whole.plan, whole.plan.discretization.slices)
        return work.of(1, len(whole.models) * self.pitches * sum(load.size for load in whole.loads))

    def blocks(self, *, conditioned: bool) -> Iterator[_ContactBlock]:
        """Cut it."""
        whole, count = replace(self.whole, conditioned=conditioned), self.whole.candidates.position.size
        chunks = together(count)
        parts = min(math.ceil(count * self.seconds_a_position / TASK_SECONDS), len(chunks))
        for numbers in np.array_split(np.arange(len(chunks)), max(parts, 1)):
            rows = np.concatenate([chunks[k] for k in numbers])
            candidates = _laid_out_alike(whole.candidates.rows(rows), whole.candidates)
            starts, assembled = whole.starts, whole.assembled
            yield replace(
                whole,
                candidates=candidates,
                starts=None if starts is None else tuple(forces[rows] for forces in starts),
                assembled=None if assembled is None else replace(assembled.rows(rows), candidates=candidates),
            )


def _solved_lines(
    lines: Sequence[_Line], workers: Workers, *, conditioned: bool = False, report: Report = unreported
) -> list[_SolvedBlock]:
    """Solve lines; their contacts keep what was assembled for them. `report` is called after each line."""
    solved: list[_SolvedBlock] = []
    for line, blocks in zip(lines, _by_line(lines, workers, _solve_block, conditioned), strict=True):
        joined = _joined(line, blocks)
        plain = replace(joined.problems[0], candidates=line.whole.candidates)
        line.contact.take(line.whole.models[0], plain)
        solved.append(joined)
        report(len(solved) / len(lines))
    return solved


def _deflections(lines: Sequence[_Line], workers: Workers) -> list[list[FloatArray]]:
    """Solve lines of one set of loads; of each line the curves (T P, L, 2) in m of every model."""
    return [
        [_rows([block[k][0] for block in blocks], line.pitches) for k in range(len(line.whole.models))]
        for line, blocks in zip(lines, _by_line(lines, workers, _deflect_block, False), strict=True)
    ]


def _by_line(
    lines: Sequence[_Line],
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


def _joined(line: _Line, blocks: list[_SolvedBlock]) -> _SolvedBlock:
    """Put the blocks of a line together; all models share one compliance."""
    compliance = np.concatenate([block.problems[0].compliance for block in blocks])
    models = range(len(line.whole.models))
    tilts = [np.concatenate([block.problems[k].tilt for block in blocks]) for k in models]
    tilt = max(tilts, key=np.size)  # that of flanks that slope, if any does
    problems, solutions = [], []
    for k in models:
        parts = [block.problems[k] for block in blocks]
        candidates = _joined_candidates([part.candidates for part in parts], line.pitches)
        problems.append(replace(parts[0], candidates=candidates, compliance=compliance, tilt=tilt))
        sets = zip(*(block.solutions[k] for block in blocks), strict=True)
        solutions.append(tuple(_joined_arrays(list(each), line.pitches, ("load",)) for each in sets))
    known = [block.condition for block in blocks if block.condition is not None]
    return _SolvedBlock(tuple(problems), tuple(solutions), np.concatenate(known) if known else None)


def _joined_candidates(parts: list[Candidates], pitches: int) -> Candidates:
    """Put candidates together; their slices do not go through pitches."""
    slices = [part.slices for part in parts]
    return replace(
        parts[0],
        position=_rows([part.position for part in parts], pitches),
        touch=_joined_arrays([part.touch for part in parts], pitches),
        width=_rows([part.width for part in parts], pitches),
        slices=replace(
            slices[0],
            present=_rows([part.present for part in slices], 1),
            touch=_joined_arrays([part.touch for part in slices], 1),
            patch_1=_joined_arrays([part.patch_1 for part in slices], 1),
            patch_2=_joined_arrays([part.patch_2 for part in slices], 1),
        ),
    )


def _joined_arrays(parts: list[Arrays], pitches: int, same: tuple[str, ...] = ()) -> Arrays:
    """Put dataclasses of arrays over the rows together; those that are the `same` in all stay."""
    joined: Arrays = replace(
        parts[0],
        **{
            field.name: _rows([getattr(part, field.name) for part in parts], pitches)
            for field in fields(parts[0])
            if field.name not in same and isinstance(getattr(parts[0], field.name), np.ndarray)
        },
    )
    return joined


def _rows(parts: list[NDArray[Any]], pitches: int) -> NDArray[Any]:
    """Put rows together that go through the positions of a block pitch by pitch."""
    by_pitch = [part.reshape(pitches, len(part) // pitches, *part.shape[1:]) for part in parts]
    joined = np.concatenate(by_pitch, axis=1)
    return joined.reshape(len(joined) * joined.shape[1], *joined.shape[2:])


# Contact at many places at once: here, or line by line by workers, to the same bits.


Solved = list[tuple[ContactProblem, ContactSolution]]
Lines = dict[tuple[object, ...], tuple[_Line, list[int]]]


def solve_operating_points(
    points: OperatingPoints,
    position: FloatArray,
    loads: tuple[FloatArray, ...],
    *,
    conditioned: bool,
    report: Report = unreported,
) -> tuple[list[Solved], FloatArray | None]:
    """Solve all places at the positions of all base pitches.

    Parameters
    ----------
    position : ndarray, shape (P,)
        In [0, 1).
    loads : tuple of ndarray
        Sets of normal forces in N.
    conditioned : bool
        Whether workers also find condition numbers.
    report : callable
        Called with the fraction of operating points and sets of loads, or of lines, that are solved.

    Returns
    -------
    list of list of (ContactProblem, ContactSolution)
        For each set of loads, of every place.
    ndarray or None
        Condition numbers of all compliances, if workers found them.
    """
    pitches = np.arange(points.period)
    everywhere = [position] * len(points.places)
    lines = _sent_lines(points.workers, points.places, everywhere, loads, pitches)
    if not lines:
        count, here = len(loads) * len(points.places), list[Solved]()
        for load in loads:
            here.append([])
            for point in points.places:
                here[-1].append(point.solve_pitches(position, load, pitches))
                report(sum(map(len, here)) / count)
        return here, None
    sent = [line for line, _ in lines.values()]
    solved_each = _solved_lines(sent, points.workers, conditioned=conditioned, report=report)
    by_place = {
        k: (problem, solutions)
        for (_, members), line in zip(lines.values(), solved_each, strict=True)
        for k, problem, solutions in zip(members, line.problems, line.solutions, strict=True)
    }
    each = [by_place[k] for k in sorted(by_place)]
    solved = [[(problem, solutions[k]) for problem, solutions in each] for k in range(len(loads))]
    known = [line.condition for line in solved_each if line.condition is not None]
    return solved, np.concatenate(known) if known else None


def deflected_operating_points(
    points: Sequence[OperatingPoint],
    position: Sequence[FloatArray],
    load: FloatArray,
    pitches: IntArray | None,
    workers: Workers,
    known: Sequence[Candidates] | None = None,
    starts: Sequence[Start] | None = None,
) -> list[FloatArray]:
    """Return transmission error and load arm (T P, L, 2) in m of places.

    Parameters
    ----------
    position : sequence of ndarray, shape (P,)
        Of each place, in [0, 1).
    load : ndarray, shape (L,)
        Normal forces, N.
    pitches : ndarray of int, shape (T,), or None
        Base pitches; None: as `OperatingPoint.solve` takes it.
    known : sequence of Candidates, optional
        Of plain involutes at the positions, for each place.
    starts : sequence of Start, optional
        Forces near the solution at each place; without `pitches`.
    """
    lines = _sent_lines(workers, points, position, (load,), pitches, known)
    if not lines:
        solved = _deflected_here(points, position, load, pitches, known, starts)
        return list(solved)
    if starts is not None:
        lines = {
            key: (_started(line, [starts[k] for k in numbers]), numbers)
            for key, (line, numbers) in lines.items()
        }
    deflected = _deflections([line for line, _ in lines.values()], workers)
    by_place = {
        k: curve
        for (_, members), curves in zip(lines.values(), deflected, strict=True)
        for k, curve in zip(members, curves, strict=True)
    }
    return [by_place[k] for k in range(len(points))]


def assemble_remotely(points: OperatingPoints, models: Sequence[ContactModel], position: FloatArray) -> None:
    """Let workers assemble what operating points need with other models; nothing without workers."""
    sent = [OperatingPoint(point.contact, model) for point, model in zip(points.places, models, strict=True)]
    lines = _sent_lines(points.workers, sent, [position] * len(sent), (), None)
    _solved_lines([line for line, _ in lines.values()], points.workers)


def _deflected_here(
    points: Sequence[OperatingPoint],
    position: Sequence[FloatArray],
    load: FloatArray,
    pitches: IntArray | None,
    known: Sequence[Candidates] | None,
    starts: Sequence[Start] | None,
) -> Iterator[FloatArray]:
    """Yield the curves of places, solved in this process; parameters of `deflected_operating_points`."""
    for k, point in enumerate(points):
        if known is not None:
            point.contact.assemble(point.model, known[k])
        if pitches is None:
            start = None if starts is None else starts[k]
            yield _curves(point.contact.pair, *point.solve(position[k], load, start=start))
        else:
            yield _curves(point.contact.pair, *point.solve_pitches(position[k], load, pitches))


def _started(line: _Line, starts: Sequence[Start]) -> _Line:
    forces = tuple(start.on(line.whole.candidates) for start in starts)
    return replace(line, whole=replace(line.whole, starts=forces))


def _sent_lines(
    workers: Workers,
    points: Sequence[OperatingPoint],
    position: Sequence[FloatArray],
    loads: tuple[FloatArray, ...],
    pitches: IntArray | None,
    known: Sequence[Candidates] | None = None,
) -> Lines:
    """Gather the places that share a compliance into lines, each with the numbers of its places.

    Empty where there is nobody else to solve them, or less than one task of work.
    """
    if isinstance(workers, InProcess):
        return {}
    members: dict[tuple[object, ...], list[int]] = {}
    for k, point in enumerate(points):
        members.setdefault((id(point.contact), *point.contact.key(point.model, position[k])), []).append(k)
    lines = {}
    for key, numbers in members.items():
        contact, first = points[numbers[0]].contact, points[numbers[0]].model
        candidates = contact.candidates(first, position[numbers[0]]) if known is None else known[numbers[0]]
        models = tuple(points[k].model for k in numbers)
        kept = contact.kept(first, position[numbers[0]])
        turned = pitches if first.period > 1 else None
        whole = _ContactBlock(contact.pair, contact.plan, candidates, models, turned, loads, assembled=kept)
        lines[key] = (_Line(contact, whole), numbers)
    seconds = sum(line.seconds_a_position * line.whole.candidates.position.size for line, _ in lines.values())
    return lines if seconds > TASK_SECONDS else {}
