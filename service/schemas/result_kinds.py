"""Kinds of results: where the service answers for each, and what its files are."""

from __future__ import annotations

from dataclasses import dataclass

NETCDF = "application/x-netcdf"
JSON = "application/json"
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
        ResultKind("flanks", "/v1/flanks"),
        ResultKind("run", "/v1/runs"),
        ResultKind("sensitivity", "/v1/sensitivities"),
        ResultKind("ablation", "/v1/ablations", JSON),
        ResultKind("frontier", "/v1/frontiers", JSON),
        ResultKind("optimisation", "/v1/optimisations", JSON),
        ResultKind("scatter", "/v1/scatters", JSON),
        ResultKind("modes", "/v1/modes"),
        ResultKind("response", "/v1/responses"),
        ResultKind("steady", "/v1/steadies"),
    )
}


def suffix_of_type(media_type: str) -> str:
    """Return the ending of files of a media type."""
    return _SUFFIXES[media_type]


def suffix_of(kind: str) -> str:
    """Return the ending of the files of a kind; of one that is not known, that of netCDF."""
    known = RESULT_KINDS.get(kind)
    return _SUFFIXES[NETCDF] if known is None else known.suffix
