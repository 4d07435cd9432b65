"""Methods that search the unit cube for the design of least merit.

A point of the unit cube is a design: each coordinate is a variable over its range. The merit is the objective
with a penalty for limits that are exceeded. The rough merit costs less and ranks designs only. A walk is a
sequence of designs, each from the linear program about the one before.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import count
from typing import Protocol

import numpy as np
from scipy.optimize import Bounds, differential_evolution, minimize

from fe_contact.errors import integer
from fe_contact.microgeometry.counted_merit import Budget, BudgetUsed, CountedMerit, Design
from fe_contact.microgeometry.design_problem import Merit, SearchProblem
from fe_contact.types import FloatArray, Json
from model_studies.progress import unreported

SIMPLEX_SIZE, SIMPLEX_MERIT = 1e-3, 1e-4
"""Size of a converged simplex, over the range of a variable, and its range of merits over the merit of the
start.
"""


EDGE = 0.2
"""Edge of the first simplex over the ranges, towards the inside."""


SPREAD = 1e-3
"""Standard deviation of the merit over a converged population, over its mean."""


FIRST_REGION = 0.2
"""Largest step of a linear program to begin with, in parts of the ranges."""


POOR, GOOD, POORER = 0.25, 0.75, 0.4
"""Parts of the predicted fall below and above which the trust region shrinks or grows, and the part of the
step that it shrinks to.
"""


TRIED = 7
"""Steps of every start; then the best of them is followed to its end."""


ASIDE, MIN_GAIN, MISSES = 0.05, 0.005, 3
"""Restarts of a walk near its end: largest distance over the ranges, least relative gain that counts, and
number of consecutive restarts without such a gain that ends the walk.
"""


FINISHED = 3
"""Number of rough walks that are continued by the merit: the best by it."""


EXPLORED = 0.65
"""Part of the designs that exploration may use: the simplex behind it needs some hundred to converge."""


Cancel = Callable[[], bool]


LINEARIZED, FOLLOWED = 2.1, 75
"""Cost of a design with its slopes in assessments (2.1 of a helical pair with five variables), and number of
designs of the walk to the end and of its restarts.
"""


class Method(Protocol):
    """A way to search the unit cube."""

    def minimize(
        self, merit: CountedMerit, rough: CountedMerit, start: FloatArray, seed: np.random.SeedSequence
    ) -> None:
        """Search from `start` (d,) until converged; the merits remember the best.

        `rough` costs less and only ranks designs; its designs may end before those of `merit`. Raises
        `BudgetUsed`, `Cancelled` by the merit: the search is over.
        """

    def to_json(self) -> Json:
        """Return plain JSON."""


@dataclass(frozen=True)
class NelderMead:
    """Simplex of Nelder and Mead (1965) in bounds, its coefficients by dimension (Gao and Han 2012).

    Cheap and local: start it more than once.
    """

    def minimize(
        self, merit: CountedMerit, rough: CountedMerit, start: FloatArray, seed: np.random.SeedSequence
    ) -> None:
        """Search; nothing is random, and nothing is rough."""
        bounds = Bounds(np.zeros(start.size), np.ones(start.size))
        minimize(
            merit,
            start,
            method="Nelder-Mead",
            bounds=bounds,
            options={
                "initial_simplex": np.vstack([start, start + np.diag(np.where(start < 0.5, EDGE, -EDGE))]),
                "xatol": SIMPLEX_SIZE,
                "fatol": SIMPLEX_MERIT,
                "adaptive": True,
                "maxfev": 10**9,
            },
        )

    def to_json(self) -> Json:
        """Return plain JSON."""
        return {"method": "nelder_mead"}


@dataclass(frozen=True)
class SequentialLinearProgramming:
    """Linear programs over the derivatives of the curves in a trust region, from design to design.

    Peak-to-peak is made of maxima, whose kinks a program of all positions, loads and nodes sees [1]_. It is
    local: a Sobol' sequence ranked by the rough merit gives further starts; each is followed for some
    designs, the best of them to its end. Where a contact begins curves have kinks that a program sees from
    one side only; so it is taken up again a little beside where it ended.

    References
    ----------
    .. [1] K. Madsen, H. Schjaer-Jacobsen, Linearly constrained minimax optimization, Math. Programming 14
       (1978) 208-223.
    """

    sample: int = 64
    """Points of the sequence, 0 to 4096; 0: from the start alone."""
    trials: int = 3
    """The best of them that are followed, 0 to 64."""

    def __post_init__(self) -> None:
        integer("method.sample", self.sample, 0, 4096)
        integer("method.trials", self.trials, 0, 64)

    def minimize(
        self, merit: CountedMerit, rough: CountedMerit, start: FloatArray, seed: np.random.SeedSequence
    ) -> None:
        """Search; the sequence and the points beside an end are random."""
        walks = [_begun(merit, _Walk(start))]
        walks += [
            _begun(merit, _Walk(point))
            for point in _screened(rough, self.sample, self.trials, start.size, seed)
        ]
        if len(walks) > 1:
            walks = list(_following_walks(merit, walks, TRIED))
        _try_neighbors(merit, _followed(merit, min(walks, key=lambda walk: walk.value)), seed)

    def to_json(self) -> Json:
        """Return plain JSON."""
        return {"method": "sequential_linear_programming", "sample": self.sample, "trials": self.trials}


@dataclass(frozen=True)
class StagedLinearProgramming:
    """Sequential linear programmes for a rough merit that is nearly the merit itself, and much cheaper.

    The best points of a Sobol' sequence and the start are followed to their ends by the rough merit: where a
    walk comes to is not told by its first steps. The best ends by the merit are followed on by it. `sample`,
    `trials`: as of `SequentialLinearProgramming`.
    """

    sample: int = 64
    trials: int = 8

    def minimize(
        self, merit: CountedMerit, rough: CountedMerit, start: FloatArray, seed: np.random.SeedSequence
    ) -> None:
        """Search; where walks of the rough merit end, and those of the merit, is remembered by each."""
        merit(start)
        with suppress(BudgetUsed):
            points = [start, *_screened(rough, self.sample, self.trials, start.size, seed)]
            for walk in _following_walks(rough, [_Walk(point) for point in points]):
                rough.end(walk.position)
            assessed, position = min(rough.ends, key=lambda design: design[0].merit)
            _try_neighbors(rough, _Walk(position, value=assessed.merit), seed)
        known = sorted([*rough.ends, *filter(None, (rough.best,))], key=lambda design: design[0].order)
        starts: list[FloatArray] = []
        for _, position in known:
            if all(np.abs(position - other).max() > ASIDE for other in starts):
                starts.append(position)
        ranked = sorted(zip(merit.assessed_in_turn(starts), range(len(starts)), strict=True))
        for _ in _following_walks(merit, [_Walk(starts[index]) for _, index in ranked[:FINISHED]]):
            pass  # the merit remembers the best

    def to_json(self) -> Json:
        """Return plain JSON."""
        return {"method": "staged_linear_programming", "sample": self.sample, "trials": self.trials}


def _screened(
    rough: CountedMerit, sample: int, trials: int, dimensions: int, seed: np.random.SeedSequence
) -> list[FloatArray]:
    """Return the best trials of a sample of a Sobol' sequence, as far as the designs reach."""
    from scipy.stats import qmc  # noqa: PLC0415 (start-up time)

    explored: list[tuple[float, FloatArray]] = []
    with suppress(BudgetUsed):
        sequence = qmc.Sobol(dimensions, rng=np.random.default_rng(seed))
        points = list(sequence.random_base2((sample - 1).bit_length())[:sample])
        for value, point in zip(rough.assessed_in_turn(points), points, strict=True):
            explored.append((value, point))
    explored.sort(key=lambda trial: trial[0])
    return [point for value, point in explored[:trials] if np.isfinite(value)]


