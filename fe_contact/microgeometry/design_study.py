"""What every study of a pair's micro-geometry begins with: one model, one compliance, one evaluator."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from bounds import SiNote
from fe_contact.allowed_error import AllowedError
from fe_contact.analysis.decided import Decided
from fe_contact.analysis.model_choice import decide
from fe_contact.analysis.pair_contact import pair_contact
from fe_contact.analysis.request import Checked
from fe_contact.analysis.request_check import check_asked, check_request
from fe_contact.analysis.table_axes import LARGEST_DEVIATION
from fe_contact.checks import increasing, integer, within
from fe_contact.effects.misalignment import Misalignment
from fe_contact.errors import InputError
from fe_contact.geometry import ParallelAxes
from fe_contact.microgeometry.evaluator import Evaluator
from fe_contact.microgeometry.scatter import MISALIGNMENT, Scatter
from fe_contact.microgeometry.variables import effect_of, figure, modified
from fe_contact.progress import Progress
from fe_contact.stage_clock import StageClock
from fe_contact.types import FloatArray, IntArray


@dataclass(frozen=True)
class DesignStudy:
    """A pair whose designs can be assessed.

    Attributes
    ----------
    decided : Decided
        Model and discretization, of all designs and all torques.
    all_torques : ndarray, shape (T,)
        Of its loads, N m.
    counted : ndarray of int, shape (L,)
        Which of them count; the others are for maps.
    evaluator : Evaluator
        At the torques that count.
    """

    decided: Decided
    all_torques: FloatArray
    counted: IntArray
    evaluator: Evaluator

    @property
    def torque(self) -> FloatArray:
        """Torques that count (L,), N m."""
        return np.asarray(self.all_torques[self.counted])


@dataclass(frozen=True)
class Accuracies:
    """What `analyze` takes of the same names."""

    tolerance: AllowedError | float | None = None
    level: str | None = None
    time_budget: float | None = None
    model: str = "auto"
    effects: Mapping[str, str] | None = None


def design_study(
    pair: ParallelAxes,
    torques: Sequence[float] | FloatArray,
    further_torques: Sequence[float] | FloatArray,
    varied: Mapping[str, float],
    scatter: Scatter,
    misalignment: float,
    positions: int,
    accuracy: Accuracies,
    clock: StageClock,
    report: Progress,
    cache: Path | None,
) -> DesignStudy:
    """Choose the model and condense the gears.

    Parameters
    ----------
    pair : GearPair or InternalGearPair
    torques, further_torques : sequence of float
        Those that count, and those that only maps show, N m.
    varied : mapping
        ``gear.quantity`` to m of a design in which nothing that is varied is zero: by it the effects are
        decided.
    scatter : Scatter
    misalignment : float
        About which it scatters, m.
    positions : int
        Equally spaced in a base pitch.
    accuracy : Accuracies
    clock, report, cache
        See `analyze`.

    Raises
    ------
    InputError
        A value that cannot be used, or something is varied whose effect is off.
    """
    counted = increasing("torques", torques)
    everything = np.union1d(counted, further_torques)
    with clock.stage("planning"):
        checked = check_study(pair, everything, varied, scatter, misalignment, positions, accuracy)
        decided = _on_one_mesh(checked, cache)
    report("compliance", 0.0)
    with clock.stage("compliance"):
        contact = pair_contact(pair, decided.plan, cache)
    report("compliance", 1.0)
    index = np.searchsorted(everything, counted)
    load = decided.checked.request.load[index]
    place = np.arange(positions) / positions
    evaluator = Evaluator(contact, decided.checked.decided, place, load, misalignment, scatter.nodes())
    return DesignStudy(decided, everything, index, evaluator)


def check_study(
    pair: ParallelAxes,
    torques: FloatArray,
    varied: Mapping[str, float],
    scatter: Scatter,
    misalignment: float,
    positions: int,
    accuracy: Accuracies,
) -> Checked:
    """Check the request of a design in which everything acts that may act in any; computes nothing.

    Parameters and errors are those of `design_study`, all torques in one.
    """
    integer("positions", positions, 8, 4096, "64 resolve a spur pair.")
    within(
        "misalignment", misalignment, -LARGEST_DEVIATION, LARGEST_DEVIATION, SiNote("In m: 10 um is 1e-5.")
    )
    nodes = scatter.nodes()
    present = {name: figure(pair, name) for name in scatter.modification} | dict(varied)
    acting = {name: present[name] + scatter.modification.get(name, 0.0) for name in present}
    checked = check_request(
        modified(pair, acting),
        torques=torques,
        tolerance=accuracy.tolerance,
        level=accuracy.level,
        time_budget=accuracy.time_budget,
        model=accuracy.model,
        misalignments=np.unique(misalignment + nodes.misalignment),
        effects=accuracy.effects,
        on_violation="report",
        spare=False,
    )
    _refuse_off(checked, varied, scatter)
    return checked


def _on_one_mesh(checked: Checked, cache: Path | None) -> Decided:
    """Return model and mesh by the asked accuracy, every effect decided for good."""
    decided = decide(checked, cache)
    request = decided.checked.request
    fixed = replace(request, effects=decided.checked.decided, neglected={}, turned_on={})
    return replace(decided, checked=check_asked(fixed, spare=False))


def _refuse_off(checked: Checked, varied: Mapping[str, float], scatter: Scatter) -> None:
    """Refuse to vary what an effect that is off would hide."""
    shown = {name: effect_of(name) for name in (*varied, *scatter.modification)}
    if scatter.misalignment:
        shown[MISALIGNMENT] = Misalignment.name
    for name, effect in shown.items():
        if checked.decided[effect] == "off":
            bound = f'"on" or "auto" where {name} is varied'
            raise InputError(f"effects.{effect}", "off", bound, "Or leave it out of the variables.")
