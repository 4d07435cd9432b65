"""What the links of the OpenAPI document promise: from a submission to state, events, results and dismissal.

Schemathesis walks them at random from bodies that start from feasible pairs. Nothing is computed.
"""

import os
from collections import Counter

import pytest
import schemathesis
from feasible_bodies import FeasibleBodies
from hypothesis import HealthCheck, Phase, settings
from running_service import until
from written_service import written_service

BODIES = int(os.environ.get("LOA_GENERATED_BODIES", "0"))
WALKS = max(BODIES // 100, 8)
SUBMITTED = ".*" if BODIES else "analyze"
"""Processes from whose submissions walks start: with every change one, as all have the same links."""
STEPS = 8
FOLLOWED = ("status", "events", "results", "dismiss")


@pytest.fixture(scope="module")
def service(tmp_path_factory):
    with written_service(tmp_path_factory.mktemp("links")) as running:
        yield running


@pytest.mark.law
def test_every_link_leads_to_what_it_says(service):
    schema = schemathesis.openapi.from_dict(service.description)
    schema.config.update(base_url=service.url)
    feasible = FeasibleBodies(service.description, {})
    walked: Counter[tuple[str, int]] = Counter()

    @schema.hook
    def before_generate_body(context, strategy):
        bodies = feasible.of(context.operation.path, context.operation.method)
        return strategy if bodies is None else bodies

    linked = schema.include(path_regex=rf"/{SUBMITTED}/execution$|^/v1/jobs/")

    class Walk(linked.as_state_machine()):
        """Walks along links; a job ends before the next step."""

        def get_call_kwargs(self, case):
            return {"headers": service.headers, "timeout": 60.0}

        def after_call(self, response, case):
            if response.status_code == 201:
                job = case.operation.schema["/v1/jobs/{job_id}"]["GET"]
                where = {"job_id": response.json()["jobID"]}
                until(lambda: self.ended(job.Case(path_parameters=where)))

        def ended(self, status):
            return status.call(**self.get_call_kwargs(status)).json()["finished"] is not None

        def step(self, taken):
            output = super().step(taken)
            if taken.transition is not None and taken.is_applied:
                link = taken.transition.id.split(" -> ")[1].rpartition(" ")[2]
                walked[link, output.response.status_code] += 1
            return output

        def validate_response(self, response, case, **options):
            refusals = schemathesis.checks.CHECKS.get_one("positive_data_acceptance")
            case.validate_response(response, excluded_checks=[refusals])

    Walk.run(
        settings=settings(
            max_examples=WALKS,
            stateful_step_count=STEPS,
            deadline=None,
            derandomize=True,
            database=None,
            phases=[Phase.generate],
            suppress_health_check=list(HealthCheck),
        )
    )
    assert all(walked[link, 200] for link in FOLLOWED), walked
