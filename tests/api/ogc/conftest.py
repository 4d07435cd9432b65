"""A service that OGC API - Processes 1.0 (OGC 18-062r2) is asked about.

Of its classes core, ogc-process-description, json, job-list and dismiss, as far as they concern what
is offered: asynchronous execution of processes with one output. The marker `requirement` of a test has the
identifiers that it states.
"""

import pytest
from fastapi.testclient import TestClient
from service_fakes import REGISTRY

from service.app import create_app
from service.settings import Settings


@pytest.fixture(scope="module")
def client(tmp_path_factory):
    settings = Settings(data_directory=tmp_path_factory.mktemp("ogc"))
    with TestClient(create_app(settings, REGISTRY)) as found:
        yield found
