"""Some positions of a line of the table: the task that workers are given.

Positions do not depend on each other: every load is started from the one below it at the same position, or
from forces that are given with it. So a table may be cut between any of them and keeps its bits. What is
found for all positions of a line together, which pairs touch at all and what counts as a tie of gaps, is
found before they are cut.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fe_contact.analysis.pairs.pair_contact import Bodies, PairContact
from fe_contact.contact import (
    Candidates,
    ContactModel,
    ContactProblem,
    ContactSolution,
    Start,
    solve_contact,
)
from fe_contact.contact.condition import condition_numbers
from fe_contact.geometry import ParallelAxes
from fe_contact.planning import Plan
from fe_contact.types import FloatArray, IntArray


@dataclass(frozen=True)
class ContactBlock:
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
class SolvedBlock:
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


def solve_block(bodies: Bodies, block: ContactBlock) -> SolvedBlock:
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
    return SolvedBlock(problems, solutions, condition)


def deflect_block(bodies: Bodies, block: ContactBlock) -> tuple[tuple[FloatArray, ...], ...]:
    """Return the STE (rows, L) in m of each model for each set of loads alone: one task."""
    solved = solve_block(bodies, block).solutions
    return tuple(tuple(solution.deflection for solution in each) for each in solved)
