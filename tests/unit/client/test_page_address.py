"""An address of the page is the case and the result that it shows; a hostile one is an error."""

import base64
import json
import zlib
from collections.abc import Callable
from typing import Any

import httpx2
import pytest
from command_line import loa, printed
from small_table import small_table
from stored_jobs import ADDRESS, against, case

from lineofaction.client.drivers import BlockingDriver
from lineofaction.client.page_address import LONGEST_WORD, PageAddress
from lineofaction.gearbox.problems import BadInput, NotFound
from lineofaction.gearbox.schemas import Case, validated
from lineofaction.gearbox.schemas.reading import read_model

KEY, OTHER = "ab" * 32, "cd" * 32
JOB = "11111111-1111-4111-8111-111111111111"
SCENE_JOB = "22222222-2222-4222-8222-222222222222"
GONE = "33333333-3333-4333-8333-333333333333"
BY_THE_PAGE = (  # by packed.js
    "eyJwYWlyIjp7Im5vcm1hbF9tb2R1bGVfbW0iOjQsImNlbnRlcl9kaXN0YW5jZV9tbSI6ODAsInBpbmlvbiI6eyJ0ZWV0aCI6MjAsImZhY2Vf"
    "d2lkdGhfbW0iOjI1LCJib3JlX2RpYW1ldGVyX21tIjo0MCwidGlwX3JlbGllZl91bSI6N30sIndoZWVsIjp7InRlZXRoIjoyMCwiZmFjZV93"
    "aWR0aF9tbSI6MjUsImJvcmVfZGlhbWV0ZXJfbW0iOjQwfX0sImxvYWQiOnsidG9ycXVlX25fbSI6WzEwLDEwMF19LCJyZXBvcnQiOnsicHJv"
    "amVjdCI6IlByw7xmc3RhbmQgwrUgfj4_In19"
)


def packed(content: object) -> str:
    """Return content as packed.js packs it."""
    text = content if isinstance(content, str) else json.dumps(content, separators=(",", ":"))
    return base64.urlsafe_b64encode(text.encode()).decode().rstrip("=")


def relieved(relief_um: float = 7) -> dict[str, Any]:
    content = case()
    content["pair"]["pinion"] |= {"tip_relief_um": relief_um}
    return content | {"report": {"project": "Prüfstand µ ~>?"}}


ANSWERS = {
    "/v1/examples": [{"case": case(17), "hash": KEY, "stored": True}],
    f"/v1/results/{KEY}": {"case": case(21)},
    f"/v1/jobs/{JOB}/inputs": {"processID": "flank", "inputs": {"case": case(22)}},
    f"/v1/jobs/{SCENE_JOB}/inputs": {"inputs": {"scene": {"meshes": [{"database_hash": KEY}]}}},
}


def service(request: httpx2.Request) -> httpx2.Response:
    answer = ANSWERS.get(request.url.path)
    if answer is None:
        return httpx2.Response(404, json=NotFound("There is none.").as_json())
    return httpx2.Response(200, json=answer)


def test_a_case_is_packed_as_by_the_page():
    page = PageAddress.of(f"{ADDRESS}/#case={BY_THE_PAGE}")
    assert page.case == validated(Case, relieved())
    numbers = json.dumps(relieved(), ensure_ascii=False, separators=(",", ":")).replace(".0", "")
    assert packed(numbers) == BY_THE_PAGE


@pytest.mark.parametrize(
    ("fragment", "teeth", "result"),
    [
        ("", 17, KEY),
        ("#", 17, KEY),
        ("#tab=orders&at=0.5&name=Gear%20%26%20%CE%BC", 17, KEY),
        (f"#database={KEY}&name=case", 21, KEY),
        (f"#analyze={JOB}", 22, JOB),
        (f"#database={KEY}&flank={JOB}&live={packed({'misalignment_um': 3})}", 22, KEY),
        (f"#database={KEY}&flank={GONE}", 21, KEY),
        (f"#database={KEY}&case={packed(case(23))}", 23, KEY),
        (f"#simulate={SCENE_JOB}", 21, SCENE_JOB),
        (f"#job={JOB}&unit=ab.cd&see=14", 22, JOB),
        (f"#case={packed(case(24))}&a={KEY}..{packed(case(25))}&c=first&on=b&motion=3", 24, None),
    ],
)
def test_an_address_is_the_case_and_the_result_that_it_shows(fragment, teeth, result, tmp_path):
    with against(service, tmp_path) as client:
        assert client.case_at(f"{ADDRESS}/{fragment}") == validated(Case, case(teeth))
        if result is not None:
            assert client.result_at(f"{ADDRESS}/{fragment}") == result
            return
        with pytest.raises(BadInput, match=r"address = 'case&a&c&on&motion': .*loa analyze case\.toml"):
            client.result_at(f"{ADDRESS}/{fragment}")


