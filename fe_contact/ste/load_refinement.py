"""Levels between the stored loads, with the kink where a further tooth pair comes into contact.

At a fixed position the load-deflection curve is smooth except where a further pair begins to carry: there
its tangent jumps. One cubic across such a kink rounds it over the whole step between two loads, which puts
false peaks of some per cent of peak-to-peak beside every handover. Both branches are known, though, by a
point and a tangent each, and so is where they meet. Levels laid into the step follow the two branches and
leave only the short cubic that holds the kink to round it. Measured gains: docs/theory/ste-database.md.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fe_contact.ste.force_cubic import ForceCubic
from fe_contact.types import BoolArray, FloatArray, IntArray

# shared by the steps that hold a kink; with more, the position knots are what limits the table
_INSERTED = 64
# a branch stiffens with F^exponent; line contact is near 0.1, a triangle of contact 0.5
_LARGEST_EXPONENT = 0.5


Pair = tuple[FloatArray, FloatArray]  # deflection in m and stiffness in N/m


@dataclass(frozen=True)
class LoadLevels:
    """A stack of levels: force (L,) N, deflection m and stiffness N/m (P, M, D, L)."""

    force: FloatArray
    deflection: FloatArray
    stiffness: FloatArray


def refined(levels: LoadLevels, pairs: IntArray) -> LoadLevels:
    """Insert levels into every step in which a pair comes into contact at some position.

    `pairs` (P, M, D, L) counts the pairs in contact; level 0 is lift-off. At positions without a kink in the
    step the inserted levels lie on the cubic that is there anyway.
    """
    kinked = _kinked(levels, pairs)
    steps = [k for k in range(1, levels.force.size - 1) if kinked[..., k].any()]
    if not steps:
        return levels
    parts = 1 + -(-_INSERTED // len(steps))
    fractions = np.arange(1, parts) / parts
    pieces = [levels]
    for k in steps:
        force = levels.force[k] + fractions * (levels.force[k + 1] - levels.force[k])
        smooth, branches = _on_cubic(levels, k, force), _on_branches(levels, pairs, k, force)
        chosen = (
            np.where(kinked[..., k, None], kink, cubic) for kink, cubic in zip(branches, smooth, strict=True)
        )
        pieces.append(LoadLevels(force, *chosen))
    return _merged(pieces)


def _kinked(levels: LoadLevels, pairs: IntArray) -> BoolArray:
    """Find the steps (P, M, D, L - 1) in which a pair is added and the two tangents meet."""
    secant = np.diff(levels.force) / np.diff(levels.deflection, axis=-1)
    below, above = levels.stiffness[..., :-1], levels.stiffness[..., 1:]
    return np.asarray((np.diff(pairs, axis=-1) > 0) & (below < secant) & (secant < above))


def _on_branches(
    levels: LoadLevels, pairs: IntArray, k: int, force: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Deflection and stiffness at `force` on the softer of the branches from both ends of step k.

    A branch takes its curvature from the next step on its own side; not so where it would then miss the
    other end of the step.
    """
    ends = levels.force[k : k + 2]
    start, end = levels.deflection[..., k, None], levels.deflection[..., k + 1, None]
    before, after = _exponent(levels, pairs, k - 1), _exponent(levels, pairs, k + 1)
    before = np.where(_branch(levels, k, before, ends[1:])[0] >= end, before, 0.0)
    after = np.where(_branch(levels, k + 1, after, ends[:1])[0] <= start, 0.0, after)
    (lower, soft), (upper, stiff) = _branch(levels, k, before, force), _branch(levels, k + 1, after, force)
    return np.minimum(lower, upper), np.where(lower < upper, soft, stiff)


def _branch(
    levels: LoadLevels, k: int, exponent: FloatArray, force: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Deflection and stiffness at `force` from level k on, with stiffness growing as F^exponent."""
    ratio, stiffness = force / levels.force[k], levels.stiffness[..., k, None]
    power = 1.0 - exponent
    rise = levels.force[k] / (np.where(stiffness > 0.0, stiffness, np.inf) * power) * (ratio**power - 1.0)
    return levels.deflection[..., k, None] + rise, stiffness * ratio**exponent


def _exponent(levels: LoadLevels, pairs: IntArray, k: int) -> FloatArray:
    """Exponent (P, M, D, 1) of stiffness over force in step k; 0 where it is not one branch of a curve."""
    if k == levels.force.size - 1:
        return np.zeros((*levels.deflection.shape[:-1], 1))
    force = levels.force[k : k + 2]
    below, above = levels.stiffness[..., k, None], levels.stiffness[..., k + 1, None]
    if k == 0:  # from lift-off on F ~ (d - d0)^n, so that K ~ F^(1 - 1/n)
        straight = np.maximum(above * np.diff(levels.deflection[..., :2], axis=-1), force[1])
        return np.asarray(np.minimum(1.0 - force[1] / straight, _LARGEST_EXPONENT))
    branch = (pairs[..., k, None] == pairs[..., k + 1, None]) & (below > 0.0)
    growth = np.log(np.where(branch, above / np.where(branch, below, 1.0), 1.0))
    return np.asarray(np.clip(growth / np.log(force[1] / force[0]), 0.0, _LARGEST_EXPONENT))


def _on_cubic(levels: LoadLevels, k: int, force: FloatArray) -> Pair:
    """Deflection and stiffness at `force` on the cubic of step k."""
    shape = (*levels.deflection.shape[:-1], force.size)
    deflection, stiffness = (
        np.repeat(entry[..., k : k + 2].reshape(-1, 2), force.size, axis=0)
        for entry in (levels.deflection, levels.stiffness)
    )
    flat = np.zeros_like(deflection)
    cubic = ForceCubic(
        deflection, flat, np.broadcast_to(levels.force[k : k + 2], flat.shape), stiffness, flat
    )
    forces, nowhere = np.tile(force, len(flat) // force.size), np.zeros(len(flat), bool)
    at_force = cubic.deflection(forces, nowhere)
    return at_force.reshape(shape), cubic.sample(at_force, nowhere, nowhere)[1].reshape(shape)


def _merged(pieces: list[LoadLevels]) -> LoadLevels:
    """All levels in the order of their forces."""
    force = np.concatenate([piece.force for piece in pieces])
    order = np.argsort(force)
    deflection = np.concatenate([piece.deflection for piece in pieces], axis=-1)
    stiffness = np.concatenate([piece.stiffness for piece in pieces], axis=-1)
    return LoadLevels(force[order], deflection[..., order], stiffness[..., order])
