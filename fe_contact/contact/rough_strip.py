r"""Strips of rough flanks: even gaps of parabolas with the same approach under load.

Flanks with waves as short as the strip touch at a crest, then at the crests beside it, then all over: no
parabola describes that. Two half planes with the true gap are solved under some loads [1]_, and the breaks of
an even gap are placed so that its strip (`fe_contact.contact.strip`) gives way as much. All of it is
geometry: lengths are over the relative radius of plain flanks, loads are P = 2 p/(pi E*) over it, so that the
half strip of plain flanks is sqrt(2 P).

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

_RATIO = 1.6
HALF_STRIPS: FloatArray = np.array([0.0025 * _RATIO**k for k in range(8)])
"""Half strips of plain flanks under the solved loads, over the relative radius. Gears under rated loads have
0.01 to 0.04.
"""
LOADS: FloatArray = 0.5 * HALF_STRIPS**2
BREAKS = 2 * HALF_STRIPS.size
_USUAL = 4
"""Index of the load whose centroid the patch has: a half strip of 0.016."""
_CELLS = 48
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
        Where the true gap is least, m.
    curvature : ndarray, shape (n,)
        Of plain flanks, 1/m.
    spread : ndarray, shape (n,)
        Bound of highest less lowest deviation from these, m.
    """
    count = position.size
    crest, center, error = np.empty((3, count))
    ends, bends = np.empty((2, count, BREAKS // 2))
    for part in np.array_split(np.arange(count), count // _AT_ONCE + 1):
        excess, center[part] = _excess(gap_of, part, position[part], curvature[part], spread[part])
        crest[part], ends[part], bends[part], error[part] = _even_gaps(excess, HALF_STRIPS, LOADS)
    ends, bends = ends / curvature[:, None], bends * curvature[:, None]
    places, no_end = np.concatenate([ends, -ends], axis=1), np.full(count, np.inf)
    gap = Gap(
        slope=np.zeros(count),
        curvature=crest * curvature,
        low=-no_end,
        high=no_end,
        offset=places,
        jump=np.zeros(places.shape),
        bend=np.concatenate([bends, bends], axis=1),
    )
    return RoughStrip(gap, center / curvature, error)


def _excess(
    gap_of: GapOf, part: IntArray, position: FloatArray, curvature: FloatArray, spread: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the approach (n, K) of flanks beyond that of plain ones under the loads, and centroids (n,).

    What cells miss is the same on plain flanks.
    """
    cells, raised = (np.arange(_CELLS) + 0.5) / _CELLS - 0.5, float(np.max(spread * curvature))
    excess, center = np.zeros((part.size, LOADS.size)), np.zeros(part.size)
    level = gap_of(position, part)[:, None]
    for k, half in enumerate(HALF_STRIPS):
        reach = min(math.sqrt(_MIN_WINDOW**2 + 2.0 * raised / half**2), _LARGEST_WINDOW)
        ways = 2.0 * reach * cells
        there = position[:, None] + half / curvature[:, None] * ways
        gap = gap_of(there.ravel(), np.repeat(part, _CELLS)).reshape(there.shape) - level
        approach, middle = half_planes(gap * curvature[:, None] / half**2, 2.0 * reach)
        excess[:, k] = half**2 * (approach - half_planes(0.5 * ways[None] ** 2, 2.0 * reach)[0])
        if k == _USUAL:
            center = half * middle
    return excess, center


@njit(cache=True, error_model="numpy")
def half_planes(gap: FloatArray, window: float) -> tuple[FloatArray, FloatArray]:
    """Return approach and centroid (n,) of half planes with gaps (n, N) at even places of a window.

    Lengths are over the half strip of plain flanks, gaps over its square times their curvature: the load is
    1/2. The approach is that beyond a point at a distance of 1; centroids are from the middle of the window.
    """
    count = gap.shape[1]
    kernel, plain = _kernel(count, window / count), np.zeros(count)
    places = ((np.arange(count) + 0.5) / count - 0.5) * window
    for j in range(count):
        plain[j] = math.sqrt(max(1.0 - places[j] * places[j], 0.0))
    plain *= 0.5 / plain.sum()
    approach, center = np.empty(len(gap)), np.empty(len(gap))
    for i in range(len(gap)):
        approach[i], force = _pressed(kernel, gap[i], plain)
        center[i] = 2.0 * (force * places).sum()
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
        pushed, first = force[j], count - 1 - j
        if pushed != 0.0:
            for i in range(count):
                motion[i] += kernel[first + i] * pushed
    return motion


@inner(error_model="numpy")
def _mean_where(values: FloatArray, force: FloatArray) -> float:
    """Return the mean of values on the cells that carry."""
    total, count = 0.0, 0
    for i in range(force.size):
        if force[i] > 0.0:
            total += values[i]
            count += 1
    return total / count


@inner(error_model="numpy")
def _pressed(kernel: FloatArray, gap: FloatArray, start: FloatArray) -> tuple[float, FloatArray]:
    """Return the approach of half planes with a gap (N,), and the forces on the cells, >= 0.

    Conjugate gradients on the cells that carry; they begin anew as further ones overlap. `start`: forces with
    the same sum.
    """
    count, load = gap.size, start.sum()
    force, way, along, level = start.copy(), np.zeros(count), 0.0, 0.0
    for _ in range(_STEPS):
        off = _displacements(kernel, force) + gap
        level = _mean_where(off, force)
        steep = 0.0
        for i in range(count):
            off[i] -= level
            if force[i] > 0.0:
                steep += off[i] * off[i]
        turn, along = steep / along if along > 0.0 else 0.0, steep
        for i in range(count):
            way[i] = off[i] + turn * way[i] if force[i] > 0.0 else 0.0
        bent = _displacements(kernel, way)
        mean, up, down = _mean_where(bent, force), 0.0, 0.0
        for i in range(count):
            up += off[i] * way[i]
            down += (bent[i] - mean) * way[i]
        if not down > 0.0:
            break
        step, before = up / down, force.copy()
        for i in range(count):
            if force[i] > 0.0:
                force[i] = max(force[i] - step * way[i], 0.0)
            elif off[i] < 0.0:
                force[i], along = -step * off[i], 0.0
        force *= load / force.sum()
        if np.abs(force - before).sum() <= _TOLERANCE * load:
            break
    return level, force


@njit(cache=True, error_model="numpy")
def _even_gaps(
    excess: FloatArray, plain: FloatArray, load: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Return curvatures (n,) at the touching point, breaks and bends (n, K), over plain ones, what is missed.

    Half the strip is the exponential of what a further load gives way: between two loads it follows from
    their `excess` (n, K), what the gap so far has missed included. A break at the end of the strip of one
    interval gives that of the next its length. Behind the last break flanks are plain.
    """
    count, loads = excess.shape
    crest, error = np.empty(count), np.zeros(count)
    places, bends = np.empty((count, loads)), np.zeros((count, loads))
    for i in range(count):
        reached, below, half, total = 0.0, 0.0, 0.0, 0.0
        for k in range(loads):
            between = 0.5 * plain[k] ** 2 / _RATIO  # at the middle strip of the interval
            slope = (excess[i, k] - reached) / (load[k] - below)
            longer = min(max(math.exp(-slope), _NARROWER), _WIDER)
            half = max(math.sqrt(2.0 * between) * longer, _GROWTH * half)
            if k == 0:
                crest[i] = total = 2.0 * between / half**2
            else:
                first = _even_means(half, crest[i], places[i], bends[i], k - 1)[0]
                bend = 0.5 * math.pi * (between / half - first) / past_break(places[i, k - 1], half)[3]
                bends[i, k - 1] = max(bend, FLATTEST - total)
                total += bends[i, k - 1]
            places[i, k] = half
            below = load[k]
            of_plain = below * (0.25 - math.log(plain[k]))
            reached = _approach_under(below, crest[i], places[i], bends[i], k) - of_plain
            error[i] = max(error[i], abs(reached - excess[i, k]) / math.sqrt(below))
        bends[i, loads - 1] = 1.0 - total
    return crest, places, bends, error


@inner(error_model="numpy")
def _approach_under(load: float, crest: float, places: FloatArray, bends: FloatArray, count: int) -> float:
    """Return the approach of an even gap with so many breaks under a load, beyond a patch of half-width 1."""
    low, high = 0.0, math.sqrt(2.0 * load / FLATTEST)
    half, mean = high, 0.0
    for _ in range(_HALVINGS):
        half = 0.5 * (low + high)
        first, mean = _even_means(half, crest, places, bends, count)
        if half * first < load:
            low = half
        else:
            high = half
    return mean - load * (math.log(half) + 0.25)


@inner(error_model="numpy")
def _even_means(
    half: float, crest: float, places: FloatArray, bends: FloatArray, count: int
) -> tuple[float, float]:
    """Return the means of g' sin t and of g over a strip about the middle of an even gap."""
    first, mean = 0.5 * crest * half, 0.25 * crest * half * half
    for k in range(count):
        if places[k] < half:
            _, _, _, tilted, square = past_break(places[k], half)
            first += 2.0 * bends[k] * tilted / math.pi
            mean += bends[k] * square / math.pi
    return first, mean
