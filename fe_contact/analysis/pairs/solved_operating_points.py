"""Contact at many places at once: here, or line by line by workers, to the same bits."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from fe_contact.analysis.pairs.contact_lines import TASK_SECONDS, Line, SolvedLine, deflections, solved_lines
from fe_contact.analysis.pairs.pair_contact import OperatingPoint, OperatingPoints
from fe_contact.contact import Candidates, ContactModel, ContactProblem, ContactSolution, Start
from fe_contact.types import FloatArray, IntArray
from fe_contact.workers import InProcess, Workers
from model_studies.progress import Report, unreported

Solved = list[tuple[ContactProblem, ContactSolution]]
Lines = dict[tuple[object, ...], tuple[Line, list[int]]]


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
    points : OperatingPoints
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
    solved_each = solved_lines(sent, points.workers, conditioned=conditioned, report=report)
    each = _each_place(lines, solved_each)
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
    """Return the STE (T P, L) in m of places.

    Parameters
    ----------
    points : sequence of OperatingPoint
    position : sequence of ndarray, shape (P,)
        Of each place, in [0, 1).
    load : ndarray, shape (L,)
        Normal forces, N.
    pitches : ndarray of int, shape (T,), or None
        Base pitches; None: as `OperatingPoint.solve` takes it.
    workers : Workers
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
        lines = {key: (_started(line, numbers, starts), numbers) for key, (line, numbers) in lines.items()}
    deflected = deflections([line for line, _ in lines.values()], workers)
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
    solved_lines([line for line, _ in lines.values()], points.workers)


def _deflected_here(
    points: Sequence[OperatingPoint],
    position: Sequence[FloatArray],
    load: FloatArray,
    pitches: IntArray | None,
    known: Sequence[Candidates] | None,
    starts: Sequence[Start] | None,
) -> Iterator[FloatArray]:
    """Yield the STE of places, solved in this process; parameters of `deflected_operating_points`."""
    for k, point in enumerate(points):
        if known is not None:
            point.contact.assemble(point.model, known[k])
        if pitches is None:
            start = None if starts is None else starts[k]
            yield point.solve(position[k], load, start=start)[1].deflection
        else:
            yield point.solve_pitches(position[k], load, pitches)[1].deflection


def _started(line: Line, numbers: Sequence[int], starts: Sequence[Start]) -> Line:
    return replace(line, starts=tuple(starts[k].on(line.candidates) for k in numbers))


def _sent_lines(
    workers: Workers,
    points: Sequence[OperatingPoint],
    position: Sequence[FloatArray],
    loads: tuple[FloatArray, ...],
    pitches: IntArray | None,
    known: Sequence[Candidates] | None = None,
) -> Lines:
    """Gather the places that share a compliance into lines, each with the numbers of its places.

    Empty where there is nobody else to solve them, or too little for others to do: that is decided by the
    case alone.
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
        line = Line(contact, models, candidates, pitches if first.period > 1 else None, loads, assembled=kept)
        lines[key] = (line, numbers)
    seconds = sum(line.seconds_a_position * line.candidates.position.size for line, _ in lines.values())
    return lines if seconds > TASK_SECONDS else {}


def _each_place(
    lines: Lines, solved: Sequence[SolvedLine]
) -> list[tuple[ContactProblem, tuple[ContactSolution, ...]]]:
    by_place = {
        k: (problem, solutions)
        for (_, members), line in zip(lines.values(), solved, strict=True)
        for k, problem, solutions in zip(members, line.problems, line.solutions, strict=True)
    }
    return [by_place[k] for k in sorted(by_place)]
