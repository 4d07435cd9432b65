"""The OpenAPI document holds for generated requests: no 500, answers as documented, bad data refused.

Bodies start from feasible pairs (`feasible_bodies`), so that most of them pass validation; every fifth
breaks its schema; some are drawn from the description alone, as any generator draws them. Nothing that is
submitted is worked on. With every change: some requests of every operation, and of a fifth of them bodies of
the other kinds, but for plans and live questions, which have a worker of their own. With
`LOA_GENERATED_BODIES` (scripts/nightly, in one process): at least so many bodies in one run, to plans, live
questions and force queries of a table that exists too, with an access key; counts, and what was refused why,
in out/generated_bodies.json.
"""

import json
import os
import re
import tempfile
from collections import Counter
from pathlib import Path
from typing import Any

import cbor2
import pytest
import schemathesis
from described_api import DESCRIPTION
from feasible_bodies import FeasibleBodies
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st
from schemathesis import GenerationMode
from schemathesis.core import NotSet
from schemathesis.hooks import HookDispatcher, HookScope
from whole_service import WholeService, stored, whole_service

from service.app import create_app
from service.schemas.examples import request_example
from service.settings import Settings
from service.worker.process import default_registry

Operation = schemathesis.schemas.APIOperation

BODIES = int(os.environ.get("LOA_GENERATED_BODIES", "0"))
FEW = 20
DRAFTS = "/v1/drafts/"
LIVE = ("/v1/plans", f"{DRAFTS}plan", "/v1/databases/{key}/ste", f"{DRAFTS}{{key}}/ste")
MOVED = {"torque_n_m": [0.5], "pinion": {"tip_relief_um": 3.0, "tip_relief_length_mm": 0.4}}
EXAMPLES: dict[str, Any] = dict.fromkeys(LIVE[2:], MOVED)


@schemathesis.serializer("application/cbor")
def cbor(_context: schemathesis.SerializationContext, value: object) -> bytes:
    return cbor2.dumps(value)


_directory = tempfile.TemporaryDirectory(prefix="loa-api-")


def _service() -> WholeService:
    if BODIES:
        return whole_service(Path(_directory.name))
    app = create_app(Settings(data_directory=Path(_directory.name), queue_limit=100_000), works=False)
    return WholeService(app, {}, "", "")


def _of_a_run() -> dict[str, Any]:
    """Return what names a stored run, with one that is there."""
    simulate, listen = (f"/v1/processes/{process}/execution" for process in ("simulate", "listen"))
    run, _ = stored(Path(_directory.name), "simulate", request_example(simulate), "run")
    example = request_example(listen)
    return {listen: {"inputs": example["inputs"] | {"run": run}}}


EXAMPLES |= _of_a_run() if BODIES else {}
service = _service()
schema = schemathesis.openapi.from_dict(DESCRIPTION)
schema.app = service.app
rejected = schema.config.checks.negative_data_rejection
rejected.expected_statuses = [*rejected.expected_statuses, "413"]  # too large before it is read
feasible = FeasibleBodies(DESCRIPTION, EXAMPLES)
right = HookDispatcher(scope=HookScope.TEST)
sent: Counter[str] = Counter()
asked: set[str] = set()
refused: Counter[str] = Counter()


@right.hook
def before_generate_body(context: Any, strategy: st.SearchStrategy[Any]) -> st.SearchStrategy[Any]:
    """Start from feasible pairs."""
    bodies = feasible.of(context.operation.path, context.operation.method)
    return strategy if bodies is None else bodies


if BODIES:

    @schema.hook
    def map_path_parameters(_context: Any, path_parameters: Any) -> Any:
        """Name what is there, half of the time."""
        return path_parameters and service.existing(path_parameters)


operations = [found.ok() for found in schema.get_all_operations()]
chosen = [one for one in operations if BODIES or one.path not in LIVE]
with_body = [one for one in chosen if one.body]
EACH = -(-11 * BODIES // (10 * len(with_body)))
"""Bodies of an operation; a tenth may be alike."""


def parametrized(some: list[Operation]) -> pytest.MarkDecorator:
    """Return the mark of a test of each of some operations."""
    return pytest.mark.parametrize("operation", some, ids=[one.label for one in some])


def as_long_as(examples: int) -> settings:
    """Return the settings of a run of so many examples of each operation."""
    return settings(
        max_examples=examples,
        deadline=None,
        derandomize=not BODIES,
        database=None,
        phases=[Phase.generate, Phase.shrink],
        suppress_health_check=list(HealthCheck),
    )


@pytest.fixture(scope="module", autouse=True)
def _ended():
    yield
    service.app.state.context.stop_waiting()  # warm processes of readers and workers, too


@pytest.fixture(autouse=True)
def _counted():
    """Keep the counts so far."""
    yield
    if BODIES:
        Path("out").mkdir(exist_ok=True)
        counts = {"sent": dict(sorted(sent.items())), "refused": dict(refused.most_common())}
        Path("out/generated_bodies.json").write_text(json.dumps(counts, indent=1))


def check_described(case: schemathesis.Case) -> None:
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
        for fault in answer.json()["errors"][:1] if answer.status_code == 422 else ():
            refused[f"{case.operation.label} {kind_of(fault)}"] += 1


def kind_of(fault: dict[str, Any]) -> str:
    """Return field and bound of a fault without their numbers."""
    return re.sub(r"-?\d[\d.e+-]*", "#", f"{fault['field']}: {fault['bound']}")


@pytest.mark.drawn
@parametrized(chosen)
def test_a_request_is_answered_as_documented(operation):
    @as_long_as(max(EACH * 4 // 5, FEW))
    @given(operation.as_strategy(hooks=right))
    def check_answer(case):
        if case.headers:  # drawn twice, it would be the name of another request
            case.headers.pop("Idempotency-Key", None)
        check_described(case)

    check_answer()
    asked.add(operation.label)


@pytest.mark.drawn
@parametrized([one for one in with_body if not one.path.startswith(DRAFTS)])  # there faults are an answer
def test_a_body_that_breaks_its_schema_is_answered_as_documented(operation):
    @as_long_as(max(-(-EACH // 5), FEW // 5))
    @given(operation.as_strategy(generation_mode=GenerationMode.NEGATIVE))
    def check_answer(case):
        check_described(case)

    check_answer()


EXECUTIONS = [f"POST /v1/processes/{process}/execution" for process in default_registry()]


def accepted(*labels: str) -> float:
    """Return the share of accepted bodies, right and wrong ones."""
    count = sum(number for name, number in sent.items() if name.rpartition(" ")[0] in labels)
    return sum(sent[f"{label} 201"] for label in labels) / count


def test_at_least_half_of_the_bodies_are_accepted():
    if left := set(EXECUTIONS) - asked:
        pytest.skip(f"{len(left)} processes are left to the night, and with them their right bodies")
    assert accepted(*EXECUTIONS) >= 0.5
    few = {label: accepted(label) for label in EXECUTIONS if BODIES}
    assert all(share >= 0.5 for share in few.values()), few


def test_so_many_bodies_were_sent():
    assert sent["bodies"] >= BODIES


@pytest.mark.drawn
@parametrized(with_body)
def test_a_body_drawn_from_the_description_alone_is_answered_as_documented(operation):
    """Last, as most of these are refused: they are not among those of which half are accepted."""

    @as_long_as(max(EACH // 5, FEW // 5))
    @given(operation.as_strategy())
    def check_answer(case):
        check_described(case)

    check_answer()
