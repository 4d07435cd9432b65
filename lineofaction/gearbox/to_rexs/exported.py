"""A REXS document with the results of its stages."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from fe_contact.ste import SteDatabase
from lineofaction.gearbox.convert.case import gear_pair
from lineofaction.gearbox.from_rexs.stage_case import StageCase
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.rexs import Attribute, Document, upgrade
from lineofaction.gearbox.schemas import Case
from lineofaction.gearbox.schemas.reading import validated
from lineofaction.gearbox.to_rexs.calculated import with_calculated
from lineofaction.gearbox.to_rexs.stage_results import stage_results


def exported(
    document: Document,
    cases: Sequence[StageCase],
    databases: Sequence[SteDatabase],
    torque: float | None = None,
) -> Document:
    """Return the document, in the newest version of REXS, with the results of stages as calculated.

    Parameters
    ----------
    document : Document
        As read, of any version.
    cases : sequence of StageCase
        Of the document; a database belongs to the stage whose pair its case has, and to those equal to it.
    databases : sequence of SteDatabase
    torque : float, optional
        On gear 1, N m; each table's largest by default.

    Raises
    ------
    BadInput
        A table of no stage's pair, a torque outside what is stored, or a document that cannot be upgraded.
    JobFailed
        A table with failed points.
    """
    results: dict[int, tuple[Attribute, ...]] = {}
    for database in databases:
        stage = _stage_of(cases, database)
        attributes = stage_results(gear_pair(stage.case), database, torque)
        results |= dict.fromkeys((stage.stage, *stage.equal), attributes)
    newest = replace(document, model=upgrade(document.model)[0])
    return with_calculated(newest, results)


def _stage_of(cases: Sequence[StageCase], database: SteDatabase) -> StageCase:
    """Return the stage whose pair a database is of."""
    pair = validated(Case, database.metadata.case).pair
    stage = next((stage for stage in cases if stage.case.pair == pair), None)
    if stage is None:
        names = ", ".join(stage.name for stage in cases) or "none"
        teeth = f"{pair.pinion.teeth}/{pair.wheel.teeth} teeth"
        bound = f"a table of the pair of a stage of the file, as opened: {names}"
        raise BadInput.of("database", teeth, bound, "Compute the table of the case that the import gives.")
    return stage
