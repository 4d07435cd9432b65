"""Figures of a design that limits bound, with errors from rougher discretizations of the same design."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

import numpy as np

from fe_contact.analysis.pairs.pair_contact import PairContact, pair_contact
from fe_contact.microgeometry.evaluator import Evaluation, Evaluator
from fe_contact.microgeometry.root_influence import RootInfluence

REMAINING = {"pressure": 1.0, "face_load_factor": 1.5, "root_stress": 1.0}
"""Error of each figure over its change between two discretizations. The error of a figure NAME is the field
`NAME_error` of an evaluation. The ratios were set on ten drawn pairs against finer meshes in more slices
(benchmarks/limit_coverage.py)."""


class _Change(NamedTuple):
    """A design on a discretization and on a rougher one, and the weight of their difference."""

    finer: Evaluation
    rougher: Evaluation
    weight: float = 1.0


def confirmed_figures(evaluator: Evaluator, values: Mapping[str, float], cache: Path | None) -> Evaluation:
    """Evaluate a design, ``gear.quantity`` to m, with the errors of its pressure, K_Hbeta and root stress.

    An error is the root of the sum of the squares of those of positions, slices and meshes. Each is the
    largest relative change over all nodes and loads, as a change may vanish at one of them by chance.

    Parameters
    ----------
    cache : Path, optional
        Directory of flank compliances: the coarse meshes are taken from it, or computed.
    """
    evaluation = evaluator.evaluate(values)
    changes = list(_changes(evaluator, evaluation, values, cache))
    errors = {f"{name}_error": _left(changes, name) * getattr(evaluation, name) for name in REMAINING}
    return replace(evaluation, **errors)


def _left(changes: list[_Change], name: str) -> float:
    """Return the relative error of a figure by its changes; those that are NaN count as none."""
    ratios = [getattr(change.rougher, name) / getattr(change.finer, name) for change in changes]
    parts = [
        change.weight * np.abs(np.nan_to_num(ratio, nan=1.0) - 1.0).max()
        for change, ratio in zip(changes, ratios, strict=True)
    ]
    return REMAINING[name] * float(np.linalg.norm(parts))


def _changes(
    evaluator: Evaluator, evaluation: Evaluation, values: Mapping[str, float], cache: Path | None
) -> Iterator[_Change]:
    """Solve a design on rougher discretizations; slices and meshes are changed at every second position.

    Wider load patches say nothing about root stress, as they cover the stations of the roots.
    """
    contact, discretization = evaluator.contact, evaluator.contact.plan.discretization
    even, odd = (evaluator.at(evaluator.position[parity::2]) for parity in (0, 1))

    def on(rougher: PairContact, roots: RootInfluence | None = None) -> Evaluation:
        return replace(even, contact=replace(rougher, varied=True), roots=roots).evaluate(values)

    half = even.evaluate(values)
    yield _Change(evaluation, half)
    yield _Change(evaluation, odd.evaluate(values))  # one of both halves lacks the position of the largest
    if discretization.slices > 1:
        yield _Change(half, on(contact.in_slices(discretization.coarse_slices), evaluator.roots))
    plain = contact.in_plane_strain  # as the coarse meshes are
    coarse = pair_contact(contact.pair, contact.plan, cache, coarse=True)
    by_mesh = [
        half if rougher is contact else on(rougher) for rougher in (plain, plain.in_coarse_patches, coarse)
    ]
    yield from (_Change(*ends) for ends in pairwise(by_mesh))
    if evaluator.roots is not None and evaluator.roots.rough is not None:
        rough = replace(even, roots=evaluator.roots.rough).evaluate(values)
        yield _Change(half, rough, evaluator.roots.remaining)
