"""Depth of tip edges inside the mating flanks in a contact that was solved without them.

Sizes: P positions, L loads, m or more candidates with contacts of edges, n without them.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fe_contact.analysis.pairs.operating_points import OperatingPoint
from fe_contact.contact import Candidates, ContactProblem, ContactSolution
from fe_contact.geometry import ParallelAxes
from fe_contact.types import FloatArray

OUTSIDE = 1e-3
"""Distance before A and after E at which the gap of an edge is assessed, base pitches. The gap grows from
there on.
"""


def handovers(pair: ParallelAxes) -> FloatArray:
    """Return the positions (2,) in [0, 1), rising, just before a pair meets at A and after it leaves at E."""
    path = pair.path_of_contact
    start, end = (float(pair.position(roll)) for roll in (path.start, path.end))
    return np.sort(np.array([start - OUTSIDE, end + OUTSIDE]) % 1.0)


def edge_depth(point: OperatingPoint, problem: ContactProblem, solution: ContactSolution) -> FloatArray:
    """Return how far tip edges would be inside the mating flanks (L,), m; 0 where they stay clear.

    The forces are those of the solution. The motion of the unloaded edges with the loaded teeth is included.
    """
    position, phases = problem.candidates.position, len(problem.compliance)
    # row r has the phase r modulo their number: every pitch has the same phases
    phase, pitch = position[:phases] % 1.0, np.floor(position).astype(np.int64)
    model = replace(point.model, corner_contact=True)
    edges = point.contact.problem(model, phase, pitch if model.tooth_gaps else None)
    touch = edges.candidates.touch
    off_line = (touch.lever_1 != 1.0) | (touch.lever_2 != 1.0)  # contacts of edges off the line of action
    force = _with_zeros(problem.candidates, edges.candidates, np.nan_to_num(solution.force))
    motion = edges.displacement(force)
    approach = edges.candidates.motion_arm  # (P, m), normal approach per unit deflection
    closing = approach[:, None, :] * np.nan_to_num(solution.deflection)[:, :, None]
    gap = np.where(off_line, touch.gap, np.inf) * approach
    return np.asarray(np.max(closing - motion - gap[:, None, :], axis=(0, 2), initial=0.0))


def _with_zeros(part: Candidates, candidates: Candidates, force: FloatArray) -> FloatArray:
    """Return the forces (P, L, m) on all `candidates`, from `force` (P, L, n) on `part` of them."""
    column = {
        key: i for i, key in enumerate(zip(candidates.pair.tolist(), candidates.face_position, strict=True))
    }
    carried = np.zeros((*force.shape[:2], candidates.pair.size))
    keys = zip(part.pair.tolist(), part.face_position, strict=True)
    carried[:, :, [column[key] for key in keys]] = force
    return carried
