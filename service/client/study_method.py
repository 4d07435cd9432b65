"""The methods of the client for a study: submit, wait, fetch."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from inspect import Parameter, Signature
from typing import Any

from service.client.jobs import JobClient
from service.client.portable import inputs_of
from service.registry import Study

FORMS: dict[str, tuple[str, Callable[[JobClient, str, str], Any]]] = {
    "": ("the figures, as ``loa {study.name} --json`` prints them", JobClient.fetch_figures),
    "_file": ("the path of the netCDF file", JobClient.fetch_file),
}
"""What the methods of a study return, by how their names end."""


def study_method(study: Study, ending: str) -> Callable[..., Any]:
    """Return a method of a study: submit, wait, and fetch in the form of `FORMS`."""
    words, fetch = FORMS[ending]
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
        return fetch(self, result.key, result.kind)

    run.__name__ = f"{study.package}{ending}"
    run.__qualname__ = f"Studies.{run.__name__}"
    run.__doc__ = _METHOD.format(study=study, returned=words.format(study=study))
    run.__signature__ = signature  # type: ignore[attr-defined]
    return run


_METHOD = """{study.description}

        Submits, waits, and returns {returned}.

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
