"""A question to a study, asked in Python, by the verb and over HTTP, each once."""

import json
import pickle
import re
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import pytest
from study_rows import StudyRow
from study_service import Served
from typer.testing import CliRunner, Result

from dynamics.results import RunResult
from lineofaction.cli.commands import app
from lineofaction.gearbox import workbench
from lineofaction.gearbox.convert.checked_case import CheckedCase
from lineofaction.gearbox.registry import STUDIES
from lineofaction.gearbox.schemas.spelling import spelling_of
from lineofaction.gearbox.study import Study
from lineofaction.report.drawing.page import Page
from lineofaction.report.presentation import presentation_of

Json = dict[str, Any]

_MEASURED = re.compile(r"(cpu|wall)_seconds|(peak_memory_|predicted_)?bytes|stages|knee|(.*_)?cost(_ratio)?")
"""Names of times and of what follows from them."""
_OF_FILE = ("hash", "sha256", "size", "written", "file", "warnings")

ANNOUNCED = r"(?m)^(loa {}: about|\d+ Hz at \d+ rpm of) .*\n"
"""What a verb says before it computes: its cost, and the order that is complained of."""


def unmeasured(value: Any, own: tuple[str, ...] = ()) -> Any:
    """Return figures without the values of times, which differ from run to run, and of `own`."""
    if isinstance(value, dict):
        return {
            name: ...
            if name in own or (_MEASURED.search(name) and not isinstance(inner, str))
            else unmeasured(inner, own)
            for name, inner in value.items()
        }
    return [unmeasured(item, own) for item in value] if isinstance(value, list) else value


@dataclass(frozen=True)
class Computed:
    """What a function of Python gives: its result and its figures, and what progress it reported."""

    result: Any
    figures: Json
    reported: list[tuple[str, float]]


@dataclass(frozen=True)
class Ended:
    """A job over HTTP: its last status, what its events told, the hash of its result, and its figures."""

    status: Json
    events: list[Json]
    key: str
    figures: Json


class StudyRuns:
    def __init__(self, row: StudyRow, folder: Path, served: Served) -> None:
        self.row, self.folder, self.served = row, folder, served
        self.study: Study = row.registered
        self.inputs = row.inputs
        self.subject = self.inputs.pop(row.subject)
        self.file = folder / f"{row.subject}.json"
        self.file.write_text(json.dumps(self.subject), encoding="utf-8")
        self._result: Any = None
        self._asked: object = None
        self._files: dict[str, Path] = {}
        self._texts: dict[str, Result] = {}

    # In Python.

    @cached_property
    def python(self) -> Computed:
        seen: list[tuple[str, float]] = []
        run = {} if self.run is None else {"run": self.run}
        with self.at_home() as patch, warnings.catch_warnings(record=True):
            patch.setattr(self.study.run, "compute", self._noted)
            result = STUDIES[self.study.name].function(
                self.subject, self.inputs, progress=lambda *step: seen.append(step), **run
            )
        figures = json.loads(json.dumps(self.study.run.figures(result), allow_nan=False))
        return Computed(result, figures, seen)

    @cached_property
    def run(self) -> RunResult | None:
        if self.study.name != "listen":
            return None
        with self.at_home(), warnings.catch_warnings(record=True):
            run = workbench.simulate(self.subject)
        run.to_netcdf(self.folder / "run.nc")
        return run

    @contextmanager
    def at_home(self) -> Iterator[pytest.MonkeyPatch]:
        with pytest.MonkeyPatch.context() as patch:
            patch.setenv("XDG_CACHE_HOME", str(self.folder / "cache"))
            yield patch

    # By the verb.

    def call(self, inputs: Json, *further: object, subject: Path | None = None) -> Result:
        arguments = [subject or self.file, *_spelled(self.study, inputs, self.folder), *further]
        with self.at_home():
            return CliRunner().invoke(app, [self.study.name, *map(str, arguments)])

    def verb(self, *further: object, subject: Path | None = None) -> Result:
        """Call the verb with the question, or for another subject; it computes once for all calls."""
        with self.at_home() as patch:
            patch.setattr(self.study.run, "compute", self._remembered)
            return self.call(self.inputs, *further, subject=subject)

    def _noted(self, subject: Any, inputs: Any, means: Any) -> Any:
        self._asked = question_of(subject, inputs)
        return type(self.study.run).compute(self.study.run, subject, inputs, means)

    def _remembered(self, subject: Any, inputs: Any, means: Any) -> Any:
        """Return what the verb computes: of the very question of Python, to the last bit, what that has."""
        if self._result is None:
            result = self.python.result
            same = self._asked == question_of(subject, inputs)
            compute = type(self.study.run).compute
            self._result = result if same else compute(self.study.run, subject, inputs, means)
        return self._result

    @property
    def page(self) -> Page:
        """The page of what the verb computed: times are among its headlines."""
        assert self.printed
        joined = self.study.run.joined({self.file.stem: self._result}) if self.study.several else self._result
        return presentation_of(self.study).page(joined)

    @cached_property
    def printed(self) -> Json:
        done = self.verb("--json")
        assert (done.exit_code, done.stderr) == (0, ""), done.output
        answer: Json = json.loads(done.stdout)
        return answer

    def written(self, ending: str) -> tuple[Path, str]:
        if ending not in self._files:
            output = self.folder / ("out" if self.study.folder else f"result{ending}")
            done = self.verb("-o", output)
            said = re.sub(ANNOUNCED.format(self.study.name), "", done.stderr)
            assert (done.exit_code, said) == (0, ""), done.output
            for each in self.study.endings if self.study.folder else (ending,):
                file = output / f"{self.study.folder}{each}" if self.study.folder else output
                self._files[each], self._texts[each] = file, done
        return self._files[ending], self._texts[ending].stdout

    # Over HTTP.

    @property
    def body(self) -> Json:
        run = {"run": self._run_key} if self.study.name == "listen" else {}
        return {self.row.subject: self.subject, **self.inputs, **run}

    @cached_property
    def _run_key(self) -> str:
        key: str = self.served.client.simulate.submit(self.subject).wait().key
        return key

    def execute(self, body: Json, **headers: str) -> Any:
        path = f"/v1/processes/{self.study.name}/execution"
        return self.served.http.post(path, json={"inputs": body}, headers=headers)

    @cached_property
    def job(self) -> Ended:
        http = self.served.http
        entered = self.execute(self.body)
        assert entered.status_code == 201, entered.text
        place = entered.headers["location"]
        lines = http.get(f"{place}/events").text.splitlines()
        events = [json.loads(line[6:]) for line in lines if line.startswith("data: ")]
        status = http.get(place).json()
        assert status["status"] == "successful", http.get(f"{place}/results").text
        key = self.served.client.result(status["jobID"]).key
        figures: Json = http.get(f"/v1/results/{key}").json()
        return Ended(status, events, key, figures)


