"""The method of the client for a study: submit, wait, fetch."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Mapping
from inspect import Parameter, Signature
from typing import Any

from service.client.jobs import JobClient
from service.client.portable import inputs_of
from service.registry import JSON, Study


def study_method(study: Study) -> Callable[..., Any]:
    """Return the method of a study: submit, wait, and read the JSON or return the netCDF file."""
    signature = Signature(
        [
            Parameter("self", Parameter.POSITIONAL_ONLY),
            Parameter(study.argument, Parameter.POSITIONAL_OR_KEYWORD),
            *([Parameter("study", Parameter.POSITIONAL_OR_KEYWORD)] if study.from_file else []),
            Parameter("progress", Parameter.POSITIONAL_OR_KEYWORD, default=None),
            *([] if study.from_file else [Parameter("options", Parameter.VAR_KEYWORD)]),
        ]
    )

    def run(self: JobClient, *arguments: Any, **named: Any) -> Any:
        bound = signature.bind(self, *arguments, **named).arguments
        options = {
            name: _plain(value) for name, value in bound.get("study", bound.get("options", {})).items()
        }
        inputs = inputs_of(bound[study.argument]) | options
        result = self.obtain(study.name, inputs, bound.get("progress"))
        file = self.fetch_file(result.key, result.kind)
        return json.loads(file.read_bytes()) if study.media_type == JSON else file

    run.__name__ = study.package if study.media_type == JSON else f"{study.package}_file"
    run.__qualname__, run.__doc__ = f"Studies.{run.__name__}", _METHOD.format(study=study)
    run.__signature__ = signature  # type: ignore[attr-defined]
    return run


_METHOD = """{study.description}

        Submits, waits, and returns what ``loa {study.name} --json`` prints, or the path of the netCDF file.

        Parameters
        ----------
        {study.argument} : model, mapping or Path
        progress : callable, optional
            Called with every state seen.
        study or **options
            What is varied: as in the file of the verb, or its options by name. What is left out has its
            default.
        """


def _plain(value: Any) -> Any:
    """Return a value of JSON: any sequence as a list."""
    is_sequence = isinstance(value, Iterable) and not isinstance(value, str | Mapping)
    return list(value) if is_sequence else value
