"""Sampling of a tolerance Monte Carlo: the pairs it draws and the quantities it estimates."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from fe_contact.checks import integer, within


@dataclass(frozen=True)
class Sampling:
    """A sample of pairs and its quantiles.

    Attributes
    ----------
    samples : int
        Pairs, 2 to 1 000 000.
    seed : int
        Equal seeds give equal results to the last bit, with any workers.
    confidence : float
        Of the bounds of the quantiles.
    fractions : sequence of float
        Quantiles to estimate.
    positions : int
        Equally spaced in a base pitch.
    """

    samples: int = 1000
    seed: int = 0
    confidence: float = 0.95
    fractions: Sequence[float] = (0.05, 0.5, 0.95)
    positions: int = 64

    def __post_init__(self) -> None:
        integer("samples", self.samples, 2, 1_000_000)
        integer("seed", self.seed, 0, 2**63 - 1)
        within("confidence", self.confidence, 0.5, 0.9999)
        for index, fraction in enumerate(self.fractions):
            within(f"fractions[{index}]", fraction, 0.0, 1.0)
