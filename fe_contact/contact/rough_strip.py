r"""Strips of rough flanks: even gaps of parabolas with the same approach under load.

Flanks with waves as short as the strip touch at a crest, then at the crests beside it, then all over: no
parabola describes that. Two half planes with the true gap are solved under some loads [1]_. Then an even gap,
one that is symmetric about the touching point, is composed of parabolas between breaks, so that its strip
(`fe_contact.contact.strip`) has the same approach under these loads.

Only the geometry counts: lengths are over the relative radius of plain flanks, the parabola without waves,
and loads are P = 2 p/(pi E*) over it, so that the half strip of plain flanks is sqrt(2 P).

References
----------
.. [1] I. A. Polonsky, L. M. Keer, A numerical method for solving rough contact problems based on the
   multi-level multi-summation and conjugate gradient techniques, Wear 231 (1999) 206-219.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from fe_contact.contact.strip import Gap, past_break
from fe_contact.types import FloatArray, IntArray
from host.loops import inner, njit

_RATIO = 1.6  # of successive half strips
HALF_STRIPS: FloatArray = np.array([0.0025 * _RATIO**k for k in range(8)])
"""Half strips of plain flanks under the solved loads, over the relative radius. Gears under rated loads have
0.01 to 0.04.
"""
LOADS: FloatArray = 0.5 * HALF_STRIPS**2
"""Solved loads P. K is their number."""
BREAKS = 2 * HALF_STRIPS.size
"""Number of breaks of an even gap, on both sides."""
_USUAL = 4
"""Index of the load whose centroid the patch has: a half strip of 0.016."""
_CELLS = 48
"""Number of cells of the sampled window."""
_MIN_WINDOW, _LARGEST_WINDOW = 2.7, 12.0
"""Half of the sampled window over the half strip of plain flanks, least and largest. Besides the first crest,
flanks touch at further crests. These lie as far out as deviations and deflections make up for the gap of
round flanks.
"""
FLATTEST = 0.02
"""Least curvature of the even gap: its strip grows with the load."""
_NARROWER, _WIDER = math.exp(-10.0), math.e
"""Bounds of a strip over the strip of plain flanks."""
_GROWTH = 1.15
"""Least growth of a strip from one load to the next. A gap as steep as a wall stays steep behind it."""
_STEPS, _TOLERANCE = 200, 2e-3
"""Most steps of the conjugate gradients, and the change of the forces over the load that ends them. The error
of the approach is of the order of its square.
"""
_HALVINGS = 24
"""Number of bisections in the search for a strip."""
_AT_ONCE = 512
"""Contacts whose gaps are sampled together."""

GapOf = Callable[[FloatArray, IntArray], FloatArray]
"""Gap in m at ways (k,) along the flanks of some contacts (k,)."""


class RoughStrip(NamedTuple):
    """Even gaps of n contacts, without ends, and their errors."""

    gap: Gap
    center: FloatArray
    """Distance of the load's centroid from the touching point, m. Shape (n,)."""
    approach_error: FloatArray
    """Largest error of the approach of the even gap under the solved loads, over the geometric mean of
    relative radius and 2 p/(pi E*). Under a larger load the error is larger, but at most the height of the
    waves. Shape (n,).
    """


