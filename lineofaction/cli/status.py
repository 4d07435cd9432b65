"""``loa status``: the results of a folder, and the predicted cost of the verbs that renew them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from bounds import engineering
from lineofaction.cli.costs import listening_cost, simulation_cost, study_cost, table_cost, tables_cost
from lineofaction.cli.output import console, print_json, table
from lineofaction.cli.subjects import inputs_of_study
from lineofaction.gearbox.input_file import InputFile
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.project import ResultState, file_of, status_of, unread_in
from lineofaction.gearbox.registry import STUDIES
from lineofaction.gearbox.schemas import Case, read_model, read_table
from lineofaction.gearbox.studies.cost import StudyCost
from lineofaction.gearbox.studies.scene_before_tables import CASES
from lineofaction.gearbox.subjects import scene_of

_STATES, _HEAD = ("fresh", "stale", "missing"), ("state", "result", "made by")
_NAMED = 3
"""Largest number of verbs that are named where several refuse for the same reason."""


def result_costs(states: Iterable[ResultState], project: Path) -> dict[str, StudyCost | BadInput]:
    """Return the predicted cost of each result, by its name, for its verb without options.

    Where the verb would refuse to run, the refusal takes the place of the cost. A fresh result has none: it
    was made with options that are not known here. A result without a prediction is left out.
    """
    costs: dict[str, StudyCost | BadInput] = {}
    for state in states:
        try:
            cost = None if state.source is None else _result_cost(state.verb, state.source, project)
        except BadInput as refused:
            if state.state != "fresh":
                costs[state.name] = refused
            continue
        if cost is not None:
            costs[state.name] = cost
    return costs


def _result_cost(verb: str, source: Path, project: Path) -> StudyCost | None:
    study = STUDIES.get(verb)
    if verb == "analyze":
        return table_cost(read_model(Case, source))
    if verb == "simulate":
        return simulation_cost(*scene_of(source))
    if verb == "listen":
        return listening_cost(scene_of(source)[0].run.duration_s)
    if study is None:
        return None
    if "shafts" in read_table(source):
        subject: Any = scene_of(source)[0]
    else:
        subject = CASES.of(read_model(Case, source))
    inputs = inputs_of_study(study, subject, project, {})
    narrowed = study.run.narrowed(subject, inputs)
    study.run.check(narrowed, inputs)
    return study_cost(study, narrowed, project, inputs)


def scene_tables_cost(project: Path) -> StudyCost:
    """Return the predicted cost of those tables of the folder's scene that are not in the cache."""
    try:
        file = file_of(InputFile(project), "scene")
    except BadInput:
        return StudyCost(())
    return tables_cost(*scene_of(file))


def run_status(folder: Path, *, as_json: bool) -> None:
    """Print the state of the results of a folder."""
    if not folder.is_dir():
        raise BadInput.of("folder", str(folder), "a folder", "Make one with: loa open UNIT.rexs")
    states = status_of(folder)
    unread = [_reason(error) for error in unread_in(folder)]
    tables = scene_tables_cost(folder).seconds
    costs = result_costs(states, folder)
    seconds = {name: cost.seconds for name, cost in costs.items() if isinstance(cost, StudyCost)}
    refused = {name: _reason(cost) for name, cost in costs.items() if isinstance(cost, BadInput)}
    due = [result.name for result in states if result.state != "fresh"]
    total = tables + sum(seconds.get(name, 0.0) for name in due)
    if as_json:
        entries = [
            {
                "name": result.name,
                "verb": result.verb,
                "state": result.state,
                "cpu_seconds": seconds.get(result.name),
            }
            | ({"refused": refused[result.name]} if result.name in refused else {})
            for result in states
        ]
        not_predicted = sum(name not in seconds for name in due)
        totals = {"tables_cpu_seconds": tables, "due_cpu_seconds": total, "not_predicted": not_predicted}
        print_json({"results": entries, **totals, "unread": unread})
        return
    counts = Counter[str](result.state for result in states)
    out = console()
    out.print(", ".join(f"{counts[state]} {state}" for state in _STATES))
    if due:
        unpriced = {
            "that nothing predicts": sum(name not in costs for name in due),
            "refused": sum(name in refused for name in due),
        }
        exceptions = " and ".join(f"{count} {kind}" for kind, count in unpriced.items() if count)
        remark = f", without {exceptions}" if exceptions else ""
        out.print(f"stale or missing: about {engineering(total, 2)} CPU s{remark}")
    if tables:
        out.print(f"of that the tables of the scene, which are not kept: {engineering(tables, 2)} CPU s")
    predictions = {name: engineering(cost, 2) for name, cost in seconds.items()}
    predictions |= dict.fromkeys(refused, "refused")
    rows = [
        [result.state, result.name, f"loa {result.verb}", predictions.get(result.name, "-")]
        for result in sorted(states, key=lambda result: _STATES.index(result.state))
    ]
    out.print(table([*_HEAD, "CPU s"], rows, text_columns=_HEAD))
    out.print("CPU s as predicted for the verb without options; - not predicted")
    verbs = {result.name: result.verb for result in states}
    for line in [*_refusals({name: verbs[name] for name in refused}, refused), *unread]:
        out.print(line)


def _reason(error: BadInput) -> str:
    """Return the reason of a refusal in one line; the suggestions are left to the verb itself."""
    return "; ".join(str(replace(fault, suggestion="")) for fault in error.faults)


def _refusals(verbs: Mapping[str, str], reasons: Mapping[str, str]) -> Iterator[str]:
    """Yield each reason once, after the verbs that refuse for it."""
    for reason in dict.fromkeys(reasons.values()):
        names = list(dict.fromkeys(verbs[name] for name in reasons if reasons[name] == reason))
        named = ", ".join(names) if len(names) <= _NAMED else f"{names[0]} and {len(names) - 1} more"
        yield f"refused by loa {named}: {reason}"
