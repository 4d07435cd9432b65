"""Variants of a model, each by itself; those that cannot be computed are left out with their reason."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any, TypeVar

from model_studies.progress import Progress
from model_studies.workers import InProcess, Workers, divided

V = TypeVar("V")
R = TypeVar("R")


class LeftOut(Exception):
    """A variant is not valid here; the text says why."""


def run_variants(
    stage: str,
    variants: Mapping[str, V],
    compute: Callable[[V], R],
    failures: tuple[type[Exception], ...],
    progress: Progress,
    workers: Workers = InProcess(),  # noqa: B008 (frozen)
    seconds: float | None = None,
    costs: Mapping[str, float] | None = None,
) -> tuple[dict[str, R], dict[str, str]]:
    """Compute every variant; one that fails does not end the study.

    Parameters
    ----------
    compute : callable
        Computes a variant. Workers need a function of a module, or a `partial` of one.
    seconds : float, optional
        Predicted CPU seconds of all variants, see `divided`.
    costs : mapping, optional
        Predicted cost of variants by name, in any unit, by which the fraction done is reported; that of one
        without is zero. Default: all cost the same.

    Returns
    -------
    results : dict
        By name, in the order of the variants.
    omitted : dict of str to str
        Name of a variant to the reason why it has no result: `LeftOut`, one of `failures`, no memory.
    """
    results, omitted = {}, {}
    outcomes = divided(workers, _attempted, (compute, failures), list(variants.values()), seconds)
    shares = [1.0 if costs is None else costs.get(name, 0.0) for name in variants]
    whole, done = sum(shares) or 1.0, 0.0
    for name, share in zip(variants, shares, strict=True):
        progress(stage, done / whole)
        result, reason = next(outcomes)
        done += share
        if reason is None:
            results[name] = result
        else:
            omitted[name] = reason
    progress(stage, 1.0)
    return results, omitted


@contextmanager
def reason_of_failure(
    omitted: dict[str, str], name: str, failures: tuple[type[Exception], ...]
) -> Iterator[None]:
    """Note in `omitted` why the variant of a name has no result: `LeftOut`, one of `failures`, no memory."""
    known: tuple[type[Exception], ...] = (LeftOut, *failures)
    try:
        yield
    except known as error:
        omitted[name] = str(error)
    except MemoryError:
        omitted[name] = "out of memory"


def _attempted(shared: tuple[Callable[[V], R], tuple[type[Exception], ...]], variant: V) -> Any:
    """Return the result of a variant and None, or None and the reason why there is no result."""
    compute, failures = shared
    omitted: dict[str, str] = {}
    with reason_of_failure(omitted, "variant", failures):
        return compute(variant), None
    return None, omitted["variant"]