def test_nothing_that_is_known_is_not_found(tmp_path):
    with against(service, tmp_path) as client, pytest.raises(NotFound):
        client.case_at(f"{ADDRESS}/#database={OTHER}")


# Hostile addresses.


def typed(content: object) -> str:
    return f"{ADDRESS}/#case={packed(content)}"


BOMB = base64.urlsafe_b64encode(zlib.compress(b"0" * 50_000_000)).decode().rstrip("=")
CASE = packed(case())
HOSTILE = {
    "file": (f"file:///etc/passwd#case={CASE}", "address", "http:// or https://"),
    "ftp": (f"ftp://127.0.0.1:1/#case={CASE}", "address", "http:// or https://"),
    "script": ("javascript:alert(1)", "address", "http:// or https://"),
    "no scheme": (f"localhost:8321/#database={KEY}", "address", "http:// or https://"),
    "user": (f"http://u:secret@127.0.0.1:1/#case={CASE}", "address", "without user or password"),
    "host in a user": (f"http://127.0.0.1:1\\@example.org/#case={CASE}", "address", "a host"),
    "line in a host": (f"http://127.0.0.1:1\n.example.org/#case={CASE}", "address", "a host"),
    "port": (f"http://127.0.0.1:99999/#case={CASE}", "address", "a host"),
    "path": (f"http://127.0.0.1:1/v1/../x/#case={CASE}", "address", "http://127.0.0.1:1/#"),
    "long": (f"{ADDRESS}/#case={'A' * LONGEST_WORD}", "address", "at most 1500000 characters"),
    "long name": (f"{ADDRESS}/#{'a' * 2_000_000}", "address", "at most 1500000 characters"),
    "no base64": (f"{ADDRESS}/#case=!!!!", "case", "base64url"),
    "odd base64": (f"{ADDRESS}/#case=A", "case", "base64url"),
    "no text": (f"{ADDRESS}/#case=_____w", "case", "base64url"),
    "no JSON": (typed("pair = 1"), "case", "a JSON object"),
    "no object": (typed([1]), "case", "a JSON object"),
    "no number": (typed(case() | {"load": {"torque_n_m": [float("nan")]}}), "case", "JSON"),
    "deep": (typed('{"pair":' + "[" * 500_000), "case", "a JSON object"),
    "deep tables": (typed('{"pair":' * 20_000 + "1" + "}" * 20_000), "case", "a JSON object"),
    "colors in a field": (typed({"pair": {"\x1b[31m": 1}}), "case", "a JSON object"),
    "digits": (typed('{"pair":' + "9" * 5000 + "}"), "case", "a JSON object"),
    "no case": (typed(case() | {"load": {}}), "case.load.torque_n_m", "must be given"),
    "endless": (typed(json.dumps(case()).replace("100.0", "1e999")), "case.load.torque_n_m[1]", "must be"),
    "half a letter": (typed(case() | {"report": {"title": "\ud800"}}), "case.report.title", "must be"),
    "a file": (typed(case() | {"case_file": "/etc/passwd"}), "case.case_file", "no such field"),
    "bomb as a case": (f"{ADDRESS}/#case={BOMB}", "case", "base64url of a JSON object"),
    "bomb as a unit": (f"{ADDRESS}/#unit={packed('x')}.{BOMB}", "unit", "loa open FILE"),
    "way up": (f"{ADDRESS}/#database=../../jobs", "database", "a content hash"),
    "way up in a hash": (f"{ADDRESS}/#database={'a' * 58}%2F..%2Fa", "database", "a content hash"),
    "line after a hash": (f"{ADDRESS}/#database={KEY}%0A", "database", "a content hash"),
    "way up in a job": (f"{ADDRESS}/#analyze=../results/{KEY}", "analyze", "the identifier of a job"),
    "other digits": (f"{ADDRESS}/#database={'%D9%A1' * 64}", "database", "a content hash"),
    "unknown word": (f"{ADDRESS}/#database={KEY}&exec=ls", "address", "words of the page"),
    "no word": (f"{ADDRESS}/#fields", "address", "words of the page"),
    "colors": (f"{ADDRESS}/#%1B[31m%0Ax=1", "address", "\\x1b[31m\\nx=1"),
    "variant": (f"{ADDRESS}/#database={KEY}&on=z", "on", "as the page writes it"),
}


