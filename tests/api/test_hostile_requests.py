"""Requests that are made to hurt: refused in the one shape, at little cost, telling nothing secret."""

import gzip
import json
import re
import tempfile
import time
import tracemalloc
from pathlib import Path
from typing import Any

import pytest
from fastapi.testclient import TestClient
from httpx2 import Response
from small_table import small_table

from lineofaction.gearbox.problems import BadInput, DatabaseUnavailable
from lineofaction.gearbox.schemas.toml import toml_table
from service.access.capacity import Capacity
from service.access.key_file import KeyFile
from service.app import create_app
from service.schemas.examples import CASE, SCENE
from service.settings import Settings, load_settings
from service.store.places import result_files

KEY = "5" * 64
QUERY = f"/v1/databases/{KEY}/query"


@pytest.fixture(scope="module")
def http():
    """A caller of a service without keys that holds a table."""
    with tempfile.TemporaryDirectory(prefix="loa-hostile-") as directory:
        app = create_app(Settings(data_directory=Path(directory)))
        file = Path(directory) / "table.nc"
        small_table().to_netcdf(file)
        app.state.context.store.put(KEY, "database", file)
        yield TestClient(app, raise_server_exceptions=False)


def assert_refused(answer: Response, *statuses: int) -> Any:
    assert answer.status_code in statuses, answer.text[:300]
    assert answer.headers["content-type"] == "application/problem+json"
    return answer.json()


TOML = {
    "deep arrays": "a = " + "[" * 40_000,
    "deep tables": "a = " + "{b=" * 3000 + "1" + "}" * 3000,
    "long key": ".".join("a" * 20_000) + " = 1",
    "long quoted key": " . ".join(['"a"'] * 20_000) + " = 1",
    "long header": "[" + ".".join("a" * 20_000) + "]",
    "long key in a table": "a = {" + ".".join("a" * 20_000) + " = 1}",
    "many digits": "a = " + "9" * 100_000,
    "many tables": "\n".join(f"[a{number}]" for number in range(20_000)),
}


@pytest.mark.parametrize("kind", TOML)
def test_toml_that_costs_much_is_refused(http, kind):
    problem = assert_refused(http.post("/v1/cases/from-toml", json={"toml": TOML[kind]}), 422)
    assert len(problem["errors"]) <= 50
    if "long" in kind:
        assert problem["errors"][0]["bound"] == "TOML with keys of at most 32 parts"


def test_beyond_so_many_requests_at_once_the_service_answers_for_its_health_alone(tmp_path, monkeypatch):
    monkeypatch.setattr("service.app.capacity", lambda _workers: Capacity(1))
    app = create_app(Settings(data_directory=tmp_path), works=False)
    with TestClient(app) as http:
        problem = assert_refused(http.get("/v1/jobs"), 503)
        assert problem["type"] == "urn:lineofaction:problem:too-many-requests"
        assert http.get("/health").status_code == 200
    assert 'loa_problems_total{problem="too-many-requests"}' in app.state.metrics.text().decode()


def test_keys_as_long_as_they_may_be_and_rows_of_numbers_are_read():
    numbers = ", ".join(["0.125"] * 500)
    text = f"{'.'.join('a' * 32)} = 1\n[b]\nrows = [\n  [{numbers}],\n  [{numbers}]\n]\n"
    assert toml_table(text, "toml")["b"]["rows"][1][499] == 0.125
    with pytest.raises(BadInput):
        toml_table(".".join("a" * 33) + " = 1", "toml")


def test_a_body_of_many_unknown_fields_gets_some_faults(http):
    case = CASE | {f"field{number}": 0 for number in range(20_000)}
    problem = assert_refused(http.post("/v1/cases/outline", json={"inputs": {"case": case}}), 422)
    assert len(problem["errors"]) == 50


NAMES = {
    "very long": ["a" * 1_000_000, "helix_angle_deg" * 50_000],
    "with markup": ["<script>alert(1)</script>", "[bold red]", "</td>", "{{7*7}}", "%s", "x]", "x."],
    "with control characters": ["\x1b[31m", "x\nerror: forged", "\u202e", "\0", "\u2028"],
    "thousands": [f"helix_angle_deg_{number:064d}" for number in range(20_000)],
}
"""Names of fields that a gear does not have."""


