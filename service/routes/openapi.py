"""The description of the API: what the framework writes, with an example for every body."""

from __future__ import annotations

from http import HTTPStatus
from typing import Any

from fastapi import FastAPI

from service.routes.errors import MEDIA_TYPE as PROBLEM
from service.routes.errors import PROBLEM_SCHEMA
from service.routes.events import EVENT_STREAM
from service.routes.media_types import CBOR, JSON
from service.schemas.answer_examples import answer_example, problem_example
from service.schemas.problem import ProblemBody
from service.schemas.request_examples import request_example

_REF = "#/components/schemas/{model}"
_SHOWN = (JSON, CBOR, EVENT_STREAM)


def install_description(app: FastAPI) -> None:
    """Let `app` describe itself with examples."""
    written = app.openapi

    def described() -> dict[str, Any]:
        """Return the description, made once."""
        fresh = app.openapi_schema is None
        document = written()
        if fresh:
            _add_examples(document)
        return document

    app.openapi = described  # type: ignore[method-assign]  # as the framework says to


def _add_examples(document: dict[str, Any]) -> None:
    """Put an example beside the schema of every body that can be shown as text; name the one error body."""
    _add_problem(document.setdefault("components", {}).setdefault("schemas", {}))
    for path, methods in document["paths"].items():
        for operation in methods.values():
            _show(operation.get("requestBody", {}).get("content", {}), request_example(path))
            for status, response in operation.get("responses", {}).items():
                content = response.get("content", {})
                if not status.startswith("2") and content.pop(JSON, None) is not None:
                    content.setdefault(PROBLEM, {})  # in place of the framework's own error body
                if status.startswith("2"):
                    _show(content, answer_example(path))
                elif PROBLEM in content:
                    shown = problem_example(int(status), HTTPStatus(int(status)).phrase)
                    content[PROBLEM] = {
                        "schema": {"$ref": PROBLEM_SCHEMA},
                        "example": shown,
                    }


def _add_problem(schemas: dict[str, Any]) -> None:
    """Add the schema of problems and of their parts."""
    problem = ProblemBody.model_json_schema(ref_template=_REF)
    schemas.update(problem.pop("$defs"))
    schemas["ProblemBody"] = problem
    for unused in ("HTTPValidationError", "ValidationError"):
        schemas.pop(unused, None)


def _show(content: dict[str, Any], example: Any) -> None:
    """Add an example to the bodies of a content."""
    for kind in _SHOWN:
        if kind in content and example is not None:
            content[kind] = {**content[kind], "example": example}
