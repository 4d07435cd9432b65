"""What follows from a row of the registry: process, client method, verb, result kind, example of a study."""

from __future__ import annotations

import json
from inspect import signature
from typing import Any

import pytest
from click import Context
from typer.main import get_command

from lineofaction.cli.commands import app
from lineofaction.client import LineOfActionClient
from lineofaction.client.offers import offers
from lineofaction.gearbox.registry import STUDIES, Study, study_of
from lineofaction.gearbox.schemas.model import BoundaryModel
from lineofaction.gearbox.schemas.result_kinds import RESULT_KINDS
from lineofaction.gearbox.studies.computation import Computation
from lineofaction.report.document import stored_study
from lineofaction.report.presentation import Presentation, presentation_of
from service.schemas.examples import INPUTS
from service.worker.process import default_registry

LOA = get_command(app)
EVERY = pytest.mark.parametrize("study", STUDIES.values(), ids=list(STUDIES))


@EVERY
def test_it_has_its_parts(study: Study) -> None:
    assert issubclass(study.inputs, BoundaryModel)
    assert isinstance(study.run, Computation) and isinstance(presentation_of(study), Presentation)
    assert sum(share for _, share in study.stages) == pytest.approx(1.0)
    assert study_of(study.kind) is study


@EVERY
def test_its_process_takes_what_is_studied_and_what_is_varied(study: Study) -> None:
    process = default_registry()[study.name]
    subject = set(process.inputs.model_fields) - set(study.inputs.model_fields)
    assert subject == set(study.subject.split(" or "))
    assert process.kind == study.kind and study.kind in RESULT_KINDS
    process.inputs.model_validate_json(json.dumps(INPUTS[study.name]))  # the example is accepted


OF_LISTEN = {"run": "runs", "microphone_mm": "microphone"}
"""Options of the verb that is not made from its row: it takes several runs, and a position as text."""


@EVERY
def test_its_verb_has_an_option_for_everything_that_is_varied(study: Study) -> None:
    names = {option.name for option in LOA.get_command(Context(LOA), study.name).params}
    varied = {"study"} if study.from_file else set(study.inputs.model_fields)
    if study.name == "listen":
        varied = {OF_LISTEN.get(name, name) for name in varied}
    assert {study.argument, "output", "json", "strict"} | varied <= names


@EVERY
def test_the_client_has_a_process_that_says_what_it_takes(study: Study) -> None:
    with LineOfActionClient("http://127.0.0.1:9") as client:
        process = getattr(client, study.package)
    expected = "study" if study.from_file else "options"
    assert list(signature(process).parameters) == [study.argument, expected]
    assert process.__doc__ == study.description


def test_a_call_that_does_not_fit_is_told_what_would() -> None:
    with LineOfActionClient("http://127.0.0.1:9") as client:
        calls: Any = client
        for wrong in (
            lambda: calls.flank({}, 60.0),
            calls.flank.submit,
            lambda: calls.analyze({}, x=1),
        ):
            with pytest.raises(TypeError, match=r"^(flank\(case, \*\*options\)|analyze\(case\)): "):
                wrong()


def test_the_client_has_the_processes_of_the_service_and_no_others() -> None:
    processes = default_registry()
    assert list(offers()) == list(processes)
    for name, offer in offers().items():
        subject, *_ = offer.signature.parameters
        known = set(processes[name].inputs.model_fields)
        assert {subject} <= known or (subject == "subject" and {"case", "scene"} <= known)


@EVERY
def test_its_files_are_known_from_those_of_others(study: Study) -> None:
    file = study.run.file
    assert file.values
    assert all(stored_study({file.attribute: value, "title": "any"}) is study for value in file.values)
    assert stored_study({file.attribute: "something else"}) is None
