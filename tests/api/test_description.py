"""The description of the API: what a generator, a linter and a reader expect of it."""

import json
import os
import subprocess
import sys
from collections.abc import Iterator
from inspect import iscoroutinefunction
from pathlib import Path
from typing import Any

import pytest
from described_api import DESCRIPTION
from fastapi.routing import APIRoute

from lineofaction.gearbox import problems
from lineofaction.gearbox.problems import ServiceError
from lineofaction.gearbox.registry import STUDIES
from service.routes import (
    batches,
    cases,
    drafts,
    events,
    health,
    job_results,
    jobs,
    processes,
    result_drawings,
    results,
)
from service.routes.media_types import OF_STATUS
from service.schemas.answers import class_name
from service.worker.process import default_registry

OPERATIONS = {
    operation["operationId"]: operation
    for methods in DESCRIPTION["paths"].values()
    for operation in methods.values()
}
LINTERS = Path(sys.prefix) / "linters" / "node_modules" / ".bin"
RULES = {
    "extends": "spectral:oas",
    "rules": {
        "info-contact": "off",  # whoever runs the service is asked
        "oas3-operation-security-defined": "off",  # 3.1 lets keys have roles; redocly knows
    },
}


@pytest.mark.law
def test_it_is_openapi():
    from openapi_spec_validator import OpenAPIV31SpecValidator  # noqa: PLC0415 (a second that each worker would pay)

    assert [error.message for error in OpenAPIV31SpecValidator(DESCRIPTION).iter_errors()] == []


def test_operations_are_named_by_words_and_processes_by_their_names():
    assert len(OPERATIONS) == sum(len(methods) for methods in DESCRIPTION["paths"].values())
    assert all(name.isidentifier() and name.islower() and "v1" not in name for name in OPERATIONS)
    assert {name.replace("-", "_") for name in default_registry()} <= set(OPERATIONS)


def test_every_tag_is_explained():
    used = {tag for operation in OPERATIONS.values() for tag in operation["tags"]}
    explained = {tag["name"]: tag["description"] for tag in DESCRIPTION["tags"]}
    assert used == set(explained) and all(explained.values())


def test_every_operation_says_its_refusals():
    for name, operation in OPERATIONS.items():
        closed = {"401", "429"} if operation.get("security") != [] else set()
        body = {"413", "415", "422"} if "requestBody" in operation else set()
        always = {"400", "405", "408", "421", "431", "500", "503"}
        assert always | closed | body <= set(operation["responses"]), name


def test_every_answer_says_its_headers():
    components = DESCRIPTION["components"]
    for name, operation in OPERATIONS.items():
        for status, response in operation["responses"].items():
            entry = components["responses"].get(response.get("$ref", "").rpartition("/")[2], response)
            expected = {"X-Request-ID", *OF_STATUS.get(int(status), ())}
            assert expected <= set(entry["headers"]) <= set(components["headers"]), (name, status)


def test_a_problem_that_says_when_to_try_again_has_a_status_that_does():
    kinds = [kind for kind in vars(problems).values() if isinstance(kind, type)]
    later = {
        kind.status for kind in kinds if issubclass(kind, ServiceError) and kind.retry_after_s is not None
    }
    assert later and all("Retry-After" in OF_STATUS[status] for status in later)


def test_a_job_leads_to_its_results():
    executions = [OPERATIONS[name.replace("-", "_")] for name in default_registry()]
    for operation in (*executions, OPERATIONS["job_status"], OPERATIONS["dismiss_job"]):
        (answer,) = (entry for status, entry in operation["responses"].items() if status in ("200", "201"))
        assert answer["links"]["results"]["operationId"] == "job_results"
        for link in answer["links"].values():
            (parameter,) = (p for p in OPERATIONS[link["operationId"]]["parameters"] if p["in"] == "path")
            assert link["parameters"] == {parameter["name"]: "$response.body#/jobID"}


def test_results_are_typed_by_process():
    content = OPERATIONS["job_results"]["responses"]["200"]["content"]
    assert list(content) == ["application/json", "application/x-netcdf"]
    typed = {entry["$ref"].rpartition("/")[2] for entry in content["application/json"]["schema"]["anyOf"]}
    assert typed == {f"{class_name(name)}Results" for name in (*default_registry(), "batch")}
    for study in STUDIES.values():
        schema = DESCRIPTION["components"]["schemas"][f"{class_name(study.name)}Results"]
        assert (schema["required"], schema["additionalProperties"]) == ([study.kind], False)


