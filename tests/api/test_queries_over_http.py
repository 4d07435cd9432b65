"""Force queries: every encoding gives the database's own numbers to the last bit, and refuses the same."""

import hashlib
import json
import struct
from dataclasses import replace
from typing import Any

import cbor2
import numpy as np
import pytest
from fastapi.testclient import TestClient
from httpx2 import Response
from sliced_face import sliced_database

from lineofaction.client import LineOfActionClient
from lineofaction.gearbox.schemas.query import LIMITS, MAX_POINTS
from service.app import create_app
from service.settings import Settings

KEY = hashlib.sha256(b"sliced table").hexdigest()
PATH = f"/v1/databases/{KEY}/query"
JSON, CBOR, RAW = "application/json", "application/cbor", "application/octet-stream"
COUNT = 400


@pytest.fixture(scope="module")
def table():
    return sliced_database((-2e-5, 0.0, 1e-5), (-1e-4, 0.0, 1e-4), positions=6)


@pytest.fixture(scope="module")
def stated(table):
    """The table with errors at its nodes and between them."""
    draw = np.random.default_rng(11)
    nodes = table.static_transmission_error.shape
    return replace(
        table,
        error_estimate=draw.uniform(1e-8, 1e-7, nodes),
        interval_error=draw.uniform(1e-8, 1e-7, (3, *nodes[1:])),
    )


@pytest.fixture(scope="module")
def client(stated, tmp_path_factory):
    directory = tmp_path_factory.mktemp("data")
    app = create_app(Settings(data_directory=directory))
    stated.to_netcdf(directory / "table.nc")
    app.state.context.store.put(KEY, "database", directory / "table.nc")
    with TestClient(app, raise_server_exceptions=False) as found:
        yield found


def columns() -> dict[str, list[float]]:
    random = np.random.default_rng(3)
    return {
        "position": random.uniform(-2.0, 2.0, COUNT).tolist(),
        "deflection_um": random.uniform(-20.0, 60.0, COUNT).tolist(),
        "misalignment_um": random.uniform(-30.0, 30.0, COUNT).tolist(),
        "center_distance_change_mm": random.uniform(-0.15, 0.15, COUNT).tolist(),
    }


def raw(given: dict[str, list[float]]) -> bytes:
    return np.array(list(given.values()), dtype="<f8").tobytes()


def typed(given: dict[str, list[float]]) -> bytes:
    return cbor2.dumps({name: cbor2.CBORTag(86, raw({name: column})) for name, column in given.items()})


def ask(client: TestClient, body: bytes, kind: str, accept: str | None = None, **params: str) -> Response:
    headers = {"Content-Type": kind} | ({} if accept is None else {"Accept": accept})
    return client.post(PATH, content=body, headers=headers, params=params)


def numbers(answer: Response) -> tuple[list[float], list[float], list[int]]:
    """Return force, stiffness and flags of an answer in any encoding."""
    assert answer.status_code == 200, answer.text
    if answer.headers["content-type"] == RAW:
        force, stiffness, flags = np.frombuffer(answer.content, "<f8").reshape(3, -1)
        return force.tolist(), stiffness.tolist(), flags.astype(int).tolist()
    found = answer.json() if answer.headers["content-type"] == JSON else cbor2.loads(answer.content)
    bits = {"inside": 0, "lifted_off": 1, "above_table": 2}
    bits |= {"outside_misalignment": 4, "outside_center_distance": 8}
    flags = [sum(bits[word] for word in words.split("+")) for words in found["validity"]]
    return found["force_n"], found["stiffness_n_per_um"], flags


BODIES = {
    JSON: lambda given: (json.dumps(given).encode(), JSON),
    CBOR: lambda given: (cbor2.dumps(given), CBOR),
    "typed arrays": lambda given: (typed(given), CBOR),
    RAW: lambda given: (raw(given), RAW),
}


@pytest.mark.parametrize("accept", [JSON, CBOR, RAW])
@pytest.mark.parametrize("sent", BODIES)
def test_every_encoding_gives_the_numbers_of_the_database(client, table, sent, accept):
    given = columns()
    answer = ask(client, *BODIES[sent](given), accept, columns=",".join(given))
    x, d, m, c = (np.array(column) for column in given.values())
    wanted = table.force_at(x, d * 1e-6, m * 1e-6, c * 1e-3)
    force, stiffness, flags = numbers(answer)
    assert force == wanted.force.tolist()
    assert stiffness == (wanted.stiffness / 1e6).tolist()
    assert flags == wanted.validity.tolist() and len(set(flags)) > 6


