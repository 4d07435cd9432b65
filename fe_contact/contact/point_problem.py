"""One position of the contact: the forces of its contacts under given motions of the bodies, compiled."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from fe_contact.contact.problem import ContactProblem
from fe_contact.contact.strip import (
    CURVATURE,
    free_strip,
    gap_table,
    half_strip,
    strip_at,
    strip_load,
    strip_middle,
    widest_strip,
)
from fe_contact.types import BoolArray, FloatArray, IntArray
from host.loops import inner

# Local approach of the contacts as the compiled solver uses it: increasing and concave in the load.


SMALLEST_STRIP = 1e-4
"""Half length of the contact strip over the reference length below which the law is straight."""
LARGEST_STRIP = 0.66
"""Half length of the contact strip over the reference length above which the law goes on straight."""
_TOLERANCE, _PLAIN_TOLERANCE = 1e-9, 1e-6
_STEPS = 100


_WIDTH, _FREE, _MODULUS, _MIDDLE, _HALF, _LENGTH = range(6)
"""Columns of `LocalLaw.strip`."""


class LocalLaw(NamedTuple):
    """The law of m contacts at one position."""

    gap: FloatArray
    """About the touching points, a `gap_table`. Shape (m, 4 + 3 B)."""
    strip: FloatArray
    """Length of contact line of each in m; half strip in m up to which its gap is a parabola alone; contact
    modulus E* in Pa, less where a tip corner yields; middle and half length of the strip found last, from
    which the next one is searched, m: a half length of zero is none yet; reference length in m, greater near
    free ends. Shape (m, 6).
    """
    length: float
    """Reference length away from free ends, m."""


@inner(error_model="numpy")
def local_law(gap: FloatArray, width: FloatArray, modulus: FloatArray, length: float) -> LocalLaw:
    """Return the law of a table of gaps under which no strip is known yet."""
    strip = np.zeros((width.size, 6))
    for i in range(width.size):
        strip[i, _WIDTH], strip[i, _FREE], strip[i, _MODULUS] = width[i], free_strip(gap, i), modulus[i]
        strip[i, _LENGTH] = length
    return LocalLaw(gap, strip, length)


@inner(error_model="numpy")
def approach(law: LocalLaw, i: int, force: float) -> tuple[float, float, bool]:
    """Local approach of contact `i` under `force` in N.

    Returns
    -------
    value, slope : float
        Approach in m and its derivative in m/N; both straight on below zero force.
    beyond : bool
        Whether the strip has outgrown the reference length.
    """
    width, modulus = law.strip[i, _WIDTH], law.strip[i, _MODULUS]
    p, (k, least, most) = force / width, _limits(law, i)
    half, rigid = 0.0, 0.0
    if p > 0.0:
        middle, half, rigid = half_strip(law.gap, i, p, modulus, law.strip[i, _MIDDLE], law.strip[i, _HALF])
        law.strip[i, _MIDDLE], law.strip[i, _HALF] = middle, half
    if half <= least:
        load, rigid = strip_load(law.gap, i, least, modulus)
        slope = rigid / load + k * (-math.log(SMALLEST_STRIP) - 0.25)
        return slope * p, slope / width, False
    beyond = half > most
    if beyond:
        half, (_, rigid) = most, strip_load(law.gap, i, most, modulus)
    slope = k * (math.log(law.strip[i, _LENGTH] / half) - 0.25)
    return rigid + slope * p, slope / width, beyond


@inner(error_model="numpy")
def plain_approach(law: LocalLaw, i: int, force: float) -> float:
    """Return the local approach in m of contact `i` under `force` in N, > 0, on a gap that is a parabola."""
    p, (k, least, most) = force / law.strip[i, _WIDTH], _limits(law, i)
    curvature = float(law.gap[i, CURVATURE])
    half = min(max(math.sqrt(2.0 * k * p / curvature), least), most)
    return float(0.25 * curvature * half * half + k * p * (math.log(law.strip[i, _LENGTH] / half) - 0.25))


@inner(error_model="numpy")
def width_of(law: LocalLaw, i: int) -> float:
    """Return the length of contact line of contact `i`, m."""
    return float(law.strip[i, _WIDTH])


@inner(error_model="numpy")
def carrying_strip(law: LocalLaw, i: int, force: float) -> tuple[float, float]:
    """Return middle and half length in m of the strip over which contact `i` carries `force` in N, > 0."""
    _, least, most = _limits(law, i)
    p, modulus = force / law.strip[i, _WIDTH], law.strip[i, _MODULUS]
    _, half, _ = half_strip(law.gap, i, p, modulus, law.strip[i, _MIDDLE], law.strip[i, _HALF])
    half = min(max(half, least), most)
    return (0.0 if half <= law.strip[i, _FREE] else strip_middle(law.gap, i, half)), half


@inner(error_model="numpy")
def _force_at(law: LocalLaw, i: int, value: float) -> tuple[float, float]:
    """Force of contact `i` in N at a local approach in m, and its derivative in N/m; zero where flanks part.

    The inverse of `approach`.
    """
    if value <= 0.0:
        return 0.0, 0.0
    width, free, modulus = law.strip[i, _WIDTH], law.strip[i, _FREE], law.strip[i, _MODULUS]
    middle, half, curvature = 0.0, law.strip[i, _HALF], law.gap[i, CURVATURE]
    if half <= free:
        half = _plain_strip(curvature, law.strip[i, _LENGTH], value, half)
    else:
        middle = law.strip[i, _MIDDLE]
    if half <= free:
        load, slope = _plain_load(curvature, law.strip[i, _LENGTH], modulus, half, value)
    else:
        _, least, most = _limits(law, i)
        guess = max(half, least)
        middle, half, first, rigid = strip_at(law.gap, i, value, law.strip[i, _LENGTH], middle, guess)
        carried = 0.5 * math.pi * modulus * half * first
        if not least < half < most:
            half, middle = _strip_at(law, i, value, guess), 0.0
            carried, rigid = strip_load(law.gap, i, half, modulus)
        load, slope = _load_on(half, carried, rigid, law.strip[i, _LENGTH], modulus, value)
    law.strip[i, _MIDDLE], law.strip[i, _HALF] = middle, half
    return width * load, width * slope


@inner(error_model="numpy")
def _load_on(
    half: float, carried: float, rigid: float, length: float, modulus: float, value: float
) -> tuple[float, float]:
    """Line load in N/m at an approach in m, and its derivative in N/m^2, from the strip that carries it.

    At a given strip the load follows from the approach, which is stationary in the strip, so that an error of
    the strip enters squared.
    """
    slope = 2.0 / (math.pi * modulus) * (math.log(length / half) - 0.25)
    if half <= SMALLEST_STRIP * length and value < rigid + slope * carried:
        secant = carried / (rigid + slope * carried)
        return secant * value, secant
    return (value - rigid) / slope, 1.0 / slope


@inner(error_model="numpy")
def _limits(law: LocalLaw, i: int) -> tuple[float, float, float]:
    """Return k = 2/(pi E*) in 1/Pa, and the least and the largest half strip that the formulas take, m."""
    length = law.strip[i, _LENGTH]
    return 2.0 / (math.pi * law.strip[i, _MODULUS]), SMALLEST_STRIP * length, LARGEST_STRIP * length


@inner(error_model="numpy")
def _plain_strip(curvature: float, length: float, value: float, guess: float) -> float:
    """Half strip in m of a parabola at an approach in m: y (1/4 - ln(y)/2) = 2 approach/(q l^2), y = (h/l)^2.

    Not above `LARGEST_STRIP` reference lengths. `guess`: half strip to begin with in m, or zero. The last
    step leaves its square.
    """
    scaled = 2.0 * value / (curvature * length * length)
    most = LARGEST_STRIP * LARGEST_STRIP
    if scaled >= most * (0.25 - 0.5 * math.log(most)):
        return LARGEST_STRIP * length
    y = min(guess * guess / (length * length), most)
    if y == 0.0:
        y = scaled / (0.25 - 0.4 * math.log(0.5 * scaled))
    for _ in range(_STEPS):
        following = (scaled - 0.5 * y) / (-0.25 - 0.5 * math.log(y))  # Newton's step, written out
        following = min(max(following, 0.1 * y), most)
        if abs(following - y) <= _PLAIN_TOLERANCE * y:
            return length * math.sqrt(following)
        y = following
    return length * math.sqrt(y)


@inner(error_model="numpy")
def _plain_load(
    curvature: float, length: float, modulus: float, half: float, value: float
) -> tuple[float, float]:
    """Line load in N/m of a parabola at an approach in m, its derivative in N/m^2; `half` is its strip."""
    half = max(half, SMALLEST_STRIP * length)
    rise = 0.25 * curvature * half * half
    return _load_on(half, math.pi * modulus * rise, rise, length, modulus, value)


@inner(error_model="numpy")
def _strip_at(law: LocalLaw, i: int, value: float, half: float) -> float:
    """Half strip in m at an approach in m, from a guess on; at the limits where it would be beyond them."""
    k, low, high = _limits(law, i)
    high = min(high, widest_strip(law.gap, i))
    if high <= low:
        return float(high)
    half = min(half, high)
    below, above, power = low, high, 2.0
    last_half, last_error = 0.0, math.inf
    for _ in range(_STEPS):
        load, rigid = strip_load(law.gap, i, half, law.strip[i, _MODULUS])
        error = math.log((rigid + k * load * (math.log(law.strip[i, _LENGTH] / half) - 0.25)) / value)
        if error < 0.0:
            below = half
        else:
            above = half
        if below >= above:
            return half
        if last_half > 0.0:
            power = max((error - last_error) / math.log(half / last_half), 0.3)
        following = half * math.exp(-error / power)
        if not below <= following <= above or abs(error) > 0.5 * abs(last_error):
            following = math.sqrt(below * above) if below < 0.01 * above else 0.5 * (below + above)
            if above == high and error < 0.0:
                following = high
            elif below == low and error > 0.0 and half < 10.0 * low:
                following = low
        if abs(following - half) <= _TOLERANCE * half:
            return following
        last_half, last_error, half = half, error, following
    return half


class PointProblems(NamedTuple):
    """All P positions as the compiled solver reads them; position p has the bodies of row p modulo Q."""

    bodies: FloatArray
    tilt: FloatArray
    """`bodies`, `tilt`: The tilt is empty where flanks do not roll. Shape (Q, n, n) each."""
    radius: FloatArray
    """Ndarray, shape (P, n) where flanks roll, else (Q, n)."""
    edge: FloatArray
    """Of `EdgeStrips`. Ndarray, shape (Q, n, 8) where flanks roll, else (1, n, 8)."""
    present: BoolArray
    """Shape (Q, n)."""
    curves: FloatArray
    heights: FloatArray
    """`curves`, `heights`: Ndarray, shapes (points of a pair, K), (K, K)."""
    gap: FloatArray
    motion_arm: FloatArray
    torque_arm: FloatArray
    width: FloatArray
    """`gap`, `motion_arm`, `torque_arm`, `width`: Shape (P, m) each."""
    about: FloatArray
    """A `gap_table`. Shape (P, m, 4 + 3 B)."""
    length: float
    """Reference length away from free ends, m."""
    lengths: FloatArray
    modulus: FloatArray
    """`lengths`, `modulus`: Shape (Q, m) each."""


def point_problems(problem: ContactProblem) -> PointProblems:
    """Return the positions of a contact problem, row by row in memory.

    Compiled code is made anew for every order of every array: in the order that candidates happen to have,
    the solver was compiled up to eight times, some four seconds each.
    """
    c, rows = problem.candidates, np.ascontiguousarray
    first, second = problem.half_planes
    return PointProblems(
        rows(problem.bodies),
        rows(problem.rolling),
        rows(problem.radius),
        rows(problem.edges),
        rows(c.slices.present),
        rows(c.curves),
        rows(c.heights),
        rows(c.gap * c.motion_arm),
        rows(c.motion_arm),
        rows(c.torque_share),
        rows(c.width),
        gap_table(c.gap_about),
        float(c.slices.law_length),
        rows(problem.law_length),
        rows(2.0 / (math.pi * (first + second))),
    )


class PointProblem(NamedTuple):
    """One position: m contacts that can carry force, on n = J K curves of J pairs."""

    bodies: FloatArray
    """Height of curve i per unit force on j, without what is in the local law, m/N. Shape (n, n)."""
    tilt: FloatArray
    """Tilt of the flanks at curve i per unit force on j, 1/N; see `ContactProblem`. Ndarray, shape (n, n), or
    (0, 0) where no radius is above zero.
    """
    radius: FloatArray
    """How far tilted flanks move their strip, m. Shape (n,)."""
    edge: FloatArray
    """Of `EdgeStrips`. Shape (n, 8)."""
    curve: FloatArray
    """Parts of the force of each contact on w curves beside each other, and of their heights there. Shape (m,
    w).
    """
    first: IntArray
    """The first of those curves. Shape (m,)."""
    gap: FloatArray
    """Normal rigid gap in m. Shape (m,)."""
    motion_arm: FloatArray
    torque_arm: FloatArray
    """`motion_arm`, `torque_arm`: Normal approach per unit deflection, and share of the load per unit force;
    > 0. Shape (m,) each.
    """
    law: LocalLaw


class RowBodies(NamedTuple):
    """What all problems of one row of bodies have in common."""

    there: BoolArray
    """Slices that any contact can press on. Shape (n,)."""
    moved: FloatArray
    tilt: FloatArray
    """`moved`, `tilt`: See `bodies` and `tilt` of `PointProblem`."""
    curve: FloatArray
    first: IntArray
    """`curve`, `first`: See `PointProblem`, of the points of one pair. Ndarray, shapes (points, w),
    (points,).
    """


@inner(error_model="numpy")
def row_bodies(every: PointProblems, row: int) -> RowBodies:
    """Return what positions share that repeat row `row` in further base pitches."""
    there = every.present[row]
    slices = np.flatnonzero(there)
    moved, tilt = every.bodies[row][slices][:, slices], np.zeros((0, 0))
    moved = _turned(every.heights, _turned(every.heights, moved))
    if every.tilt.size:
        tilt = _turned(every.heights, _turned(every.heights, every.tilt[row][slices][:, slices]))
    curve, first = _beside(every.curves)
    return RowBodies(there, moved, tilt, curve, first)


@inner(error_model="numpy")
def problem_at(every: PointProblems, p: int) -> tuple[PointProblem, IntArray]:
    """Return the problem of a position, and its contacts among all candidates."""
    return problem_on(every, row_bodies(every, p % every.bodies.shape[0]), p)


@inner(error_model="numpy")
def problem_on(every: PointProblems, bodies: RowBodies, p: int) -> tuple[PointProblem, IntArray]:
    """Return the problem of a position on the bodies of its row, and its contacts among all candidates."""
    row, (points, count) = p % every.bodies.shape[0], every.curves.shape
    pairs = np.cumsum(bodies.there[::count]) - 1  # of all pairs among those that are there
    here = np.flatnonzero(~(every.gap[p] == np.inf))  # also those that are not a number
    radius = every.radius[p % every.radius.shape[0]][bodies.there]
    law = local_law(every.about[p][here], every.width[p][here], every.modulus[row][here], every.length)
    law.strip[:, _LENGTH] = every.lengths[row][here]
    point = here % points
    first = pairs[here // points] * count + bodies.first[point]
    arms = every.motion_arm[p][here], every.torque_arm[p][here]
    edge = every.edge[p % every.edge.shape[0]][bodies.there]
    held = bodies.moved, bodies.tilt, radius, edge
    return PointProblem(*held, bodies.curve[point], first, every.gap[p][here], *arms, law), here


@inner(error_model="numpy")
def _turned(heights: FloatArray, moved: FloatArray) -> FloatArray:
    """Return the heights (r, n) of the curves of all pairs for motions (n, r) of their slices."""
    count, turned = heights.shape[0], np.empty(moved.shape)
    for first in range(0, moved.shape[0], count):
        np.dot(heights, moved[first : first + count], turned[first : first + count])
    return np.ascontiguousarray(turned.T)


@inner(error_model="numpy")
def _beside(curves: FloatArray) -> tuple[FloatArray, IntArray]:
    """Return the curves (points, w) that are not zero at each point, and which is the first of them."""
    points, count = curves.shape
    first, width = np.zeros(points, dtype=np.int64), 1
    for i in range(points):
        there = np.flatnonzero(curves[i])
        first[i], width = there[0], max(width, there[-1] - there[0] + 1)
    first = np.minimum(first, count - width)
    beside = np.empty((points, width))
    for i in range(points):
        beside[i] = curves[i, first[i] : first[i] + width]
    return beside, first


class State(NamedTuple):
    """The state of an iteration."""

    held: FloatArray
    """Forces on the curves h, N. Shape (n,)."""
    moved: FloatArray
    """What they move, u(h), m. Shape (n,)."""
    yielding: FloatArray
    """Its derivative, m/N. Shape (n, n)."""
    force: FloatArray
    slope: FloatArray
    """`force`, `slope`: Of the contacts under these motions: N, N/m. Shape (m,) each."""
    pressed: FloatArray
    """Those forces on the curves N'F, N. Shape (n,)."""


