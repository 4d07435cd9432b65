"""Contact of an operating point over many base pitches, solved in parts and reduced to stored arrays.

The touching points of a whole hunting cycle take gigabytes. Parts of its base pitches are laid out, solved
and reduced one after the other: memory holds those of one part beside the arrays of the table.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fe_contact.analysis.pairs.contact_fields import contact_fields, support_fields
from fe_contact.analysis.pairs.operating_points import OperatingPoint
from fe_contact.analysis.pairs.tip_edges import edge_depth
from fe_contact.contact import ContactProblem, ContactSolution
from fe_contact.contact.sweep import solve_sets
from fe_contact.geometry import ParallelAxes
from fe_contact.planning.cost_model import POINTS_AT_ONCE
from fe_contact.types import FloatArray, IntArray
from model_studies.progress import Report, unreported


def problems_in_parts(
    point: OperatingPoint, position: FloatArray, pitches: IntArray | None
) -> Iterator[ContactProblem]:
    """Yield the contact of positions (P,) in [0, 1) of each base pitch (T,), several base pitches at a time.

    `pitches` None stands for the first base pitch. Where all teeth are alike, only the first is yielded.
    """
    contact, model = point.contact, point.model
    if pitches is None or model.period == 1:
        yield contact.problem(model, position)
        return
    points = contact.problem(model, position).candidates.gap.size
    count = max(POINTS_AT_ONCE // points, 1)
    for part in np.split(pitches, np.arange(count, pitches.size, count)):
        yield contact.problem(model, position, np.repeat(part, position.size))


@dataclass(frozen=True)
class SolvedContact:
    """Contact of an operating point at P positions in each of T base pitches, as a table stores it."""

    problem: ContactProblem
    """Contact problem of the first base pitch."""
    solution: ContactSolution
    """Solution in all base pitches, except its forces (P, L, n), which are those of the first base pitch."""
    stored: Mapping[str, NDArray[Any]]
    """Arrays (T P, L, ...) of the table, by their names."""
    edge_depth: FloatArray
    """Largest depth of tip edges inside the mating flanks, m; 0 where edges stay clear or were not assessed.
    Shape (L,).
    """

    @classmethod
    def of(cls, pair: ParallelAxes, problem: ContactProblem, solution: ContactSolution) -> SolvedContact:
        """Return a solved contact with all arrays of `contact_fields`; tip edges are not assessed."""
        fields = contact_fields(pair, problem, solution)
        return cls(problem, solution, fields, np.zeros(solution.load.size))


def solved_in_parts(
    point: OperatingPoint,
    position: FloatArray,
    sets: Sequence[FloatArray],
    pitches: IntArray | None,
    *,
    edges: bool,
    report: Report = unreported,
) -> tuple[SolvedContact, ...]:
    """Solve positions (P,) in the base pitches (T,) at sets of normal forces in N, each by itself.

    The first set has all arrays of a table; the others have only those of support loads.

    Parameters
    ----------
    pitches : ndarray of int, shape (T,), or None
        As `problems_in_parts` takes them.
    edges : bool
        Whether the depth of tip edges under the first set is wanted.
    report : callable
        Called with the fraction of the base pitches that are solved.
    """
    parts: list[list[SolvedContact]] = []
    solved, count = 0, position.size * (1 if pitches is None else pitches.size)
    for problem in problems_in_parts(point, position, pitches):
        solutions = solve_sets(problem, sets)
        depth = edge_depth(point, problem, solutions[0]) if edges else np.zeros(sets[0].size)
        first = parts[0][0].problem if parts else _first_pitch(problem)
        stored_rows = 0 if parts else first.candidates.position.size  # forces of the first base pitch alone
        part = []
        for number, solution in enumerate(solutions):
            if number:  # support loads
                stored = support_fields(problem, solution)
            else:
                stored = contact_fields(point.contact.pair, problem, solution)
            forces = replace(solution, force=solution.force[:stored_rows].copy())
            part.append(SolvedContact(first, forces, stored, depth))
        parts.append(part)
        solved += problem.candidates.position.size
        report(min(solved / count, 1.0))
    return tuple(map(_one_after_another, zip(*parts, strict=True)))


def _first_pitch(problem: ContactProblem) -> ContactProblem:
    """Return the part of a problem of several base pitches that lies in the first of them."""
    candidates, rows = problem.candidates, np.arange(len(problem.compliance))
    if candidates.position.size == rows.size:
        return problem
    first = replace(
        candidates,
        position=candidates.position[rows],
        touch=candidates.touch.rows(rows),
        width=candidates.width[rows],
    )
    return problem.touching(first)


def _one_after_another(parts: Sequence[SolvedContact]) -> SolvedContact:
    """Join the parts of the base pitches of one set of loads."""
    first, solutions = parts[0], [part.solution for part in parts]
    if len(parts) == 1:
        return first
    names = [field.name for field in fields(ContactSolution) if field.name != "load"]
    solution = replace(
        first.solution,
        **{name: np.concatenate([getattr(solution, name) for solution in solutions]) for name in names},
    )
    stored = {name: np.concatenate([part.stored[name] for part in parts]) for name in first.stored}
    depth: FloatArray = np.max([part.edge_depth for part in parts], axis=0)
    return SolvedContact(first.problem, solution, stored, depth)
