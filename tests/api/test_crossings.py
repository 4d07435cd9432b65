"""Every operation against every caller that may not: of another project, no scope, expired, revoked."""

import json
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

import pytest
from fastapi import FastAPI
from fastapi.testclient import TestClient
from httpx2 import Response
from service_fakes import EXECUTION, REGISTRY
from small_table import small_table

from lineofaction.gearbox.problems import KeyExpired, MissingScope, NotFound, Unauthorised
from service.access.holder import Scope
from service.access.key_file import KeyFile
from service.app import create_app
from service.routes.access import OPEN_FOLDER, OPEN_PATHS
from service.routes.scopes import OPEN_TO_ALL, ScopedRoute
from service.settings import Settings

KEY, NO_KEY, RUN, MODES = "ab" * 32, "cd" * 32, "ef" * 32, "12" * 32
NO_JOB = "00000000-0000-4000-8000-000000000000"
BODIES: dict[str, Any] = {
    "query_forces": {"position": [0.5], "deflection_um": [5.0]},
    **{route: {"torque_n_m": [10.0]} for route in ("live_ste", "draft_ste")},
    "fake": {"inputs": {"wish": {"text": "unseen"}}},
    "relabel_job": {"title": "shown"},
}


@dataclass(frozen=True)
class WalkedRoute:
    """A route with one of its methods."""

    method: str
    path: str
    route: Any

    def __str__(self) -> str:
        return f"{self.method} {self.path}"

    def at(self, **parameters: str) -> str:
        """Return the path with parameters, some more than it has."""
        return self.path.format_map(parameters)


def walked_routes(app: FastAPI) -> list[WalkedRoute]:
    return list(_walk(app.routes, ""))


def _walk(routes: Any, prefix: str) -> Iterator[WalkedRoute]:
    for route in routes:
        inner = getattr(route, "original_router", None)
        if inner is not None:
            yield from _walk(inner.routes, prefix + route.include_context.prefix)
        else:
            for method in sorted(route.methods):
                yield WalkedRoute(method, prefix + route.path, route)


def key_at(walked: WalkedRoute) -> str:
    """Return the hash of the result that a route is about: sounds are of runs, motions of modes."""
    return {"sound": RUN, "motion": MODES}.get(walked.path.rpartition("/")[2], KEY)


_directory = tempfile.TemporaryDirectory(prefix="loa-crossings-")
_settings = Settings(data_directory=Path(_directory.name))
_keys = KeyFile(_settings.key_file)
_keys.add("first")  # before the service starts: it stays closed
APP: FastAPI = create_app(_settings, REGISTRY, works=False)
ROUTES = walked_routes(APP)
CLOSED = [walked for walked in ROUTES if walked.route.scope is not OPEN_TO_ALL]


@dataclass(frozen=True)
class Two:
    """A service with the job and the database of one project."""

    http: TestClient
    job: str
    """Identifier of the owner's job, which has ended."""
    keys: dict[str, str]
    """Access keys by what their holders are."""

    def send(self, who: str, walked: WalkedRoute, job: str = "", key: str = "") -> Response:
        names = {
            "job_id": job or self.job,
            "key": key or key_at(walked),
            "process_id": "fake",
            "name": "api.js",
        }
        return self.http.request(
            walked.method,
            walked.at(**names),
            json=BODIES.get(walked.route.name),
            headers={"Authorization": f"Bearer {self.keys[who]}"},
            follow_redirects=False,
        )


@pytest.fixture(scope="module")
def two():
    """The service with keys of two projects, and one key of each that is refused."""
    rights = {
        "owner": {"project": "axle"},
        "stranger": {"project": "drum"},
        "anybody": {},
        "expired": {"project": "axle", "expires": "1h"},
        "revoked": {"project": "axle"},
    }
    rights |= {f"no {s}": {"project": "axle", "scopes": [o for o in Scope if o != s]} for s in Scope}
    keys = {who: _keys.add(who.replace(" ", "-"), **of) for who, of in rights.items()}
    _keys.remove("revoked")
    _let_expire("expired")
    with TestClient(APP, raise_server_exceptions=False) as http:
        mine = APP.state.context.within("axle")
        mine.store.put(KEY, "database", _table("table.nc"))
        mine.store.put(RUN, "run", _table("table.nc"))
        mine.store.put(MODES, "modes", _table("table.nc"))
        job = mine.submissions.submit("fake", KEY, {"wish": {"text": "hidden"}}, stored=True).id
        yield Two(http, job, keys)


def _let_expire(name: str) -> None:
    content = json.loads(_settings.key_file.read_text())
    for entry in content["keys"]:
        if entry["name"] == name:
            entry["expires"] = (datetime.now(UTC) - timedelta(seconds=1)).isoformat()
    _settings.key_file.write_text(json.dumps(content))


def test_every_route_says_what_it_needs():
    assert len(ROUTES) > 35
    assert all(isinstance(walked.route, ScopedRoute) for walked in ROUTES)
    assert {walked.route.scope for walked in ROUTES} == {*Scope, OPEN_TO_ALL}


def test_a_route_that_says_nothing_cannot_be_defined():
    from fastapi import APIRouter  # noqa: PLC0415

    with pytest.raises(AttributeError, match="scope"):
        APIRouter(route_class=ScopedRoute).get("/forgotten")(lambda: None)


def test_what_is_open_to_all_is_what_no_key_is_asked_for():
    open_to_all = {walked.path for walked in ROUTES if walked.route.scope is OPEN_TO_ALL}
    assert open_to_all == {*OPEN_PATHS, f"{OPEN_FOLDER}{{name}}"}


