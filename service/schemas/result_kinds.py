"""Results of the service: where they are, and of which kinds."""

from __future__ import annotations

from dataclasses import dataclass

from service.registry import STUDIES

SUFFIX = ".nc"
"""Ending of their files, which are netCDF."""
RESULTS = "/v1/results"
"""Where results are on the service, before their hash."""


@dataclass(frozen=True)
class ResultKind:
    """One kind of results.

    Attributes
    ----------
    name : str
        In the store and in the results of a job.
    collection : str
        Under which version 0.1 had them, ``/v1/COLLECTION/HASH``, which redirects; empty: it had none.
    """

    name: str
    collection: str = ""


RESULT_KINDS: dict[str, ResultKind] = {
    kind.name: kind
    for kind in (
        ResultKind("database", "databases"),
        ResultKind("run", "runs"),
        *(ResultKind(row.kind, row.collection) for row in STUDIES.values()),
    )
}
