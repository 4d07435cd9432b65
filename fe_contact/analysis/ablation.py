"""Ablation: every effect toggled by itself, the change beside what it was estimated at."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from fe_contact.allowed_error import AllowedError
from fe_contact.analysis.compute_database import compute_database
from fe_contact.analysis.effect_ledger import toggled
from fe_contact.analysis.influences import estimated_influences
from fe_contact.analysis.model_choice import decide
from fe_contact.analysis.request import Checked
from fe_contact.analysis.request_check import check_asked, check_request
from fe_contact.effects import EFFECTS, LedgerEntry
from fe_contact.effects.influence import Influence
from fe_contact.errors import InputError, MeshError, SolveError
from fe_contact.geometry import ParallelAxes
from fe_contact.planning import planned, predict_run
from fe_contact.progress import Progress, silent
from fe_contact.types import FloatArray, Json

HARMONICS = 5
"""Mesh harmonics that are compared."""


@dataclass(frozen=True)
class Figures:
    """What a table says of its curves at each load (L,), m, at the largest of its misalignments in size.

    Attributes
    ----------
    mean, peak_to_peak : ndarray, shape (L,)
    harmonics : ndarray, shape (L, 5)
        Amplitudes of the mesh harmonics, the first one first.
    cpu_seconds : float
        Of the contact, measured.
    predicted_cpu_seconds : float
        Of the whole run with nothing in the cache.
    """

    mean: FloatArray
    peak_to_peak: FloatArray
    harmonics: FloatArray
    cpu_seconds: float
    predicted_cpu_seconds: float

    def to_json(self) -> Json:
        """Return plain JSON."""
        return {
            "mean_m": self.mean.tolist(),
            "peak_to_peak_m": self.peak_to_peak.tolist(),
            "harmonics_m": self.harmonics.tolist(),
            "cpu_seconds": self.cpu_seconds,
            "predicted_cpu_seconds": self.predicted_cpu_seconds,
        }


@dataclass(frozen=True)
class EffectAblation:
    """One effect toggled.

    Attributes
    ----------
    name : str
    on : bool
        Whether the case has it on.
    reason : str
        Why, from the ledger.
    with_effect, without_effect : Figures
        One of them is the case itself.
    estimate : Influence or None
        What leaving it out changes at the nominal load, as the ledger says; None where it has no estimate.
    """

    name: str
    on: bool
    reason: str
    with_effect: Figures
    without_effect: Figures
    estimate: Influence | None

    @property
    def mean_change(self) -> FloatArray:
        """Change (L,) of the mean STE by leaving the effect out, m."""
        return self.without_effect.mean - self.with_effect.mean

    @property
    def peak_to_peak_change(self) -> FloatArray:
        """Change (L,) of the peak-to-peak STE by leaving the effect out, m."""
        return self.without_effect.peak_to_peak - self.with_effect.peak_to_peak

    @property
    def harmonic_change(self) -> FloatArray:
        """Change (L, 5) of the amplitudes by leaving the effect out, m."""
        return self.without_effect.harmonics - self.with_effect.harmonics

    @property
    def cost_ratio(self) -> float:
        """Predicted CPU time with the effect over that without, nothing cached."""
        return self.with_effect.predicted_cpu_seconds / self.without_effect.predicted_cpu_seconds

    def to_json(self) -> Json:
        """Return plain JSON: changes in m and in parts of the value with the effect."""
        return {
            "name": self.name,
            "on": self.on,
            "reason": self.reason,
            "with": self.with_effect.to_json(),
            "without": self.without_effect.to_json(),
            "mean_change_m": self.mean_change.tolist(),
            "peak_to_peak_change_m": self.peak_to_peak_change.tolist(),
            "harmonic_change_m": self.harmonic_change.tolist(),
            "relative_mean_change": (self.mean_change / self.with_effect.mean).tolist(),
            "relative_peak_to_peak_change": (
                self.peak_to_peak_change / self.with_effect.peak_to_peak
            ).tolist(),
            "estimate": None if self.estimate is None else self.estimate.to_json(),
            "cost_ratio": self.cost_ratio,
        }


@dataclass(frozen=True)
class Ablation:
    """All effects of a case, each toggled by itself.

    Attributes
    ----------
    torque, normal_force : ndarray, shape (L,)
        N m on the driving gear, and N.
    misalignment : float
        At which the figures are, m.
    nominal : Figures
        Of the case.
    effects : tuple of EffectAblation
    left_out : dict of str to str
        Effects that were not toggled, and why.
    """

    torque: FloatArray
    normal_force: FloatArray
    misalignment: float
    nominal: Figures
    effects: tuple[EffectAblation, ...]
    left_out: dict[str, str]

    def measured(self, entry: EffectAblation) -> Influence:
        """Return what leaving an effect out changes at the nominal load, as the two tables have it."""
        whole = entry.with_effect
        changes = (entry.mean_change, entry.peak_to_peak_change, whole.mean, whole.peak_to_peak)
        return Influence(
            float(self.torque[-1]), self.misalignment, *(float(values[-1]) for values in changes)
        )

    def to_json(self) -> Json:
        """Return plain JSON in SI units."""
        return {
            "torque_n_m": self.torque.tolist(),
            "normal_force_n": self.normal_force.tolist(),
            "misalignment_m": self.misalignment,
            "nominal": self.nominal.to_json(),
            "effects": [entry.to_json() for entry in self.effects],
            "left_out": self.left_out,
        }


def ablate(
    pair: ParallelAxes,
    *,
    torques: Sequence[float] | FloatArray | None = None,
    normal_forces: Sequence[float] | FloatArray | None = None,
    tolerance: AllowedError | float | None = None,
    level: str | None = None,
    time_budget: float | None = None,
    model: str = "auto",
    positions: int | None = None,
    pitches: int | None = None,
    misalignments: Sequence[float] = (0.0,),
    effects: Mapping[str, str] | None = None,
    only: Sequence[str] | None = None,
    progress: Progress | None = None,
    cache: Path | None = None,
) -> Ablation:
    """Switch each effect of a case over and report what that changes.

    Parameters
    ----------
    pair, torques, normal_forces, tolerance, level, time_budget, model, positions, pitches, misalignments, \
