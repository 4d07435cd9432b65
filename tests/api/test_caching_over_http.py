"""What caches may keep: with keys nothing that is shared, without keys results for ever (RFC 9111)."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from fastapi.testclient import TestClient
from httpx2 import Response

from lineofaction.gearbox.registry import NETCDF
from lineofaction.gearbox.schemas.result_kinds import RESULT_KINDS
from service.access.keyring import KeyFile
from service.app import create_app
from service.settings import Settings

KEY, ABSENT = "5" * 64, "6" * 64
PUBLIC = ("/health", "/ready")  # requested without a key, and as old as the answer


@pytest.fixture(scope="module")
def service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[TestClient, dict[str, str]]]:
    """A caller of a service that has keys and a result of every kind, and the header with a key."""
    directory = tmp_path_factory.mktemp("kept")
    secret = KeyFile(directory / "keys.json").add("bench")
    app = create_app(Settings(data_directory=directory), works=False)
    for kind in RESULT_KINDS:
        file = directory / "file.nc"
        file.write_text("{}")
        app.state.context.store.put(KEY, kind, file)
    yield TestClient(app, raise_server_exceptions=False), {"Authorization": f"Bearer {secret}"}


def directives(answer: Response) -> set[str]:
    return {part.strip() for part in answer.headers.get("cache-control", "").split(",")}


def varies(answer: Response) -> set[str]:
    """Return the headers of the request that an answer hangs on."""
    return {part.strip().lower() for part in answer.headers.get("vary", "").split(",")}


def kept_for_its_caller_alone(answer: Response) -> bool:
    """Whether no shared cache keeps an answer, and the caller's own asks before it uses it again."""
    said = directives(answer)
    private = {"private", "no-cache"} <= said and "authorization" in varies(answer)
    shared = said & {"public", "immutable"} or "max-age" in str(said)
    return (private or "no-store" in said) and not shared


def paths(client: TestClient) -> list[str]:
    """Return every GET path of the description, of results that are and of some that are not."""
    described = client.app.openapi()["paths"]  # type: ignore[attr-defined]
    named = [path for path, methods in described.items() if "get" in methods and path not in PUBLIC]
    held = [path.replace("{key}", KEY) for path in named if "{key}" in path and "figures" not in path]
    missing = [path.replace("{key}", ABSENT).replace("{process_id}", "analyze") for path in named]
    return [*held, *missing, "/openapi.json", "/v1/nowhere"]


@pytest.mark.law
def test_with_keys_no_shared_cache_keeps_any_answer(service: tuple[TestClient, dict[str, str]]) -> None:
    client, bearer = service
    kept, statuses = {}, set()
    for path in paths(client):
        answer = client.get(path, headers=bearer | {"Accept": f"{NETCDF}, application/json;q=0.5"})
        statuses.add(answer.status_code)
        if not kept_for_its_caller_alone(answer):
            kept[path] = answer.headers.get("cache-control")
    assert kept == {}
    assert {200, 404} <= statuses


def test_with_keys_a_known_version_is_confirmed_to_who_may_have_it(
    service: tuple[TestClient, dict[str, str]],
) -> None:
    client, bearer = service
    path, accept = f"/v1/results/{KEY}", {"Accept": NETCDF}
    first = client.get(path, headers=bearer | accept)
    known = accept | {"If-None-Match": first.headers["etag"]}
    again = client.get(path, headers=bearer | known)
    assert (first.status_code, again.status_code) == (200, 304)
    assert kept_for_its_caller_alone(again) and {"accept", "authorization"} <= varies(first)
    refused = client.get(path, headers=known)
    assert refused.status_code == 401 and directives(refused) == {"no-store"}


def test_an_event_stream_is_kept_by_nobody(service: tuple[TestClient, dict[str, str]]) -> None:
    client, bearer = service
    job = client.app.state.context.submissions.submit("analyze", KEY, {}, stored=True)  # type: ignore[attr-defined]
    answer = client.get(f"/v1/jobs/{job.id}/events", headers=bearer)
    assert answer.status_code == 200 and "no-store" in directives(answer)


def test_what_needs_no_key_holds_nothing_secret(service: tuple[TestClient, dict[str, str]]) -> None:
    client, _ = service
    assert [directives(client.get(path)) for path in PUBLIC] == [{"no-store"}] * 2
    for path in ("/", "/page/api.js"):
        answer = client.get(path)
        assert answer.status_code == 200 and directives(answer) == {"no-cache"}


def test_without_keys_results_are_kept_for_ever_and_refusals_never(tmp_path: Path) -> None:
    app = create_app(Settings(data_directory=tmp_path), works=False)
    file = tmp_path / "file.nc"
    file.write_text("{}")
    app.state.context.store.put(KEY, "ablation", file)
    client = TestClient(app, raise_server_exceptions=False, headers={"Accept": NETCDF})
    assert {"public", "immutable"} <= directives(client.get(f"/v1/results/{KEY}"))
    assert "authorization" not in varies(client.get(f"/v1/results/{KEY}"))
    for path in (f"/v1/results/{ABSENT}", "/v1/nowhere", "/v1/ablations/short"):
        assert directives(client.get(path)) == {"no-store"}