@pytest.mark.law
def test_the_description_names_the_scopes():
    document = APP.openapi()
    for walked in ROUTES:
        operation = document["paths"].get(walked.path, {}).get(walked.method.lower())
        if operation is not None:
            scope = walked.route.scope
            assert operation["security"] == ([] if scope is None else [{"accessKey": [scope]}, {}])
    assert all(
        f"`{scope}`" in document["components"]["securitySchemes"]["accessKey"]["description"]
        for scope in Scope
    )


@pytest.mark.law
@pytest.mark.parametrize("walked", CLOSED, ids=str)
def test_a_missing_scope_is_refused_and_named(two, walked):
    scope = walked.route.scope
    refused = two.send(f"no {scope}", walked)
    assert (refused.status_code, refused.json()["type"]) == (403, MissingScope.type)
    assert f"the scope {scope};" in refused.json()["detail"]
    assert refused.headers["www-authenticate"] == f'Bearer error="insufficient_scope", scope="{scope}"'
    for other in set(Scope) - {scope, Scope.OPERATE}:  # to dismiss a job of others needs that too
        assert two.send(f"no {other}", walked).status_code != 403, other


@pytest.mark.parametrize("walked", CLOSED, ids=str)
def test_an_expired_and_a_revoked_key_are_refused(two, walked):
    expired, revoked = two.send("expired", walked), two.send("revoked", walked)
    assert (expired.status_code, expired.json()["type"]) == (401, KeyExpired.type)
    assert "has expired" in expired.json()["detail"]
    assert (revoked.status_code, revoked.json()["type"]) == (401, Unauthorised.type)
    assert (
        "invalid_token" in expired.headers["www-authenticate"]
        and "invalid_token" in revoked.headers["www-authenticate"]
    )


@pytest.mark.parametrize("who", ["stranger", "anybody"])
@pytest.mark.parametrize("walked", CLOSED, ids=str)
def test_nothing_of_another_project_is_found(two, walked, who):
    """Whatever its owner gets: a stranger gets what there is of no such thing, to the letter."""
    found, refused = two.send("owner", walked), two.send(who, walked)
    nothing = two.send(who, walked, job=NO_JOB, key=NO_KEY)
    if {"{job_id}", "{key}"} & set(walked.path.split("/")):
        assert found.status_code not in (401, 403, 404, 422), "the owner finds it"
        assert refused.status_code == NotFound.status
        assert _without(refused, two.job, key_at(walked)) == _without(nothing, NO_JOB, NO_KEY)
    else:
        assert two.job not in refused.text and KEY not in refused.text and "hidden" not in refused.text
        assert refused.status_code == found.status_code


def _without(answer: Response, job: str, key: str) -> str:
    return answer.text.replace(job, "JOB").replace(key, "KEY")


def test_lists_show_what_is_the_callers(two):
    """The walk above proves nothing of lists that are empty anyway."""
    lists = [walked for walked in CLOSED if walked.route.name in ("list_jobs", "list_databases")]
    shown = [two.send("owner", walked).text for walked in lists]
    assert two.job in shown[0] and KEY in shown[1]
    two.keys["newcomer"] = _keys.add("newcomer", project="new")
    for walked, field in zip(lists, ("jobs", "databases"), strict=True):
        assert two.send("newcomer", walked).json()[field] == []


def test_a_report_compares_nothing_with_another_projects(two):
    APP.state.context.within("drum").store.put(NO_KEY, "database", _table("other.nc"))
    (walked,) = [walked for walked in CLOSED if walked.path == "/v1/results/{key}/figures"]
    headers = {"Authorization": f"Bearer {two.keys['stranger']}"}
    answer = two.http.get(walked.at(key=NO_KEY), params={"against": KEY}, headers=headers)
    assert answer.status_code == 404 and KEY in answer.json()["detail"]


def _table(name: str) -> Path:
    file = _settings.data_directory / name
    small_table().to_netcdf(file)
    return file


def test_a_scene_takes_no_table_of_another_project(two):
    """Checked by the worker too: `tests/unit/service/test_projects.py`."""
    from lineofaction.gearbox.problems import BadInput  # noqa: PLC0415
    from lineofaction.gearbox.schemas.meshes import MeshInput  # noqa: PLC0415
    from service.worker.preparations import _check_source  # noqa: PLC0415

    mesh = MeshInput.model_construct(database_hash=KEY, case=None, case_file=None, database_file=None)
    _check_source("mesh", mesh, APP.state.context.within("axle").store)
    with pytest.raises(BadInput, match="the hash of a stored database"):
        _check_source("mesh", mesh, APP.state.context.within("drum").store)


def test_readiness_tells_nobody_how_much_there_is(two):
    assert two.http.get("/ready").json() == {"status": "ready"}


def test_a_job_of_others_in_the_project_is_theirs_to_dismiss_or_the_operators(two):
    headers = {
        who: {"Authorization": f"Bearer {two.keys[who]}"} for who in ("owner", "no operate", "no dismiss")
    }
    body = {"inputs": {"wish": {"mode": "hang"}}}

    def enter(who):
        return str(two.http.post(EXECUTION, json=body, headers=headers[who]).headers["location"])

    theirs, own = enter("owner"), enter("no operate")
    refused = two.http.delete(theirs, headers=headers["no operate"])
    assert (refused.status_code, refused.json()["type"]) == (403, MissingScope.type)
    assert two.http.get(theirs, headers=headers["owner"]).json()["status"] == "accepted"
    assert two.http.delete(own, headers=headers["no operate"]).json()["status"] == "dismissed"
    other = enter("no dismiss")
    assert two.http.delete(other, headers=headers["owner"]).json()["status"] == "dismissed", (
        "the operator may"
    )
    two.http.delete(theirs, headers=headers["owner"])
