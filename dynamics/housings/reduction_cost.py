"""CPU time and memory of the reduction of a housing, predicted before it runs."""

from __future__ import annotations

from typing import NamedTuple

from bounds import MAX_BYTES
from dynamics.housings.free_modes import basis_vectors
from dynamics.work_cost import Cost

REFERENCE = 1e5
"""Freedoms at which the figures below hold: walls 10 mm thick, the reference host of `host_speed`.

Fitted to a thin-walled cast box of 9 500 to 221 000 freedoms and 20 to 80 modes.
"""
ASSEMBLY, FACTOR, SOLVE = 2.9, 6.8, 0.074
"""CPU seconds: matrices and their ordering, factor, one step of Lanczos' method or one deflection."""
ORTHOGONALIZATION, PROJECTION = 2.7e-4, 1.6e-4
"""CPU seconds of one step against one vector of Lanczos' basis, and of one pair of vectors in Galerkin's
matrices.
"""
FIRST_STEPS, STEPS_PER_MODE = 36.0, 1.8
"""Steps of Lanczos' method, restarts included: those without any mode, and those per mode."""
REFINED = 2.0
"""Solutions for a deflection: one, and its refinement."""
FILL = 0.935e9
"""Bytes of the matrices and their factor."""


class CostLimit(NamedTuple):
    """Limits of CPU time (s) and memory (bytes) of a reduction."""

    seconds: float = 600.0
    bytes: float = MAX_BYTES


def reduction_cost(freedoms: int, modes: int, motions: int) -> Cost:
    """Predict the cost of `reduce_housing` on the reference host.

    A solid block fills its factor more.

    Parameters
    ----------
    freedoms : int
        Freedoms of the mesh.
    motions : int
        Motions of all seats.
    """
    size = freedoms / REFERENCE
    steps, basis = FIRST_STEPS + STEPS_PER_MODE * modes, basis_vectors(modes)
    seconds = (
        ASSEMBLY * size**1.3
        + FACTOR * size**1.55
        + SOLVE * size**1.25 * (steps + REFINED * motions)
        + size**1.1 * (ORTHOGONALIZATION * steps * basis + PROJECTION * (modes + motions) ** 2)
    )
    vectors = basis + modes + 4.0 * motions  # vectors of all freedoms in memory at once
    return Cost(seconds, FILL * size**1.1 + 8.0 * freedoms * vectors)
