"""What caches may keep: with keys nothing that is shared, without keys results for ever (RFC 9111)."""

import shutil
import socket
import subprocess
from pathlib import Path

import httpx2
import pytest
from fastapi.testclient import TestClient
from httpx2 import Response
from running_service import until
from served_app import served

from lineofaction.gearbox.registry import NETCDF, RESULT_KINDS
from service.access.key_file import KeyFile
from service.app import create_app
from service.settings import Settings

KEY, ABSENT = "5" * 64, "6" * 64
PUBLIC = ("/health", "/ready")  # requested without a key, and as old as the answer


@pytest.fixture(scope="module")
def service(tmp_path_factory):
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
    described = client.app.openapi()["paths"]
    named = [path for path, methods in described.items() if "get" in methods and path not in PUBLIC]
    held = [path.replace("{key}", KEY) for path in named if "{key}" in path and "figures" not in path]
    missing = [path.replace("{key}", ABSENT).replace("{process_id}", "analyze") for path in named]
    return [*held, *missing, "/openapi.json", "/v1/nowhere"]


@pytest.mark.law
def test_with_keys_no_shared_cache_keeps_any_answer(service):
    client, bearer = service
    kept, statuses = {}, set()
    for path in paths(client):
        answer = client.get(path, headers=bearer | {"Accept": f"{NETCDF}, application/json;q=0.5"})
        statuses.add(answer.status_code)
        if not kept_for_its_caller_alone(answer):
            kept[path] = answer.headers.get("cache-control")
    assert kept == {}
    assert {200, 404} <= statuses


def test_with_keys_a_known_version_is_confirmed_to_who_may_have_it(service):
    client, bearer = service
    path, accept = f"/v1/results/{KEY}", {"Accept": NETCDF}
    first = client.get(path, headers=bearer | accept)
    known = accept | {"If-None-Match": first.headers["etag"]}
    again = client.get(path, headers=bearer | known)
    assert (first.status_code, again.status_code) == (200, 304)
    assert kept_for_its_caller_alone(again) and {"accept", "authorization"} <= varies(first)
    refused = client.get(path, headers=known)
    assert refused.status_code == 401 and directives(refused) == {"no-store"}


def test_an_event_stream_is_kept_by_nobody(service):
    client, bearer = service
    job = client.app.state.context.submissions.submit("analyze", KEY, {}, stored=True)
    answer = client.get(f"/v1/jobs/{job.id}/events", headers=bearer)
    assert answer.status_code == 200 and "no-store" in directives(answer)


def test_what_needs_no_key_holds_nothing_secret(service):
    client, _ = service
    assert [directives(client.get(path)) for path in PUBLIC] == [{"no-store"}] * 2
    for path in ("/", "/page/api.js"):
        answer = client.get(path)
        assert answer.status_code == 200 and directives(answer) == {"no-cache"}


def test_without_keys_results_are_kept_for_ever_and_refusals_never(tmp_path):
    app = create_app(Settings(data_directory=tmp_path), works=False)
    file = tmp_path / "file.nc"
    file.write_text("{}")
    app.state.context.store.put(KEY, "ablation", file)
    client = TestClient(app, raise_server_exceptions=False, headers={"Accept": NETCDF})
    assert {"public", "immutable"} <= directives(client.get(f"/v1/results/{KEY}"))
    assert "authorization" not in varies(client.get(f"/v1/results/{KEY}"))
    for path in (f"/v1/results/{ABSENT}", "/v1/nowhere", "/v1/ablations/short"):
        assert directives(client.get(path)) == {"no-store"}


# A shared cache in front of the service, nginx.


PATH = f"/v1/results/{KEY}"
NGINX = shutil.which("nginx", path="/usr/sbin:/usr/bin:/usr/local/sbin:/usr/local/bin")
_CONFIGURATION = """
daemon off; master_process off; pid {place}/pid; error_log {place}/error.log;
events {{ worker_connections 64; }}
http {{
  access_log off;
  client_body_temp_path {place}/body; proxy_temp_path {place}/proxy; fastcgi_temp_path {place}/fastcgi;
  uwsgi_temp_path {place}/uwsgi; scgi_temp_path {place}/scgi;
  proxy_cache_path {place}/cache keys_zone=all:1m;
  server {{
    listen unix:{place}/socket;
    location / {{
      proxy_pass http://127.0.0.1:{service};
      proxy_cache all;
      add_header X-Cache $upstream_cache_status always;
    }}
  }}
}}
"""


@pytest.fixture
def cached(tmp_path):
    """A caller behind a cache, which keeps what RFC 9111 allows it; the service has a result and no keys."""
    if NGINX is None:
        pytest.skip("nginx is not installed")
    app = create_app(Settings(data_directory=tmp_path / "data"), works=False)
    file = tmp_path / "file.nc"
    file.write_text("{}")
    app.state.context.store.put(KEY, "ablation", file)
    with served(app) as service:
        text = _CONFIGURATION.format(place=tmp_path, service=service)
        (tmp_path / "nginx.conf").write_text(text)
        command = [str(NGINX), "-c", str(tmp_path / "nginx.conf"), "-e", str(tmp_path / "error.log")]
        proxy = subprocess.Popen(command)
        try:
            until(lambda: _listens(tmp_path / "socket"))
            transport = httpx2.HTTPTransport(uds=str(tmp_path / "socket"))
            with httpx2.Client(
                base_url="http://localhost", transport=transport, headers={"Accept": NETCDF}
            ) as client:
                yield client
        finally:
            proxy.terminate()
            proxy.wait()


def _listens(path: Path) -> bool:
    """Whether a server accepts at a path. httpx2 leaves open the socket of a refused connection."""
    with socket.socket(socket.AF_UNIX) as caller:
        return caller.connect_ex(str(path)) == 0


def test_a_cache_keeps_results_of_an_open_service(cached):
    """So that the test below can fail: this cache does keep what it may."""
    answers = [cached.get(PATH) for _ in range(2)]
    assert [answer.headers["x-cache"] for answer in answers] == ["MISS", "HIT"]


def test_a_cache_serves_nobody_what_was_given_for_a_key(cached, tmp_path):
    keys = KeyFile(tmp_path / "data" / "keys.json")
    bearer = {"Authorization": f"Bearer {keys.add('bench')}"}
    allowed = [cached.get(PATH, headers=bearer) for _ in range(2)]
    assert [answer.status_code for answer in allowed] == [200, 200]
    assert [cached.get(PATH).status_code, cached.get(PATH, headers=bearer).status_code] == [401, 200]
    keys.add("other")  # the service stays shut
    keys.remove("bench")
    assert cached.get(PATH, headers=bearer).status_code == 401
    assert [answer.headers["x-cache"] for answer in allowed] == ["MISS", "MISS"]
