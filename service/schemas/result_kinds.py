"""Results of the service: where they are, and what the files of their kinds are."""

from __future__ import annotations

from dataclasses import dataclass

from service.registry import JSON, NETCDF, STUDIES

_SUFFIXES = {NETCDF: ".nc", JSON: ".json"}


RESULTS = "/v1/results"
"""Where results are on the service, before their hash."""


@dataclass(frozen=True)
class ResultKind:
    """One kind of results.

    Attributes
    ----------
    name : str
        In the store and in the results of a job.
    media_type : str
        Of their files.
    collection : str
        Under which version 0.1 had them, ``/v1/COLLECTION/HASH``, which redirects; empty: it had none.
    """

    name: str
    media_type: str = NETCDF
    collection: str = ""

    @property
    def suffix(self) -> str:
        """Ending of their files."""
        return suffix_of_type(self.media_type)


RESULT_KINDS: dict[str, ResultKind] = {
    kind.name: kind
    for kind in (
        ResultKind("database", collection="databases"),
        ResultKind("run", collection="runs"),
        *(ResultKind(row.kind, row.media_type, row.collection) for row in STUDIES.values()),
    )
}


def suffix_of_type(media_type: str) -> str:
    """Return the ending of files of a media type."""
    return _SUFFIXES[media_type]


def suffix_of(kind: str) -> str:
    """Return the ending of the files of a kind; of one that is not known, that of netCDF."""
    known = RESULT_KINDS.get(kind)
    return _SUFFIXES[NETCDF] if known is None else known.suffix