def _try_neighbors(merit: CountedMerit, best: _Walk, seed: np.random.SeedSequence) -> None:
    """Restart a walk near its end until `MISSES` restarts in a row gain too little."""
    random, misses = np.random.default_rng(seed.spawn(1)[0]), 0
    draws: list[FloatArray] = []
    while misses < MISSES and np.isfinite(best.value):
        fresh = MISSES - misses - len(draws)
        draws += [random.uniform(-1.0, 1.0, best.position.size) for _ in range(fresh)]
        asides = [np.clip(best.position + ASIDE * draw, 0.0, 1.0) for draw in draws]
        for other in _following_walks(merit, [_Walk(aside, 2.0 * ASIDE) for aside in asides]):
            draws.pop(0)
            misses = 0 if other.value < (1.0 - MIN_GAIN) * best.value else misses + 1
            if other.value < best.value:
                best = other
                break  # the other restarts began near the previous best design


@dataclass(frozen=True)
class _Walk:
    """State of a walk by linear programs: `position` (d,) is the best design so far, `value` its merit."""

    position: FloatArray
    region: float = FIRST_REGION
    value: float = np.inf
    linear: Merit | None = None


def _begun(merit: CountedMerit, walk: _Walk) -> _Walk:
    """Assess the design that a walk starts from."""
    value, linear = merit.linearize(walk.position)
    return replace(walk, value=value, linear=linear)


