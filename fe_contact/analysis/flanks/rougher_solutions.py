"""An operating point on rougher discretizations, for the errors of flank results and root stress."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

import numpy as np

from fe_contact.analysis.pairs.pair_contact import PairContact, pair_contact
from fe_contact.analysis.request.solved_run import SolvedOperatingPoint
from fe_contact.contact import ContactSolution
from fe_contact.errors import SolveError
from fe_contact.types import BoolArray, FloatArray

FEWEST_POSITIONS = 8
"""Least number of positions with which every second position is left out to measure the error between
positions.
"""


class Rougher(NamedTuple):
    """An operating point as it was solved, and on a discretization that is rougher in one respect."""

    finer: SolvedOperatingPoint
    rougher: SolvedOperatingPoint


def halves(position: FloatArray) -> tuple[BoolArray, ...]:
    """Return which of the positions (P,) are every second one, and which the others; none where few are."""
    even = np.arange(position.size) % 2 == 0
    return (even, ~even) if position.size >= FEWEST_POSITIONS else ()


def rougher_solutions(point: SolvedOperatingPoint, cache: Path | None) -> Iterator[Rougher]:
    """Yield changes by slices, load patches and meshes, at the first of the `halves` of the positions.

    Raises `MeshError`, `SolveError`: a rougher discretization has no mesh or no solution.

    Parameters
    ----------
    solved : SolvedOperatingPoint
        Of one load.
    cache : Path, optional
        Directory of flank compliances: the coarse meshes are taken from it, or computed.
    """
    contact, plan, decimated = point.contact, point.plan, point
    for even in halves(point.problem.candidates.position)[:1]:
        decimated = _at(point, even)
    if plan.discretization.slices > 1:
        yield Rougher(decimated, _on(decimated, contact.in_slices(plan.discretization.coarse_slices)))
    plain = contact.in_plane_strain  # the coarse meshes have no correction for the finite width
    by_mesh = [decimated if plain is contact else _on(decimated, plain)]
    if plain.in_coarse_patches is not plain:
        by_mesh.append(_on(decimated, plain.in_coarse_patches))
    by_mesh.append(_on(decimated, pair_contact(contact.pair, plan, cache, coarse=True)))
    yield from (Rougher(*ends) for ends in pairwise(by_mesh))


def _at(point: SolvedOperatingPoint, keep: BoolArray) -> SolvedOperatingPoint:
    """Return the operating point at some of the positions (P,)."""
    rows = np.flatnonzero(keep)
    fields = {name: values[rows] for name, values in vars(point.solution).items() if name != "load"}
    return replace(
        point, solved=[(point.problem.rows(rows), ContactSolution(load=point.solution.load, **fields))]
    )


def _on(point: SolvedOperatingPoint, contact: PairContact) -> SolvedOperatingPoint:
    """Return the operating point, solved at the same positions on another discretization."""
    places = point.places.on(contact)
    position = point.problem.candidates.position
    pitch = np.floor(position).astype(np.int64)
    problem, solution = places.places[0].solve(
        position - pitch, point.solution.load, pitch if pitch.any() else None
    )
    if not solution.converged:
        raise SolveError("positions without a solution on a rougher discretization", partial=solution)
    return replace(point, places=places, solved=[(problem, solution)])
