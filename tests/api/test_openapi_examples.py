"""Every body of the API has an example: those sent are accepted, those answered are as their schemas say."""

import json
import re
import tempfile
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import cbor2
import jsonschema_rs
import pytest
from described_api import DESCRIPTION
from fastapi.testclient import TestClient
from named_run import put_named_run
from small_table import small_table

from service.app import create_app
from service.schemas.answer_examples import HASH
from service.schemas.examples import request_example
from service.settings import Settings

BINARY = ("application/x-netcdf", "application/octet-stream", "audio/wav")
_directory = tempfile.TemporaryDirectory(prefix="loa-examples-")
_app = create_app(Settings(data_directory=Path(_directory.name)))
OPERATIONS = [
    (method, path, operation)
    for path, methods in DESCRIPTION["paths"].items()
    for method, operation in methods.items()
]
SENT = [
    (path, kind, body)
    for _, path, operation in OPERATIONS
    for kind, body in operation.get("requestBody", {}).get("content", {}).items()
    if kind not in BINARY
]
ANSWERED = [
    (method, path, status, kind, body)
    for method, path, operation in OPERATIONS
    for status, named in operation["responses"].items()
    for response in [
        DESCRIPTION["components"]["responses"].get(named.get("$ref", "").rpartition("/")[2], named)
    ]
    for kind, body in response.get("content", {}).items()
    if kind not in BINARY
]


def schemas(part: Any) -> Iterator[dict[str, Any]]:
    """Yield every schema of the description that has a type or alternatives, nested ones too."""
    if isinstance(part, dict):
        if {"type", "anyOf", "oneOf", "$ref"} & part.keys():
            yield part
        for inner in part.values():
            yield from schemas(inner)
    elif isinstance(part, list):
        for inner in part:
            yield from schemas(inner)


@cache
def validator(schema: str) -> Any:
    return jsonschema_rs.validator_for({"components": DESCRIPTION["components"], **json.loads(schema)})


def assert_conforms(example: Any, schema: dict[str, Any]) -> None:
    validator(json.dumps(schema)).validate(example)


def test_every_reference_leads_somewhere():
    named = re.findall(r'"\$ref": "#/components/(\w+)/([\w-]+)"', text := json.dumps(DESCRIPTION))
    assert len(named) == text.count('"$ref"') > 0
    for part, name in named:
        assert name in DESCRIPTION["components"][part]


@pytest.mark.parametrize(("path", "kind", "body"), SENT, ids=[f"{path} {kind}" for path, kind, _ in SENT])
def test_a_body_to_send_has_an_example_of_its_schema(path, kind, body):
    assert_conforms(body["example"], body["schema"])


@pytest.mark.law
def test_every_answer_has_an_example_of_its_schema():
    for method, path, status, kind, body in ANSWERED:
        shown = (
            [body["example"]]
            if "example" in body
            else [e["value"] for e in body.get("examples", {}).values()]
        )
        assert shown or kind == "text/plain", f"{method} {path} {status} {kind}"
        for example in shown:
            assert_conforms(example, body.get("schema", {}))
            if kind == "application/problem+json":
                assert example["status"] == int(status)


def test_every_field_has_examples_of_its_schema():
    examples = [(field, example) for field in schemas(DESCRIPTION) for example in field.get("examples", [])]
    assert len(examples) > 400
    fields, told = ({str(n): pair[part] for n, pair in enumerate(examples)} for part in (0, 1))
    assert_conforms(told, {"properties": fields})


def test_every_array_says_what_its_items_are():
    arrays = [schema for schema in schemas(DESCRIPTION) if schema.get("type") == "array"]
    assert len(arrays) > 100
    assert [schema for schema in arrays if "items" not in schema] == []


@pytest.fixture(scope="module")
def client(tmp_path_factory):
    """A client of the app with a table, and what is taken for a run: nothing is computed here."""
    file = tmp_path_factory.mktemp("table") / "table.nc"
    small_table().to_netcdf(file)
    _app.state.context.store.put(HASH, "database", file)
    put_named_run(_app.state.context.store)
    yield TestClient(_app)


LIVE = ("/v1/plans", "/v1/drafts/plan", "/v1/drafts/{key}/ste", "/v1/databases/{key}/ste")
"""Answered by a worker of their own: test_live_over_http."""
OF_A_JOB = "/v1/jobs/{job_id}"


@pytest.mark.parametrize(
    ("path", "kind", "body"),
    [entry for entry in SENT if entry[0] not in (*LIVE, OF_A_JOB)],
    ids=[f"{path} {kind}" for path, kind, _ in SENT if path not in (*LIVE, OF_A_JOB)],
)
def test_the_example_of_a_body_is_accepted(client, path, kind, body):
    url = path.replace("{key}", HASH)
    if kind == "application/cbor":
        answer = client.post(url, content=cbor2.dumps(body["example"]), headers={"Content-Type": kind})
    else:
        answer = client.post(url, json=body["example"])
    assert answer.status_code in (200, 201), answer.text


def test_the_example_of_a_change_is_accepted(client):
    ((_, _, body),) = [entry for entry in SENT if entry[0] == OF_A_JOB]
    job = client.post("/v1/processes/analyze/execution", json=request_example("analyze/execution")).json()
    assert client.patch(f"/v1/jobs/{job['jobID']}", json=body["example"]).status_code == 200
