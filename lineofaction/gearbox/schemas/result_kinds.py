"""Results of the service: where they are, and of which kinds."""

from __future__ import annotations

from typing import TYPE_CHECKING

from lineofaction.gearbox.registry import STUDIES, study_of

if TYPE_CHECKING:
    from lineofaction.gearbox.schemas.figures import Figures

SUFFIX = ".nc"
"""Ending of their files, which are netCDF."""
RESULTS = "/v1/results"
"""Where results are on the service, before their hash."""


RESULT_KINDS = ("database", "run", *(study.kind for study in STUDIES.values()))
"""Kinds of results, by their names in the store and in the results of a job."""


def figures_model(kind: str) -> type[Figures]:
    """Return the model of the figures of a kind; those of an unknown one are not declared."""
    from lineofaction.gearbox.schemas.figures import Figures, RunFigures, TableFigures  # noqa: PLC0415 (start-up time)

    study = study_of(kind)
    models: dict[str, type[Figures]] = {"database": TableFigures, "run": RunFigures}
    models |= {} if study is None else {kind: study.answer}
    return models.get(kind, Figures)
