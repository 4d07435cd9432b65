"""The verb of any study: compute, write, print."""

from __future__ import annotations

import hashlib
import sys
from collections.abc import Callable, Sequence
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

from bounds import engineering
from bounds.types import Json
from host import cpu_seconds
from host.directories import cache_home
from lineofaction.cli.costs import announce_cost, loading_cost, study_cost, tables_cost, written_out
from lineofaction.cli.output import (
    check_writable,
    console,
    csv_text,
    print_headlines,
    print_json,
    print_parts,
    print_written,
)
from lineofaction.cli.scene_tables import tabled_scene
from lineofaction.cli.subjects import assessed_scene, inputs_of_study
from lineofaction.cli.verb_warnings import in_lines, messages, warn, warnings_so_far
from lineofaction.gearbox.convert.case import case_json
from lineofaction.gearbox.convert.case_plausibility import case_warnings
from lineofaction.gearbox.convert.checked_case import CheckedCase
from lineofaction.gearbox.convert.complaint import marks_of_case
from lineofaction.gearbox.executor import open_executor
from lineofaction.gearbox.input_file import InputFile
from lineofaction.gearbox.interrupts import until_interrupted
from lineofaction.gearbox.number_list import number_list
from lineofaction.gearbox.problems import BadInput, JobFailed
from lineofaction.gearbox.progress_bars import progress_bar
from lineofaction.gearbox.project import result_name
from lineofaction.gearbox.registry import SUFFIX
from lineofaction.gearbox.result_files import COMPLAINT, stamp, stamp_scene
from lineofaction.gearbox.schemas import Case, read_model, read_table
from lineofaction.gearbox.schemas.fault_lines import located
from lineofaction.gearbox.schemas.model import BoundaryModel
from lineofaction.gearbox.schemas.report import ReportInput
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.schemas.spelling import item_type, spelling_of
from lineofaction.gearbox.studies.computation import Means
from lineofaction.gearbox.studies.cost import StudyCost
from lineofaction.gearbox.study import Study
from lineofaction.gearbox.study_cache import cached_workers
from lineofaction.report.document import read_run, write_page
from lineofaction.report.document import write as write_result
from lineofaction.report.drawing.marks import marked_page_of_case
from lineofaction.report.presentation import presentation_of
from lineofaction.report.title_block import titled

Writer = Callable[[Any, Path], object]

_FIRST_LINES = 2
"""Number of the first lines of a study's text; a main result that stands among them is not printed twice."""


class _Subject(NamedTuple):
    """A case or a scene to study, and the folder of its files."""

    content: CheckedCase | SceneInput
    folder: Path

    @property
    def fields(self) -> Case | SceneInput:
        """The case or the scene as its file has it."""
        return self.content.case if isinstance(self.content, CheckedCase) else self.content


def run_study(study: Study, options: Json) -> None:
    """Run a study as its verb was called; `options` holds argument and options by their names."""
    files = options[study.argument] if study.several else [options[study.argument]]
    sources = [_subject_of(study, file) for file in files]
    run = None if options.get("run") is None else read_run(options["run"], "run")
    inputs = _inputs(study, options, sources[0].content, files[0].project)
    subjects = []
    for file, source in zip(files, sources, strict=True):
        with located(file):
            narrowed = study.run.narrowed(source.content, inputs)
            if isinstance(narrowed, CheckedCase):  # what is implausible about a scene is said with its tables
                warn(case_warnings(narrowed))
            subjects.append(_Subject(narrowed, source.folder))
    targets = _targets(study, options["output"], files[0])
    for subject in subjects:
        study.run.check(subject.content, inputs)
    runs = targets[0].with_name(f"{targets[0].stem}_runs") if targets else None
    interrupts = until_interrupted if study.run.interruptible else nullcontext
    with open_executor(options["workers"], options["scheduler"]) as executor:
        stages = study.stages
        if not options["json"]:
            stages = _announced_cost(study, subjects, inputs, options, targets).shares(stages, loading_cost())
        with (
            cached_workers(study, [subject.fields for subject in subjects], inputs, executor) as workers,
            progress_bar(stages) as report,
            interrupts() as cancel,
        ):
            means = Means(cache_home(), report, workers, cancel, runs, run)
            results = [
                study.run.compute(_with_tables(subject, options.get("service"), means), inputs, means)
                for subject in subjects
            ]
            interrupted = cancel is not None and cancel()
    # processes of this machine are our children, whose time we know
    remote_seconds = executor.cost.cpu_seconds if options["scheduler"] else 0.0
    result = results[0]
    if study.several:
        result = study.run.joined(dict(zip(_names(study, files), results, strict=True)))
    warn(study.run.warnings(result) or ())
    _write(study, subjects[0].content, sources[0].fields.report, result, targets)
    _print(study, result, targets, options, remote_seconds)
    if interrupted:
        raise KeyboardInterrupt("interrupted. The result above is the best so far.")
    if failure := study.run.failure(result):
        raise JobFailed(failure)


