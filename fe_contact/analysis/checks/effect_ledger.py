"""The effect ledger of a run: state, reason, influence, cost and check of every effect."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from bounds import engineering
from fe_contact.analysis.checks.assumptions import Assumption
from fe_contact.analysis.request.influences import Influences, estimated_influences
from fe_contact.analysis.request.request import Checked
from fe_contact.analysis.request.request_check import checked_request
from fe_contact.effects import LedgerEntry
from fe_contact.effects.composer import flipped
from fe_contact.effects.influence.influence import Influence
from fe_contact.errors import InputError
from fe_contact.planning.plan import Plan
from fe_contact.types import Json

NOT_CHECKED = "no; toggling it measures it (ablation)"


def effect_ledger(
    checked: Checked,
    cache: Path | None,
    assumptions: Sequence[Assumption] = (),
    *,
    plan: Plan | None = None,
    influences: Influences | None = None,
    estimates: bool = True,
) -> list[Json]:
    """Return one entry per effect as plain JSON.

    Parameters
    ----------
    cache : Path, optional
        Directory of compliances and of what is known of the host, for predicted times.
    assumptions : sequence of Assumption
        What was checked after the run.
    plan : Plan, optional
        Plan of the run, for the cost of its mesh and slices; default: those that the accuracy requires.
    influences : mapping of str to Influence, optional
        Influences estimated for the plan, before the run; default: estimated here.
    estimates : bool
        Whether influence and cost are estimated, in milliseconds; without it they are None.
    """
    costs = _costs(checked, cache, plan) if estimates else {}
    if influences is None:
        influences = estimated_influences(checked) if estimates else {}
    return [
        _entry(entry, influences.get(entry.name), costs.get(entry.name), assumptions)
        for entry in checked.ledger
    ]


def _entry(
    entry: LedgerEntry, influence: Influence | None, seconds: float | None, assumptions: Sequence[Assumption]
) -> Json:
    checks = [check for check in assumptions if check.effect == entry.name]
    return entry.to_json() | {
        "influence": None if influence is None else influence.to_json(),
        "cost_cpu_seconds": seconds,
        "price": _price(entry, influence, seconds),
        "checked": "; ".join(f"{check.what}: {check.reason}" for check in checks) or NOT_CHECKED,
        "holds": all(check.holds is not False for check in checks) if checks else None,
    }


def _costs(checked: Checked, cache: Path | None, plan: Plan | None) -> dict[str, float | None]:
    """Predict the CPU seconds that each effect adds to the run.

    None if the effect cannot be toggled. Effects that are off and not called for are left out: leaving them
    out saved nothing.
    """
    cost = _predicted(checked, cache, plan)
    acting = [entry for entry in checked.ledger if entry.on or entry.verdict.on]
    return {entry.name: _cost(checked, entry, cost, (cache, plan)) for entry in acting}


def _cost(
    checked: Checked, entry: LedgerEntry, cost: float, known: tuple[Path | None, Plan | None]
) -> float | None:
    """Return the CPU seconds of one effect in a run that is predicted to take `cost`."""
    try:
        other = toggled(checked, entry.name, "off" if entry.on else "on")
    except InputError:
        return None
    other_cost = _predicted(other, *known)
    return cost - other_cost if entry.on else other_cost - cost


def _predicted(checked: Checked, cache: Path | None, run: Plan | None) -> float:
    """Return the CPU seconds of a request, with the mesh of a run, and its slices if it has several."""
    if run is None:
        return checked.predicted(checked.planned(cache), cache).cpu_seconds
    slices = run.discretization.slices
    return checked.predicted(checked.plan(run.level, slices if slices > 1 else None), cache).cpu_seconds


def _price(entry: LedgerEntry, influence: Influence | None, seconds: float | None) -> str:
    if entry.on == entry.verdict.on:
        return ""
    if entry.on:
        return f"about {engineering(seconds, 2)} CPU s" if seconds is not None else "time"
    return "not estimated" if influence is None else influence.text


def toggled(checked: Checked, name: str, choice: str) -> Checked:
    """Return the request with one effect on or off and all others as they were decided.

    Raises `InputError`: there is no such model, as a plane with an effect that acts across the face.
    """
    request = checked.request
    choices = flipped(request.registry, checked.decision, name, choice)
    face, _ = request.model_effects
    # choices of every effect are explicit now, so the model must not decide any of them
    plane_stress = request.options.model == "plane_stress" and choices[face] == "off"
    options = replace(request.options, model="plane_stress" if plane_stress else "auto", effects=choices)
    neglected = {other: reason for other, reason in request.neglected.items() if other != name}
    return checked_request(
        replace(request, options=options, neglected=neglected, turned_on={}), neglect=False
    )