@pytest.mark.parametrize("accept", [JSON, CBOR])
def test_the_error_of_a_force_is_that_of_the_curve_through_its_point(client, stated, accept):
    """In steps of the stiffness; none where the table holds no error."""
    given = columns()
    answer = ask(client, json.dumps(given).encode(), JSON, accept)
    found = answer.json() if accept == JSON else cbor2.loads(answer.content)
    inside = [words == "inside" for words in found["validity"]]
    known = [error is not None for error in found["force_error_n"]]
    assert set(known) == {True, False}
    assert not any(error and not within for error, within in zip(known, inside, strict=True))
    x, _, m, c = (np.array(column) for column in given.values())
    forces = np.array(found["force_n"]) / np.cos(stated.geometry.base_helix_angle)
    for k in np.flatnonzero(known)[::20].tolist():
        point = {"misalignment": 1e-6 * m[k], "center_distance_change": 1e-3 * c[k]}
        if forces[k] < stated.force[0]:
            continue
        (band,) = stated.curve(force=float(forces[k]), at=x[k], **point).error
        expected = 1e6 * found["stiffness_n_per_um"][k] * band
        assert found["force_error_n"][k] == pytest.approx(expected, rel=1e-9)


def test_the_client_gives_the_same(client, tmp_path):
    given = columns()
    wanted = ask(client, json.dumps(given).encode(), JSON).json()
    with LineOfActionClient("http://testserver", cache_dir=tmp_path, transport=client._transport) as light:
        x, d, *rest = given.values()
        found = light.query(KEY, x, d, misalignment_um=rest[0], center_distance_change_mm=rest[1])
        assert found.model_dump() == wanted
        one = light.query(KEY, x, d[:1], misalignment_um=7.0)
    body = {"position": x, "deflection_um": d[:1], "misalignment_um": 7.0}
    assert one.model_dump() == ask(client, json.dumps(body).encode(), JSON).json()


def test_one_value_serves_all_points(client):
    given = columns()
    alone = given | {"misalignment_um": 5.0, "center_distance_change_mm": [0.01]}
    repeated = given | {"misalignment_um": [5.0] * COUNT, "center_distance_change_mm": [0.01] * COUNT}
    assert (
        ask(client, json.dumps(alone).encode(), JSON).json()
        == ask(client, json.dumps(repeated).encode(), JSON).json()
    )


def test_large_and_small_batches_give_the_same(client):
    given = {name: column * 20 for name, column in columns().items()}  # long enough for a thread
    names = ",".join(given)
    whole = numbers(ask(client, raw(given), RAW, columns=names))
    piece = numbers(ask(client, raw(columns()), RAW, columns=names))
    assert whole == tuple(part * 20 for part in piece)


@pytest.mark.parametrize(
    ("accept", "kind"),
    [
        (None, CBOR),
        ("*/*", CBOR),
        ("text/html, application/*;q=0.5", CBOR),
        (f"{JSON};q=0.4, {RAW};q=0.9", RAW),
        (f"*/*;q=0.1, {JSON}", JSON),
        (f"{CBOR};q=0, */*", JSON),
    ],
)
def test_the_answer_is_of_the_type_preferred_else_that_of_the_body(client, accept, kind):
    body = cbor2.dumps({"position": [0.0], "deflection_um": [5.0]})
    assert ask(client, body, CBOR, accept).headers["content-type"] == kind


def assert_problem(answer: Response, status: int) -> dict[str, Any]:
    assert (answer.status_code, answer.headers["content-type"]) == (status, "application/problem+json")
    found: dict[str, Any] = answer.json()
    return found


@pytest.mark.parametrize("kind", ["", "text/plain", "application/xml", "multipart/form-data", "json"])
def test_other_bodies_are_415(client, kind):
    found = assert_problem(ask(client, b'{"position": [0], "deflection_um": [0]}', kind), 415)
    assert all(known in found["detail"] for known in (JSON, CBOR, RAW))


@pytest.mark.parametrize("accept", ["text/html", "image/*", f"{JSON};q=0", "*/*;q=0"])
def test_other_answers_are_406(client, accept):
    assert_problem(ask(client, b'{"position": [0], "deflection_um": [0]}', JSON, accept), 406)


@pytest.mark.parametrize("value", [float("nan"), float("inf"), -float("inf"), 1.1e9])
@pytest.mark.parametrize("name", LIMITS)
@pytest.mark.parametrize("sent", BODIES)
def test_a_value_that_is_no_number_or_too_large_is_named(client, sent, name, value):
    given = {column: [0.0] * 5 for column in LIMITS}
    given[name][3] = value
    answer = ask(client, *BODIES[sent](given), columns=",".join(given))
    (fault,) = assert_problem(answer, 422)["errors"]
    assert fault["field"] == f"{name}[3]"
    assert fault["bound"].endswith(f"from {-LIMITS[name]:g} to {LIMITS[name]:g}")