def _announced_cost(
    study: Study, subjects: Sequence[_Subject], inputs: Any, options: Json, targets: Sequence[Path]
) -> StudyCost:
    """Print on standard error what is known beforehand, and the cost if it is more than a moment.

    Return what of the cost is known.
    """
    for subject in subjects:
        if known := study.run.known_before(written_out(*subject), inputs):
            sys.stderr.write(in_lines(known, sys.stderr) + "\n")
    costs = [study_cost(study, *subject, inputs) for subject in subjects]
    if study.run.tables and options.get("service") is None:
        costs += [tables_cost(scene, folder) for scene, folder in subjects if isinstance(scene, SceneInput)]
    announce_cost(study.name, costs, targets)
    return sum(filter(None, costs), StudyCost(()))


def _write(
    study: Study, subject: Any, about: ReportInput | None, result: Any, targets: Sequence[Path]
) -> None:
    """Write a result of a case or scene into files; `about` is its title block."""
    for target in targets:
        target.parent.mkdir(exist_ok=True)
        _writers(study, subject, about)[target.suffix](result, target)
        stamp(target, warnings_so_far())
        if target.suffix == SUFFIX and (marks := _marks(subject)):
            stamp_scene(target, {COMPLAINT: marks})


def _print(study: Study, result: Any, targets: list[Path], options: Json, remote_seconds: float) -> None:
    if options["json"]:
        names = [str(target) for target in targets]
        files: Json = {"written": names[0], "file": names[0]} if names else {}
        print_json(({"written": names} if study.folder else files) | study.run.figures(result))
    elif options.get("csv"):
        sys.stdout.write(_csv(study, result))
    else:
        _show(study, result, targets, remote_seconds)


def _inputs(study: Study, options: Json, subject: CheckedCase | SceneInput, project: Path | None) -> Any:
    if isinstance(options.get("study"), BoundaryModel):  # the verb has read the file of the inputs
        return options["study"]
    fields = {} if study.takes.from_file else _fields(study, options)
    return inputs_of_study(study, subject, project, fields, options.get("study"))


def _fields(study: Study, options: Json) -> Json:
    fields = {}
    for name, field in study.inputs.model_fields.items():
        value, spelling = options[name], spelling_of(field)
        if spelling and spelling.value is not None:
            value = spelling.value if value else field.default
        elif spelling and spelling.file and value is not None:
            with value.open("rb") as content:
                value = hashlib.file_digest(content, "sha256").hexdigest()
        elif value is not None and (kind := item_type(field)):
            option = spelling.option if spelling else f"--{name.replace('_', '-')}"
            parts = [part.strip() for part in value.split(",")]
            value = number_list(option, value) if kind is float else parts
        if value is not None:
            fields[name] = value
    return fields


def _subject_of(study: Study, file: InputFile) -> _Subject:
    if study.takes.subject == "scene" or (study.takes.subject != "case" and "shafts" in read_table(file)):
        return _Subject(*assessed_scene(file))
    return _Subject(CheckedCase(read_model(Case, file)), file.folder)


