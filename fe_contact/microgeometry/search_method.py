"""Ways to search the unit cube for the design of least merit."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from scipy.optimize import Bounds, differential_evolution, minimize

from fe_contact.checks import integer
from fe_contact.microgeometry.counted_merit import CountedMerit, Spent
from fe_contact.types import FloatArray, Json

SIMPLEX_SIZE, SIMPLEX_MERIT = 1e-3, 1e-4
"""A simplex this small has converged: parts of the range of a variable, and of the merit of the start."""
EDGE = 0.2
"""Of the first simplex, in parts of the ranges, towards the inside."""
SPREAD = 1e-3
"""Standard deviation of the merit over a population that has converged, in parts of its mean."""


class Method(Protocol):
    """A way to search the unit cube."""

    def minimise(
        self, merit: CountedMerit, rough: CountedMerit, start: FloatArray, seed: np.random.SeedSequence
    ) -> None:
        """Search from `start` (d,) until converged; the merits remember the best.

        `rough` costs less and only ranks designs; its designs may end before those of `merit`.

        Raises
        ------
        Spent, Cancelled
            By the merit: the search is over.
        """
        ...

    def to_json(self) -> Json:
        """Return plain JSON."""
        ...


@dataclass(frozen=True)
class NelderMead:
    """Simplex of Nelder and Mead (1965) in bounds, its coefficients by dimension (Gao and Han 2012).

    Cheap and local: start it more than once.
    """

    def minimise(
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
class DifferentialEvolution:
    """Differential evolution (Storn and Price 1997) by the rough merit, then a simplex from its best.

    Attributes
    ----------
    population : int
        Individuals for each variable, 3 to 50.
    """

    population: int = 5

    def __post_init__(self) -> None:
        integer("method.population", self.population, 3, 50)

    def minimise(
        self, merit: CountedMerit, rough: CountedMerit, start: FloatArray, seed: np.random.SeedSequence
    ) -> None:
        """Search; the start is one of the first population."""
        merit(start)
        with suppress(Spent):
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
        NelderMead().minimise(merit, rough, start if rough.best is None else rough.best[1], seed)

    def to_json(self) -> Json:
        """Return plain JSON."""
        return {"method": "differential_evolution", "population": self.population}
