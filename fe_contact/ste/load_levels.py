"""Levels between the stored loads: with the kink where a further tooth pair comes into contact."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fe_contact.ste.metadata import PairGeometry
from fe_contact.types import BoolArray, FloatArray, IntArray

# levels inserted into all steps with a kink together; with more, the position knots limit the accuracy
_INSERTED = 64


# largest size of an array over positions and levels: tables of long periods have fewer inserted levels, at
# least one in each step with a kink; 12 in place of 64 change curves between the loads by up to 12 nm (rms)
_NUMBERS = 2_000_000


# a branch stiffens with F^exponent; line contact is near 0.1, a triangle of contact 0.5
_LARGEST_EXPONENT = 0.5


# halvings of the interval of an exponent: to 1e-9
_HALVINGS = 30


# least compliance of a smooth curve over the mean one of its step: inside it a cubic may be flat
_MIN_COMPLIANCE = 0.1


# power of the force in which the deflection of a smooth step is a cubic: of 0, 1/4, 1/2 and 1 the one with
# the smallest errors over loads five times apart, chosen on the same ten drawn pairs (seed 7) whose errors
# docs/decisions/0012 states
_POWER = 0.25


# ratio of loads up to which a cubic between deflection and force is close enough to the smooth curve
_CLOSE_LOADS = 1.5


# overlap ratio from which a helical pair comes into contact gradually: over so long a path the gap beyond the
# path of contact grows by several deflections
_GRADUAL_OVERLAP = 0.1


Pair = tuple[FloatArray, FloatArray]  # deflection in m and stiffness in N/m


SMOOTHING = 0.01
"""Half width of the smoothed change of direction at the pitch point, base pitches."""


@dataclass(frozen=True)
class LoadLevels:
    """A stack of levels: force (L,) N, deflection m and stiffness N/m (P, M, D, L)."""

    force: FloatArray
    deflection: FloatArray
    stiffness: FloatArray


def smooth_share(gears: PairGeometry) -> float:
    """Return the share of the smooth curve in inserted levels, 0 to 1, by how a further pair begins to touch.

    Along a whole line (0) the stiffness jumps; from a corner (1) the line of contact grows from nothing, and
    so does the stiffness.
    """
    overlap = gears.face_width * math.tan(gears.base_helix_angle) / gears.base_pitch
    return min(overlap / _GRADUAL_OVERLAP, 1.0)


def refined_levels(levels: LoadLevels, pairs: IntArray, gradual: float) -> LoadLevels:
    """Insert levels into steps that hold a kink at some position, and into wide steps.

    `pairs` (P, M, D, L) counts the pairs in contact; level 0 is lift-off. At positions without a kink, and to
    the part `gradual` at all positions, the inserted levels lie on the smooth curve.
    """
    secant = np.diff(levels.force) / np.diff(levels.deflection, axis=-1)
    below, above = levels.stiffness[..., :-1], levels.stiffness[..., 1:]
    kinked = (np.diff(pairs, axis=-1) > 0) & (below < secant) & (secant < above) & (gradual < 1.0)
    pieces = [levels]
    for k, count in _inserted_counts(levels, kinked).items():
        low, high = levels.force[k : k + 2]
        force = low * (high / low) ** (np.arange(1, count + 1) / (count + 1))
        deflection, stiffness = _smooth(levels, k, force)
        sharp = np.where(kinked[..., k, None], 1.0 - gradual, 0.0)
        if sharp.any():
            kinked_deflection, stiff = _on_branches(levels, pairs, k, force)
            deflection = deflection + sharp * (kinked_deflection - deflection)
            stiffness = 1.0 / (1.0 / stiffness + sharp * (1.0 / stiff - 1.0 / stiffness))
        pieces.append(LoadLevels(force, deflection, stiffness))
    return _load_refinement_merged(pieces)


def _inserted_counts(levels: LoadLevels, kinked: BoolArray) -> dict[int, int]:
    """Return how many levels to insert into the steps that get any.

    Steps with a kink share the levels that the table has room for, at least one each; wide steps get levels
    only if there is room for all of these.
    """
    steps = range(1, levels.force.size - 1)
    kinks = [k for k in steps if kinked[..., k].any()]
    bearable = _NUMBERS // levels.deflection[..., 0].size - levels.force.size
    inserted = min(max(bearable, len(kinks)), _INSERTED) if kinks else 0
    counts = {k: -(-inserted // len(kinks)) for k in kinks}  # rounded up
    ratio = levels.force[2:] / levels.force[1:-1]
    steps_between = np.ceil(np.log(ratio) / math.log(_CLOSE_LOADS) * (1.0 - 1e-9)).astype(int) - 1
    wide = {k: int(steps_between[k - 1]) for k in steps if k not in counts and steps_between[k - 1] > 0}
    return counts | wide if sum(wide.values()) + inserted <= bearable else counts


def _smooth(levels: LoadLevels, k: int, force: FloatArray) -> Pair:
    """Deflection and stiffness at `force` on the smooth curve of step k, monotone.

    The curve is a straight line and, for what the deflection has beyond it, a cubic in F^`_POWER`: a linear
    law stays linear.
    """
    ends = levels.force[k : k + 2]
    lag, compliance = levels.deflection[..., k : k + 2], 1.0 / levels.stiffness[..., k : k + 2]
    straight = _straight_compliance(compliance, np.diff(lag, axis=-1) / (ends[1] - ends[0]))
    axis = ends**_POWER
    width = axis[1] - axis[0]
    beyond = lag - straight * ends
    rise = np.diff(beyond, axis=-1)
    # d lag / d F^p = (d lag / dF) F^(1 - p) / p
    slope = np.minimum((compliance - straight) * ends ** (1.0 - _POWER) / _POWER, 3.0 * rise / width)
    t = (force**_POWER - axis[0]) / width
    s = 1.0 - t
    tangents = (s * slope[..., :1] - t * slope[..., 1:]) * width
    deflection = beyond[..., :1] + t * t * (3.0 - 2.0 * t) * rise + t * s * tangents + straight * force
    growth = 6.0 * t * s * rise / width
    growth += s * (1.0 - 3.0 * t) * slope[..., :1] + t * (3.0 * t - 2.0) * slope[..., 1:]
    softness = straight + growth * _POWER * force ** (_POWER - 1.0)
    minimum = _MIN_COMPLIANCE * np.diff(lag, axis=-1) / (ends[1] - ends[0])
    return deflection, 1.0 / np.maximum(softness, minimum)


def _straight_compliance(compliance: FloatArray, secant: FloatArray) -> FloatArray:
    """Return the compliance (..., 1) of the straight part of a step, m/N, >= 0.

    It is that of the stiffer end, or less where the other end is soft. The secant of the remainder is then at
    least a third of its largest slope, as a monotone cubic needs.
    """
    largest = compliance.max(axis=-1, keepdims=True)
    part = np.minimum(compliance.min(axis=-1, keepdims=True), 1.5 * secant - 0.5 * largest)
    return np.asarray(np.maximum(part, 0.0))


def _on_branches(levels: LoadLevels, pairs: IntArray, k: int, force: FloatArray) -> Pair:
    """Deflection and stiffness at `force` on the stiffer of the branches from both ends of step k.

    A branch takes its curvature from the next step on its own side, or as much of it as lets it meet the
    other branch inside the step.
    """
    ends = levels.force[k : k + 2]
    start, end = levels.deflection[..., k, None], levels.deflection[..., k + 1, None]
    wanted = _exponent(levels, pairs, k - 1)
    before = _largest_exponent(levels, k, wanted, ends[1:], end, np.greater_equal)
    wanted = _exponent(levels, pairs, k + 1)
    after = _largest_exponent(levels, k + 1, wanted, ends[:1], start, np.greater)
    lower, upper = _branch(levels, k, before, force), _branch(levels, k + 1, after, force)
    soft, stiff = (
        levels.stiffness[..., level, None] * (force / levels.force[level]) ** exponent
        for level, exponent in ((k, before), (k + 1, after))
    )
    return np.minimum(lower, upper), np.where(lower < upper, soft, stiff)


def _largest_exponent(
    levels: LoadLevels,
    k: int,
    maximum: FloatArray,
    force: FloatArray,
    limit: FloatArray,
    compare: Callable[[FloatArray, FloatArray], BoolArray],
) -> FloatArray:
    """Return the largest exponents (P, M, D, 1) up to `maximum` with which branches compare with a limit.

    `compare` takes the deflection at `force` on the branch of level k, and the `limit`, both (P, M, D, 1). It
    holds for the exponent 0. Branches for which it holds with the maximum are not searched.
    """
    short = ~compare(_branch(levels, k, maximum, force), limit)[..., 0]
    if not short.any():
        return maximum
    high, limit, ratio = maximum[short], limit[short], force / levels.force[k]
    # what of a branch does not depend on the exponent
    start, stiffness = _branch_start(levels, k)
    start, stiffness = start[short], stiffness[short]
    low = np.zeros_like(high)
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        inside = compare(start + _rise(stiffness, levels.force[k], ratio, middle), limit)
        low, high = np.where(inside, middle, low), np.where(inside, high, middle)
    exponent = maximum.copy()
    exponent[short] = low
    return exponent


def _branch(levels: LoadLevels, k: int, exponent: FloatArray, force: FloatArray) -> FloatArray:
    """Return the deflection at forces on the branch of level k, whose stiffness grows with F^exponent, m."""
    start, stiffness = _branch_start(levels, k)
    return np.asarray(start + _rise(stiffness, levels.force[k], force / levels.force[k], exponent))


def _rise(stiffness: FloatArray, force: float, ratio: FloatArray, exponent: FloatArray) -> FloatArray:
    """Return how far a branch of this stiffness at a force rises to `ratio` times the force, m."""
    power = 1.0 - exponent
    return np.asarray(force / (stiffness * power) * (ratio**power - 1.0))


def _branch_start(levels: LoadLevels, k: int) -> tuple[FloatArray, FloatArray]:
    """Return deflection in m and stiffness in N/m of level k, infinite at lift-off, (..., 1) each."""
    stiffness = levels.stiffness[..., k, None]
    return levels.deflection[..., k, None], np.where(stiffness > 0.0, stiffness, np.inf)


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


def _load_refinement_merged(pieces: list[LoadLevels]) -> LoadLevels:
    force = np.concatenate([piece.force for piece in pieces])
    order = np.argsort(force)
    deflection = np.concatenate([piece.deflection for piece in pieces], axis=-1)
    stiffness = np.concatenate([piece.stiffness for piece in pieces], axis=-1)
    return LoadLevels(force[order], deflection[..., order], stiffness[..., order])