@pytest.fixture
def asked(monkeypatch):
    """Requests of the command line, which the service in memory answers."""
    requests: list[httpx2.Request] = []

    def answer(request):
        requests.append(request)
        return service(request)

    plain: Callable[..., None] = BlockingDriver.__init__

    def connect(driver, _, options):
        plain(driver, httpx2.MockTransport(answer), options)

    monkeypatch.setattr(BlockingDriver, "__init__", connect)
    monkeypatch.delenv("LOA_SERVICE", raising=False)
    monkeypatch.delenv("LOA_KEY", raising=False)
    return requests


@pytest.mark.drawn
@pytest.mark.parametrize("name", HOSTILE)
@pytest.mark.parametrize("ending", ["toml", "nc"])
def test_a_hostile_address_is_one_error_that_names_the_word(name, ending, asked, tmp_path):
    address, word, said = HOSTILE[name]
    refused = loa("fetch", address, "-o", tmp_path / f"x.{ending}")
    assert refused.exit_code == 2, refused.output
    (line,) = refused.stderr.splitlines()
    assert line.startswith(f"error: {word} = ") and said in line
    assert len(line) < 700 and "secret" not in line
    assert asked == [] and list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("environment", "option"),
    [
        ({"LOA_KEY": "secret"}, ()),
        ({"LOA_KEY": "secret", "LOA_SERVICE": "https://gears.example"}, ()),
        ({"LOA_SERVICE": "http://u:secret@example.org"}, ()),
        ({"LOA_SERVICE": "https://example.org"}, ()),
        ({}, ("--service", "http://127.0.0.1:8321")),
        ({}, ("--service", "http://example.org:8080")),
    ],
)
@pytest.mark.parametrize("fragment", [f"case={CASE}", f"database={KEY}", f"analyze={JOB}", ""])
def test_no_key_and_no_request_leaves_its_service(
    environment, option, fragment, asked, tmp_path, monkeypatch
):
    for name, value in environment.items():
        monkeypatch.setenv(name, value)
    for ending in ("toml", "nc"):
        refused = loa("fetch", f"http://example.org/#{fragment}", "-o", tmp_path / f"x.{ending}", *option)
        assert refused.exit_code == 2
        (line,) = refused.stderr.splitlines()
        assert line.startswith("error: service = ") and "http://example.org:80" in line
    assert asked == [] and list(tmp_path.iterdir()) == []


def test_a_key_goes_to_the_service_that_is_stated(asked, tmp_path, monkeypatch):
    monkeypatch.setenv("LOA_KEY", "mine")
    monkeypatch.setenv("LOA_SERVICE", "http://example.org:80/")
    printed("fetch", f"http://example.org/#database={KEY}", "-o", tmp_path / "case.toml")
    assert [str(request.url) for request in asked] == [f"http://example.org/v1/results/{KEY}"]
    assert asked[0].headers["authorization"] == "Bearer mine"


def test_a_case_as_typed_is_a_file_without_a_request(asked, tmp_path):
    file = tmp_path / "case.toml"
    assert printed("fetch", f"https://example.org/#case={BY_THE_PAGE}", "-o", file)["kind"] == "case"
    assert read_model(Case, file) == validated(Case, relieved())
    assert asked == []


def test_the_result_of_an_edited_design_says_so(asked, tmp_path, monkeypatch):
    stored, file = tmp_path / "stored.nc", tmp_path / "ste.nc"
    small_table().to_netcdf(stored)
    monkeypatch.setattr(
        "lineofaction.client.LineOfActionClient.fetch_result", lambda _, key: (stored, "database")
    )
    done = loa("fetch", f"{ADDRESS}/#database={KEY}&case={CASE}", "-o", file)
    assert done.exit_code == 0 and file.read_bytes() == stored.read_bytes()
    assert "its design was edited since the result" in done.stdout
    same = loa("fetch", f"{ADDRESS}/#database={KEY}", "-o", file)
    assert "since the result" not in same.stdout and asked == []
