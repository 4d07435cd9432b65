"""The interface of a study's module `run`."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from dynamics.results import RunResult
from fe_contact.workers import InProcess, Workers
from lineofaction.gearbox.schemas.model import BoundaryModel
from lineofaction.gearbox.studies.result_file import ResultFile

Json = dict[str, Any]
Result = Any


@dataclass(frozen=True)
class Means:
    """The means that a study works with.

    Attributes
    ----------
    home : Path
        Folder of the caches.
    report : callable
        Called as report(stage, fraction).
    workers : Workers
        Who does the tasks.
    cancel : callable, optional
        Says whether to end with the best so far.
    folder : Path, optional
        Where to put the runs that a study keeps in full; None: nowhere.
    run : RunResult, optional
        Whose bearing forces a study takes in place of the linear response.
    """

    home: Path
    report: Callable[[str, float], None]
    workers: Workers = field(default_factory=InProcess)
    cancel: Callable[[], bool] | None = None
    folder: Path | None = None
    run: RunResult | None = None


def with_defaults(inputs: BoundaryModel) -> Json:
    """Return inputs as JSON, with all defaults."""
    return inputs.model_dump(mode="json")


@dataclass(frozen=True)
class Computation:
    """The work of a study.

    Attributes
    ----------
    compute : callable
        ``compute(subject, inputs, means)``: case, or scene as `tables` says, model of the inputs and `Means`
        to the result. Raises `BadInput`, `JobFailed`.
    facts : callable
        Figures of a result in the units of the boundary, as they are printed and served.
    file : ResultFile
        How a result is written and read back.
    narrowed : callable
        ``narrowed(subject, inputs)``: what of the subject the inputs choose; it is checked, hashed and
        computed. Default: all of it.
    tables : bool
        Whether a scene comes with the tables of its meshes, as `TabledScene`; else as `HousedScene`.
    check : callable
        ``check(subject, inputs)`` refuses what a schema accepts, and computes nothing; raises `BadInput`.
        Here and below a scene is a `SceneInput`.
    normalized : callable
        ``normalized(subject, inputs)``: the inputs of a job as JSON, alike for equal questions; may raise
        `BadInput`. Default: with all defaults.
    warnings : callable
        What a result warns of beside its case, which others assess; None for nothing.
    joined : callable, optional
        Results of several cases, by the names of their files, to one; for a verb that takes several.
    interruptible : bool
        Whether it ends with the best so far when `Means.cancel` says so.
    resumed : bool
        Whether tasks that were done are kept for an attempt after one that died.
    kept : callable
        ``kept(result, means)``: the runs in `Means.folder`, by the hash that they are stored under.
    writers : mapping
        Further files of the verb, by their ending: called with result, what was studied, and file.
    failure : callable
        Says what of a result was not found; empty if nothing is missing.
    """

    compute: Callable[[Any, Any, Means], Result]
    facts: Callable[[Result], Json]
    file: ResultFile
    narrowed: Callable[[Any, Any], Any] = lambda subject, _inputs: subject
    tables: bool = True
    check: Callable[[Any, Any], object] = lambda _subject, _inputs: None
    normalized: Callable[[Any, Any], Json] = lambda _subject, inputs: with_defaults(inputs)
    warnings: Callable[[Result], list[Json] | None] = lambda _found: None
    joined: Callable[[Mapping[str, Result]], Result] | None = None
    interruptible: bool = False
    resumed: bool = False
    kept: Callable[[Result, Means], Mapping[str, Path]] = lambda _result, _means: {}
    writers: Mapping[str, Callable[[Result, Any, Path], object]] = field(default_factory=dict)
    failure: Callable[[Result], str] = lambda _found: ""

    def save_facts(self, result: Result, file: Path) -> None:
        """Write the figures as JSON."""
        file.write_text(f"{json.dumps(self.facts(result), allow_nan=False)}\n", encoding="utf-8")
