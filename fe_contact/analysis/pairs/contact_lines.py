"""Contact at many operating points, line by line: in this process or by workers, to the same bits.

A line is one center distance at some misalignments: they share the compliance between the candidates, which
costs most. It is cut between positions into blocks (`ContactBlock`) of a predicted cost. The cuts depend on
the case alone, not on the number of workers.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, fields, replace
from functools import partial
from itertools import chain, groupby
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from fe_contact.analysis.pairs.array_layout import Arrays, laid_out_alike
from fe_contact.analysis.pairs.contact_block import (
    ContactBlock,
    SolvedBlock,
    curves_of_point,
    deflect_block,
    solve_block,
)
from fe_contact.analysis.pairs.operating_points import OperatingPoint, OperatingPoints
from fe_contact.analysis.pairs.pair_contact import Bodies, PairContact
from fe_contact.analysis.pairs.solved_contact import SolvedContact, solved_in_parts
from fe_contact.contact import Candidates, ContactProblem, Start
from fe_contact.contact.face_assembly import together
from fe_contact.contact.plain_touch import Touch
from fe_contact.planning.cost_model import unit_work
from fe_contact.types import FloatArray, IntArray
from model_studies.progress import Report, unreported
from model_studies.workers import InProcess, Workers

TASK_SECONDS = 0.1
"""Predicted CPU seconds of a block: five times the cost of its distribution by Dask."""

R = TypeVar("R")  # result of a block, or of an operating point


@dataclass(frozen=True)
class _Line:
    """Operating points of one compliance: their contact, and all positions as one block without bodies."""

    contact: PairContact
    block: ContactBlock

    @property
    def pitches(self) -> int:
        """Number of base pitches in which every position is solved."""
        return 1 if self.block.pitches is None else self.block.pitches.size

    @property
    def seconds_a_position(self) -> float:
        """CPU seconds that one position is predicted to take."""
        block = self.block
        work = unit_work(block.pair, block.plan, block.plan.discretization.slices)
        return work.of(1, len(block.models) * self.pitches * sum(load.size for load in block.loads))

    def blocks(self) -> Iterator[ContactBlock]:
        """Yield the blocks of the line, of about `TASK_SECONDS` each."""
        block, count = self.block, self.block.candidates.position.size
        chunks = together(count)  # positions whose compliance is assembled in one go
        parts = min(math.ceil(count * self.seconds_a_position / TASK_SECONDS), len(chunks))
        for numbers in np.array_split(np.arange(len(chunks)), max(parts, 1)):
            rows = np.concatenate([chunks[k] for k in numbers])
            candidates = laid_out_alike(block.candidates.rows(rows), block.candidates)
            starts, assembled = block.starts, block.assembled
            yield replace(
                block,
                candidates=candidates,
                starts=None if starts is None else tuple(forces[rows] for forces in starts),
                assembled=None if assembled is None else replace(assembled.rows(rows), candidates=candidates),
            )


def _solved_lines(lines: Sequence[_Line], workers: Workers, report: Report = unreported) -> list[SolvedBlock]:
    """Solve lines; their contacts keep the assembled compliances. `report` is called after each line."""
    solved: list[SolvedBlock] = []
    for line, blocks in zip(lines, _by_line(lines, workers, solve_block), strict=True):
        joined = _joined_block(line, blocks)
        plain = replace(joined.contacts[0][0].problem, candidates=line.block.candidates)
        line.contact.take(line.block.models[0], plain)
        solved.append(joined)
        report(len(solved) / len(lines))
    return solved


def _deflections(lines: Sequence[_Line], workers: Workers) -> list[list[FloatArray]]:
    """Solve lines of one set of loads; return of each line the curves (T P, L, 2) in m of every model."""
    curves = []
    for line, blocks in zip(lines, _by_line(lines, workers, deflect_block), strict=True):
        curves.append([_rows(list(parts), line.pitches) for parts in zip(*blocks, strict=True)])
    return curves


def _by_line(
    lines: Sequence[_Line], workers: Workers, function: Callable[[Bodies, ContactBlock], R]
) -> Iterator[list[R]]:
    """Yield the results of the blocks of every line; lines of the same bodies go out together."""
    for _, group in groupby(lines, key=lambda line: id(line.contact.bodies)):
        alike = list(group)
        blocks_by_line = [list(line.blocks()) for line in alike]
        results = workers.run(function, alike[0].contact.bodies, list(chain.from_iterable(blocks_by_line)))
        for blocks in blocks_by_line:
            yield [next(results) for _ in blocks]


def _joined_block(line: _Line, blocks: list[SolvedBlock]) -> SolvedBlock:
    """Put the blocks of a line together; all models share one compliance."""
    # the same problem for all sets of loads: (blocks, models), and by model
    problems = [[contacts[0].problem for contacts in block.contacts] for block in blocks]
    by_model = list(zip(*problems, strict=True))
    compliance = np.concatenate([parts[0].compliance for parts in problems])
    tilts = [np.concatenate([problem.tilt for problem in parts]) for parts in by_model]
    tilt = max(tilts, key=np.size)  # that of flanks that slope, if any does
    contacts = []
    for k, parts in enumerate(by_model):
        candidates = _joined_candidates([part.candidates for part in parts])
        share = np.concatenate([np.broadcast_to(p.share_1, p.compliance.shape[:2]) for p in parts])
        problem = replace(parts[0], candidates=candidates, compliance=compliance, tilt=tilt, share_1=share)
        sets = zip(*(block.contacts[k] for block in blocks), strict=True)
        contacts.append(tuple(_joined_contact(list(group), problem, line.pitches) for group in sets))
    known = [block.condition for block in blocks if block.condition is not None]
    return SolvedBlock(tuple(contacts), np.concatenate(known) if known else None)


def _joined_contact(parts: list[SolvedContact], problem: ContactProblem, pitches: int) -> SolvedContact:
    """Join the contacts of the blocks of a line; forces are those of one base pitch."""
    solutions = [part.solution for part in parts]
    forces = _rows([solution.force for solution in solutions], 1)
    solution = replace(_joined_arrays(solutions, pitches, ("load", "force")), force=forces)
    stored = {name: _rows([part.stored[name] for part in parts], pitches) for name in parts[0].stored}
    depth: FloatArray = np.max([part.edge_depth for part in parts], axis=0)
    return SolvedContact(problem, solution, stored, depth)


def _joined_candidates(parts: list[Candidates]) -> Candidates:
    """Put candidates in one base pitch together."""
    slices = [part.slices for part in parts]
    return replace(
        parts[0],
        position=_rows([part.position for part in parts], 1),
        touch=_joined_touch([part.touch for part in parts]),
        width=_rows([part.width for part in parts], 1),
        slices=replace(
            slices[0],
            present=_rows([part.present for part in slices], 1),
            touch=_joined_touch([part.touch for part in slices]),
            patch_1=_joined_arrays([part.patch_1 for part in slices], 1),
            patch_2=_joined_arrays([part.patch_2 for part in slices], 1),
            turned_normals=_rows([part.turned_normals for part in slices], 1),
        ),
    )


def _joined_touch(parts: list[Touch]) -> Touch:
    """Put touching points together; only blocks where flanks are rough have the breaks of their strips."""
    breaks = max(part.offset.shape[-1] for part in parts)
    return _joined_arrays([part.with_breaks(breaks) for part in parts], 1)


def _joined_arrays(parts: list[Arrays], pitches: int, same: tuple[str, ...] = ()) -> Arrays:
    """Join dataclasses of arrays over their rows; arrays named in `same` are equal in all of them."""
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
    """Join the rows of blocks, each of which goes through its positions pitch by pitch."""
    by_pitch = [part.reshape(pitches, len(part) // pitches, *part.shape[1:]) for part in parts]
    joined = np.concatenate(by_pitch, axis=1)
    return joined.reshape(len(joined) * joined.shape[1], *joined.shape[2:])


Lines = dict[tuple[object, ...], tuple[_Line, list[int]]]
"""Lines and the numbers of their operating points, by what the points of a line share."""


def solve_operating_points(
    points: OperatingPoints,
    position: FloatArray,
    loads: tuple[FloatArray, ...],
    *,
    conditioned: bool,
    edges: bool,
    report: Report = unreported,
) -> tuple[list[list[SolvedContact]], FloatArray | None]:
    """Solve all operating points at the positions of all base pitches.

    Parameters
    ----------
    position : ndarray, shape (P,)
        Positions in [0, 1).
    loads : tuple of ndarray
        Sets of normal forces in N: those of a table, support loads.
    conditioned : bool
        Whether workers also find condition numbers.
    edges : bool
        Whether the depth of tip edges under the first set is wanted.
    report : callable
        Called with the fraction of operating points and base pitches, or of lines, that are solved.

    Returns
    -------
    list of list of SolvedContact
        Contacts of every operating point, for each set of loads.
    ndarray or None
        Condition numbers of all compliances, if workers found them.
    """
    pitches, count = np.arange(points.period), len(points.places)
    everywhere = [position] * count
    lines = _sent_lines(points.workers, points.places, everywhere, loads, pitches)
    if not lines:
        local_sets = []
        for k, point in enumerate(points.places):
            part = partial(_total_fraction, report, k, count)
            local_sets.append(solved_in_parts(point, position, loads, pitches, edges=edges, report=part))
        return [list(group) for group in zip(*local_sets, strict=True)], None
    sent = [
        replace(line, block=replace(line.block, conditioned=conditioned, edges=edges))
        for line, _ in lines.values()
    ]
    solved_lines = _solved_lines(sent, points.workers, report)
    contacts = _by_point(lines, [line.contacts for line in solved_lines])
    known = [line.condition for line in solved_lines if line.condition is not None]
    return [list(group) for group in zip(*contacts, strict=True)], np.concatenate(known) if known else None


def _total_fraction(report: Report, done: int, count: int, fraction: float) -> None:
    """Report the fraction of `count` parts, of which `done` are solved and the next one to a `fraction`."""
    report((done + fraction) / count)


def _by_point(lines: Lines, results: Sequence[Sequence[R]]) -> list[R]:
    """Return the results of the points of every line in the order of all points."""
    by_point: dict[int, R] = {}
    for (_, numbers), results_of_line in zip(lines.values(), results, strict=True):
        by_point |= zip(numbers, results_of_line, strict=True)
    return [by_point[k] for k in sorted(by_point)]


def deflected_operating_points(
    points: Sequence[OperatingPoint],
    position: Sequence[FloatArray],
    load: FloatArray,
    pitches: IntArray | None,
    workers: Workers,
    candidates: Sequence[Candidates] | None = None,
    starts: Sequence[Start] | None = None,
) -> list[FloatArray]:
    """Return transmission error and load arm (T P, L, 2) in m of operating points.

    Parameters
    ----------
    position : sequence of ndarray, shape (P,)
        Positions at each point, in [0, 1).
    load : ndarray, shape (L,)
        Normal forces, N.
    pitches : ndarray of int, shape (T,), or None
        Base pitches; None: as `OperatingPoint.solve` takes it. Points by derivatives need all of them.
    known : sequence of Candidates, optional
        Candidates of plain involutes at the positions, for each point.
    starts : sequence of Start, optional
        Forces near the solution at each point; without `pitches`.
    """
    derived = pitches is not None and any(point.derived is not None for point in points)
    lines = {} if derived else _sent_lines(workers, points, position, (load,), pitches, candidates)
    if not lines:
        return list(_local_curves(points, position, load, pitches, candidates, starts))
    if starts is not None:
        for key, (line, numbers) in lines.items():
            forces = tuple(starts[k].on(line.block.candidates) for k in numbers)
            lines[key] = replace(line, block=replace(line.block, starts=forces)), numbers
    return _by_point(lines, _deflections([line for line, _ in lines.values()], workers))


def _local_curves(
    points: Sequence[OperatingPoint],
    position: Sequence[FloatArray],
    load: FloatArray,
    pitches: IntArray | None,
    candidates: Sequence[Candidates] | None,
    starts: Sequence[Start] | None,
) -> Iterator[FloatArray]:
    """Yield the curves of points, solved in this process; parameters of `deflected_operating_points`."""
    for k, point in enumerate(points):
        if candidates is not None:
            point.contact.assemble(point.model, candidates[k])
        if point.derived is not None and pitches is not None:
            yield point.derived.on(point, position[k], load)
        else:
            yield curves_of_point(point, position[k], load, pitches, None if starts is None else starts[k])


def _sent_lines(
    workers: Workers,
    points: Sequence[OperatingPoint],
    position: Sequence[FloatArray],
    loads: tuple[FloatArray, ...],
    pitches: IntArray | None,
    known: Sequence[Candidates] | None = None,
) -> Lines:
    """Return lines of operating points that share a compliance, each with the numbers of its points.

    There are none without workers, or where the work is less than one task.
    """
    if isinstance(workers, InProcess):
        return {}
    members: dict[tuple[object, ...], list[int]] = {}
    for k, point in enumerate(points):
        key = (id(point.contact), *point.contact.key(point.model, position[k]))
        members.setdefault(key, []).append(k)
    lines = {}
    for key, numbers in members.items():
        first = numbers[0]
        contact, model = points[first].contact, points[first].model
        candidates = contact.candidates(model, position[first]) if known is None else known[first]
        models = tuple(points[k].model for k in numbers)
        problem = contact.cached_problem(model, position[first])
        turned = pitches if model.period > 1 else None
        block = ContactBlock(contact.pair, contact.plan, candidates, models, turned, loads, assembled=problem)
        lines[key] = (_Line(contact, block), numbers)
    seconds = sum(line.seconds_a_position * line.block.candidates.position.size for line, _ in lines.values())
    return lines if seconds > TASK_SECONDS else {}