@inner(error_model="numpy")
def pressed_state(problem: PointProblem, force: FloatArray) -> State:
    """Return a state with the forces (m,) of the contacts on the curves; what they move is still missing."""
    n, m = problem.bodies.shape[0], force.size
    yielding = np.zeros((n, n)) if problem.tilt.size else problem.bodies  # it stays where no flank rolls
    state = State(np.zeros(n), np.zeros(n), yielding, force, np.zeros(m), np.zeros(n))
    press(problem, force, state.pressed)
    state.held[:] = state.pressed
    return state


@inner(error_model="numpy")
def evaluate(problem: PointProblem, gap: FloatArray, elastic: float, state: State) -> None:
    """Fill in forces and slopes of the contacts, and the forces on the curves, under the motions."""
    law, arm, motion = problem.law, problem.motion_arm, motions(problem, state.moved)
    for q in range(gap.size):
        state.force[q], state.slope[q] = _force_at(law, q, arm[q] * elastic - gap[q] - motion[q])
    press(problem, state.force, state.pressed)


@inner(error_model="numpy")
def press(problem: PointProblem, force: FloatArray, out: FloatArray) -> None:
    """Fill in the forces of the contacts on the curves."""
    out[:] = 0.0
    for q in range(force.size):
        if force[q] != 0.0:
            for a in range(problem.curve.shape[1]):
                out[problem.first[q] + a] += problem.curve[q, a] * force[q]


@inner(error_model="numpy")
def motions(problem: PointProblem, moved: FloatArray) -> FloatArray:
    """Return the motions of the bodies at the contacts (m,) from those of the curves, m."""
    curve, first, out = problem.curve, problem.first, np.empty(problem.first.size)
    for q in range(out.size):
        value = 0.0
        for a in range(curve.shape[1]):
            value += curve[q, a] * moved[first[q] + a]
        out[q] = value
    return out


@inner(error_model="numpy")
def stiffness(problem: PointProblem, state: State) -> float:
    """Return how fast the contacts take load as the gear moves, N/m."""
    value = 0.0
    for q in range(state.slope.size):
        value += problem.torque_arm[q] * state.slope[q] * problem.motion_arm[q]
    return value