def rough_strip(gap_of: GapOf, position: FloatArray, curvature: FloatArray, spread: FloatArray) -> RoughStrip:
    """Return the even gaps about touching points.

    Parameters
    ----------
    position : ndarray, shape (n,)
        Positions along the flanks at which the true gap is least, m.
    curvature : ndarray, shape (n,)
        Relative curvature of plain flanks, 1/m.
    spread : ndarray, shape (n,)
        Bound of the highest less the lowest deviation from plain flanks, m.
    """
    count = position.size
    crest, center, error = np.empty((3, count))
    ends, bends = np.empty((2, count, BREAKS // 2))
    for part in np.array_split(np.arange(count), count // _AT_ONCE + 1):
        excess, center[part] = _excess(gap_of, part, position[part], curvature[part], spread[part])
        crest[part], ends[part], bends[part], error[part] = _even_gaps(excess, HALF_STRIPS, LOADS)
    ends, bends = ends / curvature[:, None], bends * curvature[:, None]
    breaks, no_end = np.concatenate([ends, -ends], axis=1), np.full(count, np.inf)
    gap = Gap(
        slope=np.zeros(count),
        curvature=crest * curvature,
        low=-no_end,
        high=no_end,
        offset=breaks,
        jump=np.zeros(breaks.shape),
        bend=np.concatenate([bends, bends], axis=1),
    )
    return RoughStrip(gap, center / curvature, error)


def _excess(
    gap_of: GapOf, part: IntArray, position: FloatArray, curvature: FloatArray, spread: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the approach (n, K) of flanks beyond that of plain ones under the loads, and centroids (n,).

    Plain flanks are solved on the same cells, so that the error by the cells cancels.
    """
    cells = (np.arange(_CELLS) + 0.5) / _CELLS - 0.5
    height = float(np.max(spread * curvature))
    excess, center = np.zeros((part.size, LOADS.size)), np.zeros(part.size)
    level = gap_of(position, part)[:, None]
    for k, half in enumerate(HALF_STRIPS):
        reach = min(math.sqrt(_MIN_WINDOW**2 + 2.0 * height / half**2), _LARGEST_WINDOW)
        distance = 2.0 * reach * cells  # from the touching point, over the half strip of plain flanks
        points = position[:, None] + half / curvature[:, None] * distance
        gap = gap_of(points.ravel(), np.repeat(part, _CELLS)).reshape(points.shape) - level
        approach, centroid = half_planes(gap * curvature[:, None] / half**2, 2.0 * reach)
        plain_approach, _ = half_planes(0.5 * distance[None] ** 2, 2.0 * reach)
        excess[:, k] = half**2 * (approach - plain_approach)
        if k == _USUAL:
            center = half * centroid
    return excess, center


@njit(cache=True, error_model="numpy")
def half_planes(gap: FloatArray, window: float) -> tuple[FloatArray, FloatArray]:
    """Return approach and centroid (n,) of half planes with gaps (n, N) in N equal cells of a window.

    Lengths are over the half strip of plain flanks, gaps over its square times their curvature: the load is
    1/2. The approach is counted beyond a point at a distance of 1, the centroid from the middle of the
    window.
    """
    count = gap.shape[1]
    kernel, plain = _kernel(count, window / count), np.zeros(count)
    cells = ((np.arange(count) + 0.5) / count - 0.5) * window
    for j in range(count):
        plain[j] = math.sqrt(max(1.0 - cells[j] * cells[j], 0.0))
    plain *= 0.5 / plain.sum()  # forces of plain flanks by Hertz, from which the search starts
    approach, center = np.empty(len(gap)), np.empty(len(gap))
    for i in range(len(gap)):
        approach[i], force = _pressed(kernel, gap[i], plain)
        center[i] = 2.0 * (force * cells).sum()  # over the load of 1/2
    return approach, center


@inner(error_model="numpy")
def _kernel(count: int, cell: float) -> FloatArray:
    """Return the displacements of all cells by a unit force on the middle one, (2 N - 1,): mean -ln|x|."""
    kernel = np.empty(2 * count - 1)
    kernel[count - 1] = 1.0 - math.log(0.5 * cell)
    for d in range(1, count):
        far, near = d + 0.5, d - 0.5
        motion = 1.0 - math.log(cell) - far * math.log(far) + near * math.log(near)
        kernel[count - 1 - d], kernel[count - 1 + d] = motion, motion
    return kernel


@inner(error_model="numpy")
def _displacements(kernel: FloatArray, force: FloatArray) -> FloatArray:
    """Return the displacements under forces on even cells."""
    count = force.size
    motion = np.zeros(count)
    for j in range(count):
        first = count - 1 - j  # index in the kernel of the displacement of cell 0
        if force[j] != 0.0:
            for i in range(count):
                motion[i] += kernel[first + i] * force[j]
    return motion


@inner(error_model="numpy")
def _mean_where(values: FloatArray, force: FloatArray) -> float:
    """Return the mean of values on the cells with a force."""
    total, count = 0.0, 0
    for i in range(force.size):
        if force[i] > 0.0:
            total += values[i]
            count += 1
    return total / count


@inner(error_model="numpy")
def _pressed(kernel: FloatArray, gap: FloatArray, start: FloatArray) -> tuple[float, FloatArray]:
    """Return the approach of half planes with a gap (N,), and the forces on the cells, >= 0.

    The forces have the sum of those of `start`. Conjugate gradients [1]_ act on the cells with a force. They
    start again when further cells overlap and get a force. The residual is the gap after the displacements,
    less its mean over the cells with a force: in contact it is the same everywhere.
    """
    count, load = gap.size, start.sum()
    force, direction, previous, approach = start.copy(), np.zeros(count), 0.0, 0.0
    for _ in range(_STEPS):
        residual = _displacements(kernel, force) + gap
        approach = _mean_where(residual, force)
        square = 0.0
        for i in range(count):
            residual[i] -= approach
            if force[i] > 0.0:
                square += residual[i] * residual[i]
        share = square / previous if previous > 0.0 else 0.0  # 0: a new start, along the residual alone
        previous = square
        for i in range(count):
            direction[i] = residual[i] + share * direction[i] if force[i] > 0.0 else 0.0
        change = _displacements(kernel, direction)
        mean, numerator, denominator = _mean_where(change, force), 0.0, 0.0
        for i in range(count):
            numerator += residual[i] * direction[i]
            denominator += (change[i] - mean) * direction[i]
        if not denominator > 0.0:
            break
        step, before = numerator / denominator, force.copy()
        for i in range(count):
            if force[i] > 0.0:
                force[i] = max(force[i] - step * direction[i], 0.0)
            elif residual[i] < 0.0:
                force[i], previous = -step * residual[i], 0.0
        force *= load / force.sum()
        if np.abs(force - before).sum() <= _TOLERANCE * load:
            break
    return approach, force


@njit(cache=True, error_model="numpy")
def _even_gaps(
    excess: FloatArray, plain: FloatArray, load: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Return the curvature at the touching point, breaks, bends at them, and the error of the approach.

    Curvatures (n,), breaks and bends (n, K) are over those of plain flanks.

    The slope of the excess over the load is minus the logarithm of the half strip over that of plain flanks.
    So the half strip between two loads follows from the difference of their `excess` (n, K); the error of the
    gap so far counts too. A break at the end of the strip of one interval, with a change of curvature (bend),
    gives the strip of the next interval its length. Beyond the last break the flanks are plain.
    """
    count, loads = excess.shape
    crest, error = np.empty(count), np.zeros(count)
    breaks, bends = np.empty((count, loads)), np.zeros((count, loads))
    for i in range(count):
        reached, below, half, total = 0.0, 0.0, 0.0, 0.0  # excess, load, half strip and curvature so far
        for k in range(loads):
            middle_load = 0.5 * plain[k] ** 2 / _RATIO  # load of the geometric mean of both half strips
            slope = (excess[i, k] - reached) / (load[k] - below)
            ratio = min(max(math.exp(-slope), _NARROWER), _WIDER)
            half = max(math.sqrt(2.0 * middle_load) * ratio, _GROWTH * half)
            if k == 0:
                crest[i] = total = 2.0 * middle_load / half**2
            else:
                first = _even_means(half, crest[i], breaks[i], bends[i], k - 1)[0]
                tilted = past_break(breaks[i, k - 1], half)[3]
                bend = 0.5 * math.pi * (middle_load / half - first) / tilted
                bends[i, k - 1] = max(bend, FLATTEST - total)
                total += bends[i, k - 1]
            breaks[i, k] = half
            below = load[k]
            plain_approach = below * (0.25 - math.log(plain[k]))
            reached = _approach_under(below, crest[i], breaks[i], bends[i], k) - plain_approach
            error[i] = max(error[i], abs(reached - excess[i, k]) / math.sqrt(below))
        bends[i, loads - 1] = 1.0 - total
    return crest, breaks, bends, error


@inner(error_model="numpy")
def _approach_under(load: float, crest: float, breaks: FloatArray, bends: FloatArray, count: int) -> float:
    """Return the approach of an even gap with `count` breaks under a load, beyond a patch of half-width 1."""
    low, high = 0.0, math.sqrt(2.0 * load / FLATTEST)
    half, mean = high, 0.0
    for _ in range(_HALVINGS):
        half = 0.5 * (low + high)
        first, mean = _even_means(half, crest, breaks, bends, count)
        if half * first < load:
            low = half
        else:
            high = half
    return mean - load * (math.log(half) + 0.25)


@inner(error_model="numpy")
def _even_means(
    half: float, crest: float, breaks: FloatArray, bends: FloatArray, count: int
) -> tuple[float, float]:
    """Return the means of g' sin t and of g over a strip about the middle of an even gap.

    g is the gap at half sin t, with the angle t from -pi/2 to pi/2 over which the means are taken.
    """
    first, mean = 0.5 * crest * half, 0.25 * crest * half * half
    for k in range(count):
        if breaks[k] < half:
            _, _, _, tilted, square = past_break(breaks[k], half)
            first += 2.0 * bends[k] * tilted / math.pi
            mean += bends[k] * square / math.pi
    return first, mean