@pytest.mark.parametrize("kind", NAMES)
def test_unknown_fields_with_hostile_names_are_refused_in_few_plain_words(http, kind):
    pinion = CASE["pair"]["pinion"] | dict.fromkeys(NAMES[kind], 0)
    case = CASE | {"pair": CASE["pair"] | {"pinion": pinion}}
    body = json.dumps({"inputs": {"case": case}})
    began = time.process_time()
    answer = http.post("/v1/cases/outline", content=body, headers={"Content-Type": "application/json"})
    problem = assert_refused(answer, 422)
    assert time.process_time() - began < 3.0
    assert 0 < len(problem["errors"]) == min(50, len(NAMES[kind])) and len(answer.content) < 64_000
    for fault in problem["errors"]:
        assert fault["field"].isprintable() and len(fault["field"]) < 1000
        # the advice has names of our own alone
        assert re.fullmatch(r"(Did you mean|Nearest of \d+ here:) [\w, /.?-]+", fault["suggestion"])
    assert problem["detail"].isprintable()


@pytest.mark.parametrize("process", ["analyze", "sensitivity"])
@pytest.mark.parametrize("field", ["bore_diameter_mm", "face_width_mm"])
def test_a_gear_without_width_is_refused(http, process, field):
    """Its compliance would be infinite (found by spoiling bodies)."""

    pair = CASE["pair"] | {name: CASE["pair"][name] | {field: 1e-300} for name in ("pinion", "wheel")}
    body = {"inputs": {"case": CASE | {"pair": pair}}}
    problem = assert_refused(http.post(f"/v1/processes/{process}/execution", json=body), 422)
    assert f"pair.pinion.{field}" in [fault["field"] for fault in problem["errors"]]


@pytest.mark.parametrize(
    "body",
    [
        b'{"inputs":' + b"[" * 3_900_000,
        b"[" * 100_000 + b"]" * 100_000,
        b"[" * 40_000 + b"]" * 40_000,
        b'{"inputs":{"case":' + b"[" * 20_000 + b"]" * 20_000 + b"}}",
        b'{"inputs":{"case":' + b'{"pair":' * 20_000 + b"1" + b"}" * 20_000 + b"}}",
        b'{"inputs":' * 400 + b"1" + b"}" * 400,
        b"9" * 1_000_000,
    ],
)
@pytest.mark.parametrize("path", ["/v1/processes/analyze/execution", QUERY])
def test_json_that_is_deep_or_long_is_refused(http, path, body):
    assert_refused(http.post(path, content=body, headers={"Content-Type": "application/json"}), 400, 413, 422)


CBOR = {
    "an array of 2^64": b"\x9b" + b"\xff" * 8,
    "an array of 2^32": b"\x9a" + b"\xff" * 4,
    "a map of 2^64": b"\xbb" + b"\xff" * 8,
    "bytes of 2^63": b"\x5b\x7f" + b"\xff" * 7,
    "nested arrays": b"\x81" * 3_900_000,
    "endless arrays": b"\x9f" * 1_000_000,
    "pieces of nothing": b"\x5f" + b"\x40" * 3_000_000,
    "a typed array of 2^32": b"\xa1\x68position\xd8\x56\x5a" + b"\xff" * 4,
    "a number of 24 million bits": b"\xc2\x5a\x00\x30\x00\x00" + b"\xff" * 0x300000,
    "a shared value": b"\xd8\x1c\x81\xd8\x1d\x00",
}


@pytest.mark.parametrize("kind", CBOR)
def test_cbor_that_announces_much_is_refused_without_room_for_it(http, kind):
    tracemalloc.start()
    answer = http.post(QUERY, content=CBOR[kind], headers={"Content-Type": "application/cbor"})
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert_refused(answer, 422)
    assert peak < 64e6


