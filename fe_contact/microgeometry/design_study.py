"""The start of every study of a pair's micro-geometry: one model, one compliance, one evaluator."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np

from fe_contact.analysis.pairs.pair_contact import pair_contact
from fe_contact.analysis.request.decided import Decided
from fe_contact.analysis.request.model_choice import decide
from fe_contact.analysis.request.request import Checked
from fe_contact.analysis.request.request_check import check_asked, check_request
from fe_contact.checks import integer
from fe_contact.errors import InputError
from fe_contact.geometry import ParallelAxes
from fe_contact.microgeometry.design_loads import DesignLoads, Misalignments, misalignment_axis
from fe_contact.microgeometry.evaluator import Evaluator
from fe_contact.microgeometry.scatter import MISALIGNMENT, Scatter
from fe_contact.microgeometry.variables import effect_of, figure, modified
from fe_contact.options import AnalysisOptions, Levels, Run, TableAxes
from fe_contact.stage_clock import StageClock
from fe_contact.types import FloatArray, IntArray


@dataclass(frozen=True)
class DesignStudy:
    """A pair whose designs can be assessed.

    Attributes
    ----------
    decided : Decided
        Model and discretization, of all designs and all torques.
    loads : DesignLoads
        All T of them: those of the full analysis.
    force : ndarray, shape (T,)
        Their normal forces, N.
    counted : ndarray of int, shape (L,)
        Which of them count; the others are for maps.
    evaluator : Evaluator
        At the loads that count.
    """

    decided: Decided
    loads: DesignLoads
    force: FloatArray
    counted: IntArray
    evaluator: Evaluator

    @property
    def torque(self) -> FloatArray:
        """Torques that count (L,), N m."""
        return np.asarray(self.loads.torque[self.counted])


@dataclass(frozen=True)
class DesignSpace:
    """The designs of a pair and their assessment.

    Attributes
    ----------
    pair : GearPair or InternalGearPair
    varied : mapping
        ``gear.quantity`` to m of a design in which nothing that is varied is zero: by it the effects are
        decided.
    scatter : Scatter
    misalignment : float or sequence of float
        About which it scatters, m: one value, or one for each torque.
    positions : int
        Equally spaced in a base pitch.
    options : AnalysisOptions
        Their `positions`, `receipt` and `on_violation` do not count.
    """

    pair: ParallelAxes
    varied: Mapping[str, float]
    scatter: Scatter
    misalignment: Misalignments
    positions: int
    options: AnalysisOptions

    def check(self, torques: Levels, further_torques: Levels = ()) -> Checked:
        """Check the request of a design in which everything acts that may act in any; computes nothing.

        Parameters
        ----------
        torques, further_torques : sequence of float
            Those that count, each with its misalignment, and others that the table has, N m.

        Raises
        ------
        InputError
            A value that cannot be used, or something is varied whose effect is off.
        """
        integer("positions", self.positions, 8, 4096, "64 resolve a spur pair.")
        loads = DesignLoads.of(torques, self.misalignment)
        scattered = self.scatter.modification
        present = {name: figure(self.pair, name) for name in scattered} | dict(self.varied)
        acting = {name: present[name] + scattered.get(name, 0.0) for name in present}
        skews = misalignment_axis(loads.misalignment, self.scatter.nodes().misalignment)
        checked = check_request(
            modified(self.pair, acting),
            TableAxes(np.union1d(loads.torque, further_torques), misalignments=skews),
            replace(self.options, positions=None, receipt="full", on_violation="report"),
            spare=False,
        )
        _refuse_off(checked, self.varied, self.scatter)
        return checked


def design_study(
    space: DesignSpace, torques: Levels, further_torques: Levels, clock: StageClock, run: Run
) -> DesignStudy:
    """Choose the model and condense the gears.

    Parameters
    ----------
    space : DesignSpace
    torques, further_torques : sequence of float
        Those that count, and those that only maps show, N m.
    clock : StageClock
    run : Run
        Only this process works.

    Raises
    ------
    InputError
        As `DesignSpace.check`.
    """
    own = DesignLoads.of(torques, space.misalignment)
    loads, counted = own.with_torques(further_torques)
    with clock.stage("planning"):
        decided = _on_one_mesh(space.check(torques, further_torques), run.cache)
    run.progress("compliance", 0.0)
    with clock.stage("compliance"):
        report = partial(run.progress, "compliance")
        contact = pair_contact(space.pair, decided.plan, run.cache, report=report)
    run.progress("compliance", 1.0)
    position, nodes = np.arange(space.positions) / space.positions, space.scatter.nodes()
    level = np.searchsorted(np.unique(loads.torque), loads.torque)  # the table has every torque once
    force = decided.checked.request.load[level]
    evaluator = Evaluator(contact, decided.checked.decided, position, force[counted], own.misalignment, nodes)
    return DesignStudy(decided, loads, force, counted, evaluator)


def _on_one_mesh(checked: Checked, cache: Path | None) -> Decided:
    """Return model and mesh by the requested accuracy, every effect decided for good."""
    decided = decide(checked, cache)
    request = decided.checked.request
    options = replace(request.options, effects=decided.checked.decided)
    fixed = replace(request, options=options, neglected={}, turned_on={})
    return replace(decided, checked=check_asked(fixed, spare=False))


def _refuse_off(checked: Checked, varied: Mapping[str, float], scatter: Scatter) -> None:
    """Refuse to vary what an effect that is off would hide."""
    request = checked.request
    shown = {name: effect_of(name, request.registry) for name in (*varied, *scatter.modification)}
    if scatter.misalignment:
        shown[MISALIGNMENT] = request.named(MISALIGNMENT)
    for name, effect in shown.items():
        if checked.decided[effect] == "off":
            bound = f'"on" or "auto" where {name} is varied'
            raise InputError(f"effects.{effect}", "off", bound, "Or leave it out of the variables.")