def _with_tables(subject: _Subject, service: str | None, means: Means) -> Any:
    """Return a case as it is, a scene with its tables."""
    if isinstance(subject.content, CheckedCase):
        return subject.content
    return tabled_scene(subject.content, subject.folder, service, means.report, means.workers)


def _names(study: Study, files: Sequence[InputFile]) -> list[str]:
    """Return names of results, the shortest that distinguish their files."""
    names = [file.path.stem.removeprefix(f"{study.name}_").replace("_", " ") for file in files]
    return [str(file) for file in files] if len(set(names)) < len(names) else names


def _targets(study: Study, output: Path | None, file: InputFile) -> list[Path]:
    """Return the files to write; raises `BadInput` if one cannot be."""
    if output is None and file.project is not None:
        result = file.project / result_name(study, "" if study.several else file.part)
        output = result.parent if study.folder else result
    if output is None:
        return []
    if study.folder:
        return _output_files(output, study)
    if output.suffix not in study.accepted:
        raise BadInput.of("output", str(output), f"a file ending in one of {', '.join(study.accepted)}")
    check_writable(output)
    return [output]


def _output_files(output: Path, study: Study) -> list[Path]:
    """Return the files to write: one with an accepted ending, or in a folder one of each ending.

    Raises `BadInput`: `output` is neither, or cannot be written.
    """
    bound = f"a folder, or a file ending in one of {', '.join(study.accepted)}"
    if output.suffix and not output.is_dir():
        if output.suffix not in study.accepted:
            raise BadInput.of("output", str(output), bound)
        check_writable(output)
        return [output]
    if output.is_file():
        raise BadInput.of("output", str(output), bound)
    check_writable(output / "x" if output.is_dir() else output)  # any file in the folder
    return [output / f"{study.folder}{ending}" for ending in study.endings]


def _writers(study: Study, subject: Any, about: ReportInput | None) -> dict[str, Writer]:
    """Return the writers of a result by the ending of the file; `subject` is the case or scene studied."""
    run, page = study.run, presentation_of(study)

    def write_result_page(result: Any, file: Path) -> None:
        records = {f"{study.name}.json": run.figures(result)}
        marks, drawn = _marks(subject), replace(page.page(result), records=records)
        complete = titled(drawn if marks is None else marked_page_of_case(drawn, marks), about)
        write_page(complete, file, warnings=messages())

    further = {  # `write=write` binds the writer of each ending, not the last one
        ending: lambda result, file, write=write: write(result, subject, file)
        for ending, write in run.writers.items()
    }
    return {
        **dict.fromkeys((".nc", ".json", ".png"), write_result),
        **dict.fromkeys((".html", ".pdf"), write_result_page),
        ".csv": lambda result, file: file.write_text(_csv(study, result), encoding="utf-8"),
        **further,
    }


def _marks(subject: Any) -> Json | None:
    """Return the marks of a case's complaint; results of a scene know its own."""
    return marks_of_case(case_json(subject.case)) if isinstance(subject, CheckedCase) else None


def _csv(study: Study, result: Any) -> str:
    numbers = presentation_of(study).series
    assert numbers is not None
    series = numbers(result)
    return csv_text(series.head, series.rows)


def _show(study: Study, result: Any, targets: list[Path], remote_seconds: float) -> None:
    """Print the main results, tables and lines, and the whole cost: tables, workers, other children."""
    presentation = presentation_of(study)
    if point := presentation.point(result):
        console().print(point, soft_wrap=True)
    parts = list(presentation.text(result))
    first = {part for part in parts[:_FIRST_LINES] if isinstance(part, str)}
    headlines = presentation.page(result).headlines
    print_headlines(
        [line for line in headlines if first.isdisjoint((line.value, f"{line.name}: {line.value}"))]
    )
    print_parts(parts)
    console().print(f"cost {engineering(cpu_seconds() + remote_seconds, 3)} CPU s")
    print_written(targets)
