"""Idle connections: kept for longer than callers and proxies keep them, and no hindrance to a stop."""

from __future__ import annotations

import http.client
import time
from pathlib import Path

from killed_service import KilledService
from running_service import PATIENCE_S

CLIENTS_KEEP_S = 5.0  # the default of our client's library


def test_an_idle_connection_is_closed_by_the_caller_not_under_its_request(tmp_path: Path) -> None:
    with KilledService(tmp_path, {}, ["serve"]) as service:
        service.request("GET", "/health")
        connection = http.client.HTTPConnection(service.address.removeprefix("http://"), timeout=PATIENCE_S)
        for pause in (0.0, 1.4 * CLIENTS_KEEP_S):
            time.sleep(pause)
            connection.request("GET", "/health")
            answer = connection.getresponse()
            assert (answer.status, answer.read()) == (200, b'{"status":"ok"}')
        assert service.stop() == [0]
        connection.close()
