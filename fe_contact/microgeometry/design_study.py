"""The start of every study of a pair's micro-geometry: one model, one compliance, one evaluator."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path

import numpy as np

from fe_contact.analysis.pairs.pair_contact import pair_contact
from fe_contact.analysis.request.model_choice import Decision, decide
from fe_contact.analysis.request.request import Checked
from fe_contact.analysis.request.request_check import check_request, checked_request
from fe_contact.effects import compose
from fe_contact.errors import InputError, integer
from fe_contact.geometry import ParallelAxes
from fe_contact.microgeometry.design_loads import CALLED_FOR, DesignLoads, Misalignments, misalignment_axis
from fe_contact.microgeometry.evaluator import Evaluator, deviating
from fe_contact.microgeometry.objective import NO_LIMITS, Limits
from fe_contact.microgeometry.root_influence import RootInfluence
from fe_contact.microgeometry.scatter import MISALIGNMENT, Scatter
from fe_contact.microgeometry.variables import effect_of, figure, modified
from fe_contact.options import AnalysisOptions, Levels, Run, TableAxes
from fe_contact.types import FloatArray, IntArray
from model_studies.stage_clock import StageClock


@dataclass(frozen=True)
class DesignStudy:
    """A pair whose designs can be assessed."""

    decision: Decision
    """Model and discretization of all designs and all torques."""
    loads: DesignLoads
    """All T loads of the full analysis."""
    force: FloatArray
    """Normal forces of the loads, N. Shape (T,)."""
    counted: IntArray
    """Indices of the loads that count for the objective; the others are for maps. Shape (L,)."""
    evaluator: Evaluator
    """Evaluator at the loads that count."""

    @property
    def torque(self) -> FloatArray:
        """Torques that count (L,), N m."""
        return np.asarray(self.loads.torque[self.counted])


@dataclass(frozen=True)
class DesignSpace:
    """The designs of a pair and their assessment."""

    pair: ParallelAxes
    varied: Mapping[str, float]
    """Design by which effects are decided, ``gear.quantity`` to m: no varied quantity of it is zero."""
    scatter: Scatter
    misalignment: Misalignments
    """Mean misalignment, m: one value, or one for each torque."""
    positions: int
    """Number of equally spaced positions in a base pitch."""
    options: AnalysisOptions
    """Options of the analysis. Their `positions`, `receipt` and `on_violation` are ignored."""
    minimum: Mapping[str, float] = field(default_factory=dict)
    """Design with the least material removed, ``gear.quantity`` to m. Effects that it calls for are on."""

    def check(self, torques: Levels, further_torques: Levels = ()) -> Checked:
        """Check the request of a design in which everything acts that may act in any; computes nothing.

        `torques`, `further_torques`: Torques that count, each with its misalignment, and further torques of
        the table, N m. Raises `InputError`: a value that cannot be used, or a quantity is varied whose effect
        is off.
        """
        integer("positions", self.positions, 8, 4096, "64 resolve a spur pair.")
        loads = DesignLoads.of(torques, self.misalignment)
        scattered = self.scatter.modification
        present = {name: figure(self.pair, name) for name in scattered} | dict(self.varied)
        acting = {name: amount + _toward(name) * scattered.get(name, 0.0) for name, amount in present.items()}
        skews = misalignment_axis(loads.misalignment, self.scatter.nodes().misalignment)
        axes = TableAxes(np.union1d(loads.torque, further_torques), misalignments=skews)
        options = replace(self.options, positions=None, receipt="full", on_violation="report")
        checked = check_request(modified(self.pair, acting), axes, options, neglect=False)
        _refuse_off(checked, self.varied, self.scatter)
        return _with_effects_of(self._with_the_least_removed(), checked)

    def _with_the_least_removed(self) -> ParallelAxes:
        """Return the pair with every variable at its lower bound, less its scatter."""
        present = {name: figure(self.pair, name) for name in self.scatter.modification} | dict(self.varied)
        removed = present | dict(self.minimum)
        deviation = {name: -amount for name, amount in self.scatter.modification.items()}
        return deviating(modified(self.pair, removed), deviation)


def _with_effects_of(barest: ParallelAxes, checked: Checked) -> Checked:
    """Turn on effects that only the design with the least removed calls for, such as corner contact."""
    _, ledger = compose(replace(checked.request, pair=barest).scene, checked.request.choices)
    missing = {entry.name for entry in checked.ledger if entry.choice == "auto" and not entry.on}
    reasons = {entry.name: CALLED_FOR for entry in ledger if entry.on and entry.name in missing}
    if not reasons:
        return checked
    turned_on = {**checked.request.turned_on, **reasons}
    return checked_request(replace(checked.request, turned_on=turned_on), neglect=False)


def _toward(name: str) -> float:
    """Return the sign of a deviation that acts: hollow flanks stand at their ends, where tip edges touch."""
    return -1.0 if name.endswith("_form") else 1.0


def design_study(
    space: DesignSpace,
    torques: Levels,
    further_torques: Levels,
    clock: StageClock,
    run: Run,
    checked: Checked | None = None,
    limits: Limits = NO_LIMITS,
) -> DesignStudy:
    """Choose the model and condense the gears.

    Raises `InputError` as `DesignSpace.check`.

    Parameters
    ----------
    torques, further_torques : sequence of float
        Torques that count, and torques that only maps show, N m.
    run : Run
        Cache and progress; its workers are not used.
    checked : Checked, optional
        Result of `DesignSpace.check`, if it was called before.
    limits : Limits
        Limits of the search. A limit of the root stress needs the solution of its unit loads.
    """
    design_loads = DesignLoads.of(torques, space.misalignment)
    loads, counted = design_loads.with_torques(further_torques)
    with clock.stage("planning"):
        decision = _on_one_mesh(checked or space.check(torques, further_torques), run.cache)
    run.progress("compliance", 0.0)
    with clock.stage("compliance"):
        report = partial(run.progress, "compliance")
        contact = pair_contact(space.pair, decision.plan, run.cache, report=report)
    run.progress("compliance", 1.0)
    position, nodes = np.arange(space.positions) / space.positions, space.scatter.nodes()
    level = np.searchsorted(np.unique(loads.torque), loads.torque)  # the table has every torque once
    force = decision.checked.request.load[level]
    varied, choices = replace(contact, varied=True), decision.checked.decision
    roots = None
    if limits.root_stress is not None:
        with clock.stage("root stress"):
            roots = RootInfluence.of(contact, run.cache)
    evaluator = Evaluator(varied, choices, position, force[counted], design_loads.misalignment, nodes, roots)
    return DesignStudy(decision, loads, force, counted, evaluator)


def _on_one_mesh(checked: Checked, cache: Path | None) -> Decision:
    """Return model and mesh by the requested accuracy, every effect decided for good."""
    decision = decide(checked, cache)
    request = decision.checked.request
    options = replace(request.options, effects=decision.checked.decision)
    fixed = replace(request, options=options, neglected={}, turned_on={})
    return replace(decision, checked=checked_request(fixed, neglect=False))


def _refuse_off(checked: Checked, varied: Mapping[str, float], scatter: Scatter) -> None:
    """Refuse to vary quantities that an effect hides because it is off."""
    request = checked.request
    effects = {name: effect_of(name, request.registry) for name in (*varied, *scatter.modification)}
    if scatter.misalignment:
        effects[MISALIGNMENT] = request.named(MISALIGNMENT)
    for name, effect in effects.items():
        if checked.decision[effect] == "off":
            bound = f'"on" or "auto" where {name} is varied'
            raise InputError(f"effects.{effect}", "off", bound, "Or leave it out of the variables.")
