"""Scatter of assembly and manufacture: normal deviations, and the nodes at which designs are assessed.

A quadrature rule replaces the expectation of a quantity over d independent deviations by a weighted sum over
S nodes, in each of which all d deviations have values.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from bounds import SiNote, at_least
from fe_contact.errors import InputError, finite, integer, positive
from fe_contact.microgeometry.variables import gear_and_quantity
from fe_contact.types import FloatArray, Json
from host.optional_modules import special
from model_studies import in_unit

MISALIGNMENT = "misalignment"
"""Name of the deviation of the misalignment; the others are named ``gear.quantity``."""
MAX_NODES = 1024
"""Largest number of nodes of a rule: a design is solved at each of them."""
MAX_POINTS = 33
"""Largest number of points of a Gauss-Hermite rule in a dimension."""
MAX_LOG2_SIZE = 10
"""Base-2 logarithm of the size of the largest sample, which has `MAX_NODES` points."""


class _ScatterRule(Protocol):
    """Nodes and weights for the expectation over independent standard normal deviates."""

    def nodes(self, dimensions: int) -> tuple[FloatArray, FloatArray]:
        """Return nodes (S, d) in standard deviations and weights (S,) that sum to 1."""

    def finer(self, dimensions: int) -> _ScatterRule:
        """Return another rule: the error of this one is the difference of the two expectations."""

    def to_json(self) -> Json:
        """Return plain JSON."""


@dataclass(frozen=True)
class GaussHermite:
    """Tensor product of Gauss-Hermite rules: exact for polynomials of degree 2 `points` - 1 in each deviate.

    `points`: in each dimension, 1 to 33.
    """

    points: int = 5

    def __post_init__(self) -> None:
        integer("scatter.rule.points", self.points, 1, MAX_POINTS)

    def nodes(self, dimensions: int) -> tuple[FloatArray, FloatArray]:
        """Return the nodes, the last dimension running fastest."""
        if self.points**dimensions > MAX_NODES:
            remedy = "Take fewer points, or a SobolSample."
            raise InputError("scatter.rule.points", self.points, f"at most {MAX_NODES} nodes in all", remedy)
        point, weight = special.roots_hermitenorm(self.points)
        grid = np.meshgrid(*[point] * dimensions, indexing="ij")
        weights = np.meshgrid(*[weight / weight.sum()] * dimensions, indexing="ij")
        return np.stack([axis.ravel() for axis in grid], axis=1), np.prod(weights, axis=0).ravel()

    def finer(self, dimensions: int) -> _ScatterRule:
        """Return a rule of about one and a half times as many points, or the nearest one within `MAX_NODES`.

        Where no rule with more points fits, it has one point less, which overstates the error. A rule of a
        single point is then compared with the largest sample.
        """
        for points in (1 + self.points + self.points // 2, self.points + 1, self.points - 1):
            if points > 0 and points**dimensions <= MAX_NODES:
                return GaussHermite(min(points, MAX_POINTS))
        return SobolSample(MAX_LOG2_SIZE)

    def to_json(self) -> Json:
        """Return plain JSON."""
        return {"rule": "gauss_hermite", "points": self.points}


@dataclass(frozen=True)
class SobolSample:
    """Fixed sample of equal weights: a scrambled Sobol' sequence through the normal quantile."""

    log2_size: int = 4
    """Base-2 logarithm of the number of points, 0 to 10."""
    seed: int = 0
    """Seed of the scrambling."""

    def __post_init__(self) -> None:
        integer("scatter.rule.log2_size", self.log2_size, 0, MAX_LOG2_SIZE)
        integer("scatter.rule.seed", self.seed, 0, 2**63 - 1)

    def nodes(self, dimensions: int) -> tuple[FloatArray, FloatArray]:
        """Return the sample."""
        from scipy.stats import qmc  # noqa: PLC0415 (start-up time)

        size = 2**self.log2_size
        uniform = qmc.Sobol(dimensions, rng=self.seed).random_base2(self.log2_size)
        return np.asarray(special.ndtri(uniform)), np.full(size, 1.0 / size)

    def finer(self, dimensions: int) -> SobolSample:
        """Return the sample of four times the size, of the same sequence."""
        return SobolSample(min(self.log2_size + 2, MAX_LOG2_SIZE), self.seed)

    def to_json(self) -> Json:
        """Return plain JSON."""
        return {"rule": "sobol_sample", "log2_size": self.log2_size, "seed": self.seed}


@dataclass(frozen=True)
class Scatter:
    """Independent normal deviations from the design."""

    misalignment: float = 0.0
    """Standard deviation of the misalignment in m, >= 0."""
    modification: Mapping[str, float] = field(default_factory=dict)
    """``gear.quantity`` to the standard deviation of that quantity in m, > 0. Removed material is not
    scattered below zero: such a deviate counts as zero.
    """
    rule: _ScatterRule = GaussHermite()
    """Nodes of the expectation."""

    def __post_init__(self) -> None:
        if finite("scatter.misalignment", self.misalignment, SiNote("In m: 10 µm is 1e-5.")) < 0.0:
            raise InputError("scatter.misalignment", self.misalignment, at_least(0.0))
        for name, deviation in self.modification.items():
            gear_and_quantity(f"scatter.modification.{name}", name)
            positive(f"scatter.modification.{name}", deviation, SiNote("A standard deviation in m."))

    def to_json(self) -> Json:
        """Return plain JSON."""
        spread = {"misalignment_m": self.misalignment, "modification_m": dict(self.modification)}
        return spread | self.rule.to_json()

    def nodes(self) -> ScatterNodes:
        """Return deviations and weights of the nodes; without any scatter there is one node, the design."""
        spread = {MISALIGNMENT: self.misalignment} if self.misalignment else {}
        spread |= dict(sorted(self.modification.items()))
        if not spread:
            return ONE_NODE
        finer = self._rule_nodes(spread, self.rule.finer(len(spread)))
        return self._rule_nodes(spread, self.rule, finer)

    @staticmethod
    def _rule_nodes(
        spread: Mapping[str, float], rule: _ScatterRule, finer: ScatterNodes | None = None
    ) -> ScatterNodes:
        point, weight = rule.nodes(len(spread))
        return ScatterNodes(tuple(spread), point * np.array(list(spread.values())), weight, finer)


NO_SCATTER = Scatter()


@dataclass(frozen=True)
class ScatterNodes:
    """Nodes at which a design is assessed."""

    names: tuple[str, ...]
    """Names of the deviating quantities: "misalignment" and ``gear.quantity``."""
    deviation: FloatArray = field(metadata=in_unit("m"))
    """Deviations at the nodes, m. Shape (S, d)."""
    weight: FloatArray
    """Weights of the nodes in the expectation, sum 1. Shape (S,)."""
    finer: ScatterNodes | None = None
    """Finer nodes, which estimate the error of the expectation; None where nothing scatters."""

    @property
    def misalignment(self) -> FloatArray:
        """Deviation of the misalignment at each node (S,), m."""
        if MISALIGNMENT not in self.names:
            return np.zeros(self.weight.size)
        return np.asarray(self.deviation[:, self.names.index(MISALIGNMENT)])

    def modification(self, node: int) -> dict[str, float]:
        """Deviation of every scattered figure of the modifications at a node, m."""
        deviations = zip(self.names, self.deviation[node], strict=True)
        return {name: float(value) for name, value in deviations if name != MISALIGNMENT}


ONE_NODE = ScatterNodes((), np.zeros((1, 0)), np.ones(1))
"""Node of a scatter of nothing: the design itself, with weight 1."""