@pytest.mark.parametrize("path", ["/v1/cases/from-toml", QUERY])
def test_a_packed_body_is_refused(http, path):
    """Also one that would be read as something else: packed columns are columns of other numbers."""
    packed = gzip.compress(b"\0" * 1600, mtime=0)
    kind = "application/octet-stream" if path == QUERY else "application/json"
    content = packed[: len(packed) // 16 * 16]
    assert_refused(
        http.post(path, content=content, headers={"Content-Type": kind, "Content-Encoding": "gzip"}), 415
    )
    assert http.post(QUERY, json={"position": [0], "deflection_um": [5]}).status_code == 200


@pytest.mark.parametrize(
    "host", ["localhost", "LOCALHOST:8321", "127.0.0.1:1", "127.9.9.9", "[::1]:80", "testserver"]
)
def test_a_host_that_is_this_machine_is_answered(http, host):
    assert http.get("/v1/jobs", headers={"Host": host}).status_code == 200


@pytest.mark.parametrize(
    "host",
    [
        "rebound.example",
        "127.0.0.1.rebound.example",
        "localhost.example:80",
        "192.0.2.1",
        "",
        "[::2]",
    ],
)
def test_a_page_of_another_site_does_not_reach_a_service_without_keys(http, host):
    for path in ("/v1/jobs", "/", "/health", "/v1/jobs/"):
        answer = http.get(path, headers={"Host": host}, follow_redirects=False)
        assert_refused(answer, 421)


def test_a_live_torque_that_is_next_to_nothing_is_refused(http):
    """Its force is none (found by generated bodies)."""
    problem = assert_refused(http.post(f"/v1/databases/{KEY}/ste", json={"torque_n_m": [5e-324]}), 422)
    assert problem["errors"][0]["field"] == "torque_n_m[0]"


def test_a_parameter_that_a_body_does_not_need_is_checked_all_the_same(http):
    body = {"position": [0.0], "deflection_um": [5.0]}
    problem = assert_refused(http.post(QUERY, json=body, params={"columns": "a" * 101}), 422)
    assert problem["errors"][0]["field"] == "columns"


def test_with_keys_any_host_may_be_named(tmp_path):
    secret = KeyFile(tmp_path / "keys.json").add("bench")
    app = create_app(Settings(data_directory=tmp_path), works=False)
    headers = {"Host": "gears.example", "Authorization": f"Bearer {secret}"}
    assert TestClient(app).get("/v1/jobs", headers=headers).status_code == 200


@pytest.mark.law
def test_no_other_origin_is_allowed_anything(http):
    origin = {"Origin": "http://other.example", "Access-Control-Request-Method": "DELETE"}
    for method, path in (("OPTIONS", "/v1/jobs"), ("GET", "/v1/jobs"), ("GET", "/"), ("GET", "/v1/none")):
        answer = http.request(method, path, headers=origin)
        assert not [name for name in answer.headers if name.startswith("access-control-")]
        assert answer.headers["x-content-type-options"] == "nosniff"


@pytest.mark.parametrize(
    "kind", ["text/plain", "application/x-www-form-urlencoded", "multipart/form-data; boundary=a"]
)
def test_what_a_form_of_another_site_can_send_starts_nothing(http, kind):
    body = json.dumps({"inputs": {"case": CASE}})
    before = http.get("/v1/jobs").json()["jobs"]
    answer = http.post("/v1/processes/analyze/execution", content=body, headers={"Content-Type": kind})
    assert_refused(answer, 415)
    assert http.get("/v1/jobs").json()["jobs"] == before


def test_no_file_of_the_service_is_read_for_a_caller(http):
    (mesh,) = SCENE["meshes"]
    by_file = {name: value for name, value in mesh.items() if name != "case"} | {
        "database_file": "/etc/passwd"
    }
    scene = SCENE | {"meshes": [by_file]}
    problem = assert_refused(
        http.post("/v1/processes/simulate/execution", json={"inputs": {"scene": scene}}), 422
    )
    assert "root:" not in json.dumps(problem)
    assert any("database_file" in fault["field"] for fault in problem["errors"])
    for name in ("..%2f..%2f..%2fetc%2fpasswd", "%2e%2e/app.py", "../app.py", "static/../files.py"):
        assert_refused(http.get(f"/page/{name}"), 404)


@pytest.mark.parametrize(
    "url", ["s3://id:hush@bucket/prefix", "https://id:hush@host/bucket", "s3://hush@bucket"]
)
def test_what_is_secret_in_an_address_of_results_is_not_shown(tmp_path, url):
    with pytest.raises(BadInput) as caught:
        result_files(tmp_path, url)
    assert "hush" not in f"{caught.value} {caught.value.as_json()}"


@pytest.mark.parametrize(
    "url",
    [
        "postgresql://loa:hush/1@host/name",
        "postgresql://loa:hush@host:port/name",
        "mysql://loa:hush@h/n",
        "hush",
    ],
)
def test_what_is_secret_in_an_address_of_a_database_is_not_shown(tmp_path, url):
    settings = load_settings(data_directory=tmp_path, database_url=url)
    assert "hush" not in repr(settings)
    with pytest.raises((BadInput, DatabaseUnavailable)) as caught:
        create_app(settings)
    assert "hush" not in f"{caught.value} {caught.value.as_json()}"
