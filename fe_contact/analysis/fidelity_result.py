"""What a fidelity of the accuracy study gave on a case, and how far it is from the finest one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from fe_contact.analysis.accuracy_study import Fidelity
from fe_contact.ste import SteDatabase
from fe_contact.types import FloatArray, Json


@dataclass(frozen=True)
class FidelityResult:
    """What one fidelity gave on a case.

    Attributes
    ----------
    name, title : str
    mean, peak_to_peak : ndarray, shape (C,)
        Of each curve (loads, then alignments), m.
    stated_error : float
        The error its table states: of mean and peak-to-peak, relative, the worst over the curves. That of the
        positions is in it, which is the same for all fidelities.
    mean_error, peak_to_peak_error : float
        Relative difference to the reference, the worst over the curves; of the reference what its mesh
        leaves, by the difference of the next coarser mesh and the second order of convergence (NaN if none
        was run).
    cpu_seconds : float
        Of the whole run, its error estimate included.
    stages : dict
        CPU seconds by stage.
    peak_memory_bytes : int
        Of the process by the end of the fidelity.
    """

    name: str
    title: str
    mean: FloatArray
    peak_to_peak: FloatArray
    stated_error: float
    mean_error: float
    peak_to_peak_error: float
    cpu_seconds: float
    stages: dict[str, float]
    peak_memory_bytes: int

    @property
    def error(self) -> float:
        """The worse of both errors, which a tolerance speaks of."""
        return max(self.mean_error, self.peak_to_peak_error)

    def to_json(self) -> Json:
        """Return plain JSON; errors that are not known are left out."""
        errors = {"mean_error": self.mean_error, "peak_to_peak_error": self.peak_to_peak_error}
        known = {name: error for name, error in errors.items() if np.isfinite(error)}
        return known | {
            "name": self.name,
            "title": self.title,
            "mean_m": self.mean.tolist(),
            "peak_to_peak_m": self.peak_to_peak.tolist(),
            "stated_error": self.stated_error,
            "cpu_seconds": self.cpu_seconds,
            "stages": self.stages,
            "peak_memory_bytes": self.peak_memory_bytes,
        }


def fidelity_results(
    fidelities: Sequence[Fidelity], tables: Mapping[str, SteDatabase]
) -> tuple[FidelityResult, ...]:
    """Measure every table against the last one, and that one by its convergence."""
    figures = {name: _figures(table) for name, table in tables.items()}
    reference = figures[fidelities[-1].name]
    found = [
        _result(fidelity, tables[fidelity.name], figures[fidelity.name], reference) for fidelity in fidelities
    ]
    part, coarser = _remaining(fidelities)
    errors = (
        (found[coarser].mean_error, found[coarser].peak_to_peak_error) if coarser is not None else (0.0, 0.0)
    )
    found[-1] = replace(found[-1], mean_error=part * errors[0], peak_to_peak_error=part * errors[1])
    return tuple(found)


def _remaining(fidelities: Sequence[Fidelity]) -> tuple[float, int | None]:
    """Part of the difference to the next coarser mesh that the last fidelity leaves, and its index."""
    last = fidelities[-1]
    alike = [
        i
        for i, fidelity in enumerate(fidelities[:-1])
        if fidelity.family == last.family and fidelity.element_size > last.element_size
    ]
    if not alike:
        return float("nan"), None
    ratio = (fidelities[alike[-1]].element_size / last.element_size) ** 2
    return 1.0 / (ratio - 1.0), alike[-1]


def _figures(table: SteDatabase) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Mean, peak-to-peak (C,) in m of every curve, and the worse of their stated relative errors."""
    axes = (table.force, table.misalignment, table.center_distance_change)
    curves = [
        table.curve(force=float(force), misalignment=float(skew), center_distance_change=float(change))
        for force, skew, change in product(*axes)
    ]
    mean, swing = ([getattr(curve, name) for curve in curves] for name in ("mean", "peak_to_peak"))
    stated = [max(abs(a.error / a.value), abs(b.error / b.value)) for a, b in zip(mean, swing, strict=True)]
    return np.array([m.value for m in mean]), np.array([p.value for p in swing]), np.array(stated)


def _result(
    fidelity: Fidelity,
    table: SteDatabase,
    figures: tuple[FloatArray, FloatArray, FloatArray],
    reference: tuple[FloatArray, FloatArray, FloatArray],
) -> FidelityResult:
    """One fidelity against the reference."""
    receipt = table.metadata.receipt
    return FidelityResult(
        name=fidelity.name,
        title=fidelity.title,
        mean=figures[0],
        peak_to_peak=figures[1],
        stated_error=float(figures[2].max()),
        mean_error=float(np.max(np.abs(figures[0] / reference[0] - 1.0))),
        peak_to_peak_error=float(np.max(np.abs(figures[1] / reference[1] - 1.0))),
        cpu_seconds=float(receipt["cpu_seconds"]),
        stages={name: stage["cpu_seconds"] for name, stage in receipt["stages"].items()},
        peak_memory_bytes=int(receipt["peak_memory_bytes"]),
    )
