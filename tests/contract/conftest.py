"""A service without results, which no test of a file gives a job; its fakes are importable here too."""

import pytest
from fastapi.testclient import TestClient
from service_surroundings import quiet_log

from service.app import create_app
from service.settings import Settings

__all__ = ["quiet_log"]


@pytest.fixture(scope="module")
def client(tmp_path_factory):
    with TestClient(create_app(Settings(data_directory=tmp_path_factory.mktemp("data")))) as found:
        yield found
        assert found.get("/v1/jobs").json()["jobs"] == []
