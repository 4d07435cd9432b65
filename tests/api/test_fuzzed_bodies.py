"""Right bodies, nudged or spoiled at random: never a defect, every refusal a problem that says what is wrong.

A few with every change, 10 000 at night. No worker runs what is accepted. Plans and live questions have a
worker of their own: they are asked at night, of an analyzed pair.
"""

import copy
import json
import random
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import cbor2
import numpy as np
import pytest
from fastapi.testclient import TestClient
from small_table import small_table
from whole_service import whole_service

from service.app import create_app
from service.schemas.answer_examples import HASH
from service.schemas.examples import BODIES, INPUTS, QUERY
from service.settings import Settings

QUERIES, RENAMED = "/v1/databases/{key}/query", "/v1/jobs/{job_id}"
MOVED = {"torque_n_m": [0.5], "pinion": {"tip_relief_um": 3.0}}
LIVE: dict[str, Any] = {"/v1/plans": {}, "/v1/databases/{key}/ste": MOVED}
LIVE |= {"/v1/drafts/plan": {}, "/v1/drafts/{key}/ste": MOVED}
TARGETS: dict[str, Any] = {
    f"/v1/processes/{name}/execution": {"inputs": given} for name, given in INPUTS.items()
}
TARGETS |= {path: body for path, body in BODIES.items() if path not in LIVE}
LIVE_TARGETS = {path: BODIES[path] | changed for path, changed in LIVE.items()}
ODD: tuple[Any, ...] = (
    *(None, True, False, 0, 1, -1, 2, 3, 1e-300, 1e308, -1e308, 2**53, 10**30, -0.0, 0.1, 1e6),
    *(float("nan"), float("inf"), "", "on", "auto", "\x00", "\ud800", "x" * 300, "../../etc/passwd"),
    *([], [0], [0, 0], [[]], {}, {"": 0}, {"x": {"y": []}}, [None], ["a"], "1", "1e5"),
)


NUDGED = 0.2
"""Share of the bodies that stay right, or nearly so."""


@dataclass(frozen=True)
class Target:
    """A caller of an app that has a table, and the hash of that."""

    http: TestClient
    key: str


@pytest.fixture
def target(tmp_path):
    """An app whose scheduler does not run."""
    app = create_app(Settings(data_directory=tmp_path, queue_limit=100_000))
    file = tmp_path / "table.nc"
    small_table().to_netcdf(file)
    app.state.context.store.put(HASH, "database", file)
    return Target(TestClient(app, raise_server_exceptions=False), HASH)


@pytest.fixture
def whole(tmp_path):
    """One whose plans and live questions are answered."""
    found = whole_service(tmp_path)
    yield Target(TestClient(found.app, raise_server_exceptions=False, headers=found.headers), found.key)
    found.app.state.context.live.stop()


