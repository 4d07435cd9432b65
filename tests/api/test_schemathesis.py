"""The OpenAPI document holds for generated requests: no 500, answers as documented, bad data refused.

With every change: some requests of every operation, but for plans and live questions, which have a worker of
their own, to a service whose processes are fakes. With `LOA_GENERATED_BODIES` (scripts/nightly, in one
process): at least so many bodies in one run, right and wrong, to all processes, plans, live questions and
force queries of a table that exists, with an access key; counts in out/generated_bodies.json.
"""

from __future__ import annotations

import json
import os
import tempfile
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import cbor2
import pytest
import schemathesis
from hypothesis import HealthCheck, given, settings
from schemathesis.core import NotSet
from service_fakes import REGISTRY
from whole_service import WholeService, whole_service

from service.app import create_app
from service.settings import Settings

BODIES = int(os.environ.get("LOA_GENERATED_BODIES", "0"))


@schemathesis.serializer("application/cbor")
def cbor(_context: schemathesis.SerializationContext, value: object) -> bytes:
    """Write a generated body as CBOR."""
    return cbor2.dumps(value)


_directory = tempfile.TemporaryDirectory(prefix="loa-api-")


def _service() -> WholeService:
    """Return the service that is asked."""
    if BODIES:
        return whole_service(Path(_directory.name))
    fakes = create_app(Settings(data_directory=Path(_directory.name), queue_limit=10_000), REGISTRY)
    return WholeService(fakes, {}, "", "")


service = _service()
schema = schemathesis.openapi.from_asgi("/openapi.json", service.app, headers=service.headers)
FEW = 8
sent: Counter[str] = Counter()

if BODIES:

    @schema.hook
    def map_path_parameters(_context: Any, path_parameters: Any) -> Any:
        """Name what is there, half of the time."""
        return path_parameters and service.existing(path_parameters)


def as_long_as(examples: int) -> settings:
    """Return the settings of a run of so many examples of each operation."""
    slow = [HealthCheck.too_slow, HealthCheck.filter_too_much, HealthCheck.data_too_large]
    return settings(
        max_examples=examples,
        deadline=None,
        derandomize=not BODIES,
        database=None,
        suppress_health_check=slow,
    )


@pytest.fixture(scope="module", autouse=True)
def _ended() -> Iterator[None]:
    """End the live worker."""
    yield
    service.app.state.context.live.stop()


@pytest.fixture(autouse=True)
def _counted() -> Iterator[None]:
    """Keep the counts so far."""
    yield
    if BODIES:
        Path("out").mkdir(exist_ok=True)
        Path("out/generated_bodies.json").write_text(json.dumps(dict(sorted(sent.items())), indent=1))


def checked(case: schemathesis.Case) -> None:
    """Send a request and check the answer by everything the document says."""
    # what a schema allows may still be no feasible pair: a refusal of it is right
    answer = case.call_and_validate(
        timeout=120.0,
        headers=service.headers,
        excluded_checks=[schemathesis.checks.CHECKS.get_one("positive_data_acceptance")],
    )
    if not isinstance(case.body, NotSet):
        sent["bodies"] += 1
        sent[f"{case.operation.label} {answer.status_code}"] += 1


if BODIES:  # items of the plugin have one name for all operations: xdist would run the first alone
    with_body, without_body = schema.include(method="POST"), schema.exclude(method="POST")
    each = -(-BODIES // sum(1 for _ in with_body.get_all_operations()))

    @with_body.parametrize()
    @as_long_as(each)
    def test_what_is_sent_is_answered_as_documented(case: schemathesis.Case) -> None:
        checked(case)

    @without_body.parametrize()
    @as_long_as(FEW)
    def test_what_is_asked_is_answered_as_documented(case: schemathesis.Case) -> None:
        checked(case)

    def test_so_many_bodies_were_sent() -> None:
        assert sent["bodies"] >= BODIES

else:
    live = ("/v1/plans", "/v1/databases/{key}/ste")
    operations = [found.ok() for found in schema.get_all_operations()]

    @pytest.mark.parametrize(
        "operation",
        [one for one in operations if one.path not in live],
        ids=lambda operation: operation.label,
    )
    def test_a_request_is_answered_as_documented(operation: schemathesis.schemas.APIOperation) -> None:
        @as_long_as(FEW)
        @given(operation.as_strategy())
        def answered(case: schemathesis.Case) -> None:
            checked(case)

        answered()