def question_of(subject: Any, inputs: Any) -> object:
    """Return all that a study computes with: a case, or a scene with its tables and housings, and inputs."""
    written = (subject.case if isinstance(subject, CheckedCase) else subject.inputs).model_dump_json()
    tables = getattr(subject, "databases", {})
    bits = {name: table.static_transmission_error.tobytes() for name, table in tables.items()}
    return written, inputs.model_dump_json(), bits, pickle.dumps(dict(getattr(subject, "housings", {})))


def _spelled(study: Study, inputs: Json, folder: Path) -> Iterator[object]:
    """Yield inputs as the verb takes them: a file, or an option each."""
    if study.takes.from_file:
        file = folder / "inputs.json"
        file.write_text(json.dumps(inputs), encoding="utf-8")
        yield file
        return
    for name, value in inputs.items():
        yield from _option(study, name, value)


def _option(study: Study, name: str, value: Any) -> Iterator[object]:
    """Yield a field of the inputs as an option; one that there is not too."""
    field = study.inputs.model_fields.get(name)
    spelling = None if field is None else spelling_of(field)
    option = spelling.option if spelling else f"--{name.replace('_', '-')}"
    if spelling and spelling.value is not None:
        if value == spelling.value:
            yield option
        elif field is not None and value != field.default:
            yield f"--{name}={value}"  # which there is not
    elif isinstance(value, bool):
        yield option if value else option.replace("--", "--no-", 1)
    elif value is not None:
        yield f"{option}={','.join(map(str, value)) if isinstance(value, list) else value}"


def verb_call(study: str, subject: Json, folder: Path, *arguments: object) -> Result:
    file = folder / "subject.json"
    file.write_text(json.dumps(subject), encoding="utf-8")
    return CliRunner().invoke(app, [study, str(file), *map(str, arguments)])


def refused_call(study: str, subject: Json, inputs: Json, folder: Path) -> Result:
    return verb_call(study, subject, folder, *_spelled(STUDIES[study], inputs, folder))


def without_file(figures: Json) -> Json:
    return {name: value for name, value in figures.items() if name not in _OF_FILE}
