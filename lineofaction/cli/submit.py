"""``loa submit`` and ``loa fetch``: jobs of a service and their results."""

from __future__ import annotations

import os
import re
import shutil
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, nullcontext, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich.console import Console
from rich.markup import escape
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

from host.extras import MissingExtra
from lineofaction.cli.output import check_writable, console, print_headlines, print_json, print_written
from lineofaction.cli.verb_warnings import warn
from lineofaction.client import JobState, LineOfActionClient, Result, Watch
from lineofaction.client.page_address import PageAddress
from lineofaction.gearbox.convert.case import case_as_filed
from lineofaction.gearbox.input_file import InputFile
from lineofaction.gearbox.problems import BadInput, ResultNotReady
from lineofaction.gearbox.registry import studies_of
from lineofaction.gearbox.result_files import stamped
from lineofaction.gearbox.schemas import Case, read_table, validated
from lineofaction.gearbox.schemas.toml import toml_text
from lineofaction.gearbox.shallow_json import shallow_json
from lineofaction.gearbox.subjects import scene_inputs

if TYPE_CHECKING:
    from lineofaction.report.drawing.page import Headline


_COLORS = {"failed": "red", "dismissed": "yellow"}
_OF_CASES = ("analyze", *studies_of("case"))
_OF_SCENES = ("simulate", *studies_of("scene"))
_OF_BOTH = studies_of("case or scene")


def _awaited_result(client: LineOfActionClient, job: str) -> Result:
    """Print the job, wait for it with a bar on a terminal; Ctrl-C prints how to go on with it."""
    screen = Console(stderr=True)
    screen.print(f"job {job}", highlight=False)
    at = f"--service {client.session.exchange.base_url}"
    try:
        with _bar(screen) if sys.stderr.isatty() else nullcontext() as watch:
            return client.wait(job, watch)
    except KeyboardInterrupt as stop:
        stop.add_note(f"To get its result: loa fetch {job} {at} --wait -o FILE")
        stop.add_note(f"To end it: loa dismiss {job} {at}")
        raise


@contextmanager
def _bar(screen: Console) -> Iterator[Watch]:
    """Yield a watch that draws the bar of a job: its stage, per cent, time taken and time left."""
    percent, left = TextColumn("{task.percentage:>3.0f} %"), TextColumn("{task.fields[left]}")
    columns = (TextColumn("{task.description}"), BarColumn(), percent, TimeElapsedColumn(), left)
    with Progress(*columns, console=screen) as bar:
        task = bar.add_task("", total=100, left="")

        def see(state: JobState) -> None:
            name = escape(f"{state.process} {state.title}".rstrip())
            description = f"[{_COLORS.get(state.status, 'none')}]{name}: {escape(state.activity)}[/]"
            bar.update(task, completed=state.progress, description=description, left=state.time_left)
            if state.ended:
                bar.stop_task(task)

        yield see


def run_submit(
    file: InputFile,
    service: str,
    process: str | None,
    inputs: str | None,
    terms: Mapping[str, Any],
    *,
    wait: bool,
    output: Path | None,
    as_json: bool,
) -> None:
    """Submit a process, None for the file's own, with inputs as JSON; wait and write if requested."""
    if output is not None:
        check_writable(output)
    further = _further(process, inputs)
    with LineOfActionClient(service).with_terms(**terms) as client:
        state = _submitted_state(client, file, process, further)
        warn(state.warnings)
        answer: dict[str, object] = {"job": state.id, "process": state.process, "status": state.status}
        if wait or output is not None:
            result = _awaited_result(client, state.id)
            answer |= {"status": "successful", "hash": result.key, "kind": result.kind}
        if output is not None:
            shutil.copyfile(client.fetch_file(result.key, result.kind), output)
            answer["file"] = str(output)
            warn(stamped(output))
    if as_json:
        print_json(answer)
        return
    _tell(f"job {answer['job']}, {answer['process']}: {answer['status']}")
    if "hash" in answer:
        _show_result(str(answer["hash"]), str(answer["kind"]), output)
    else:
        _tell(f"Its result, once it has ended: loa fetch {state.id} --service {service} -o FILE")


def _further(process: str | None, text: str | None) -> dict[str, Any]:
    known = (*_OF_CASES, *_OF_SCENES, *_OF_BOTH)
    if process not in (None, *known):
        raise BadInput.of("--process", process, f"one of {', '.join(known)}", "Or leave it out.")
    if text is None:
        return {}
    example = """For example --inputs '{"misalignment_um": 30}'."""
    if process is None:
        raise BadInput.of("--inputs", text, "given with --process", example)
    try:
        inputs = shallow_json(text)
    except (ValueError, RecursionError):
        inputs = None
    if not isinstance(inputs, dict) or "case" in inputs or "scene" in inputs:
        raise BadInput.of("--inputs", text, "a JSON object without case and scene", example)
    return inputs


def _submitted_state(
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


def run_fetch(name: str, output: Path, service: str | None, *, wait: bool, as_json: bool) -> None:
    """Fetch a result by hash, job or page address; service None: the usual one, or that of the address."""
    check_writable(output)
    page = PageAddress.of(name) if ":" in name else None
    if page is not None and not os.environ.get("LOA_KEY"):  # a key is that of the usual service
        service = service or str(page.origin)
    with LineOfActionClient(service) as client:
        if page is not None and output.suffix == ".toml":
            _write_case(client.case_at(name), output, as_json=as_json)
            return
        if page is not None:
            name = client.result_at(name)
        if re.fullmatch("[0-9a-f]{64}", name):
            key, (file, kind) = name, client.fetch_result(name)
        else:
            result = _ended(client, name, wait=wait)
            file, key, kind = client.fetch_file(result.key, result.kind), result.key, result.kind
    shutil.copyfile(file, output)
    if page is not None and page.differing:
        text = f"At this address {page.differing} since the result; -o FILE.toml writes the design."
        warn([{"check": "address", "message": text}])
    warn(stamped(output))
    if as_json:
        print_json({"hash": key, "kind": kind, "file": str(output)})
    else:
        _show_result(key, kind, output)


def _write_case(case: Case, output: Path, *, as_json: bool) -> None:
    output.write_text(toml_text(case_as_filed(case)), encoding="utf-8")
    if as_json:
        print_json({"kind": "case", "file": str(output)})
    else:
        print_written([output])


def _ended(client: LineOfActionClient, job: str, *, wait: bool) -> Result:
    if not re.fullmatch(r"[0-9a-fA-F-]{1,64}", job):
        remedy = "loa submit prints the first two."
        raise BadInput.of("name", job, "the identifier of a job, a content hash or an address", remedy)
    try:
        return _awaited_result(client, job) if wait else client.result(job)
    except ResultNotReady as error:
        raise ResultNotReady(f"{error} Wait for it with: loa fetch {job} --wait -o FILE") from None


def _show_result(key: str, kind: str, file: Path | None) -> None:
    _tell(f"{kind} {key}")
    if file is None:
        return
    headlines: Sequence[Headline] = ()
    with suppress(MissingExtra):  # without the extra a result is written, not read
        from lineofaction.report import document  # noqa: PLC0415 (start-up time)

        headlines = document.headlines_of(document.read_inputs([file]))
    print_headlines(headlines)
    print_written([file])


def _tell(line: str) -> None:
    console().print(line, soft_wrap=True)
