"""``loa status``: the results of a folder, and what the verbs that make them are predicted to cost."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from pathlib import Path

from bounds import engineering
from host.directories import cache_home
from lineofaction.cli.output import console, print_json, table
from lineofaction.cli.subjects import is_kept, study_seconds
from lineofaction.gearbox.convert.case import CheckedCase
from lineofaction.gearbox.convert.live import plan_of
from lineofaction.gearbox.input_file import InputFile
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.project import ResultState, file_of, inputs_in, status_of
from lineofaction.gearbox.registry import STUDIES
from lineofaction.gearbox.schemas import Case, read_model, read_table, validated
from lineofaction.gearbox.subjects import scene_of, with_own_cases


def _table_seconds(case: Case) -> float:
    return plan_of(CheckedCase(case), None, cache_home() / "compliance").chosen.cost.cpu_seconds


def result_seconds(states: Iterable[ResultState], project: Path) -> dict[str, float]:
    """Return predicted CPU seconds by the name of the result, as its verb would run without options.

    What nothing predicts is left out, and what the verb would refuse.
    """
    seconds = {}
    for state in states:
        try:
            own = None if state.source is None else _result_seconds(state.verb, state.source, project)
        except BadInput:
            continue
        if own is not None:
            seconds[state.name] = own
    return seconds


def _result_seconds(verb: str, source: Path, project: Path) -> float | None:
    study = STUDIES.get(verb)
    if verb == "analyze":
        return _table_seconds(read_model(Case, source))
    if study is None:
        return None
    file = inputs_in(project, study) if study.takes.from_file else None
    inputs = validated(study.inputs, {}) if file is None else read_model(study.inputs, file)
    if "shafts" in read_table(source):
        return study_seconds(study, *scene_of(source), inputs)
    case = study.run.narrowed(CheckedCase(read_model(Case, source)), inputs)
    return study_seconds(study, case, project, inputs)


def tables_seconds(project: Path) -> float:
    """Return the predicted CPU seconds of the tables of the folder's scene that are not kept."""
    try:
        file = file_of(InputFile(project), "scene")
    except BadInput:
        return 0.0
    scene = with_own_cases(*scene_of(file))
    cases = {case.model_dump_json(): case for mesh in scene.meshes if isinstance(case := mesh.case, Case)}
    return sum(_table_seconds(case) for case in cases.values() if not is_kept(case))


_STATES, _HEAD = ("fresh", "stale", "missing"), ("state", "result", "made by")


def run_status(folder: Path, *, as_json: bool) -> None:
    """Print the state of the results of a folder."""
    if not folder.is_dir():
        raise BadInput.of("folder", str(folder), "a folder", "Make one with: loa open UNIT.rexs")
    states = status_of(folder)
    tables, seconds = tables_seconds(folder), result_seconds(states, folder)
    if as_json:
        facts = [
            {"name": own.name, "verb": own.verb, "state": own.state, "cpu_seconds": seconds.get(own.name)}
            for own in states
        ]
        print_json({"results": facts, "tables_cpu_seconds": tables})
        return
    counts = Counter[str](own.state for own in states)
    out = console()
    out.print(", ".join(f"{counts[state]} {state}" for state in _STATES))
    if tables:
        words = f"about {engineering(tables, 2)} CPU s for the first verb of the scene that needs them"
        out.print(f"tables of the meshes are not computed: {words}", soft_wrap=True)
    rows = [
        [
            own.state,
            own.name,
            f"loa {own.verb}",
            engineering(seconds[own.name], 2) if own.name in seconds else "-",
        ]
        for own in sorted(states, key=lambda own: _STATES.index(own.state))
    ]
    out.print(table([*_HEAD, "CPU s"], rows, words=_HEAD))
    out.print("CPU s as predicted for the verb without options; - not predicted")
