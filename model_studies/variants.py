"""Variants of a model, computed one by one; those that cannot be computed are left out with their reason."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TypeVar

from model_studies.progress import Progress

V = TypeVar("V")
R = TypeVar("R")


class LeftOut(Exception):
    """A variant is not valid here, and why."""


def run_variants(
    stage: str,
    variants: Mapping[str, V],
    compute: Callable[[V], R],
    failures: tuple[type[Exception], ...],
    progress: Progress,
) -> tuple[dict[str, R], dict[str, str]]:
    """Compute every variant; one that fails does not end the study.

    Returns
    -------
    results : dict
        By name, in the order of the variants.
    left_out : dict of str to str
        Name of a variant to the reason why it has no result: `LeftOut`, one of `failures`, no memory.
    """
    results, left_out = {}, {}
    known: tuple[type[Exception], ...] = (LeftOut, *failures)
    for count, (name, variant) in enumerate(variants.items()):
        progress(stage, count / len(variants))
        try:
            results[name] = compute(variant)
        except known as error:
            left_out[name] = str(error)
        except MemoryError:
            left_out[name] = "out of memory"
    progress(stage, 1.0)
    return results, left_out