def _followed(merit: CountedMerit, walk: _Walk, maximum: int | None = None) -> _Walk:
    """Begin, and step until converged, or so often at most."""
    walk = _begun(merit, walk) if walk.linear is None else walk
    for _ in range(maximum) if maximum is not None else count():
        if not np.isfinite(walk.value) or walk.region <= SIMPLEX_SIZE:
            break
        further = _stepped(merit, walk)
        if further is None:
            break
        walk = further
    return walk


def _stepped(merit: CountedMerit, walk: _Walk) -> _Walk | None:
    """Take a step if one promises anything; shorten the region where it keeps too little of it."""
    ends = np.maximum(-walk.region, -walk.position), np.minimum(walk.region, 1.0 - walk.position)
    assert walk.linear is not None
    step, promised = walk.linear.minimum(*ends)
    if walk.value - promised <= SIMPLEX_MERIT * walk.value:
        return None
    point = np.clip(walk.position + step, 0.0, 1.0)
    value, linear = merit.linearize(point)
    fulfilled, region = (walk.value - value) / (walk.value - promised), walk.region
    if fulfilled < POOR:
        region = POORER * float(np.abs(step).max())
    elif fulfilled > GOOD:
        region = min(2.0 * region, 1.0)
    return _Walk(point, region, value, linear) if value < walk.value else replace(walk, region=region)


def _following_walks(
    merit: CountedMerit, walks: Sequence[_Walk], maximum: int | None = None
) -> Iterator[_Walk]:
    """Follow walks that do not wait for each other, to their ends or so far at most, and yield each."""
    if len(walks) < 2 or not merit.divides:
        yield from (_followed(merit, walk, maximum) for walk in walks)
        return
    tasks = [(walk, maximum, merit.left + 1) for walk in walks]
    for walk, designs in merit.workers.run(_walked, merit.problem, tasks):
        merit.replay(designs)
        yield walk


def _walked(problem: SearchProblem, task: tuple[_Walk, int | None, int]) -> tuple[_Walk, list[Design]]:
    """Follow a walk: one task.

    It may assess one design more than are left: the caller, who counts them, ends there as it would here.
    """
    walk, maximum, designs = task
    merit = CountedMerit(problem, Budget(designs, never, unreported), designs)
    with suppress(BudgetUsed):
        walk = _followed(merit, walk, maximum)
    return walk, merit.designs


@dataclass(frozen=True)
class DifferentialEvolution:
    """Differential evolution (Storn and Price 1997) by the rough merit, then a simplex from its best.

    `population`: individuals for each variable, 3 to 50.
    """

    population: int = 5

    def __post_init__(self) -> None:
        integer("method.population", self.population, 3, 50)

    def minimize(
        self, merit: CountedMerit, rough: CountedMerit, start: FloatArray, seed: np.random.SeedSequence
    ) -> None:
        """Search; the start is one of the first population."""
        merit(start)
        with suppress(BudgetUsed):
            differential_evolution(
                rough,
                Bounds(np.zeros(start.size), np.ones(start.size)),
                x0=start,
                rng=np.random.default_rng(seed),
                popsize=self.population,
                tol=SPREAD,
                maxiter=10**6,
                polish=False,
            )
        NelderMead().minimize(merit, rough, start if rough.best is None else rough.best[1], seed)

    def to_json(self) -> Json:
        """Return plain JSON."""
        return {"method": "differential_evolution", "population": self.population}


def never() -> bool:
    """Nobody cancels."""
    return False
