"""Kinds of results: where the service answers for each, and what its files are."""

from __future__ import annotations

from dataclasses import dataclass

from service.registry import JSON, NETCDF, STUDIES

_SUFFIXES = {NETCDF: ".nc", JSON: ".json"}


@dataclass(frozen=True)
class ResultKind:
    """One kind of results.

    Attributes
    ----------
    name : str
        In the store and in the results of a job.
    path : str
        Where they are on the service, before the hash.
    media_type : str
        Of their files.
    """

    name: str
    path: str
    media_type: str = NETCDF

    @property
    def suffix(self) -> str:
        """Ending of their files."""
        return suffix_of_type(self.media_type)


RESULT_KINDS: dict[str, ResultKind] = {
    kind.name: kind
    for kind in (
        ResultKind("database", "/v1/databases"),
        ResultKind("run", "/v1/runs"),
        *(ResultKind(row.kind, f"/v1/{row.collection}", row.media_type) for row in STUDIES.values()),
    )
}


def suffix_of_type(media_type: str) -> str:
    """Return the ending of files of a media type."""
    return _SUFFIXES[media_type]


def suffix_of(kind: str) -> str:
    """Return the ending of the files of a kind; of one that is not known, that of netCDF."""
    known = RESULT_KINDS.get(kind)
    return _SUFFIXES[NETCDF] if known is None else known.suffix
