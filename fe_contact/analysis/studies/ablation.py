"""Ablation of a case: every effect is toggled by itself, its change is compared with its estimate."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

import model_studies
from bounds.brief import brief
from fe_contact.analysis.checks.effect_ledger import toggled
from fe_contact.analysis.database.compute_database import compute_database
from fe_contact.analysis.request.influences import estimated_influences
from fe_contact.analysis.request.model_choice import decide
from fe_contact.analysis.request.request import Checked
from fe_contact.analysis.request.request_check import as_checked, checked_request
from fe_contact.effects import EFFECTS, LedgerEntry
from fe_contact.effects.influence.influence import Influence
from fe_contact.errors import InputError, MeshError, SolveError, chosen
from fe_contact.geometry import ParallelAxes
from fe_contact.options import AnalysisOptions, Run, TableAxes
from fe_contact.types import FloatArray
from model_studies import LeftOut, in_unit, run_variants
from model_studies.progress import Report, by_cost, unreported
from model_studies.workers import InProcess, pays

HARMONICS = 5
"""Mesh harmonics that are compared."""
FAILURES = (InputError, MeshError, SolveError)
"""Errors of a case with an effect toggled that leave the effect out."""
_REQUEST = ""
"""Name of the table of the request among those with an effect toggled."""


@dataclass(frozen=True)
class Figures(model_studies.Figures):
    """Figures of a table's curves at each load (L,), at the largest of its misalignments in size.

    Attributes
    ----------
    mean, peak_to_peak : ndarray, shape (L,)
        Mean and peak-to-peak STE, m.
    cpu_seconds : float
        CPU seconds of the contact solution, measured.
    """

    harmonics: FloatArray = field(metadata=in_unit("m", "curve", "harmonic"))
    """Amplitudes of the mesh harmonics, the first one first, m. Shape (L, 5)."""
    predicted_cpu_seconds: float
    """CPU seconds of the whole run, predicted for an empty cache."""

    @property
    def cost(self) -> float:
        """The predicted CPU seconds. The measured ones depend on the cache."""
        return self.predicted_cpu_seconds


@dataclass(frozen=True)
class EffectAblation(model_studies.EffectAblation[Figures, Influence]):
    """One effect toggled; its estimate is that of the ledger, at the nominal load."""

    @property
    def harmonic_change(self) -> FloatArray:
        """Change (L, 5) of the amplitudes by leaving the effect out, m."""
        return self.change("harmonics")

    @property
    def relative_mean_change(self) -> FloatArray:
        """Change (L,) of the mean in parts of that with the effect."""
        return self.mean_change / self.with_effect.mean

    @property
    def relative_peak_to_peak_change(self) -> FloatArray:
        """Change (L,) of peak-to-peak in parts of that with the effect."""
        return self.peak_to_peak_change / self.with_effect.peak_to_peak


@brief
@dataclass(frozen=True)
class Ablation(model_studies.Ablation[Figures, EffectAblation]):
    """All effects of a case, each toggled by itself.

    Attributes
    ----------
    nominal, effects, omitted
        Figures and effects as in every ablation.
    """

    torque: FloatArray = field(metadata=in_unit("n_m", "curve"))
    """Torque on the driving gear, N m. Shape (L,)."""
    normal_force: FloatArray = field(metadata=in_unit("n", "curve"))
    """Normal force, N. Shape (L,)."""
    misalignment: float = field(metadata=in_unit("m"))
    """Misalignment of the figures, m."""

    @staticmethod
    def request(pair: ParallelAxes | Checked, axes: TableAxes | None, options: AnalysisOptions) -> Checked:
        """Check the request whose effects are toggled, once; a checked request passes unchanged."""
        nominal = None if axes is None else replace(axes, center_distance_changes=(0.0,))
        return as_checked(pair, nominal, replace(options, receipt="minimal", on_violation="report"))

    def measured(self, entry: EffectAblation) -> Influence:
        """Return the change by neglecting an effect at the nominal load, from the two tables."""
        complete = entry.with_effect
        changes = (entry.mean_change, entry.peak_to_peak_change, complete.mean, complete.peak_to_peak)
        return Influence(
            float(self.torque[-1]), self.misalignment, *(float(values[-1]) for values in changes)
        )


def ablate(
    pair: ParallelAxes | Checked,
    axes: TableAxes | None = None,
    options: AnalysisOptions = AnalysisOptions(),  # noqa: B008 (frozen)
    run: Run = Run(),  # noqa: B008 (frozen)
    *,
    only: Sequence[str] | None = None,
) -> Ablation:
    """Toggle each effect of a case and report the change.

    Raises `InputError`: a value that cannot be used, by field name; `MeshError`, `SolveError`: the case
    itself cannot be computed.

    Parameters
    ----------
    pair : GearPair, InternalGearPair or Checked
        Gear pair, or a checked request (see `Ablation.request`), which replaces pair, axes and options.
    axes : TableAxes, optional
        The tables are at the nominal center distance.
    options : AnalysisOptions
        All tables have the mesh level that the accuracy requires and a minimal receipt; violated assumptions
        are reported.
    run : Run
        With a cache the gears are condensed once for each body and model. Where a single table is worth
        several workers, they share each table by blocks; else each worker computes the table of one effect.
    only : sequence of str, optional
        Effects to toggle; default all.

    Returns
    -------
    Ablation
        Changes by every effect of the scene that can be toggled.
    """
    checked = Ablation.request(pair, axes, options)
    names = chosen("only", only, [effect.name for effect in EFFECTS])
    checked = _on_one_mesh(checked, run.cache)
    costs = {name: table.seconds for name, table in _predicted_tables(checked, names, run.cache).items()}
    variants = sum(costs.values()) - costs[_REQUEST]
    done = by_cost(partial(run.progress, "ablation"), {"request": costs[_REQUEST], "variants": variants})
    nominal = _figures(checked, run, partial(done, "request"))
    estimates = estimated_influences(checked, names)

    ledger = {entry.name: entry for entry in checked.ledger if entry.name in names}
    seconds = checked.predicted(checked.planned(run.cache), run.cache, with_errors=False).cpu_seconds
    by_blocks = pays(run.workers, seconds)
    single_run, workers = (run, InProcess()) if by_blocks else (Run(cache=run.cache), run.workers)
    toggle = partial(_toggled_ablation, checked, nominal, estimates, single_run)
    seconds *= sum(not entry.verdict.neutral for entry in ledger.values())
    effects, omitted = run_variants("variants", ledger, toggle, FAILURES, done, workers, seconds, costs)
    request = checked.request
    misalignment = request.complete_scene.largest_misalignment
    return Ablation(nominal, tuple(effects.values()), omitted, request.torque, request.load, misalignment)


class PredictedTables(NamedTuple):
    """CPU seconds to condense the gears, and of the contact of each table; largest resident memory."""

    bodies: float
    contacts: tuple[float, ...]
    bytes: int


def predicted_ablation(checked: Checked, only: Sequence[str] | None, cache: Path | None) -> PredictedTables:
    """Predict the table of a request and one with each of the effects toggled; gears are condensed once."""
    names = chosen("only", only, [effect.name for effect in EFFECTS])
    checked = _on_one_mesh(checked, cache)
    tables = _predicted_tables(checked, names, cache).values()
    memory = max((table.bytes for table in tables), default=0)
    return PredictedTables(
        sum(table.bodies for table in tables), tuple(table.contact for table in tables), memory
    )


class _PredictedTable(NamedTuple):
    """CPU seconds to condense the gears that no table before it has, and of its contact; memory."""

    bodies: float
    contact: float
    bytes: int

    @property
    def seconds(self) -> float:
        """CPU seconds of the table."""
        return self.bodies + self.contact


def _predicted_tables(
    checked: Checked, names: Sequence[str], cache: Path | None
) -> dict[str, _PredictedTable]:
    """Predict the table of the request, and by effect those with it toggled that can be computed."""
    tables, condensed = dict[str, _PredictedTable](), set[Any]()
    for entry in (None, *checked.ledger):
        if entry is not None and (entry.name not in names or entry.verdict.neutral):
            continue
        with suppress(*FAILURES):
            variant = checked if entry is None else toggled(checked, entry.name, "off" if entry.on else "on")
            plan = variant.planned(cache)
            complete = variant.predicted(plan, cache, with_errors=False)
            mesh = plan.discretization
            # tables of equal bodies on equal meshes share their compliance
            key = plan.bodies(variant.request.pair), mesh.recipes, mesh.corrected
            bodies = 0.0 if key in condensed else complete.stages["compliance"]
            condensed.add(key)
            name = _REQUEST if entry is None else entry.name
            tables[name] = _PredictedTable(bodies, complete.stages["contact"], complete.memory_bytes)
    return tables


def _toggled_ablation(
    checked: Checked,
    nominal: Figures,
    estimates: Mapping[str, Influence | None],
    run: Run,
    entry: LedgerEntry,
) -> EffectAblation:
    """Compute the table with one effect toggled."""
    if entry.verdict.neutral:
        raise LeftOut(entry.verdict.reason)
    other = _figures(toggled(checked, entry.name, "off" if entry.on else "on"), run)
    states = (nominal, other) if entry.on else (other, nominal)
    return EffectAblation(entry.name, entry.on, entry.verdict.reason, *states, estimates[entry.name])


def _on_one_mesh(checked: Checked, cache: Path | None) -> Checked:
    """Return the request with the model and mesh level that its accuracy requires, for all tables alike."""
    choice = decide(checked, cache)
    request = choice.checked.request
    return checked_request(
        replace(request, options=request.options.at_level(choice.mesh.level)), neglect=False
    )


def _figures(checked: Checked, run: Run, report: Report = unreported) -> Figures:
    """Return the figures of a table; `report` takes its fraction done."""
    request = checked.request
    predicted = checked.predicted(checked.planned(run.cache), None)
    reported = replace(run.silent, progress=by_cost(report, predicted.stages))
    table = compute_database(checked, request.to_json(), reported)
    table.require_complete()
    skew = checked.request.complete_scene.largest_misalignment
    curves = [table.curve(force=float(force), misalignment=skew) for force in table.force]
    return Figures(
        mean=np.array([curve.mean.value for curve in curves]),
        peak_to_peak=np.array([curve.peak_to_peak.value for curve in curves]),
        cpu_seconds=float(table.metadata.receipt["stages"]["contact"]["cpu_seconds"]),
        harmonics=np.array(
            [[harmonic.value for harmonic in curve.harmonics[:HARMONICS]] for curve in curves]
        ),
        predicted_cpu_seconds=predicted.cpu_seconds,
    )
