"""A shared cache in front of the service, nginx: what it may keep, and what it never sees twice."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path

import httpx2
import pytest
from running_service import until
from served_app import served

from lineofaction.gearbox.registry import NETCDF
from service.access.keyring import KeyFile
from service.app import create_app
from service.settings import Settings

KEY = "5" * 64
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

pytestmark = pytest.mark.skipif(NGINX is None, reason="nginx is not installed")


@pytest.fixture
def cached(tmp_path: Path) -> Iterator[httpx2.Client]:
    """A caller behind a cache, which keeps what RFC 9111 allows it; the service has a result and no keys."""
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
            transport = httpx2.HTTPTransport(uds=str(tmp_path / "socket"))
            with httpx2.Client(
                base_url="http://localhost", transport=transport, headers={"Accept": NETCDF}
            ) as client:
                until(lambda: _answers(client))
                yield client
        finally:
            proxy.terminate()
            proxy.wait()


def _answers(client: httpx2.Client) -> bool:
    try:
        return client.get("/health").status_code == 200
    except httpx2.TransportError:
        return False


def test_a_cache_keeps_results_of_an_open_service(cached: httpx2.Client) -> None:
    """So that the test below can fail: this cache does keep what it may."""
    answers = [cached.get(PATH) for _ in range(2)]
    assert [answer.headers["x-cache"] for answer in answers] == ["MISS", "HIT"]


def test_a_cache_serves_nobody_what_was_given_for_a_key(cached: httpx2.Client, tmp_path: Path) -> None:
    keys = KeyFile(tmp_path / "data" / "keys.json")
    bearer = {"Authorization": f"Bearer {keys.add('bench')}"}
    allowed = [cached.get(PATH, headers=bearer) for _ in range(2)]
    assert [answer.status_code for answer in allowed] == [200, 200]
    assert [cached.get(PATH).status_code, cached.get(PATH, headers=bearer).status_code] == [401, 200]
    keys.add("other")  # the service stays shut
    keys.remove("bench")
    assert cached.get(PATH, headers=bearer).status_code == 401
    assert [answer.headers["x-cache"] for answer in allowed] == ["MISS", "MISS"]