def places(value: Any, path: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    inner = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    return [path, *(deeper for key, part in inner for deeper in places(part, (*path, key)))]


def spoiled(chance: random.Random, body: Any) -> Any:
    """Return a copy of a body with one to three parts changed, dropped, doubled or renamed."""
    found = copy.deepcopy(body)
    for _ in range(chance.randint(1, 3)):
        *way, last = chance.choice(places(found)[1:] or [("nothing",)])
        holder = found
        for key in way:
            holder = holder[key]
        if isinstance(holder, dict):
            _spoil_table(chance, holder, last)
        elif isinstance(holder, list):
            _spoil_list(chance, holder, last)
    return found


def _spoil_table(chance: random.Random, table: dict[Any, Any], key: Any) -> None:
    deed = chance.choice(("odd", "odd", "near", "drop", "rename", "add"))
    if deed == "near" and isinstance(table.get(key), int | float):
        table[key] = table[key] * chance.choice((-1, 0, 0.5, 0.99, 1.01, 2, 10, 1000))
    elif deed == "drop":
        table.pop(key, None)
    elif deed == "rename":
        table[chance.choice((f"{key}_um", str(key)[:-1], "", "\x00"))] = table.pop(key, None)
    elif deed == "add":
        table[chance.choice(("misalignment_um", "effects", "accuracy", "unknown"))] = copy.deepcopy(
            chance.choice(ODD)
        )
    else:
        table[key] = copy.deepcopy(chance.choice(ODD))


def _spoil_list(chance: random.Random, values: list[Any], index: int) -> None:
    deed = chance.choice(("odd", "drop", "double", "turn", "many"))
    if deed == "odd":
        values[index] = copy.deepcopy(chance.choice(ODD))
    elif deed == "drop":
        del values[index]
    elif deed == "double":
        values.insert(index, copy.deepcopy(values[index]))
    elif deed == "turn":
        values.reverse()
    else:
        values.extend(values * chance.randint(1, 50))


def nudged(chance: random.Random, body: Any) -> Any:
    """Return a copy of a body with a thousandth more or less of one of its numbers: mostly still right."""
    found = copy.deepcopy(body)
    ways = [way for way in places(found) if isinstance(_at(found, way), float)]
    if ways:
        *way, last = chance.choice(ways)
        _at(found, way)[last] *= chance.choice((0.999, 1.001))
    return found


def _at(body: Any, way: Sequence[Any]) -> Any:
    for key in way:
        body = body[key]
    return body


def encoded(chance: random.Random, path: str, body: Any) -> tuple[bytes, str]:
    """Return a body in an encoding: one in five nudged, the others spoiled, at times in their bytes too."""
    if chance.random() < NUDGED:
        return json.dumps(nudged(chance, body)).encode(), "application/json"
    kinds = ("application/json", "application/cbor", "application/octet-stream")
    kind = chance.choice(kinds) if path == QUERIES else kinds[0]
    if kind == kinds[2]:
        content = np.array([chance.choice((0.1, 5.0, np.nan, 1e9)) for _ in range(8)]).tobytes()
    elif kind == kinds[1]:
        content = cbor2.dumps(_without_surrogates(spoiled(chance, body)))
    else:
        content = json.dumps(spoiled(chance, body)).encode()
    if content and chance.random() < 0.15:
        place = chance.randrange(len(content))
        content = (
            content[:place] + bytes([chance.randrange(256)]) * chance.randint(0, 9) + content[place + 1 :]
        )
    return content, kind


def _without_surrogates(value: Any) -> Any:
    """Return what CBOR can hold."""
    return json.loads(json.dumps(value).replace("\\ud800", "?"))


@pytest.mark.law
def test_no_spoiled_body_is_a_defect(target):
    check_answers(150, target, TARGETS)


@pytest.mark.nightly
def test_none_of_ten_thousand_is_a_defect(whole):
    statuses = check_answers(10_000, whole, TARGETS | LIVE_TARGETS)
    Path("out").mkdir(exist_ok=True)
    Path("out/fuzzed_bodies.json").write_text(json.dumps(dict(sorted(statuses.items()))))


def check_answers(count: int, target: Target, targets: dict[str, Any]) -> Counter[int]:
    """Send so many bodies, check their answers and count these by status.

    Accepted are at least half as many as are nudged, and refused as 422 at least half as many as are spoiled.
    """
    chance, statuses = random.Random(20261120), Counter[int]()
    for number in range(count):
        path, body = chance.choice([*targets.items(), (QUERIES, QUERY)])
        content, kind = encoded(chance, path, body)
        answer = target.http.request(
            "PATCH" if path == RENAMED else "POST",
            path.replace("{key}", target.key),
            content=content,
            headers={"Content-Type": kind},
        )
        statuses[answer.status_code] += 1
        told = f"body {number} to {path}: {content!r} -> {answer.text[:500]}"
        late = answer.status_code == 503 and answer.json()["type"].endswith(":live-unavailable")
        assert answer.status_code in (200, 201, 400, 404, 413, 422) or (
            late and answer.headers["retry-after"]
        ), told
        if answer.status_code >= 400:
            assert answer.headers["content-type"] == "application/problem+json", told
            assert answer.json()["detail"], told
    assert sum(statuses.values()) == count
    assert statuses[200] + statuses[201] > 0.5 * NUDGED * count, statuses
    assert statuses[422] > 0.5 * (1.0 - NUDGED) * count, statuses
    return statuses
