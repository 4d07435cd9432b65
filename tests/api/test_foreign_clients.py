"""Clients of others run every process from submission to result, with an access key.

They are generated from the description (openapi-python-client), or written for the standard (OWSLib). Nothing
is computed, but inputs and their checks are those of the service; at night all processes compute, of small
inputs.
"""

import importlib
import json
import subprocess
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import h5netcdf
import pytest
from owslib.ogcapi.processes import Processes
from running_service import until
from small_inputs import small_inputs
from written_service import Service, running_service, written_service

from lineofaction.client import LineOfActionClient
from lineofaction.gearbox.registry import NETCDF
from lineofaction.report.document import stored_study
from service.routes.media_types import RAW, WAV
from service.schemas.answers import class_name
from service.schemas.examples import INPUTS
from service.worker.process import default_registry

Json = dict[str, Any]

GENERATOR = Path(sys.prefix) / "generator" / "bin" / "openapi-python-client"
PACKAGE = "generated_client"
CONFIG = {
    "content_type_overrides": dict.fromkeys(("application/cbor", NETCDF, WAV), RAW),
    "post_hooks": [],
}


@pytest.fixture(scope="module")
def service(tmp_path_factory):
    with written_service(tmp_path_factory.mktemp("foreign")) as running:
        yield running


@pytest.fixture(scope="module")
def generated(service, tmp_path_factory):
    """The client that is generated from the description; a warning of the generator is an error."""
    if not GENERATOR.exists():
        pytest.skip("no openapi-python-client on this machine: scripts/test installs it")
    folder = tmp_path_factory.mktemp("generated")
    (folder / "openapi.json").write_text(json.dumps(service.description))
    (folder / "config.json").write_text(json.dumps(CONFIG))
    arguments = ("--path", "openapi.json", "--config", "config.json", "--output-path", PACKAGE)
    command = (GENERATOR, "generate", *arguments, "--meta", "none")
    ended = subprocess.run(
        [*command, "--fail-on-warning"], cwd=folder, check=False, capture_output=True, text=True
    )
    assert ended.returncode == 0, ended.stdout + ended.stderr
    with pytest.MonkeyPatch.context() as patched:
        patched.syspath_prepend(folder)
        yield importlib.import_module(PACKAGE)


def part(name: str) -> ModuleType:
    return importlib.import_module(f"{PACKAGE}.{name}")


def test_every_process_is_run():
    assert set(INPUTS) == set(default_registry())


def run_by_generated_client(service: Service, generated: ModuleType, process: str, inputs: Json) -> Json:
    """Run a process from submission to the file of its result; return the attributes of that."""
    models, name = part("models"), class_name(process)
    with generated.AuthenticatedClient(service.url, service.key, raise_on_unexpected_status=True) as client:
        body = getattr(models, f"Execute{name}").from_dict({"inputs": inputs})
        job = part(f"api.processes.{process.replace('-', '_')}").sync(client=client, body=body)
        assert isinstance(job, models.StatusInfo), job
        state = part("api.jobs.job_status")
        until(lambda: state.sync(job.job_id, client=client).finished is not None)
        ended = state.sync(job.job_id, client=client)
        assert ended.status == "successful", ended.message
        document = part("api.jobs.job_results").sync(job.job_id, client=client)
        assert type(document) is getattr(models, f"{name}Results")
        ((output, reference),) = document.to_dict().items()
        file = part("api.results.result_file").sync(reference["hash"], client=client)
        assert output == default_registry()[process].output
        with h5netcdf.File(file.payload) as content:
            return dict(content.attrs)


def check_run_by_owslib(service: Service, process: str, inputs: Json) -> None:
    """Run a process from submission to the address of its result."""
    owslib = Processes(f"{service.url}/v1/", headers=service.headers)
    assert process in [summary["id"] for summary in owslib.processes()]
    assert owslib.process(process)["outputs"]
    job = owslib.execute(process, inputs, async_=True)
    until(lambda: owslib._request(path=f"jobs/{job['jobID']}")["finished"] is not None)
    (reference,) = owslib._request(path=f"jobs/{job['jobID']}/results").values()
    assert reference["type"] == NETCDF


@pytest.mark.law
@pytest.mark.drawn
@pytest.mark.parametrize("process", INPUTS)
def test_a_generated_client_runs_a_process(service, generated, process):
    attributes = run_by_generated_client(service, generated, process, INPUTS[process])
    assert attributes["kind"] == default_registry()[process].kind


def test_a_generated_client_reads_a_refusal(service, generated):
    with generated.AuthenticatedClient(service.url, "no key", raise_on_unexpected_status=True) as stranger:
        problem = part("api.jobs.list_jobs").sync(client=stranger)
    assert (type(problem), problem.status) == (part("models").ProblemBody, 401)


@pytest.mark.law
@pytest.mark.drawn
@pytest.mark.parametrize("process", INPUTS)
def test_owslib_runs_a_process(service, process):
    check_run_by_owslib(service, process, INPUTS[process])


@pytest.fixture(scope="module")
def working(tmp_path_factory):
    with running_service(tmp_path_factory.mktemp("working"), default_registry()) as running:
        yield running


@pytest.mark.nightly
@pytest.mark.parametrize("process", INPUTS)
def test_foreign_clients_get_what_is_computed(working, generated, process):
    inputs = small_inputs(process)
    if process == "listen":
        with LineOfActionClient(working.url, key=working.key) as client:
            inputs["run"] = client.obtain("simulate", {"scene": inputs["scene"]}).key
    attributes = run_by_generated_client(working, generated, process, inputs)
    study = stored_study(attributes)
    assert process == (("simulate" if "schema" in attributes else "analyze") if study is None else study.name)
    check_run_by_owslib(working, process, inputs)
