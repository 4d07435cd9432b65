"""Databases as resources: metadata and file of a real table; force queries: test_queries_over_http.py."""

import base64
import hashlib

import pytest
from fastapi.testclient import TestClient
from small_table import small_table

from fe_contact.ste import SteDatabase
from lineofaction.client import LineOfActionClient
from lineofaction.gearbox.problems import NotFound
from service.app import create_app
from service.settings import Settings

KEY = hashlib.sha256(b"small table").hexdigest()
NETCDF = {"Accept": "application/x-netcdf"}


@pytest.fixture
def client(tmp_path):
    app = create_app(Settings(data_directory=tmp_path))
    file = tmp_path / "table.nc"
    small_table().to_netcdf(file)
    app.state.context.store.put(KEY, "database", file)
    with TestClient(app) as found:
        yield found


def test_the_file_is_the_table_and_its_digest_is_told(client, tmp_path):
    answer = client.get(f"/v1/results/{KEY}", headers=NETCDF)
    digest = base64.b64encode(hashlib.sha256(answer.content).digest()).decode()
    assert answer.headers["content-digest"] == f"sha-256=:{digest}:"
    file = tmp_path / "fetched.nc"
    file.write_bytes(answer.content)
    assert SteDatabase.from_netcdf(file).identical(small_table())


def test_the_kind_is_that_of_the_store(client, tmp_path):
    assert client.get(f"/v1/results/{KEY}").headers["result-kind"] == "database"
    wire = client._transport
    local = LineOfActionClient("http://testserver", cache_dir=tmp_path / "cache", transport=wire)
    with pytest.raises(NotFound, match="no run, but of the kind database"):
        local.fetch_file(KEY, "run")
    file, kind = local.fetch_result(KEY)
    assert kind == "database" and SteDatabase.from_netcdf(file).identical(small_table())


def test_metadata_is_the_default_and_in_boundary_units(client):
    answer = client.get(f"/v1/results/{KEY}").json()
    table = small_table()
    assert answer["hash"] == KEY
    assert answer["torque_n_m"] == table.torque.tolist()
    assert answer["failed_points"] == 0
    assert (
        client.get(f"/v1/results/{KEY}", headers={"Accept": "text/html, application/x-netcdf"}).content[1:4]
        == b"HDF"
    )


def test_a_damaged_table_is_refused_not_served(client):
    store = client.app.state.context.store
    path = store.verified(KEY, "database").path
    path.write_bytes(path.read_bytes()[:-1] + b"?")
    answer = client.get(f"/v1/results/{KEY}", headers=NETCDF)
    assert (answer.status_code, answer.json()["type"]) == (500, "urn:lineofaction:problem:damaged-file")
    assert client.get(f"/v1/results/{KEY}", headers=NETCDF).status_code == 404


def test_effects_are_listed(client):
    assert "corner_contact" in [effect["name"] for effect in client.get("/v1/effects").json()]
