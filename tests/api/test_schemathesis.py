"""The OpenAPI document holds for generated requests: no 500, answers as documented, bad data refused."""

from __future__ import annotations

import tempfile
from pathlib import Path

import cbor2
import schemathesis
from hypothesis import HealthCheck, settings
from service_stand_ins import REGISTRY

from service.app import create_app
from service.settings import Settings


@schemathesis.serializer("application/cbor")
def cbor(_context: schemathesis.SerializationContext, value: object) -> bytes:
    """Write a generated body as CBOR."""
    return cbor2.dumps(value)


_directory = tempfile.TemporaryDirectory(prefix="loa-api-")
app = create_app(Settings(data_directory=Path(_directory.name), queue_limit=10_000), REGISTRY)
schema = schemathesis.openapi.from_asgi("/openapi.json", app)


@schema.parametrize()
@settings(
    max_examples=12,
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.filter_too_much, HealthCheck.data_too_large],
)
def test_the_api_does_as_documented(case: schemathesis.Case) -> None:
    # what a schema allows may still be no feasible pair: a refusal of it is right
    case.call_and_validate(
        timeout=120.0, excluded_checks=[schemathesis.checks.CHECKS.get_one("positive_data_acceptance")]
    )