def linted(tmp_path: Path, linter: str, *options: str) -> str:
    if not (LINTERS / linter).exists():
        pytest.skip(f"no {linter} on this machine: scripts/test installs it where npm is")
    (tmp_path / "openapi.json").write_text(json.dumps(DESCRIPTION))
    (tmp_path / "rules.json").write_text(json.dumps(RULES))
    quiet = os.environ | {"REDOCLY_TELEMETRY": "off", "REDOCLY_SUPPRESS_UPDATE_NOTICE": "true"}
    command = (LINTERS / linter, "lint", "openapi.json", *options)
    ended = subprocess.run(command, check=False, cwd=tmp_path, env=quiet, capture_output=True, text=True)
    return "" if ended.returncode == 0 else ended.stdout + ended.stderr


@pytest.mark.nightly  # half a minute; what it asks for beyond the specification is tested by name
def test_spectral_has_nothing_to_say(tmp_path):
    assert linted(tmp_path, "spectral", "--ruleset", "rules.json", "--fail-severity", "warn") == ""


def test_redocly_finds_no_error(tmp_path):
    assert linted(tmp_path, "redocly") == ""


# Answers are typed, but for what others define.


OPEN = {
    "FaultBody.value": "what the caller wrote",
    "Parameter.value[]": "the standard lets a parameter be anything",
    "ValueDescription.schema": "a JSON Schema",
    "ReportPlot.data[]": "a trace of plotly.js",
    "ReportPlot.layout": "a layout of plotly.js",
    "JobInputs.inputs": "the inputs of a job, by its process, whose description has their schemas",
    "ResultFigures": "the figures of a result, by its kind",
}
SCHEMAS = DESCRIPTION["components"]["schemas"]
WORDS = {"title", "description", "examples", "default"}


def is_open(schema: dict[str, Any]) -> bool:
    if schema.get("type") != "object":
        return not set(schema) - WORDS
    others = schema.get("additionalProperties", not {"properties", "patternProperties"} & set(schema))
    return others in (True, {})


def untyped(schema: dict[str, Any], where: str, met: set[str]) -> Iterator[str]:
    """Yield the places in a schema at which anything may stand; each named schema is walked once."""
    name = schema.get("$ref", "").rpartition("/")[2]
    if name:
        if name not in met:
            met.add(name)
            yield from untyped(SCHEMAS[name], name, met)
        return
    if is_open(schema):
        yield where
    for kind in ("anyOf", "oneOf", "prefixItems"):
        for alternative in schema.get(kind, ()):
            yield from untyped(alternative, where, met)
    for kind in ("properties", "patternProperties"):
        for field, inner in schema.get(kind, {}).items():
            yield from untyped(inner, f"{where}.{field}", met)
    for kind, mark in (("items", "[]"), ("additionalProperties", "{}")):
        if isinstance(schema.get(kind), dict):
            yield from untyped(schema[kind], f"{where}{mark}", met)


def test_answers_are_typed_but_for_what_others_define():
    met: set[str] = set()
    places = [
        place
        for path, methods in DESCRIPTION["paths"].items()
        for method, operation in methods.items()
        for status, response in operation["responses"].items()
        if status.startswith("2")
        for content in response.get("content", {}).values()
        if "schema" in content  # events are text
        for place in untyped(content["schema"], f"{method} {path} {status}", met)
    ]
    assert len(met) > 30 and sorted(places) == sorted(OPEN)


def test_no_operation_needs_a_thread_for_what_it_depends_on():
    """A dependency that is no coroutine costs one, for which the loop waits beside busy threads."""

    def calls(dependant):
        for dependency in dependant.dependencies:
            yield dependency.call
            yield from calls(dependency)

    routers = [
        processes.processes_router(default_registry()),
        job_results.job_results_router(default_registry()),
    ]
    parts = (batches, cases, drafts, events, health, jobs, result_drawings, results)
    routers += [part.router for part in parts]
    routes = [route for router in routers for route in router.routes if isinstance(route, APIRoute)]
    named = {call for route in routes for call in calls(route.dependant)}
    assert len(routes) > 40 and len(named) >= 4
    assert [call for call in named if not iscoroutinefunction(call)] == []
