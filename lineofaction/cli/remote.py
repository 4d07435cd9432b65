"""``loa submit`` and ``loa fetch``: the client on the command line."""

from __future__ import annotations

import json
import re
import shutil
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from host.extras import MissingExtra
from lineofaction.cli.output import Report, check_writable, console, print_json, print_result
from lineofaction.cli.remote_jobs import waited
from lineofaction.cli.warned import warn
from lineofaction.client import JobState, LineOfActionClient, Result
from lineofaction.gearbox.convert.stamp import stamped
from lineofaction.gearbox.input_file import InputFile
from lineofaction.gearbox.problems import BadInput, ResultNotReady
from lineofaction.gearbox.registry import studies_of
from lineofaction.gearbox.schemas import Case, read_table, validated
from lineofaction.gearbox.subjects import scene_inputs

if TYPE_CHECKING:
    from lineofaction.report.drawing.page import Headline

_OF_CASES = ("analyze", *studies_of("case"))
_OF_SCENES = ("simulate", *studies_of("scene"))
_OF_BOTH = studies_of("case or scene")


@dataclass(frozen=True)
class ProcessRequest:
    """A process to run on a file, None for the file's own, further inputs as JSON, terms of the job."""

    process: str | None = None
    inputs: str | None = None
    terms: Mapping[str, Any] = field(default_factory=dict)


def run_submit(
    file: InputFile, service: str, request: ProcessRequest, *, wait: bool, output: Path | None, as_json: bool
) -> None:
    """Submit; wait and write if requested."""
    if output is not None:
        check_writable(output)
    further = _further(request)
    with LineOfActionClient(service).with_terms(**request.terms) as client:
        state = _submitted(client, file, request.process, further)
        warn(state.warnings)
        facts: dict[str, object] = {"job": state.id, "process": state.process, "status": state.status}
        if wait or output is not None:
            result = waited(client, state.id)
            facts |= {"status": "successful", "hash": result.key, "kind": result.kind}
        if output is not None:
            shutil.copyfile(client.fetch_file(result.key, result.kind), output)
            facts["file"] = str(output)
            warn(stamped(output))
    if as_json:
        print_json(facts)
        return
    _tell(f"job {facts['job']}, {facts['process']}: {facts['status']}")
    if "hash" in facts:
        _show_result(str(facts["hash"]), str(facts["kind"]), output)
    else:
        _tell(f"Its result, once it has ended: loa fetch {state.id} --service {service} -o FILE")


def _further(request: ProcessRequest) -> dict[str, Any]:
    known = (*_OF_CASES, *_OF_SCENES, *_OF_BOTH)
    if request.process not in (None, *known):
        raise BadInput.of("--process", request.process, f"one of {', '.join(known)}", "Or leave it out.")
    if request.inputs is None:
        return {}
    example = """For example --inputs '{"misalignment_um": 30}'."""
    if request.process is None:
        raise BadInput.of("--inputs", request.inputs, "given with --process", example)
    try:
        inputs = json.loads(request.inputs)
    except json.JSONDecodeError:
        inputs = None
    if not isinstance(inputs, dict) or "case" in inputs or "scene" in inputs:
        raise BadInput.of("--inputs", request.inputs, "a JSON object without case and scene", example)
    return inputs


def _submitted(
    client: LineOfActionClient, file: InputFile, process: str | None, further: dict[str, Any]
) -> JobState:
    content = read_table(file)
    if "shafts" in content and process not in _OF_CASES:
        return client.submit(process or "simulate", scene_inputs(file) | further)
    if "pair" in content and process not in _OF_SCENES:
        case = validated(Case, content).model_dump(mode="json")
        return client.submit(process or "analyze", {"case": case, **further})
    raise BadInput.of(
        "file", str(file), "a case (with [pair]) or a scene (with [[shafts]])", "See docs/case-file.md."
    )


def watching(report: Report) -> Callable[[JobState], None]:
    """Return the client's progress callback that feeds a bar."""

    def watch(state: JobState) -> None:
        if state.stage:
            report(state.stage, state.stage_progress / 100.0)

    return watch


def run_fetch(name: str, output: Path, service: str, *, wait: bool, as_json: bool) -> None:
    """Fetch by hash or by job."""
    check_writable(output)
    with LineOfActionClient(service) as client:
        if re.fullmatch("[0-9a-f]{64}", name):
            key, (file, kind) = name, client.fetch_result(name)
        else:
            result = _ended(client, name, wait=wait)
            file, key, kind = client.fetch_file(result.key, result.kind), result.key, result.kind
    shutil.copyfile(file, output)
    warn(stamped(output))
    if as_json:
        print_json({"hash": key, "kind": kind, "file": str(output)})
    else:
        _show_result(key, kind, output)


def _ended(client: LineOfActionClient, job: str, *, wait: bool) -> Result:
    if not re.fullmatch(r"[0-9a-fA-F-]{1,64}", job):
        raise BadInput.of("name", job, "the identifier of a job or a content hash", "loa submit prints both.")
    try:
        return waited(client, job) if wait else client.result(job)
    except ResultNotReady as error:
        raise ResultNotReady(f"{error} Wait for it with: loa fetch {job} --wait -o FILE") from None


def _show_result(key: str, kind: str, file: Path | None) -> None:
    _tell(f"{kind} {key}")
    if file is not None:
        print_result(_headlines(file), [file])


def _headlines(file: Path) -> Sequence[Headline]:
    """Return the main figures of a result; none where the extra that reads all kinds is not installed."""
    try:
        from lineofaction.report.document.content import headlines_of  # noqa: PLC0415 (start-up time)
        from lineofaction.report.document.inputs import read_inputs  # noqa: PLC0415 (start-up time)
    except MissingExtra:
        return ()
    return headlines_of(read_inputs([file]))


def _tell(line: str) -> None:
    console().print(line, highlight=False, soft_wrap=True)
