"""Results of the service: where they are, and of which kinds."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from lineofaction.gearbox.registry import STUDIES, study_of

if TYPE_CHECKING:
    from lineofaction.gearbox.schemas.figures import Figures

SUFFIX = ".nc"
"""Ending of their files, which are netCDF."""
HASH = "^[0-9a-f]{64}$"
"""Pattern of their names, which are content hashes."""
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


def figures_model(kind: str) -> type[Figures]:
    """Return the model of the figures of a kind; those of an unknown one are not declared."""
    from lineofaction.gearbox.schemas.figures import Figures, RunFigures, TableFigures  # noqa: PLC0415 (start-up time)

    study = study_of(kind)
    models: dict[str, type[Figures]] = {"database": TableFigures, "run": RunFigures}
    models |= {} if study is None else {kind: study.answer}
    return models.get(kind, Figures)
