"""Predicted costs of verbs, before they compute."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from host.directories import cache_home
from lineofaction.cli.cached_tables import CachedTables
from lineofaction.cli.verb_warnings import in_lines
from lineofaction.gearbox.convert.checked_case import CheckedCase
from lineofaction.gearbox.convert.plan import costs_of
from lineofaction.gearbox.schemas import Case
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.studies.cost import StudyCost, Work, panels_work
from lineofaction.gearbox.studies.run_cost import run_cost
from lineofaction.gearbox.studies.scene_before_tables import CASES
from lineofaction.gearbox.study import Study
from lineofaction.gearbox.subjects import with_inline_cases
from model_studies.host_speed import host_slowness
from model_studies.progress import ANNOUNCED

_READING, _PLAYED, _BY_EAR = 0.5, 0.06, 2.9
"""CPU seconds of reading a run, of a second of sound, and of a second of sound at a microphone, with the
figures of hearing."""
_LOADED = 2.5
"""CPU seconds of loading what a study needs, on the reference host."""
_LOADED_IN_WORK = 1.0
"""CPU seconds of them once the work has begun: what meshes and contact need."""
_DRAWN = {".html": 1.7, ".png": 2.1, ".svg": 2.1, ".pdf": 2.1}
"""CPU seconds of drawing a file of a result, on the reference host, by its ending."""


def study_cost(
    study: Study, subject: CheckedCase | SceneInput, folder: Path, inputs: Any
) -> StudyCost | None:
    """Return the predicted cost of a study, without the tables of a scene; None: not predicted."""
    return study.run.predicted(written_out(subject, folder), inputs, cache_home() / "compliance")


def written_out(subject: CheckedCase | SceneInput, folder: Path) -> CheckedCase | SceneInput:
    """Return a scene with its cases in place of their files, relative to `folder`; a case as it is."""
    return with_inline_cases(subject, folder) if isinstance(subject, SceneInput) else subject


def table_cost(case: Case) -> StudyCost:
    """Return the predicted cost of the table of a case, in all passes that are expected."""
    passes = costs_of(CASES.of(case), cache_home() / "compliance")
    seconds = sum(cost.cpu_seconds for cost in passes)
    return StudyCost((Work("tables", seconds, stage="analysis"),), max(cost.memory_bytes for cost in passes))


def tables_cost(scene: SceneInput, folder: Path) -> StudyCost:
    """Return the predicted cost of the tables of a scene that are not in the cache."""
    written = (mesh.case for mesh in with_inline_cases(scene, folder).meshes if isinstance(mesh.case, Case))
    cases = {case.model_dump_json(): case for case in written}
    return sum(
        (table_cost(case) for case in cases.values() if not CachedTables.file(case).is_file()), StudyCost(())
    )


def simulation_cost(scene: SceneInput, folder: Path) -> StudyCost | None:
    """Return the predicted cost of a run, without the tables of its scene; None: not predicted."""
    return run_cost(with_inline_cases(scene, folder))


def listening_cost(seconds: float, *, housings: int = 0) -> StudyCost:
    """Return the predicted cost of so many seconds of a run as a sound, radiated by `housings` if any."""
    rate = _BY_EAR if housings else _PLAYED
    sound = Work("runs", _READING), Work("seconds of sound", rate, seconds)
    return StudyCost((panels_work(housings), *sound) if housings else sound)


def announce_cost(
    verb: str, costs: Sequence[StudyCost | None], targets: Sequence[Path] | None = None
) -> None:
    """Print the predicted cost of a verb on standard error, if it is known and more than a moment.

    `targets`: files that the verb draws; they and the program are counted, but do not make a moment more.
    None: neither is counted.
    """
    total = sum(filter(None, costs), StudyCost(()))
    if None not in costs and total.seconds > ANNOUNCED:
        total += StudyCost(()) if targets is None else _program_cost(targets)
        sys.stderr.write(in_lines(f"loa {verb}: {total.text}", sys.stderr) + "\n")


def loading_cost() -> float:
    """Return the predicted CPU seconds of loading once the work of a study has begun."""
    return _LOADED_IN_WORK * host_slowness(cache_home() / "compliance")


def _program_cost(targets: Sequence[Path]) -> StudyCost:
    """Return the predicted cost of loading the program and of drawing files."""
    drawn = sum(_DRAWN.get(target.suffix, 0.0) for target in targets)
    slowness = host_slowness(cache_home() / "compliance")
    return StudyCost((Work("program and files", (_LOADED + drawn) * slowness),))