@pytest.mark.parametrize("sent", BODIES)
def test_too_many_points_are_one_clear_error(client, sent):
    given = dict.fromkeys(("position", "deflection_um"), [0] * (MAX_POINTS + 1))
    (fault,) = assert_problem(ask(client, *BODIES[sent](given)), 422)["errors"][:1]
    assert (fault["field"], fault["bound"]) == ("position", f"a list of at most {MAX_POINTS}")


@pytest.mark.parametrize(
    ("body", "kind", "field"),
    [
        (b"", RAW, "body"),
        (b"1234567", RAW, "body"),
        (b"12345678", RAW, "body"),
        (b"", CBOR, "body"),
        (b"\xff", CBOR, "body"),
        (b"\x9b" + b"\xff" * 8, CBOR, "body"),
        (b"\x81" * 5000, CBOR, "body"),
        (cbor2.dumps([1, 2]), CBOR, "body"),
        (cbor2.dumps(cbor2.CBORTag(35, "(a+)+$")), CBOR, "body"),
        (cbor2.dumps({"position": cbor2.CBORTag(2, b"\xff" * 200), "deflection_um": [0.0]}), CBOR, "body"),
        (cbor2.dumps({"position": cbor2.CBORTag(86, b"1234567"), "deflection_um": [0.0]}), CBOR, "body"),
        (cbor2.dumps({"position": cbor2.CBORTag(86, ["8 bytes"]), "deflection_um": [0.0]}), CBOR, "body"),
        (cbor2.dumps({"position": [0.0], "deflection_um": b"12345678"}), CBOR, "deflection_um"),
        (cbor2.dumps({"position": ["0"], "deflection_um": [0.0]}), CBOR, "position[0]"),
        (cbor2.dumps({"position": [0.0], "deflection_um": [0.0], "force": 1}), CBOR, "force"),
        (b"{", JSON, "body"),
        (b"\xff\xfe", JSON, "body"),
        (b"[]", JSON, "body"),
        (b'{"position": [0, 0.1], "deflection_um": [1, 2, 3]}', JSON, "deflection_um"),
        (b'{"position": [], "deflection_um": [1]}', JSON, "position"),
        (b'{"position": [0]}', JSON, "deflection_um"),
        (b'{"position": [0], "deflection_um": [0], "misalignment_um": [0, 1]}', JSON, ""),
        (
            b'{"position": [0, 1], "deflection_um": [0], "misalignment_um": [0, 1, 2]}',
            JSON,
            "misalignment_um",
        ),
        (b'{"position": [0], "deflection_um": [0], "misalignment_um": "0"}', JSON, "misalignment_um"),
        (b'{"position": [0], "deflection_um": [0], "misalignment_um": []}', JSON, "misalignment_um"),
    ],
)
def test_a_body_that_is_no_query_is_refused_by_name(client, body, kind, field):
    answer = ask(client, body, kind)
    if field == "":  # one position serves all misalignments
        assert len(answer.json()["force_n"]) == 2
        return
    assert [fault["field"] for fault in assert_problem(answer, 422)["errors"]] == [field]


@pytest.mark.parametrize(
    "names", ["", "position", "position,position,deflection_um", "deflection_um,force_n,position", "x" * 5000]
)
def test_columns_that_make_no_query_are_refused(client, names):
    body = struct.pack("<6d", *range(6)) if names else struct.pack("<d", 1.0)
    (fault,) = assert_problem(ask(client, body, RAW, columns=names), 422)["errors"]
    assert fault["field"] == "columns"


@pytest.mark.parametrize("key", ["ABC", "0" * 63, "0" * 65, "0" * 64 + "%0A"])
def test_a_key_that_is_none_is_refused(client, key):
    answer = client.post(f"/v1/databases/{key}/query", json={"position": [0.0], "deflection_um": [0.0]})
    assert [fault["field"] for fault in assert_problem(answer, 422)["errors"]] == ["key"]


def test_an_unknown_table_is_not_found(client):
    answer = client.post(f"/v1/databases/{'0' * 64}/query", json={"position": [0.0], "deflection_um": [0.0]})
    assert assert_problem(answer, 404)["type"] == "urn:lineofaction:problem:not-found"


def test_only_the_query_itself_passes_the_router_by(client):
    body = {"position": [0.3], "deflection_um": [5.0]}
    assert client.post(PATH, json=body).status_code == 200
    assert client.get(PATH).status_code == 405
    assert client.post(PATH.removeprefix("/v1"), json=body).status_code == 404
    assert client.post(f"{PATH}/", json=body, follow_redirects=False).status_code in (307, 404)
    told = client.get("/metrics").text
    assert 'method="POST",route="/v1/databases/{key}/query",status="200"' in told
