"""The result of a fidelity of the accuracy study on a case, and its distance from the finest one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import product

import numpy as np

import model_studies
from fe_contact.analysis.studies.fidelity import Fidelity
from fe_contact.ste import SteDatabase
from fe_contact.types import FloatArray
from model_studies import Outcome, in_unit
from model_studies.frontier import Errors

FIGURES = ("mean_error", "peak_to_peak_error")

NAN = float("nan")


@dataclass(frozen=True)
class FidelityResult(model_studies.FidelityResult):
    """The result of one fidelity on a case.

    Attributes
    ----------
    cpu_seconds : float
        CPU seconds of the whole run, its error estimate included.
    """

    FIGURES = FIGURES

    mean: FloatArray = field(metadata=in_unit("m", "curve"))
    peak_to_peak: FloatArray = field(metadata=in_unit("m", "curve"))
    """`mean`, `peak_to_peak`: Figures of the STE of each curve (loads, then alignments), m. Shape (C,)."""
    stated_error: float
    """Relative error of mean and peak-to-peak that the table of the fidelity states, the largest over the
    curves. It contains the error of the positions, which is the same for all fidelities.
    """
    stages: dict[str, float]
    """CPU seconds by stage."""
    peak_memory_bytes: int
    """Peak memory of the process by the end of the fidelity, bytes."""
    mean_error: float = NAN
    peak_to_peak_error: float = NAN
    """`mean_error`, `peak_to_peak_error`: Relative difference to the reference, the largest over the curves.
    For the reference itself it is the error that its mesh leaves, from the difference of the next coarser
    mesh and the second order of convergence; NaN if no coarser mesh was run.
    """


def fidelity_errors(result: FidelityResult, reference: FidelityResult) -> Errors:
    """Return the relative differences, the worst over the curves."""
    return {
        "mean_error": float(np.max(np.abs(result.mean / reference.mean - 1.0))),
        "peak_to_peak_error": float(np.max(np.abs(result.peak_to_peak / reference.peak_to_peak - 1.0))),
    }


def remaining_errors(coarser: Sequence[tuple[Fidelity, Errors]], finest: Fidelity) -> Errors:
    """Return the errors of the finest mesh, from the difference of the next coarser one at second order."""
    if not coarser:
        return dict.fromkeys(FIGURES, NAN)
    fidelity, errors = coarser[-1]
    part = 1.0 / ((fidelity.element_size / finest.element_size) ** 2 - 1.0)
    return {name: part * error for name, error in errors.items()}


def fidelity_result(outcome: Outcome[Fidelity, SteDatabase]) -> FidelityResult:
    """Return the result of a fidelity's table; the time and memory of its receipt include child processes."""
    fidelity, table = outcome.fidelity, outcome.result
    axes = (table.force, table.misalignment, table.center_distance_change)
    curves = [
        table.curve(force=float(force), misalignment=float(skew), center_distance_change=float(change))
        for force, skew, change in product(*axes)
    ]
    figures = [figure for curve in curves for figure in (curve.mean, curve.peak_to_peak)]
    receipt = table.metadata.receipt
    return FidelityResult(
        name=fidelity.name,
        title=fidelity.title,
        cpu_seconds=float(receipt["cpu_seconds"]),
        mean=np.array([curve.mean.value for curve in curves]),
        peak_to_peak=np.array([curve.peak_to_peak.value for curve in curves]),
        stated_error=max(abs(figure.error / figure.value) for figure in figures),
        stages={name: stage["cpu_seconds"] for name, stage in receipt["stages"].items()},
        peak_memory_bytes=int(receipt["peak_memory_bytes"]),
    )