effects, progress, cache
        As for `analyze`; all tables are made on the level of mesh that the accuracy asks for. With `cache`
        the gears are condensed once for each body and model.
    only : sequence of str, optional
        Effects to toggle; default all.

    Returns
    -------
    Ablation
        Of every effect that the scene holds and that can be switched.

    Raises
    ------
    InputError
        A value that cannot be used, by field name.
    MeshError, SolveError
        The case itself cannot be computed.
    """
    checked = check_request(
        pair,
        torques=torques,
        normal_forces=normal_forces,
        tolerance=tolerance,
        level=level,
        time_budget=time_budget,
        model=model,
        positions=positions,
        pitches=pitches,
        misalignments=misalignments,
        effects=effects,
        receipt="minimal",
        on_violation="report",
    )
    return ablate_checked(checked, _selected(only), progress or silent, cache)


def ablate_checked(
    checked: Checked, names: Sequence[str], progress: Progress, cache: Path | None
) -> Ablation:
    """Switch the named effects of a checked request over; parameters of `ablate`."""
    checked = _on_one_mesh(checked, cache)
    nominal = _figures(checked, cache)
    estimates = estimated_influences(checked, names)
    found, left_out = [], {}
    for count, entry in enumerate(ledger := [one for one in checked.ledger if one.name in names]):
        progress("ablation", count / len(ledger))
        if entry.verdict.neutral:
            left_out[entry.name] = entry.verdict.reason
            continue
        try:
            found.append(_switched(checked, entry, nominal, estimates[entry.name], cache))
        except (InputError, MeshError, SolveError) as error:
            left_out[entry.name] = str(error)
    progress("ablation", 1.0)
    request = checked.request
    skew = request.whole_scene.largest_misalignment
    return Ablation(request.torque, request.load, skew, nominal, tuple(found), left_out)


def _on_one_mesh(checked: Checked, cache: Path | None) -> Checked:
    """Return the request with the model and the level that its accuracy asks for: all tables compare."""
    decided = decide(checked, cache)
    request = decided.checked.request
    accuracy = replace(request.accuracy, tolerance=None, time_budget=None, level=decided.mesh.level)
    return check_asked(replace(request, accuracy=accuracy), spare=False)


def _selected(only: Sequence[str] | None) -> tuple[str, ...]:
    """Return the names requested, all if None."""
    known = tuple(effect.name for effect in EFFECTS)
    for name in only or ():
        if name not in known:
            raise InputError("only", name, f"among {', '.join(known)}")
    return known if only is None else tuple(only)


def _switched(
    checked: Checked, entry: LedgerEntry, nominal: Figures, estimate: Influence | None, cache: Path | None
) -> EffectAblation:
    """Compute the case with one effect toggled."""
    other = _figures(toggled(checked, entry.name, "off" if entry.on else "on"), cache)
    whole, without = (nominal, other) if entry.on else (other, nominal)
    return EffectAblation(entry.name, entry.on, entry.verdict.reason, whole, without, estimate)


def _figures(checked: Checked, cache: Path | None) -> Figures:
    """Compute the table of a request, without its errors, and read its curves."""
    request = checked.request
    table = compute_database(checked, request.to_json(), silent, cache)
    table.require_complete()
    skew = checked.request.whole_scene.largest_misalignment
    curves = [table.curve(force=float(force), misalignment=skew) for force in table.force]
    plan = planned(request.pair, request.load, request.accuracy, checked.model, request.alignments, cache)
    predicted = predict_run(request.pair, plan, checked.model, request.alignments, None)
    return Figures(
        np.array([curve.mean.value for curve in curves]),
        np.array([curve.peak_to_peak.value for curve in curves]),
        np.array([[one.value for one in curve.harmonics[:HARMONICS]] for curve in curves]),
        float(table.metadata.receipt["stages"]["contact"]["cpu_seconds"]),
        predicted.cpu_seconds,
    )
