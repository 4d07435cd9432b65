"""Block of positions on a line of a table, the task that workers solve.

A line of the table is one center distance with all its misalignments.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fe_contact.analysis.pairs.operating_points import OperatingPoint
from fe_contact.analysis.pairs.pair_contact import Bodies, PairContact
from fe_contact.analysis.pairs.solved_contact import SolvedContact, problems_in_parts, solved_in_parts
from fe_contact.contact import Candidates, ContactModel, ContactProblem, Start, load_arm, solve_contact
from fe_contact.contact.condition_number import condition_numbers
from fe_contact.geometry import ParallelAxes
from fe_contact.planning.plan import Plan
from fe_contact.types import FloatArray, IntArray


@dataclass(frozen=True)
class ContactBlock:
    """Contact problem of a block of positions at all misalignments."""

    pair: ParallelAxes
    """Gear pair at the center distance of the line."""
    plan: Plan
    candidates: Candidates
    """Contact candidates of plain involutes at the positions of the block."""
    models: tuple[ContactModel, ...]
    """Contact models of the misalignments. They share one compliance."""
    pitches: IntArray | None
    """Whole base pitches that the positions are repeated in, as `PairContact.solve` takes them. Ndarray of
    int, shape (T,).
    """
    loads: tuple[FloatArray, ...]
    """Sets of normal forces, N; each set is solved by itself."""
    conditioned: bool = False
    """Whether condition numbers are wanted."""
    edges: bool = False
    """Whether the depth of tip edges under the first set of loads is wanted."""
    starts: tuple[FloatArray, ...] | None = None
    """Forces on the candidates that the solution of each model starts from, N. Default: each load starts from
    the load below it. Tuple of ndarray, shape (rows, L, n).
    """
    assembled: ContactProblem | None = None
    """Problem of the candidates with their assembled compliance, where it is known; else None, and the
    compliance is assembled.
    """

    def start(self, model: int) -> Start | None:
        """Return the forces that the solution of a model starts from."""
        return None if self.starts is None else Start(self.candidates, self.starts[model])


@dataclass(frozen=True)
class SolvedBlock:
    """Solved contacts of a block, for each model and each set of loads, and condition numbers.

    The condition numbers are those of the compliance at the positions; None unless they were requested.
    """

    contacts: tuple[tuple[SolvedContact, ...], ...]
    condition: FloatArray | None


def _points(bodies: Bodies, block: ContactBlock) -> list[OperatingPoint]:
    """Return the operating points of a block, its compliance assembled."""
    contact = PairContact.of_bodies(block.pair, block.plan, bodies)
    if block.assembled is None:
        contact.assemble(block.models[0], block.candidates)
    else:
        contact.take(block.models[0], block.assembled)
    return [OperatingPoint(contact, model) for model in block.models]


def solve_block(bodies: Bodies, block: ContactBlock) -> SolvedBlock:
    """Assemble and solve a block: one task."""
    position = block.candidates.position
    contacts = tuple(
        solved_in_parts(point, position, block.loads, block.pitches, edges=block.edges)
        for point in _points(bodies, block)
    )
    # all models and sets of loads have the compliance of the first
    condition = condition_numbers(contacts[0][0].problem.compliance) if block.conditioned else None
    return SolvedBlock(contacts, condition)


def deflect_block(bodies: Bodies, block: ContactBlock) -> tuple[FloatArray, ...]:
    """Return the curves (rows, L, 2) of each model under the one set of loads of a block: one task."""
    where, (load,) = block.candidates.position, block.loads
    return tuple(
        curves_of_point(point, where, load, block.pitches, block.start(k))
        for k, point in enumerate(_points(bodies, block))
    )


def curves_of_point(
    point: OperatingPoint,
    position: FloatArray,
    load: FloatArray,
    pitches: IntArray | None,
    start: Start | None = None,
) -> FloatArray:
    """Return transmission error and load arm of an operating point, (rows, L, 2) in m.

    `start` is for positions in the first base pitch.
    """
    parts = []
    for problem in problems_in_parts(point, position, pitches):
        solution = solve_contact(problem, load, start)
        arm = load_arm(point.contact.pair, problem, solution)
        parts.append(np.stack([solution.deflection, arm], axis=-1))
    return np.concatenate(parts)
