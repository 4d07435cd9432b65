"""The start of every study of a pair's micro-geometry: one model, one compliance, one evaluator."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np

from bounds import SiNote
from fe_contact.analysis.pairs.pair_contact import pair_contact
from fe_contact.analysis.request.model_choice import Decided, decide
from fe_contact.analysis.request.request import Checked
from fe_contact.analysis.request.request_check import check_asked, check_request
from fe_contact.errors import InputError, finite, integer, within
from fe_contact.geometry import ParallelAxes
from fe_contact.microgeometry.evaluator import Evaluator
from fe_contact.microgeometry.scatter import MISALIGNMENT, Scatter
from fe_contact.microgeometry.variables import effect_of, figure, modified
from fe_contact.options import LARGEST_DEVIATION, AnalysisOptions, Levels, Run, TableAxes
from fe_contact.stage_clock import StageClock
from fe_contact.types import FloatArray, IntArray

# The loads at which designs are assessed: torques, each with the misalignment of the mesh under it.

SAME = 1e-12
"""Misalignments that differ by less, in m, are one: sums of the same two differ in their last bits."""
Misalignments = float | Levels
"""One value for all loads, or one for each, m."""


@dataclass(frozen=True)
class DesignLoads:
    """L loads, by rising torque; loads of one torque differ in their misalignment.

    Attributes
    ----------
    torque : ndarray, shape (L,)
        On the driving gear, N m.
    misalignment : ndarray, shape (L,)
        Growth of the gap over the common face width, m: shafts, bearings and housing yield with the torque.
    """

    torque: FloatArray
    misalignment: FloatArray

    @classmethod
    def of(cls, torques: Levels, misalignment: Misalignments) -> DesignLoads:
        """Return the loads of torques in N m and of their misalignments in m.

        Raises
        ------
        InputError
            No torque, torques that fall, one load twice, or another number of misalignments than one or one
            for each torque.
        """
        torque = np.array([finite(f"torques[{i}]", value) for i, value in enumerate(torques)])
        if not torque.size:
            raise InputError("torques", [], "a non-empty list of finite numbers")
        skew = np.broadcast_to(_misalignments(misalignment, torque.size), torque.shape)
        if np.any(np.diff(torque) < 0.0) or len({*zip(torque, skew, strict=True)}) < torque.size:
            bound = "increasing, and equal only at different misalignments"
            raise InputError("torques", torque.tolist(), bound, "Sort the list and drop repeats.")
        return cls(torque, skew)

    def with_torques(self, further: Levels) -> tuple[DesignLoads, IntArray]:
        """Return the loads (T,) with further torques among them, and which of all are the own ones (L,).

        Misalignments of further torques are linear between the loads, held beyond the lowest and highest.
        """
        added = np.setdiff1d(further, self.torque)
        torque = np.concatenate([self.torque, added])
        between = np.interp(added, self.torque, self.misalignment)
        order = np.argsort(torque, kind="stable")
        everything = DesignLoads(torque[order], np.concatenate([self.misalignment, between])[order])
        return everything, np.flatnonzero(order < self.torque.size)


def misalignment_axis(misalignment: FloatArray, deviation: FloatArray) -> FloatArray:
    """Return the axis of a table that holds misalignments (L,) with none and with each deviation (S,), m."""
    own = np.concatenate([misalignment, np.add.outer(deviation, misalignment).ravel()])
    rising = np.unique(own)
    return np.asarray(rising[np.append(True, np.diff(rising) > SAME)])


def on_axis(axis: FloatArray, misalignment: FloatArray) -> FloatArray:
    """Return misalignments, those of the axis (M,) to its last bit, m."""
    nearest = axis[np.abs(axis - misalignment[..., None]).argmin(axis=-1)]
    return np.where(np.abs(nearest - misalignment) <= SAME, nearest, misalignment)


def _misalignments(given: Misalignments, loads: int) -> FloatArray:
    """Check misalignments: one, or one for each load."""
    values = np.atleast_1d(np.asarray(given, dtype=object)).tolist()
    if len(values) not in (1, loads):
        raise InputError("misalignment", values, f"one number, or {loads}, one for each torque")
    ends, advice = (-LARGEST_DEVIATION, LARGEST_DEVIATION), SiNote("In m: 10 um is 1e-5.")
    names = [f"misalignment[{i}]" for i in range(len(values))] if np.ndim(given) else ["misalignment"]
    return np.array([within(*each, *ends, advice) for each in zip(names, values, strict=True)])


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
