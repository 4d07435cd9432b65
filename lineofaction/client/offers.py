"""The processes of a service as the client offers them: arguments, and readers of their results."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache, partial
from inspect import Parameter, Signature
from pathlib import Path
from typing import Any

from lineofaction.gearbox.loading import load
from lineofaction.gearbox.registry import STUDIES
from lineofaction.gearbox.study import Study

_SUBJECTS = "lineofaction.gearbox.subjects"
"""Module of the fields of a case, which the first call imports (start-up time)."""

_REMEDY = (
    "Results as objects need the libraries: pip uninstall lineofaction-client, pip install lineofaction. "
    "job.figures(), job.report() and job.file() do not."
)


@dataclass(frozen=True)
class Offer:
    """A process of the service, as the client offers it."""

    name: str
    """Name of the process on the service."""
    description: str
    signature: Signature
    """Signature of the client's calls."""
    subject: str
    """Kind of input that the process computes from: a case, a scene, or either."""
    read: Callable[[Path], Any]
    """Function from the path of a result's file to the result; it imports what it needs."""

    @property
    def attribute(self) -> str:
        """Name of the client's attribute."""
        return self.name.replace("-", "_")

    def inputs(self, *args: Any, **kwargs: Any) -> dict[str, Any]:
        """Return the inputs of a call as JSON.

        Raises TypeError: the call does not fit the signature; `BadInput`: an argument is refused.
        """
        try:
            bound = self.signature.bind(*args, **kwargs).arguments
        except TypeError as error:
            raise TypeError(f"{self.attribute}{self.signature}: {error}") from None
        subject = subject_inputs(self.subject, bound[next(iter(self.signature.parameters))])
        study = bound.get("study", bound.get("options", {}))
        study_fields: dict[str, Any] = load(f"{_SUBJECTS}:study_inputs")(study)
        return subject | study_fields


def subject_inputs(kind: str, subject: Any) -> dict[str, Any]:
    """Return a case, a scene, or an input that is either, as JSON; raises `BadInput`."""
    name = {"case": "case_inputs", "scene": "scene_inputs", "case or scene": "inputs_of"}[kind]
    inputs: dict[str, Any] = load(f"{_SUBJECTS}:{name}")(subject)
    return inputs


@contextmanager
def libraries() -> Iterator[None]:
    """Name the package to install where an import in the body fails.

    Raises `ModuleNotFoundError` with the package to install. `host.extras.MissingExtra`, which is one and
    names an extra, passes unchanged.
    """
    try:
        yield
    except ModuleNotFoundError as error:
        if type(error) is not ModuleNotFoundError:
            raise
        raise ModuleNotFoundError(f"{error.name} is not installed. {_REMEDY}", name=error.name) from None


def _read(module: str, kind: str, file: Path) -> Any:
    """Read a file as a class of a library, and import the library for it."""
    with libraries():
        result = load(f"{module}:{kind}")
    return result.from_netcdf(file)


def _signature(subject: str, *further: Parameter) -> Signature:
    return Signature([Parameter(subject, Parameter.POSITIONAL_OR_KEYWORD), *further])


def _study_offer(study: Study) -> Offer:
    if study.takes.from_file:
        default: Any = {} if study.takes.bare else Parameter.empty
        further = Parameter("study", Parameter.POSITIONAL_OR_KEYWORD, default=default)
    else:
        further = Parameter("options", Parameter.VAR_KEYWORD)

    def read(file: Path) -> Any:
        with libraries():
            stored = study.run.file
        return stored.read(file)

    signature = _signature(study.argument, further)
    return Offer(study.name, study.description, signature, study.takes.subject, read)


_DATABASE = partial(_read, "fe_contact.ste", "SteDatabase")
_RUN = partial(_read, "dynamics.results", "RunResult")
ANALYZE = Offer("analyze", "Compute the STE database of a case.", _signature("case"), "case", _DATABASE)
SIMULATE = Offer("simulate", "Compute the run of a scene.", _signature("scene"), "scene", _RUN)


@cache
def offers() -> Mapping[str, Offer]:
    """Return all processes by their names on the service."""
    return {offer.name: offer for offer in (ANALYZE, SIMULATE, *map(_study_offer, STUDIES.values()))}


def reader_of(process: str) -> Callable[[Path], Any]:
    """Return the reader of results of a process; results of an unknown process stay files."""
    return offers()[process].read if process in offers() else lambda file: file
