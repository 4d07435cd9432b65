"""Fidelities of a model: run one after the other, each measured against the finest."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Generic, Protocol, TypeVar

from host import cpu_seconds
from model_studies.progress import Progress
from model_studies.variants import run_variants

Q = TypeVar("Q")
Q_contra = TypeVar("Q_contra", contravariant=True)
R = TypeVar("R")
Errors = Mapping[str, float]
"""Relative errors by the name of the figure; NaN: not known."""


class Fidelity(Protocol[Q_contra]):
    """A model or setting, coarse or fine, that computes a request."""

    @property
    def name(self) -> str:
        """Key in tables and JSON."""

    @property
    def title(self) -> str:
        """In words."""

    @property
    def family(self) -> str:
        """The parameter it varies: errors within a family fall towards its finest."""

    def refusal(self, request: Q_contra) -> str | None:
        """Return why this fidelity is not valid for a request; None if it is."""


F = TypeVar("F", bound=Fidelity[Any])


@dataclass(frozen=True)
class Outcome(Generic[F, R]):
    """The result of a fidelity, and its CPU time in this process, s."""

    fidelity: F
    result: R
    cpu_seconds: float


def run_fidelities(
    fidelities: Sequence[F],
    request: Q,
    warm_up: Callable[[Sequence[F]], None],
    compute: Callable[[F], R],
    failures: tuple[type[Exception], ...],
    progress: Progress,
) -> tuple[list[Outcome[F, R]], dict[str, str]]:
    """Run every fidelity that is valid for a request.

    Parameters
    ----------
    fidelities : sequence of Fidelity
        By their usual cost.
    warm_up : callable
        Loads and compiles the code of these fidelities beforehand, outside of their time.
    failures : tuple of exception types
        Exceptions that omit a fidelity; the last of them is raised with fewer than two results.

    Returns
    -------
    outcomes, left_out
        As of `run_variants`.
    """
    refusals = {fidelity.name: fidelity.refusal(request) for fidelity in fidelities}
    refused = {name: reason for name, reason in refusals.items() if reason is not None}
    valid = [fidelity for fidelity in fidelities if fidelity.name not in refused]
    warm_up(valid)

    def timed(fidelity: F) -> Outcome[F, R]:
        began = cpu_seconds()
        result = compute(fidelity)
        return Outcome(fidelity, result, cpu_seconds() - began)

    by_name = {fidelity.name: fidelity for fidelity in valid}
    outcomes, failed = run_variants("ladder", by_name, timed, failures, progress)
    left_out = refused | failed
    if len(outcomes) < 2:
        raise failures[-1](f"an error needs two fidelities to compare; left out: {left_out}")
    return list(outcomes.values()), left_out


def against_finest(
    outcomes: Sequence[Outcome[F, R]],
    errors: Callable[[R, R], Errors],
    remaining: Callable[[Sequence[tuple[F, Errors]], F], Errors],
) -> list[Errors]:
    """Return the errors of every outcome against the last one, and the remaining errors of that one.

    `errors` compares a result with the reference; `remaining` estimates the errors of the finest fidelity
    from those of the coarser fidelities of its family.
    """
    *coarser, finest = outcomes
    measured = [errors(outcome.result, finest.result) for outcome in coarser]
    family = [
        (outcome.fidelity, error)
        for outcome, error in zip(coarser, measured, strict=True)
        if outcome.fidelity.family == finest.fidelity.family
    ]
    return [*measured, remaining(family, finest.fidelity)]
